"""Many curves in one file, by the command: ``python -m benchmarks.blender_batch [10000 [EDGE_LENGTH]]``.

Measured in a process of its own with the bpy module: time a curve (reading and meshing), of the first thousand and of
the last, of writing the objects and the file, and the memory on the way. With a long edge length meshes are small, and
it is Blender's and the command's own time that shows.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .memory import peak

EDGE_LENGTH = 0.25
_SELF = [sys.executable, "-m", "benchmarks.blender_batch"]


def main(count: int, edge_length: float) -> int:
    """Make the file, run the command on it, and print what it took. Exit status 1 where the last curves are slower."""
    with tempfile.TemporaryDirectory() as folder:
        scene, report = Path(folder) / "scene.blend", Path(folder) / "report.json"
        subprocess.run([*_SELF, "make", str(count), str(scene)], check=True, stdout=subprocess.DEVNULL)
        command = [*_SELF, "run", str(scene), str(report), str(edge_length)]
        busy, memory, after = _watched(command, count)
        records = json.loads(report.read_text())["curves"]
        size = (Path(folder) / "out.blend").stat().st_size
    share = min(1000, count // 2)
    first, last = (busy[share] - busy[0]) / share, (busy[-1] - busy[-1 - share]) / share
    print(f"{count} curves, {sum(record['n_triangles'] for record in records)} triangles")
    print(f"reading and meshing: {1000 * (busy[-1] - busy[0]) / (count - 1):.1f} ms a curve of one core's time")
    print(f"the first {share}: {1000 * first:.1f} ms, the last {share}: {1000 * last:.1f} ms, ratio {last / first:.3f}")
    print(f"writing the objects and a file of {size / 1e6:.0f} MB: {after.busy - busy[-1]:.0f} s")
    megabytes = ", ".join(f"{each / 1e6:.0f}" for each in memory)
    print(
        f"memory at each tenth of the curves: {megabytes} MB; most, with all objects made: {after.memory / 1e6:.0f} MB"
    )
    return 0 if last <= 1.2 * first else 1


@dataclass(frozen=True)
class End:
    """busy: seconds of one core that a process took in all; memory: the most bytes it had."""

    busy: float
    memory: int


def _watched(command: list[str], count: int) -> tuple[list[float], list[int], End]:
    """Seconds of one core until each curve was meshed, bytes in memory at each tenth of the curves, and all of both.

    Seconds of a core, as those of the clock depend on what else the machine does.
    """
    busy, memory, said = [], [], ""
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as process:
        for line in process.stdout:
            if " triangles, " in line:
                busy.append(_busy(process.pid))
                if len(busy) % max(1, count // 10) == 0:
                    memory.append(_resident(process.pid))
            said = line if line.startswith("end ") else said
    if process.returncode or len(busy) != count:
        raise SystemExit(f"the command ended with status {process.returncode} after {len(busy)} curves")
    _, seconds, most = said.split()
    return busy, memory, End(float(seconds), int(most))


def _busy(pid: int) -> float:
    """Seconds of a core; to 10 ms, as the kernel counts them."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def _resident(pid: int) -> int:
    status = Path(f"/proc/{pid}/status").read_text()
    return 1024 * int(status.split("VmRSS:")[1].split()[0])


def make(count: int, path: Path) -> None:
    """Save a scene of closed curves of 6 to 15 points, about two units across, in rows of a hundred."""
    import bpy

    bpy.ops.wm.read_factory_settings(use_empty=True)
    random = np.random.default_rng(20)
    for number in range(count):
        n = int(random.integers(6, 16))
        angles, radii = np.arange(n) * 2 * np.pi / n, random.uniform(0.5, 1.0, n)
        points = np.zeros((n, 4), dtype=np.float32)
        points[:, 0], points[:, 1], points[:, 3] = radii * np.cos(angles), radii * np.sin(angles), 1.0
        curve = bpy.data.curves.new(f"Curve {number:05}", "CURVE")
        curve.dimensions = "2D"
        spline = curve.splines.new("POLY")
        spline.points.add(n - 1)
        spline.points.foreach_set("co", points.ravel())
        spline.use_cyclic_u = True
        obj = bpy.data.objects.new(curve.name, curve)
        obj.location = 3.0 * (number % 100), 3.0 * (number // 100), 0.0
        bpy.context.scene.collection.objects.link(obj)
    bpy.ops.wm.save_as_mainfile(filepath=str(path))


def run(scene: Path, report: Path, edge_length: str) -> int:
    """The command, and at its end the time and the most memory that it took."""
    import bpy

    import addon.blender
    from addon.blender import command

    bpy.ops.wm.read_factory_settings(use_empty=True)
    addon.blender.register()
    bpy.ops.wm.open_mainfile(filepath=str(scene))
    output = scene.with_name("out.blend")
    words = ["mesh", "--edge-length", edge_length, "--output", str(output), "--report", str(report)]
    status = command.run(words)
    print("end", time.process_time(), peak(), flush=True)
    addon.blender.unregister()
    return status


if __name__ == "__main__":
    if sys.argv[1:2] == ["make"]:
        make(int(sys.argv[2]), Path(sys.argv[3]))
    elif sys.argv[1:2] == ["run"]:
        sys.exit(run(Path(sys.argv[2]), Path(sys.argv[3]), sys.argv[4]))
    else:
        asked = sys.argv[1:]
        sys.exit(main(int(asked[0]) if asked else 10_000, float(asked[1]) if asked[1:] else EDGE_LENGTH))
