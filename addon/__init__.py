"""All that the extension ships: `tessera`, the mesher, which knows nothing of Blender, and `blender`, the layer over it."""
