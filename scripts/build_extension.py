"""Build the extension with Blender's own command: a zip for each platform of the manifest, in build/extension/.

Each holds the add-on, the networks, and the onnxruntime wheels of its platform, those of requirements/wheels.lock: with
another or none of them there is no zip. The Blender is that of the environment variable BLENDER, or else the same
command as the bpy module carries it.
"""

import os
import subprocess
import sys
from pathlib import Path

from scripts.fetch_wheels import ROOT, unlike_the_lock

OUTPUT = ROOT / "build" / "extension"


def main() -> int:
    """Build and validate every zip. Exit status 1 where a wheel is not the locked one, or Blender says no."""
    if wrong := unlike_the_lock():
        print(f"not as in requirements/wheels.lock: {', '.join(wrong)}. Run `make wheels`", file=sys.stderr)
        return 1
    build(OUTPUT)
    for path in sorted(OUTPUT.glob("*.zip")):
        subprocess.run([*extension_command(), "validate", str(path)], check=True)
        print(f"{path.relative_to(ROOT)}: {path.stat().st_size / 1e6:.1f} MB")
    return 0


def build(output: Path) -> None:
    """Build into a folder, which is made, from wheels/ as it is."""
    output.mkdir(parents=True, exist_ok=True)
    for old in output.glob("*.zip"):
        old.unlink()
    command = [*extension_command(), "build", "--split-platforms"]
    subprocess.run([*command, "--source-dir", str(ROOT), "--output-dir", str(output)], check=True)


def extension_command() -> list[str]:
    """What comes before `build` or `validate`."""
    if blender := os.environ.get("BLENDER"):
        return [blender, "--command", "extension"]
    import bpy

    script = Path(bpy.utils.system_resource("SCRIPTS")) / "addons_core" / "bl_pkg" / "cli" / "blender_ext.py"
    return [sys.executable, str(script)]


if __name__ == "__main__":
    sys.exit(main())
