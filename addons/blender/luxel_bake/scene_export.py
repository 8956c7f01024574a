"""The scene as luxel reads it: a binary glTF file in lux and candela.

Blender's exporter, in its lighting mode SPEC, gives lamps 683 lumens for each watt. Surfaces that shine, and the world,
get the same factor here, so that all light is in one unit: radiances in nits, lightmaps in lux.
"""
import contextlib
import math
import os

import bpy
import numpy
from mathutils import Vector

from . import gltf_file, light_nodes, matching
from .light_nodes import LUMENS_PER_WATT, UV_NAME

STRENGTH = "KHR_materials_emissive_strength"
AREA_LAMP = "luxel area lamp "
DISC_CORNERS = 32
GREY = {"name": light_nodes.GREY, "doubleSided": True,
        "pbrMetallicRoughness": {"baseColorFactor": [0.8, 0.8, 0.8, 1], "metallicFactor": 0, "roughnessFactor": 0.5}}


def takes_part(one):
    """Whether an object is seen and rendered, as Blender's exporter asks."""
    hidden = all(collection.hide_render for collection in one.users_collection)
    return not one.hide_render and one.visible_get() and not hidden


def meshes_in(context):
    return [one for one in context.view_layer.objects if one.type == "MESH" and takes_part(one)]


def baked_objects(context):
    """Those meshes that get a lightmap. The custom property luxel_bake = False leaves one out."""
    meshes = [one for one in meshes_in(context) if one.get("luxel_bake", True)]
    if context.scene.luxel.objects == "SELECTED":
        meshes = [one for one in meshes if one.select_get()]
    return meshes


# Blender's exporter makes surfaces of the first kinds, which cast shadows and have no lightmap, and of the others none.
WITHOUT_LIGHTMAP = {"FONT": "text", "CURVE": "curve", "SURFACE": "surface"}
LEFT_OUT = {"META": "metaball", "CURVES": "hair", "POINTCLOUD": "point cloud", "VOLUME": "volume",
            "GPENCIL": "grease pencil", "GREASEPENCIL": "grease pencil"}


def has_surface(one, depsgraph):
    """Whether a curve or text has any: a path has none."""
    evaluated = one.evaluated_get(depsgraph)
    try:
        return len(evaluated.to_mesh().polygons) > 0
    finally:
        evaluated.to_mesh_clear()


def listed(names):
    return ", ".join(names[:5]) + (f" and {len(names) - 5} more" if len(names) > 5 else "")


def about_what_is_no_mesh(context):
    """Sentences about what is seen and rendered, and gets no lightmap because it is no mesh of its own."""
    depsgraph = context.evaluated_depsgraph_get()
    parts = [one for one in context.view_layer.objects if takes_part(one)]
    without = [f"{WITHOUT_LIGHTMAP[one.type]} '{one.name}'" for one in parts
               if one.type in WITHOUT_LIGHTMAP and has_surface(one, depsgraph)]
    left_out = [f"{LEFT_OUT[one.type]} '{one.name}'" for one in parts if one.type in LEFT_OUT]
    instancers = [one.parent.original for one in depsgraph.object_instances
                  if one.is_instance and one.object.type == "MESH"]
    # Curves and texts instance a mesh of their own.
    copies = {one.name: None for one in instancers
              if takes_part(one) and one.type not in {**WITHOUT_LIGHTMAP, **LEFT_OUT}}
    about = []
    if without:
        about.append(f"Left without a lightmap: {listed(without)}; convert them to meshes (Object > Convert > Mesh).")
    if left_out:
        about.append(f"Left out of the bake: {listed(left_out)}; convert them to meshes (Object > Convert > Mesh).")
    if copies:
        names = listed([f"'{name}'" for name in copies])
        about.append(f"Left without a lightmap: the instances of {names}; make them real (Object > Apply).")
    return about


def about_what_is_left_out(context):
    """Sentences about what luxel takes otherwise than Blender."""
    about = []
    hidden = [one.name for one in context.view_layer.objects
              if one.type in {"MESH", "LIGHT"} and not one.hide_render and not one.visible_get()]
    if hidden:
        about.append(f"Hidden in the viewport and left out of the bake: {', '.join(hidden[:5])}.")
    for one in context.view_layer.objects:
        if one.type != "LIGHT" or not takes_part(one):
            continue
        if one.data.type == "AREA" and one.data.spread < math.pi - 1e-3:
            about.append(f"Area lamp '{one.name}' has a spread of less than 180 degrees; luxel ignores the spread.")
        if one.data.use_nodes:
            about.append(f"Lamp '{one.name}' has nodes; luxel does not support them.")
    return about + about_what_is_no_mesh(context)


