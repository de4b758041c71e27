"""``python -m training.evaluate``: see the package."""

from __future__ import annotations

import os
import time

from .. import configuration
from . import report
from .goals import goals
from .parallel import find_all, time_tables


def main() -> None:
    """Evaluate, print the report and write it."""
    config = configuration.read()
    test, seed = config["test"], config["data"]["seeds"]["test"]
    start, processes = time.perf_counter(), os.cpu_count() or 1
    table_time = time_tables(seed)
    sets = find_all(test, seed, processes)
    folder = configuration.ROOT / "docs" / "results"
    print(report.write(folder, sets, goals(sets, table_time), test, seed))
    print(f"\n{time.perf_counter() - start:.0f} s in {processes} processes")


if __name__ == "__main__":
    main()
