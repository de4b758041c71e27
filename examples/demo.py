"""Mesh a logo, an airfoil and a text in headless Blender: `make demo`.

Prints the triangles, the qualities and the seconds of each, and writes build/demo.blend and build/demo.png.
"""

import time
from dataclasses import dataclass
from pathlib import Path

import bpy
import numpy as np

import addon.blender
from addon.tessera import element_quality
from examples.wireframes import draw

ROOT = Path(__file__).resolve().parents[1]
BUILD = ROOT / "build"


@dataclass(frozen=True)
class Piece:
    """What one curve became: vertices (n, 2) in the world's XY plane, triangles (m, 3), quality (m,)."""

    vertices: np.ndarray
    triangles: np.ndarray
    quality: np.ndarray


def main() -> None:
    """Draw the three, mesh them with the operator, print a line for each, and save."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    addon.blender.register()
    BUILD.mkdir(exist_ok=True)

    panels = {}
    for title, make, edge_length in (("logo", logo, 0.06), ("airfoil", airfoil, 0.035), ("text", words, 0.036)):
        curves = make()
        bpy.context.view_layer.update()
        start = time.perf_counter()
        meshes = mesh(curves, edge_length)
        seconds = time.perf_counter() - start
        panels[title] = [piece(obj) for obj in meshes]
        quality = np.concatenate([p.quality for p in panels[title]])
        print(
            f"{title:8} {len(quality):5} triangles  q_worst {quality.min():.3f}  q_mean {quality.mean():.3f}  "
            f"{seconds:.2f} s"
        )

    bpy.ops.wm.save_as_mainfile(filepath=str(BUILD / "demo.blend"))
    addon.blender.unregister()
    draw(panels, BUILD / "demo.png")
    print(f"wrote {BUILD / 'demo.blend'} and {BUILD / 'demo.png'}")


def logo() -> list[bpy.types.Object]:
    """The logo's SVG file, by Blender's own importer: a curve object for each path, made 2 units wide."""
    import addon_utils  # Blender's own; it can be imported only once bpy has been

    addon_utils.enable("io_curve_svg")
    bpy.ops.import_curve.svg(filepath=str(ROOT / "examples" / "logo.svg"))
    curves = list(bpy.data.collections["logo.svg"].objects)
    width = max(corner[0] for curve in curves for corner in curve.bound_box)
    for curve in curves:
        curve.scale *= 2.0 / width
        for spline in curve.data.splines:
            spline.resolution_u = 24
    return curves


def airfoil() -> list[bpy.types.Object]:
    """NACA 2412 with a sharp trailing edge, chord 3, as a closed poly curve."""
    camber, place, thickness, n = 0.02, 0.4, 0.12, 80
    x = 0.5 * (1.0 - np.cos(np.linspace(0.0, np.pi, n)))
    half = 5 * thickness * (0.2969 * np.sqrt(x) - 0.1260 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1036 * x**4)
    ahead = x < place
    line = np.where(ahead, camber / place**2, camber / (1 - place) ** 2) * np.where(
        ahead, 2 * place * x - x**2, 1 - 2 * place + 2 * place * x - x**2
    )
    slope = np.arctan(np.gradient(line, x))
    upper = np.column_stack([x - half * np.sin(slope), line + half * np.cos(slope)])
    lower = np.column_stack([x + half * np.sin(slope), line - half * np.cos(slope)])
    loop = 3.0 * np.concatenate([upper[::-1], lower[1:-1]])  # trailing edge, over the top, nose, underneath

    curve = bpy.data.curves.new("NACA 2412", "CURVE")
    curve.dimensions = "2D"
    spline = curve.splines.new("POLY")
    spline.points.add(len(loop) - 1)
    spline.points.foreach_set("co", np.column_stack([loop, np.zeros(len(loop)), np.ones(len(loop))]).ravel())
    spline.use_cyclic_u = True
    return [_place(bpy.data.objects.new("NACA 2412", curve), (2.6, 1.6))]


def words() -> list[bpy.types.Object]:
    """A text, two of its letters with holes, in Blender's own font."""
    data = bpy.data.curves.new("DO MESH", "FONT")
    data.body = "DO MESH"
    data.size = 0.72
    return [_place(bpy.data.objects.new("DO MESH", data), (2.6, 0.45))]


def mesh(curves: list[bpy.types.Object], edge_length: float) -> list[bpy.types.Object]:
    """Select the curves and run the operator, as a user would; returns the mesh objects, which it leaves selected."""
    bpy.ops.object.select_all(action="DESELECT")
    for curve in curves:
        curve.select_set(True)
    bpy.context.view_layer.objects.active = curves[0]
    bpy.ops.tessera.mesh_curve(edge_length=edge_length)
    return list(bpy.context.selected_objects)


def piece(obj: bpy.types.Object) -> Piece:
    """A mesh object's arrays, in the world's XY plane."""
    bpy.context.view_layer.update()
    points = np.empty((len(obj.data.vertices), 3), dtype=np.float32)
    triangles = np.empty((len(obj.data.polygons), 3), dtype=np.int32)
    obj.data.vertices.foreach_get("co", points.ravel())
    obj.data.polygons.foreach_get("vertices", triangles.ravel())
    matrix = np.array(obj.matrix_world)
    vertices = (points @ matrix[:3, :3].T + matrix[:3, 3])[:, :2].astype(np.float64)
    return Piece(vertices, triangles, element_quality(vertices, triangles))


def _place(obj: bpy.types.Object, at: tuple[float, float]) -> bpy.types.Object:
    obj.location = (*at, 0.0)
    bpy.context.scene.collection.objects.link(obj)
    return obj


if __name__ == "__main__":
    main()