@contextlib.contextmanager
def without_lightmap_uvs(objects):
    """Takes the lightmap's coordinates away for a while: a second bake then finds the meshes of the first one."""
    kept = []
    for mesh in {one.data for one in objects}:
        layers = mesh.uv_layers
        layer = layers.get(UV_NAME)
        if layer is None:
            continue
        coordinates = numpy.empty(2 * len(mesh.loops), numpy.float32)
        layer.data.foreach_get("uv", coordinates)
        kept.append((mesh, coordinates, layers.active.name, next(one.name for one in layers if one.active_render)))
        layers.remove(layer)
    try:
        yield
    finally:
        for mesh, coordinates, active, rendered in kept:
            layers = mesh.uv_layers
            layers.new(name=UV_NAME, do_init=False).data.foreach_set("uv", coordinates)
            layers.active = layers[active]
            layers[rendered].active_render = True


def area_corners(lamp):
    """Around an area lamp, in its own space, clockwise seen from its +Z."""
    across = lamp.size
    along = lamp.size if lamp.shape in {"SQUARE", "DISK"} else lamp.size_y
    if lamp.shape in {"SQUARE", "RECTANGLE"}:
        return [Vector((x * across / 2, y * along / 2, 0)) for x, y in ((-1, -1), (-1, 1), (1, 1), (1, -1))]
    turns = [-2 * math.pi * k / DISC_CORNERS for k in range(DISC_CORNERS)]
    # As wide as has the area of the ellipse.
    wider = math.sqrt(2 * math.pi / (DISC_CORNERS * math.sin(2 * math.pi / DISC_CORNERS)))
    return [Vector((math.cos(t) * across / 2 * wider, math.sin(t) * along / 2 * wider, 0)) for t in turns]


def area_of(corners):
    """Of a flat polygon."""
    return sum((a - corners[0]).cross(b - corners[0]).length for a, b in zip(corners[1:-1], corners[2:])) / 2


@contextlib.contextmanager
def area_lamps_as_surfaces(context):
    """glTF has no area lamps. Each is a surface for a while, which shines down the lamp's -Z axis. Yields the radiance
    of each [W/(sr m^2)] by the name of its material."""
    made, radiances = [], {}
    try:
        for one in list(context.view_layer.objects):
            if one.type != "LIGHT" or one.data.type != "AREA" or not takes_part(one):
                continue
            corners = area_corners(one.data)
            mesh = bpy.data.meshes.new(AREA_LAMP + one.name)
            mesh.from_pydata(corners, [], [range(len(corners))])
            material = bpy.data.materials.new(AREA_LAMP + one.name)
            material.use_nodes, material.use_backface_culling = True, True
            mesh.materials.append(material)
            surface = bpy.data.objects.new(AREA_LAMP + one.name, mesh)
            surface.matrix_world = one.matrix_world
            context.scene.collection.objects.link(surface)
            made.append((surface, mesh, material))
            # An area lamp of P watts has the radiance P / (4 A) in Cycles and in EEVEE.
            area = area_of([one.matrix_world @ corner for corner in corners])
            power = [channel * one.data.energy for channel in one.data.color]
            radiances[material.name] = [watts / (4 * area) if area > 0 else 0 for watts in power]
        yield radiances
    finally:
        for surface, mesh, material in made:
            bpy.data.objects.remove(surface)
            bpy.data.meshes.remove(mesh)
            bpy.data.materials.remove(material)


def uses_vertex_colors():
    """Blender shows vertex colours only where a node asks for them; in glTF they always count."""
    return any(node.type in {"VERTEX_COLOR", "ATTRIBUTE"}
               for material in bpy.data.materials if material.use_nodes for node in material.node_tree.nodes)


def export_gltf(path):
    wanted = {"filepath": path, "export_format": "GLB", "export_lights": True, "export_cameras": True,
              "export_apply": True, "export_yup": True, "export_animations": False, "export_skins": False,
              "export_morph": False, "use_renderable": True, "use_visible": True, "use_active_scene": True,
              "export_current_frame": True, "export_rest_position_armature": False,
              "export_colors": uses_vertex_colors(),
              # Blender 3.4 to 3.5, and since 3.6.
              "convert_lighting_mode": "SPEC", "export_import_convert_lighting_mode": "SPEC"}
    known = bpy.ops.export_scene.gltf.get_rna_type().properties.keys()
    bpy.ops.export_scene.gltf(**{name: value for name, value in wanted.items() if name in known})


