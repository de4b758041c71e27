"""The guarantee of the triangulation, on 100 000 examples: ``python -m benchmarks.guarantee [--examples 100000]``.

An example is a contour with inner vertices and a table, drawn by hypothesis from the strategies of the tests and judged
by the tests' own property (`tests.library.adversaries`). Exit status 0 only if all meshes are valid; a failure names
the contour. Another ``--seed`` draws other examples.
"""

from __future__ import annotations

import argparse

import hypothesis
from tqdm import tqdm

from tests.library.adversaries import Members, batches, check_guarantee, tables

# Batches in one run of hypothesis, which remembers all that it has drawn; and the fewest examples in one.
ROUND, FEWEST = 100, 30


def main() -> None:
    """Draw and check, with a progress bar."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--examples", type=int, default=100_000, help="at least so many (default: %(default)s)")
    parser.add_argument("--seed", type=int, default=0, help="of the examples (default: %(default)s)")
    arguments = parser.parse_args()
    done, number = 0, arguments.seed
    with tqdm(total=arguments.examples, unit="example") as progress:
        while done < arguments.examples:

            def check(batch: Members, table: str) -> None:
                check_guarantee(batch, table)
                progress.update(len(batch))

            settings = hypothesis.settings(
                max_examples=min(ROUND, -(-(arguments.examples - done) // FEWEST)),
                database=None,
                deadline=None,
                suppress_health_check=list(hypothesis.HealthCheck),
            )
            hypothesis.seed(number)(settings(hypothesis.given(batches, tables)(check)))()
            done, number = progress.n, number + 1
    print(f"{done} examples: all meshes valid")


if __name__ == "__main__":
    main()
