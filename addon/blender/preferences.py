"""The add-on's preferences: what the operator starts with, where results go, and how the networks run."""

import bpy

from .layout import draw_settings
from .properties import annotations, read_settings
from .settings import Settings

# The extension's own name: this file is PACKAGE.addon.blender.preferences.
PACKAGE = __package__.removesuffix(".addon.blender")


def _providers(_self, _context, text: str) -> list[str]:
    """The providers of the onnxruntime that is installed; none of one that is broken, which meshing says."""
    try:
        import onnxruntime
    except ImportError:
        return []
    return [name for name in onnxruntime.get_available_providers() if text.lower() in name.lower()]


class TESSERA_PG_defaults(bpy.types.PropertyGroup):
    """What the operator starts with."""

    __annotations__ = annotations()


class TESSERA_preferences(bpy.types.AddonPreferences):
    """Stored by Blender with its own preferences."""

    bl_idname = PACKAGE

    defaults: bpy.props.PointerProperty(type=TESSERA_PG_defaults)
    collection: bpy.props.StringProperty(
        name="Collection",
        description="Name of the collection that new meshes go to, made if it is not there. Empty: those of the source",
    )
    threads: bpy.props.IntProperty(
        name="Threads",
        description="How many threads the networks use. One is best for most curves, as the networks are small",
        default=1,
        min=1,
        max=64,
    )
    provider: bpy.props.StringProperty(
        name="Provider",
        description="What of onnxruntime runs the networks; where it is not available, the CPU does. Others than the "
        "CPU need another onnxruntime than the one that comes with the add-on",
        default="CPUExecutionProvider",
        search=_providers,
    )

    def draw(self, context: bpy.types.Context) -> None:
        """All of it, the settings as in Adjust Last Operation."""
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        box = layout.box()
        box.label(text="Networks")
        box.prop(self, "threads")
        box.prop(self, "provider")
        box = layout.box()
        box.label(text="Results")
        box.prop(self, "collection")
        box = layout.box()
        box.label(text="What Mesh Curve by Tessera starts with, until it was used once in a session")
        draw_settings(box, self.defaults)


def _preferences() -> TESSERA_preferences | None:
    """None where the add-on is registered, but not enabled as one."""
    addon = bpy.context.preferences.addons.get(PACKAGE)
    return addon.preferences if addon else None


def default_settings() -> Settings:
    """What the operator starts with in the window."""
    preferences = _preferences()
    return read_settings(preferences.defaults) if preferences else Settings()


def collection_name() -> str:
    """The collection that new meshes go to, or nothing."""
    preferences = _preferences()
    return preferences.collection if preferences else ""


def execution() -> tuple[int, str]:
    """Threads and provider of the networks."""
    preferences = _preferences()
    return (preferences.threads, preferences.provider) if preferences else (1, "CPUExecutionProvider")


def register() -> None:
    """Make the preferences known."""
    bpy.utils.register_class(TESSERA_PG_defaults)
    bpy.utils.register_class(TESSERA_preferences)


def unregister() -> None:
    """Take them back."""
    bpy.utils.unregister_class(TESSERA_preferences)
    bpy.utils.unregister_class(TESSERA_PG_defaults)