def in_lumens(material, radiances):
    """Emission in nits. glTF's emission is a factor of 1 at most and a strength."""
    radiance = radiances.get(material.get("name"))
    if radiance is not None:
        largest = max(max(radiance), 1e-30)
        material["emissiveFactor"] = [channel / largest for channel in radiance]
        material["pbrMetallicRoughness"] = {"baseColorFactor": [0, 0, 0, 1], "metallicFactor": 0}
        material.setdefault("extensions", {})[STRENGTH] = {"emissiveStrength": largest}
    if not any(material.get("emissiveFactor", [0, 0, 0])):
        return
    strength = material.setdefault("extensions", {}).setdefault(STRENGTH, {})
    strength["emissiveStrength"] = strength.get("emissiveStrength", 1) * LUMENS_PER_WATT


def finish_materials(document, radiances):
    materials = document.setdefault("materials", [])
    primitives = [one for mesh in document.get("meshes", []) for one in mesh["primitives"]]
    # glTF's own default is a metal.
    without = [one for one in primitives if "material" not in one]
    if without:
        materials.append(dict(GREY))
    for one in without:
        one["material"] = len(materials) - 1
    for material in materials:
        in_lumens(material, radiances)
        if STRENGTH in material.get("extensions", {}):
            used = document.setdefault("extensionsUsed", [])
            if STRENGTH not in used:
                used.append(STRENGTH)


def copies_in(nodes):
    """Numbers of nodes that instances of collections brought: they have the names of their originals."""
    parent = {child: number for number, node in enumerate(nodes) for child in node.get("children", [])}

    def is_copy(number):
        while (number := parent.get(number)) is not None:
            above = bpy.data.objects.get(nodes[number].get("name", ""))
            if above is not None and above.instance_type != "NONE":
                return True
        return False

    return {number for number in range(len(nodes)) if is_copy(number)}


def finish_nodes(document, wanted):
    """Says which meshes get a lightmap. Children would take that of their parents."""
    nodes = document.get("nodes", [])
    copies = copies_in(nodes)
    for number, node in enumerate(nodes):
        if "mesh" not in node:
            continue
        thing, extras = bpy.data.objects.get(node["name"]), node.setdefault("extras", {})
        if thing is not None and "luxel_density" in thing:
            extras["luxel_density"] = thing["luxel_density"]
        extras["luxel_bake"] = number not in copies and node["name"] in wanted
        if number in copies:
            node["name"] += f" (copy {number})"


def finish_lights(document):
    for light in document.get("extensions", {}).get("KHR_lights_punctual", {}).get("lights", []):
        lamp = bpy.data.lights.get(light.get("name", ""))
        if lamp is not None and lamp.type == "SUN":
            light.setdefault("extras", {})["luxel"] = {"angular_radius_rad": lamp.angle / 2}


def sort_triangles(document, binary):
    """Into an order that does not change when a bake cuts faces in two: the next bake then finds the same mesh."""
    done = set()
    for mesh in document.get("meshes", []):
        for primitive in mesh["primitives"]:
            if primitive.get("indices") is None or primitive.get("mode", 4) != 4 or primitive["indices"] in done:
                continue
            done.add(primitive["indices"])
            corners = gltf_file.accessor(document, binary, primitive["indices"]).reshape(-1, 3)
            places = gltf_file.accessor(document, binary, primitive["attributes"]["POSITION"])[corners]
            order = matching.from_lowest(places)
            turned = numpy.take_along_axis(corners, order, 1)
            keys = numpy.take_along_axis(places, order[..., None], 1).reshape(-1, 9)
            corners[:] = turned[numpy.lexsort(keys.T[::-1])]


def finish(path, wanted, radiances):
    """Adds what Blender's exporter leaves out."""
    document, binary = gltf_file.read(path)
    binary = bytearray(binary)
    finish_materials(document, radiances)
    finish_nodes(document, wanted)
    finish_lights(document)
    sort_triangles(document, binary)
    gltf_file.write(path, document, binary)


