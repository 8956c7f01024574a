"""The panel in the render properties."""
import textwrap

import bpy

from . import arguments, light_nodes, scene_export

LETTERS_IN_A_LINE = 48


def write(layout, text, icon):
    """A sentence over as many lines as it needs."""
    for number, line in enumerate(textwrap.wrap(text, LETTERS_IN_A_LINE)):
        layout.label(text=line, icon=icon if number == 0 else "BLANK1")


class LUXEL_PT_bake(bpy.types.Panel):
    bl_idname, bl_label = "LUXEL_PT_bake", "luxel"
    bl_space_type, bl_region_type, bl_context = "PROPERTIES", "WINDOW", "render"

    def draw(self, context):
        settings, state = context.scene.luxel, context.window_manager.luxel
        layout = self.layout
        layout.use_property_split = True
        column = layout.column()
        column.enabled = not state.is_baking
        self.draw_settings(column, settings)
        if state.is_baking:
            layout.label(text=state.progress or "start", icon="TIME")
            layout.operator("luxel.cancel", icon="X")
        else:
            layout.operator("luxel.bake", icon="LIGHT_SUN")
        if state.error:
            write(layout, state.error, "ERROR")
        for sentence in state.warnings.splitlines():
            write(layout, sentence, "INFO")
        self.draw_results(layout, context.scene)

    @staticmethod
    def draw_settings(column, settings):
        column.prop(settings, "objects")
        column.prop(settings, "size_by")
        column.prop(settings, "resolution" if settings.size_by == "RESOLUTION" else "density")
        column.prop(settings, "solver")
        if settings.solver == "gather":
            column.prop(settings, "quality_by")
            column.prop(settings, {"QUALITY": "quality", "SAMPLES": "samples", "ERROR": "max_error"}[settings.quality_by])
            column.prop(settings, "layers")
        elif settings.solver == "reference":
            column.prop(settings, "samples")
        if arguments.can_denoise(settings):
            column.prop(settings, "denoise")
        if settings.solver == "gather":
            column.prop(settings, "keep")
        column.prop(settings, "sky")
        if settings.sky == "SKY":
            column.prop(settings, "sun_azimuth")
            column.prop(settings, "sun_elevation")
        column.prop(settings, "folder")
        column.prop(settings, "apply_modifiers")

    @staticmethod
    def draw_results(layout, scene):
        if light_nodes.group_name(scene) not in bpy.data.node_groups:
            return
        layout.separator()
        layout.prop(scene.luxel, "show", expand=True)
        for name, socket in light_nodes.layer_mixers(scene):
            layout.prop(socket, "default_value", text=name.removeprefix(scene_export.AREA_LAMP))
        layout.operator("luxel.remove", icon="TRASH")


def register():
    bpy.utils.register_class(LUXEL_PT_bake)


def unregister():
    bpy.utils.unregister_class(LUXEL_PT_bake)
