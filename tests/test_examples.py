"""The commands that make the documentation's pictures run, and write them."""

import pytest

from examples import gallery, pictures


@pytest.mark.parametrize(
    ("module", "draw", "name"), [(pictures, "way_of_the_data", "architecture.png"), (gallery, "main", "gallery.png")]
)
def test_a_picture_is_written(module, draw, name, tmp_path, monkeypatch):
    monkeypatch.setattr(module, "FOLDER", tmp_path)
    getattr(module, draw)()
    assert (tmp_path / name).stat().st_size > 50_000
