"""Run by Blender: bakes the diffuse light of a glTF file with Cycles and says what the bake took.

    blender -b --factory-startup --python cycles_bake.py -- JOB.json

The job says scene, resolution, samples, seed, threads, denoise, image (.exr to write) and report (.json to write).
The image holds irradiance / pi, its top row is v = 0 of the file's TEXCOORD_1, alpha is 1 where a surface was baked.
"""
import json
import math
import os
import sys
import time

import bpy
import numpy

if "bool" not in vars(numpy):
    numpy.bool = bool  # the importer of Blender 3.4 uses a name that numpy 1.24 has dropped

UV = "lightmap"


def imported(path):
    """All meshes of the file as one object with one list of UVs, so that a single bake does the work."""
    for thing in list(bpy.data.objects):
        bpy.data.objects.remove(thing)
    bpy.ops.import_scene.gltf(filepath=path, convert_lighting_mode="RAW")
    meshes = [thing for thing in bpy.data.objects if thing.type == "MESH"]
    for thing in meshes:
        layers = thing.data.uv_layers
        if len(layers) < 2:
            sys.exit(f"{path}: the mesh {thing.name} has no TEXCOORD_1")
        layers[0].name, layers[1].name = "colour", UV
    bpy.ops.object.select_all(action="DESELECT")
    for thing in meshes:
        if thing.data.users > 1:
            thing.data = thing.data.copy()
        thing.select_set(True)
    bpy.context.view_layer.objects.active = meshes[0]
    if len(meshes) > 1:
        bpy.ops.object.join()
    joined = bpy.context.view_layer.objects.active
    joined.data.uv_layers.active = joined.data.uv_layers[UV]
    return joined


class Surface:
    """A material that the importer has made, and the nodes that replace it: luxel's surfaces."""

    def __init__(self, material):
        self.material, self.nodes, self.links = material, material.node_tree.nodes, material.node_tree.links
        self.principled = next((node for node in self.nodes if node.type == "BSDF_PRINCIPLED"), None)
        if self.principled is None or material.blend_method == "BLEND":
            sys.exit(f"The material {material.name} is unlit, blended, or of another kind that is not compared.")
        metallic = self.principled.inputs["Metallic"]
        if metallic.is_linked or metallic.default_value != 0:
            sys.exit(f"The material {material.name} is a metal, which is not compared.")

    def node(self, kind):
        return self.nodes.new(f"ShaderNode{kind}")

    def feed(self, socket, name):
        """Gives a socket what feeds this input of the importer's material."""
        source = self.principled.inputs[name]
        if source.is_linked:
            self.links.new(source.links[0].from_socket, socket)
        else:
            socket.default_value = source.default_value

    def mixed(self, share, first, second):
        """`second` by its share, else `first`."""
        mix = self.node("MixShader")
        for socket, source in zip(mix.inputs, (share, first, second)):
            self.links.new(source, socket)
        return mix.outputs[0]

    def front(self):
        diffuse, emission = self.node("BsdfDiffuse"), self.node("Emission")
        self.feed(diffuse.inputs["Color"], "Base Color")
        self.feed(emission.inputs["Color"], "Emission")
        self.feed(emission.inputs["Strength"], "Emission Strength")
        color = emission.inputs["Color"]
        if not color.is_linked and not any(list(color.default_value)[:3]):
            return diffuse.outputs[0]
        both = self.node("AddShader")
        self.links.new(diffuse.outputs[0], both.inputs[0])
        self.links.new(emission.outputs[0], both.inputs[1])
        return both.outputs[0]

    def black(self):
        diffuse = self.node("BsdfDiffuse")
        diffuse.inputs["Color"].default_value = (0, 0, 0, 1)
        return diffuse.outputs[0]

    def seen(self):
        """The share of a surface that is not cut out: 0 or 1."""
        cut = self.node("Math")
        cut.operation = "GREATER_THAN"
        cut.inputs[1].default_value = self.material.alpha_threshold
        self.feed(cut.inputs[0], "Alpha")
        return cut.outputs[0]

    def replace(self):
        """Diffuse, with black backs unless double-sided, cut out where alpha is below the cutoff."""
        shader = self.front()
        if self.material.use_backface_culling:
            shader = self.mixed(self.node("NewGeometry").outputs["Backfacing"], shader, self.black())
        if self.material.blend_method == "CLIP":
            shader = self.mixed(self.seen(), self.node("BsdfTransparent").outputs[0], shader)
        output = next(node for node in self.nodes if node.type == "OUTPUT_MATERIAL")
        self.links.new(shader, output.inputs["Surface"])


def convert_lights():
    """glTF's units as Cycles takes them, without a factor between lumen and watt: E = pi x the bake in all cases.

    A sun's strength is the irradiance of a surface that faces it: lux as they are. A point's power P gives the
    intensity P / (4 pi): candela times 4 pi. Emitted radiance is a radiance in both.
    """
    for light in bpy.data.lights:
        if light.type == "SUN":
            light.angle = light.get("luxel", {}).get("angular_radius_rad", 0) * 2
        elif light.type == "POINT":
            light.energy *= 4 * math.pi
            light.shadow_soft_size = 0
        else:
            sys.exit(f"The light {light.name} is a spot, which is not compared.")
        light.cycles.max_bounces = 1024


def set_cycles(job):
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.threads_mode, scene.render.threads = "FIXED", job["threads"]
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.samples, cycles.seed = job["samples"], job["seed"]
    cycles.use_adaptive_sampling = False
    cycles.use_denoising = job["denoise"]
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    cycles.max_bounces = cycles.diffuse_bounces = cycles.transparent_max_bounces = 1024
    world = scene.world or bpy.data.worlds.new("black")
    scene.world = world
    world.use_nodes = False
    world.color = (0, 0, 0)


def baked_image(job, thing):
    image = bpy.data.images.new("light", job["resolution"], job["resolution"], alpha=True, float_buffer=True)
    image.generated_color = (0, 0, 0, 0)
    image.colorspace_settings.name = "Linear"
    for slot in thing.material_slots:
        node = slot.material.node_tree.nodes.new("ShaderNodeTexImage")
        node.image = image
        slot.material.node_tree.nodes.active = node
    return image


def can_denoise():
    try:
        import _cycles
        return bool(_cycles.with_openimagedenoise)
    except (ImportError, AttributeError):
        return False


def main():
    with open(sys.argv[sys.argv.index("--") + 1], encoding="utf-8") as file:
        job = json.load(file)
    thing = imported(job["scene"])
    for material in {slot.material for slot in thing.material_slots}:
        Surface(material).replace()
    convert_lights()
    set_cycles(job)
    image = baked_image(job, thing)
    start, start_cpu = time.perf_counter(), time.process_time()
    bpy.ops.object.bake(type="DIFFUSE", pass_filter={"DIRECT", "INDIRECT"}, margin=0, use_clear=True, uv_layer=UV)
    seconds, cpu = time.perf_counter() - start, time.process_time() - start_cpu
    settings = bpy.context.scene.render.image_settings
    settings.file_format, settings.color_mode, settings.color_depth = "OPEN_EXR", "RGBA", "32"
    settings.exr_codec = "ZIP"
    image.save_render(job["image"])
    with open(job["report"], "w", encoding="utf-8") as file:
        json.dump({"seconds": seconds, "cpu_seconds": cpu, "blender": bpy.app.version_string,
                   "can_denoise": can_denoise()}, file)


try:
    main()
except BaseException as error:  # Blender itself would go on and end with code 0
    print(error if isinstance(error, SystemExit) else repr(error), file=sys.stderr)
    sys.stderr.flush()
    os._exit(1)
