"""`blender -b scene.blend --command tessera mesh --edge-length 0.05 --output out.blend`."""

import argparse
import os
import sys

import bpy

from .kinds import READABLE

# What a file may well hold besides outlines, such as a camera's path: passed over, unless it was asked for by name.
_NOT_OUTLINES = frozenset({"open", "not-planar"})


def run(arguments: list[str]) -> int:
    """Mesh the planar closed curves of the open file.

    Exit status: 0 all, 1 some failed or none was there or the output was not written, 2 usage.
    """
    try:
        options = _parser().parse_args(arguments)
        output = _output(options.output)
        objects = _objects(options.objects)
    except SystemExit as usage:
        return int(usage.code or 0)
    outcomes = [_mesh_one(obj, options) for obj in objects]
    if "meshed" not in outcomes:
        print("tessera: nothing was meshed, and nothing written", file=sys.stderr)
        return 1
    try:
        bpy.ops.wm.save_as_mainfile(filepath=output, check_existing=False)
    except RuntimeError as error:
        print(f"tessera: '{output}' was not written: {str(error).strip()}", file=sys.stderr)
        return 1
    return 1 if "failed" in outcomes else 0


def _mesh_one(obj: bpy.types.Object, options: argparse.Namespace) -> str:
    """Mesh one object and print its line. Returns "meshed", "passed over" or "failed"."""
    from . import meshing  # here, so that enabling the add-on does not load the mesher

    try:
        outline = meshing.read(obj, bpy.context.evaluated_depsgraph_get())
        edge_length = options.edge_length
        if edge_length is None:
            edge_length = meshing.default_edge_length([outline])
        meshed = meshing.mesh(obj, outline, edge_length, options.boundary)
    except meshing.Failure as failure:
        if failure.reason in _NOT_OUTLINES and options.objects is None:
            print(f"{obj.name}: passed over ({failure.reason}): {failure}")
            return "passed over"
        print(f"{obj.name}: failed ({failure.reason}): {failure}", file=sys.stderr)
        return "failed"
    meshed.write()
    report = meshed.report
    seconds = sum(report.seconds.values())
    print(
        f"{obj.name}: {report.n_triangles} triangles, q_worst {report.q_worst:.3f}, q_mean {report.q_mean:.3f}, "
        f"{seconds:.2f} s"
    )
    for warning in report.warnings:
        print(f"{obj.name}: warning: {warning}", file=sys.stderr)
    return "meshed"


def _output(path: str) -> str:
    """The absolute path to write to. A folder that is not there is an error of usage, before anything is meshed."""
    path = os.path.abspath(os.path.expanduser(path))
    if os.path.isdir(path) or not os.path.isdir(os.path.dirname(path)):
        print(f"tessera: '{path}' cannot be written: give a file in a folder that exists", file=sys.stderr)
        raise SystemExit(2)
    return path


def _objects(names: list[str] | None) -> list[bpy.types.Object]:
    """The scene's curves and texts in the order of their names, or those named. A wrong name is an error of usage."""
    scene_objects = bpy.context.scene.objects
    if names is None:
        return sorted((obj for obj in scene_objects if obj.type in READABLE), key=lambda obj: obj.name)
    chosen = []
    for name in dict.fromkeys(names):  # each once
        obj = scene_objects.get(name)
        if obj is None or obj.type not in READABLE:
            print(f"tessera: there is no curve or text named '{name}' in the scene", file=sys.stderr)
            raise SystemExit(2)
        chosen.append(obj)
    return chosen


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="blender -b SCENE.blend --command tessera", description="Planar closed curves to even triangle meshes."
    )
    verbs = parser.add_subparsers(dest="verb", required=True)
    mesh = verbs.add_parser("mesh", help="mesh every planar closed curve and text of the scene, or those named")
    mesh.add_argument(
        "--edge-length", type=float, help="target edge length in world units (1/25 of each object's largest outline)"
    )
    mesh.add_argument("--objects", nargs="+", metavar="NAME", help="the objects to mesh (all curves and texts)")
    mesh.add_argument("--boundary", choices=("resample", "keep"), default="resample", help="vertices on the outline")
    mesh.add_argument("--output", required=True, metavar="OUT.blend", help="the file to write")
    return parser


_handle = None


def register() -> None:
    """Make `--command tessera` known to Blender."""
    global _handle
    _handle = bpy.utils.register_cli_command("tessera", run)


def unregister() -> None:
    """Take it back."""
    global _handle
    bpy.utils.unregister_cli_command(_handle)
    _handle = None