def write_scene(context, path):
    """Writes the scene for a bake; it is afterwards as it was before. Returns sentences about what luxel takes
    otherwise."""
    if not hasattr(bpy.types, "EXPORT_SCENE_OT_gltf"):
        raise ValueError("Blender's glTF 2.0 add-on is off; enable it in the preferences")
    meshes = meshes_in(context)
    wanted = {one.name for one in baked_objects(context)}
    with light_nodes.scene_materials() as about, without_lightmap_uvs(meshes), area_lamps_as_surfaces(context) as radiances:
        context.view_layer.update()
        export_gltf(path)
    finish(path, wanted, radiances)
    return about + about_what_is_left_out(context)


def background(color, strength=1):
    return ["--background", ",".join(f"{LUMENS_PER_WATT * strength * channel:.9g}" for channel in list(color)[:3])]


def turn_of(node):
    """About the vertical [rad], by the nodes before a picture; None where they do anything else."""
    socket = node.inputs["Vector"]
    if not socket.is_linked:
        return 0
    before = socket.links[0].from_node
    if before.type == "TEX_COORD" and socket.links[0].from_socket.name == "Generated":
        return 0
    if before.type != "MAPPING" or any(before.inputs[name].is_linked for name in ("Location", "Rotation", "Scale")):
        return None
    turn, scale, place = (before.inputs[name].default_value for name in ("Rotation", "Scale", "Location"))
    if any(turn[:2]) or tuple(scale) != (1, 1, 1) or any(place) or turn_of_input(before) is None:
        return None
    return turn[2]


def turn_of_input(mapping):
    socket = mapping.inputs["Vector"]
    is_plain = not socket.is_linked or socket.links[0].from_node.type == "TEX_COORD"
    return 0 if is_plain else None


def world_light(context, folder):
    """Options for the light of the scene's world, and what of it luxel does not take, as a sentence or ''."""
    world = context.scene.world
    unknown = background((0, 0, 0)), "luxel does not know the world's shader and bakes it as black."
    if context.scene.luxel.sky != "WORLD" or world is None:
        return background((0, 0, 0)), ""
    if not world.use_nodes:
        return background(world.color), ""
    output = world.node_tree.get_output_node("ALL")
    if output is None or not output.inputs["Surface"].is_linked:
        return background((0, 0, 0)), ""
    node = output.inputs["Surface"].links[0].from_node
    if node.type != "BACKGROUND" or node.inputs["Strength"].is_linked:
        return unknown
    strength, color = node.inputs["Strength"].default_value, node.inputs["Color"]
    if not color.is_linked:
        return background(color.default_value, strength), ""
    picture = color.links[0].from_node
    if picture.type != "TEX_ENVIRONMENT" or picture.image is None or picture.projection != "EQUIRECTANGULAR":
        return unknown
    turn = turn_of(picture)
    if turn is None:
        return unknown
    path = os.path.join(folder, "world.exr")
    save_as_exr(context, picture.image, path)
    # Both have +X in the middle column, and Blender's +Y (luxel's -Z) a quarter to its left.
    return ["--environment", f"{path},{math.degrees(turn):.6g},{LUMENS_PER_WATT * strength:.9g}"], ""


def save_as_exr(context, image, path):
    """As it is shown: linear, 32 bits."""
    render = context.scene.render.image_settings
    kept = render.file_format, render.color_mode, render.color_depth
    try:
        render.file_format = "OPEN_EXR"
        render.color_mode, render.color_depth = "RGB", "32"
        image.save_render(path, scene=context.scene)
    finally:
        render.file_format = kept[0]
        render.color_mode, render.color_depth = kept[1:]


def has_light(context):
    """Whether anything may give light: lamps, surfaces that shine, the world, a sky."""
    if context.scene.luxel.sky == "SKY":
        return True
    if any(one.type == "LIGHT" and takes_part(one) and one.data.energy > 0 for one in context.view_layer.objects):
        return True
    if any(light_nodes.shines(slot.material) for one in context.view_layer.objects if takes_part(one)
           for slot in one.material_slots if slot.material is not None):
        return True
    return context.scene.luxel.sky == "WORLD" and world_shines(context.scene.world)


def world_shines(world):
    if world is None:
        return False
    if not world.use_nodes:
        return any(world.color)
    return any(node.type == "BACKGROUND" and (node.inputs["Color"].is_linked or any(list(node.inputs["Color"].default_value)[:3]))
               for node in world.node_tree.nodes)
