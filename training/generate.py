"""Generate the data: ``python -m training.generate train|validation [--sets ...] [--processes N]``.

A shard is a file of examples, made from a seed of its own; a file that is there is not made again, and one that was
being made when the run was killed was never given its name. In the end ``manifest.json`` says what was made from what,
and all shards are put into one file (`compact`), which is what training reads.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import multiprocessing
import os
import platform
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path

import numba
import numpy as np
from tqdm import tqdm

from . import configuration, contours, reference, running
from .compact import pack
from .measures import qualities
from .provenance import code_version, network_hashes
from .teacher import Lesson, Meshed, centre, teach

SETS = ("sector", "running")


def drawn(rng: np.random.Generator, name: str, size: int) -> Iterator[tuple[np.ndarray, float, str]]:
    """Transformed contours (N_C, 2) of a set without end, their l_s and kinds."""
    while True:
        if name == "sector":
            yield *contours.draw_sector(rng), "sector"
        else:
            pool = running.pool(rng, size)
            for row in rng.permutation(len(pool.l_s)):
                yield pool.contour[row, : pool.n_contour[row]], pool.l_s[row], running.KINDS[pool.kind[row]]


def lesson_of(points: np.ndarray, l_s: float, kind: str, most: int) -> Lesson | None:
    """What is learnt from a contour; a star keeps its one vertex, so its reference is the teacher's mesh."""
    if kind != "star":
        return teach(points, l_s, most)
    mesh = centre(points)
    return None if mesh is None else Lesson(mesh, mesh)


def make_shard(seed: tuple[int, ...], name: str, size: int, most: int) -> dict[str, np.ndarray]:
    """Arrays of ``size`` examples: padded contours and the teacher's inner vertices, counts, l_s, kinds, qualities."""
    rng = np.random.default_rng(seed)
    reference.start()
    shard = {
        "contour": np.zeros((size, contours.LARGEST_CONTOUR, 2), np.float32),
        "inner": np.zeros((size, most, 2), np.float32),
        "n_contour": np.zeros(size, np.int8),
        "n_inner": np.zeros(size, np.int8),
        "n_reference": np.zeros(size, np.int16),
        "l_s": np.zeros(size, np.float32),
        "kind": np.zeros(size, np.int8),
        "reference": np.zeros((size, 2), np.float32),
        "teacher": np.zeros((size, 2), np.float32),
    }
    row = 0
    for points, l_s, kind in drawn(rng, name, size):
        lesson = lesson_of(points, l_s, kind, most)
        if lesson is None or len(lesson.taught.vertices) > len(points) + most:
            continue
        n, inner = len(points), lesson.taught.vertices[len(points) :]
        shard["contour"][row, :n], shard["n_contour"][row] = points, n
        shard["inner"][row, : len(inner)], shard["n_inner"][row] = inner, len(inner)
        shard["n_reference"][row] = len(lesson.reference.vertices) - n
        shard["l_s"][row], shard["kind"][row] = l_s, contours.KINDS.index(kind)
        shard["reference"][row], shard["teacher"][row] = _quality(lesson.reference), _quality(lesson.taught)
        row += 1
        if row == size:
            return shard


def _quality(mesh: Meshed) -> tuple[float, float]:
    return qualities(mesh.vertices, mesh.triangles)


def work(job: tuple[Path, tuple[int, ...], str, dict]) -> Path:
    """Make one shard's file, under another name until it is whole."""
    path, seed, name, config = job
    shard = make_shard(seed, name, config["shard"], config["largest_inner"])
    unfinished = path.with_suffix(f".{os.getpid()}.part")
    with open(unfinished, "wb") as file:
        np.savez(file, **shard)
    unfinished.rename(path)
    return path


def check_folder(folder: Path, config: dict, split: str) -> None:
    """Refuse a folder with shards that this configuration does not make: they would be taken for its own."""
    expected = {f"{name}-{number:05d}.npz" for name in SETS for number in range(config["shards"][split][name])}
    for file in sorted(folder.glob("*-*.npz")):
        if file.name not in expected or len(np.load(file)["l_s"]) != config["shard"]:
            raise SystemExit(f"{file} is of another configuration: remove it, or change training/config.toml")


def write_manifest(folder: Path, split: str, config: dict) -> None:
    """What is in a folder of shards, and what it was made from."""
    shards = {}
    for file in sorted(folder.glob("*-*.npz")):
        shard = np.load(file)
        counts = np.bincount(shard["kind"], minlength=len(contours.KINDS)).tolist()
        digest = hashlib.sha256(file.read_bytes()).hexdigest()
        shards[file.name] = {
            "examples": sum(counts),
            "kinds": dict(zip(contours.KINDS, counts, strict=True)),
            "sha256": digest,
        }
    manifest = {
        "split": split,
        "examples": sum(shard["examples"] for shard in shards.values()),
        "kinds": {kind: sum(shard["kinds"][kind] for shard in shards.values()) for kind in contours.KINDS},
        "seed": config["seeds"][split],
        "configuration": config,
        "reference": {"gmsh": reference.VERSION, "options": reference.OPTIONS},
        # The running system's contours depend on the library and its networks, too.
        "code": code_version(),
        "networks": network_hashes(),
        "versions": {"python": platform.python_version(), "numpy": np.__version__, "numba": numba.__version__},
        "shards": shards,
    }
    unfinished = folder / "manifest.part"
    unfinished.write_text(json.dumps(manifest, indent=1))
    unfinished.rename(folder / "manifest.json")


def main() -> None:
    """Make the shards that are missing."""
    config = configuration.read()["data"]
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("split", choices=["train", "validation"])
    parser.add_argument("--sets", nargs="+", choices=SETS, default=SETS)
    parser.add_argument("--processes", type=int, default=os.cpu_count())
    arguments = parser.parse_args()
    folder = configuration.ROOT / config["folder"] / arguments.split
    folder.mkdir(parents=True, exist_ok=True)
    seed = config["seeds"][arguments.split]
    jobs = [
        (folder / f"{name}-{number:05d}.npz", (seed, SETS.index(name), number), name, config)
        for name in arguments.sets
        for number in range(config["shards"][arguments.split][name])
    ]
    check_folder(folder, config, arguments.split)
    jobs = [job for job in jobs if not job[0].exists()]
    # Raises if a process is killed, instead of waiting for it.
    with ProcessPoolExecutor(arguments.processes, multiprocessing.get_context("spawn")) as pool:
        for done in tqdm(as_completed([pool.submit(work, job) for job in jobs]), total=len(jobs), unit="shard"):
            done.result()
    write_manifest(folder, arguments.split, config)
    pack(folder, folder.with_suffix(".npz"))


if __name__ == "__main__":
    main()
