"""The entry of the Blender extension: everything is in addon/."""

from .addon.blender import register, unregister

__all__ = ["register", "unregister"]
