"""Bake, cancel, remove."""
import os
import shutil
import tempfile

import bpy

from . import arguments, light_nodes, process, results, scene_export

SCENE_FILE = "scene.glb"
SECONDS_BETWEEN_LOOKS = 0.25
MOST_UV_MAPS = 8
FAILURES = (ValueError, OSError, RuntimeError)

running = []  # the bake that is under way


def folder_of(context):
    """Where results lie, and whether pictures must be packed into the .blend file because that has no place yet."""
    stated = context.scene.luxel.folder or "//"
    stem = bpy.path.clean_name(os.path.splitext(os.path.basename(bpy.data.filepath))[0])
    name = "-".join(filter(None, (stem, bpy.path.clean_name(context.scene.name))))
    if bpy.data.filepath or not stated.startswith("//"):
        return os.path.join(os.path.abspath(bpy.path.abspath(stated)), name), False
    return os.path.join(bpy.app.tempdir or tempfile.gettempdir(), "luxel", name), True


def names_of(objects):
    return ", ".join(f"'{one.name}'" for one in objects[:5])


def check(context):
    """The objects that get a lightmap. Raises ValueError with a sentence."""
    settings = context.scene.luxel
    objects = scene_export.baked_objects(context)
    if not objects:
        raise ValueError("No mesh is selected" if settings.objects == "SELECTED" else "There is no visible mesh")
    linked = [one for one in objects if one.library is not None]
    if linked:
        raise ValueError(f"Linked from another file: {names_of(linked)}; make them local")
    full = [one for one in objects if len(one.data.uv_layers) >= MOST_UV_MAPS and
            light_nodes.UV_NAME not in one.data.uv_layers]
    if full:
        raise ValueError(f"No room for another UV map in {names_of(full)}: Blender allows eight; remove one")
    changed = [one for one in objects if results.changed_by_modifiers(context, one)]
    if changed and not settings.apply_modifiers:
        raise ValueError(f"Modifiers change the faces of {names_of(changed)}; tick Apply modifiers, or apply them")
    if not scene_export.has_light(context):
        raise ValueError("There is no light in the scene")
    return objects


class Work:
    """A bake from a scene to that scene."""

    def __init__(self, context):
        settings = context.scene.luxel
        luxel = process.find_luxel(program(context))
        self.scene, self.objects = context.scene.name, [one.name for one in check(context)]
        self.folder, self.packs = folder_of(context)
        os.makedirs(self.folder, exist_ok=True)
        if not settings.keep:
            shutil.rmtree(os.path.join(self.folder, "cache"), ignore_errors=True)
        scene = os.path.join(self.folder, SCENE_FILE)
        self.about = scene_export.write_scene(context, scene)
        light, about_world = scene_export.world_light(context, self.folder)
        if about_world:
            self.about.append(about_world)
        self.bake = process.Bake(luxel, arguments.bake(settings, scene, self.folder, light))

    def take(self, context):
        """Shows the results. Returns sentences that should be read."""
        report = self.bake.finish()
        scene = bpy.data.scenes.get(self.scene)
        if scene is None:
            raise RuntimeError("The baked scene no longer exists")
        if context.mode != "OBJECT":
            bpy.ops.object.mode_set(mode="OBJECT")
        objects = [scene.objects[name] for name in self.objects if name in scene.objects]
        gone = [name for name in self.objects if name not in scene.objects]
        about = [f"'{name}' is no longer in the scene." for name in gone]
        with context.temp_override(scene=scene, view_layer=scene.view_layers[0]):
            about += results.apply(bpy.context, objects, self.folder, report, self.packs)
        return self.about + self.bake.warnings + about


def program(context):
    addon = context.preferences.addons.get(__package__)
    return bpy.path.abspath(addon.preferences.program) if addon is not None else "luxel"


class LUXEL_OT_bake(bpy.types.Operator):
    """Bake the light of the scene into lightmaps"""

    bl_idname, bl_label = "luxel.bake", "Bake"
    bl_options = {"UNDO"}

    @classmethod
    def poll(cls, context):
        return not context.window_manager.luxel.is_baking and context.mode == "OBJECT"

    def begin(self, context):
        state = context.window_manager.luxel
        state.error = state.warnings = state.progress = ""
        try:
            self.work = Work(context)
        except FAILURES as error:
            return self.fail(context, error)
        running.append(self.work.bake)
        state.is_baking = True
        return None

    def fail(self, context, error):
        state = context.window_manager.luxel
        state.is_baking, state.error = False, str(error)
        self.report({"ERROR"}, str(error))
        return {"CANCELLED"}

    def end(self, context):
        state = context.window_manager.luxel
        state.is_baking, state.progress = False, ""
        running.clear()
        try:
            state.warnings = "\n".join(self.work.take(context))
        except process.Stopped as stop:
            self.report({"INFO"}, str(stop))
            return {"CANCELLED"}
        except FAILURES as error:
            return self.fail(context, error)
        return {"FINISHED"}

    def execute(self, context):
        """Without a window: waits."""
        return self.begin(context) or self.end(context)

    def invoke(self, context, event):
        failed = self.begin(context)
        if failed:
            return failed
        manager = context.window_manager
        self.timer = manager.event_timer_add(SECONDS_BETWEEN_LOOKS, window=context.window)
        manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        bake = self.work.bake
        context.window_manager.luxel.progress = process.text_of_progress(bake.stage, bake.share, bake.seconds_left)
        for area in context.screen.areas:
            if area.type == "PROPERTIES":
                area.tag_redraw()
        if not bake.is_over():
            return {"PASS_THROUGH"}
        context.window_manager.event_timer_remove(self.timer)
        return self.end(context)

    def cancel(self, context):
        """Blender ends this when it opens another file or closes the window."""
        self.work.bake.cancel()
        running.clear()
        context.window_manager.event_timer_remove(self.timer)
        context.window_manager.luxel.is_baking = False


class LUXEL_OT_cancel(bpy.types.Operator):
    """Stop the bake; the scene stays as it is"""

    bl_idname, bl_label = "luxel.cancel", "Cancel"

    def execute(self, context):
        for bake in running:
            bake.cancel()
        if not running:
            context.window_manager.luxel.is_baking = False
        return {"FINISHED"}


class LUXEL_OT_remove(bpy.types.Operator):
    """Remove the lightmaps from the scene's materials and meshes"""

    bl_idname, bl_label = "luxel.remove", "Remove"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        results.forget(context.scene)
        group = bpy.data.node_groups.get(light_nodes.group_name(context.scene))
        if group is not None:
            bpy.data.node_groups.remove(group)
        return {"FINISHED"}


CLASSES = (LUXEL_OT_bake, LUXEL_OT_cancel, LUXEL_OT_remove)


def register():
    for one in CLASSES:
        bpy.utils.register_class(one)


def unregister():
    for bake in running:
        bake.cancel()
    for one in reversed(CLASSES):
        bpy.utils.unregister_class(one)
