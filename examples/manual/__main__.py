"""The manual's pictures: ``python -m examples.manual [window | settings]`` writes docs/images/manual/ and window.png.

Those of Blender's window need the tool that the environment variable REAL_BLENDER names, whose `gui` opens a window on
a virtual screen, and the wheels of `make wheels`, as the extension is built and installed into folders of its own.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

from scripts.build_extension import build
from scripts.fetch_wheels import ROOT, unlike_the_lock

from . import settings

PICTURES = ROOT / "docs" / "images" / "manual"
TOOL = Path(os.environ.get("REAL_BLENDER") or ROOT.parent / "shared" / "tools" / "real-blender")
VERSION = "4.3"


def main() -> int:
    """Make the pictures that are named, or all."""
    PICTURES.mkdir(parents=True, exist_ok=True)
    wanted = sys.argv[1:] or ["window", "settings"]
    if "settings" in wanted:
        settings.draw_all(PICTURES)
    return window() if "window" in wanted else 0


def window() -> int:
    """Build, install, and walk through Blender's window; exit status 1 where something is missing or failed."""
    if wrong := unlike_the_lock():
        print(f"not as in requirements/wheels.lock: {', '.join(wrong)}. Run `make wheels`", file=sys.stderr)
        return 1
    if not TOOL.exists():
        print("no tool that opens Blender's window: name one with REAL_BLENDER", file=sys.stderr)
        return 1
    with tempfile.TemporaryDirectory() as folder:
        build(Path(folder) / "zips")
        (extension,) = (Path(folder) / "zips").glob("*linux_x64.zip")
        environment = os.environ | {
            "BLENDER_USER_RESOURCES": str(Path(folder) / "user"),
            "PYTHONNOUSERSITE": "1",
            "PYTHONPATH": str(ROOT),
            "MANUAL_PICTURES": str(PICTURES),
        }
        install = ("--command", "extension", "install-file", "--repo", "user_default", "--enable", extension)
        subprocess.run([TOOL, "run", VERSION, *install], env=environment, check=True)
        last = Path(folder) / "last.png"
        script = Path(__file__).with_name("walk.py")
        flags = ("--enable-event-simulate", "--python-use-system-env")
        ran = subprocess.run([TOOL, "gui", VERSION, last, script, *flags], env=environment, timeout=600)
    return ran.returncode


if __name__ == "__main__":
    sys.exit(main())
