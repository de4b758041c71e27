"""The thin layer between Blender and the mesher: it reads curves, calls `tessera`, and writes mesh objects.

Only this folder imports `bpy`. The mesher is imported where it is called, so that enabling the add-on stays quick.
"""

from . import command, following, linked, menus, notes, operators, overlay, panel, preferences

_MODULES = (preferences, linked, following, notes, operators, menus, overlay, panel, command)


def register() -> None:
    """Make the operators, then what refers to them."""
    for module in _MODULES:
        module.register()


def unregister() -> None:
    """Undo `register`, in the opposite order."""
    for module in reversed(_MODULES):
        module.unregister()
