"""What a scene says about its bake, and what the add-on remembers."""
import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, PointerProperty, StringProperty


class LuxelPreferences(bpy.types.AddonPreferences):
    bl_idname = __package__

    program: StringProperty(name="luxel", subtype="FILE_PATH", default="luxel",
                            description="Path of the program luxel; its name is enough if it is on the search path")

    def draw(self, context):
        self.layout.prop(self, "program")


def show_mode(settings, context):
    from . import light_nodes
    light_nodes.set_shown(settings.id_data, settings.show)


class LuxelSettings(bpy.types.PropertyGroup):
    objects: EnumProperty(
        name="Objects", default="VISIBLE",
        description="Meshes that get a lightmap; the others still block, reflect and emit light",
        items=[("VISIBLE", "Visible", "All meshes visible in the viewport and in renders"),
               ("SELECTED", "Selected", "The selected ones among the visible meshes")])
    size_by: EnumProperty(
        name="Size by", default="RESOLUTION",
        items=[("RESOLUTION", "Resolution", "Texels along each side of the lightmap"),
               ("DENSITY", "Density", "Texels per metre of surface")])
    resolution: IntProperty(name="Resolution", default=1024, min=16, max=16384, subtype="PIXEL")
    density: FloatProperty(name="Texels per metre", default=16, min=0.01, max=10000,
                           description="Texels per metre of surface")
    solver: EnumProperty(
        name="Solver", default="gather",
        items=[("gather", "Gather", "Random rays from each texel; suits every scene"),
               ("matrix", "Matrix", "Bounces between patches; results within seconds"),
               ("hemicube", "Hemicube", "Light at the vertices of a refined mesh; no noise"),
               ("hierarchical", "Hierarchical", "Mesh that follows shadow edges; for simple scenes"),
               ("reference", "Reference", "Path tracing; slow, for comparisons")])
    quality_by: EnumProperty(
        name="Quality by", default="QUALITY",
        items=[("QUALITY", "Preset", "Draft, good or best"),
               ("SAMPLES", "Samples", "Rays from each texel"),
               ("ERROR", "Error", "Rays until the error of the light is below this")])
    quality: EnumProperty(name="Quality", default="good",
                          items=[("draft", "Draft", "For a quick look"), ("good", "Good", ""), ("best", "Best", "")])
    samples: IntProperty(name="Samples", default=256, min=1, max=65535)
    max_error: FloatProperty(name="Largest error", default=0.02, min=0.0001, max=1, precision=4,
                             description="As a fraction of the light: 0.02 is 2 %")
    denoise: BoolProperty(name="Denoise", default=True)
    sky: EnumProperty(
        name="Sky", default="WORLD",
        items=[("WORLD", "World", "The colour or picture of the scene's world"),
               ("SKY", "Clear sky", "A clear sky with its sun"),
               ("NONE", "None", "No light from outside")])
    sun_azimuth: FloatProperty(name="Sun's bearing", default=2.356194, subtype="ANGLE",
                               description="0 degrees is Blender's Y axis, 90 degrees its X axis")
    sun_elevation: FloatProperty(name="Sun's elevation", default=0.698132, subtype="ANGLE", min=0, max=1.570796)
    layers: EnumProperty(
        name="Layers", default="none",
        items=[("none", "None", "One lightmap of all light"),
               ("per-light", "Per light", "One lightmap per light; mix them in the panel"),
               ("groups", "Groups", "One lightmap for all lights whose names differ only by a number at the end")])
    folder: StringProperty(name="Folder", subtype="DIR_PATH", default="//baked",
                           description="Folder of the lightmaps; by default beside the .blend file")
    apply_modifiers: BoolProperty(
        name="Apply modifiers", default=False,
        description="Apply the modifiers of every object whose faces they change. "
                    "If this is off, a scene with these objects is not baked")
    keep: BoolProperty(
        name="Keep for the next bake", default=True,
        description="The next bake traces only rays that an edit can have changed. Takes about nine bytes per ray "
                    "in the folder")
    show: EnumProperty(
        name="Show", default="BAKED", update=show_mode,
        items=[("BAKED", "Baked", "Surfaces in their colours, lit by the lightmap"),
               ("LIGHT", "Light alone", "The light on white surfaces"),
               ("SCENE", "Scene", "The materials as they were before the bake")])


class LuxelState(bpy.types.PropertyGroup):
    """What the panel shows of a bake."""

    progress: StringProperty(options={"SKIP_SAVE"})
    error: StringProperty(options={"SKIP_SAVE"})
    warnings: StringProperty(options={"SKIP_SAVE"})
    is_baking: BoolProperty(options={"SKIP_SAVE"})


CLASSES = (LuxelPreferences, LuxelSettings, LuxelState)


def register():
    for one in CLASSES:
        bpy.utils.register_class(one)
    bpy.types.Scene.luxel = PointerProperty(type=LuxelSettings)
    bpy.types.WindowManager.luxel = PointerProperty(type=LuxelState)


def unregister():
    del bpy.types.WindowManager.luxel
    del bpy.types.Scene.luxel
    for one in reversed(CLASSES):
        bpy.utils.unregister_class(one)
