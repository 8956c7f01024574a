"""luxel in Blender: bakes the light of a scene into lightmaps, and shows them."""

bl_info = {
    "name": "luxel",
    "description": "Bake diffuse light into lightmaps",
    "author": "The authors of luxel",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "Properties > Render > luxel",
    "category": "Render",
}


def register():
    from . import operators, panel, settings
    for part in (settings, operators, panel):
        part.register()


def unregister():
    from . import operators, panel, settings
    for part in (panel, operators, settings):
        part.unregister()
