"""`blender -b scene.blend --command tessera mesh --output out.blend`: batch work without a window."""

import bpy

from .run import run

__all__ = ["register", "run", "unregister"]

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
