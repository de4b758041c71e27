"""Run inside a Blender with the extension installed, by test_reading_installed.py.

Meshes an object of every kind by the extension's own files, and writes what came out as JSON after `--`.
"""

import importlib
import json
import sys
from pathlib import Path

import bpy
import numpy as np

# What the tests call `addon` is the installed extension's, and not the one beside them.
sys.modules["addon"] = importlib.import_module("bl_ext.user_default.tessera.addon")
sys.path.append(str(Path(__file__).resolve().parents[2]))
bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)

from addon.blender import reading, writing  # noqa: E402
from tests.blender import sources  # noqa: E402
from tests.blender.drawing import circle, poly_curve, star, text  # noqa: E402

flat = np.column_stack([star(), np.zeros(14)])


def nurbs():
    bpy.ops.curve.primitive_nurbs_circle_add()
    return bpy.context.object


def edited():
    bpy.ops.mesh.primitive_cube_add()
    obj = bpy.context.object
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    return obj


def facts(obj):
    data = obj.data
    return {
        "type": obj.type,
        "triangles": len(data.polygons),
        "corners": sorted({polygon.loop_total for polygon in data.polygons}),
        "euler": len(data.vertices) - len(data.edges) + len(data.polygons),
        "broken": data.validate(verbose=True),
    }


KINDS = {
    "bezier": circle,
    "nurbs": nurbs,
    "poly": lambda: poly_curve(star(), star() * 0.5),
    "text": lambda: text("B&o"),
    "curves": lambda: sources.hair_curves(flat, kind="CATMULL_ROM"),
    "strokes": lambda: sources.grease_pencil(flat),
    "mesh": lambda: sources.mesh_object(flat, [], [range(14)]),
    "instance": lambda: sources.instance_of(sources.collection_of(poly_curve(star()))),
}
made = {}
for name, draw in KINDS.items():
    source = draw()
    made[name] = facts(writing.write_mesh(source, sources.meshed(sources.read(source))))
    made[f"{name} in place"] = facts(writing.write_in_place(source, sources.meshed(sources.read(source))))
cube = edited()
parts = [outline.subdivided(0.4) for outline in sources.read(cube)]
writing.write_part(cube, sources.meshed(parts, 0.4))
bpy.ops.object.mode_set(mode="OBJECT")
made["edited"] = facts(cube)
found = {"file": reading.__file__, "made": made}
Path(sys.argv[sys.argv.index("--") + 1]).write_text(json.dumps(found))
