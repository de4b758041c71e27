"""All that the extension ships: `tessera`, a mesher that knows nothing of Blender, and `blender`, the layer over it."""
