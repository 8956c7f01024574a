"""What a bake leaves, taken into Blender: coordinates, pictures, materials."""
import os

import bpy
import numpy

from . import cutting, gltf_file, light_nodes, matching
from .light_nodes import UV_NAME


def to_gltf(places):
    """Blender's Z is up, glTF's Y."""
    return places[..., [0, 2, 1]] * numpy.array([1, 1, -1], numpy.float32)


def to_blender(places):
    return places[..., [0, 2, 1]] * numpy.array([1, -1, 1], numpy.float32)


def numbers_of(items, name, width):
    out = numpy.empty(width * len(items), numpy.int32)
    items.foreach_get(name, out)
    return out.reshape(-1, width)


class Triangles:
    """Of a mesh: places of their corners in glTF's axes (n, 3, 3), and numbers of loops, vertices and faces."""

    def __init__(self, mesh):
        mesh.calc_loop_triangles()
        self.loops = numbers_of(mesh.loop_triangles, "loops", 3)
        self.vertices = numbers_of(mesh.loop_triangles, "vertices", 3)
        self.faces = numbers_of(mesh.loop_triangles, "polygon_index", 1).ravel()
        places = numpy.empty(3 * len(mesh.vertices), numpy.float32)
        mesh.vertices.foreach_get("co", places)
        self.places = to_gltf(places.reshape(-1, 3))[self.vertices]

    def with_faces(self):
        return [(int(face), tuple(int(one) for one in corners)) for face, corners in zip(self.faces, self.vertices)]


def evaluated(context, thing):
    return thing.evaluated_get(context.evaluated_depsgraph_get())


def changed_by_modifiers(context, thing):
    """Whether what is rendered of an object has other faces than its mesh."""
    if not thing.modifiers:
        return False
    shown = evaluated(context, thing)
    mesh = shown.to_mesh()
    same = (len(mesh.loops), len(mesh.polygons)) == (len(thing.data.loops), len(thing.data.polygons))
    shown.to_mesh_clear()
    return not same


def apply_modifiers(context, thing):
    graph = context.evaluated_depsgraph_get()
    thing.data = bpy.data.meshes.new_from_object(thing.evaluated_get(graph), preserve_all_data_layers=True, depsgraph=graph)
    thing.modifiers.clear()


def exported_triangles(context, thing):
    """As they were exported: modifiers move vertices."""
    if not thing.modifiers:
        return Triangles(thing.data)
    shown = evaluated(context, thing)
    out = Triangles(shown.to_mesh())
    shown.to_mesh_clear()
    return out


class Places:
    """Coordinates of each loop of a mesh in the lightmap."""

    def __init__(self, triangles, loop_count, baked):
        mine, theirs = matching.from_lowest(triangles.places), matching.from_lowest(baked[0])
        sorted_baked = numpy.take_along_axis(baked[0], theirs[..., None], 1)
        loops = numpy.take_along_axis(triangles.loops, mine, 1)
        numbers = matching.match(numpy.take_along_axis(triangles.places, mine[..., None], 1), sorted_baked)
        uv = numpy.take_along_axis(baked[1], theirs[..., None], 1)[numpy.maximum(numbers, 0)]
        uv = uv * numpy.array([1, -1], numpy.float32) + numpy.array([0, 1], numpy.float32)
        found = numbers >= 0
        self.coordinates = numpy.zeros((loop_count, 2), numpy.float32)
        self.coordinates[loops[found]] = uv[found]
        # Of the triangles of a face one has won: the others lie elsewhere in the lightmap.
        self.parted = found & (self.coordinates[loops] != uv).any(axis=(1, 2))
        self.missing = ~found & (matching.areas_of(triangles.places) > 0)
        unused = numpy.ones(len(sorted_baked), bool)
        unused[numbers[found]] = False
        self.pieces = sorted_baked[unused]


def give_coordinates(context, thing, baked):
    """Returns how many triangles with an area have no place in the lightmap."""
    if thing.data.users > 1 or thing.data.library:
        thing.data = thing.data.copy()
    mesh = thing.data
    places = Places(exported_triangles(context, thing), len(mesh.loops), baked)
    if places.missing.any() and len(places.pieces) and not thing.modifiers:
        triangles, faces = Triangles(mesh), {}
        for number in numpy.flatnonzero(places.missing):
            faces.setdefault(int(triangles.faces[number]), [])
        for number, face in enumerate(triangles.faces):
            if int(face) in faces:
                faces[int(face)].append(to_blender(triangles.places[number]))
        # All of a face goes: its other triangles are pieces, too.
        whole = numpy.concatenate([places.pieces, *(triangles.places[[n]] for n in range(len(triangles.faces))
                                                    if int(triangles.faces[n]) in faces and not places.missing[n])])
        cutting.replace_by_pieces(mesh, faces, to_blender(whole))
        places = Places(Triangles(mesh), len(mesh.loops), baked)
    if places.parted.any():
        cutting.split_along(mesh, places.parted, exported_triangles(context, thing).with_faces())
        places = Places(exported_triangles(context, thing), len(mesh.loops), baked)
    set_coordinates(mesh, places.coordinates)
    return int(places.missing.sum())


def set_coordinates(mesh, coordinates):
    layers = mesh.uv_layers
    layer = layers.get(UV_NAME)
    if layer is None:
        active = layers.active.name if layers.active else UV_NAME
        rendered = next((one.name for one in layers if one.active_render), UV_NAME)
        layer = layers.new(name=UV_NAME, do_init=False)
        layers.active = layers[active]
        layers[rendered].active_render = True
        layer = layers[UV_NAME]
    layer.data.foreach_set("uv", coordinates.ravel())
    mesh.update()


def load_picture(path, name, packs):
    """A lightmap as numbers. The picture of an earlier bake gets the new file."""
    name = name[:light_nodes.LONGEST_NAME]
    image = bpy.data.images.get(name)
    if image is None:
        image = bpy.data.images.load(path)
        image.name = name
    elif image.packed_file:
        image.unpack(method="REMOVE")
    image.source, image.filepath = "FILE", path if packs or not bpy.data.filepath else bpy.path.relpath(path)
    image.colorspace_settings.name = "Non-Color"
    image.alpha_mode = "CHANNEL_PACKED"
    image.use_half_precision = False  # sunlight has more lux than a half float can say
    image.reload()
    if packs:
        image.pack()
    return image


def pictures_of(scene, folder, report, packs):
    """(layer's name, image) of each layer, or of all light."""
    layers = report.get("layers") or [{"name": "all light", "files": ["lightmap.exr"]}]
    return [(layer["name"], load_picture(os.path.join(folder, layer["files"][0]), f"{scene.name} {layer['name']}", packs))
            for layer in layers]


def own_materials(objects):
    """Materials that other objects have, too, are copied for these."""
    others = {slot.material for one in bpy.data.objects if one not in objects for slot in one.material_slots}
    copies = {}
    for one in objects:
        if not one.data.materials:
            one.data.materials.append(light_nodes.grey_material())
        for slot in one.material_slots:
            if slot.material is None:
                slot.material = light_nodes.grey_material()
            if slot.material in others or slot.material.library:
                if slot.material not in copies:
                    copies[slot.material] = slot.material.copy()
                slot.material = copies[slot.material]
    return {slot.material for one in objects for slot in one.material_slots}


def forget(scene, kept_objects=(), kept_materials=()):
    """Takes away what an earlier bake of the scene has added, but for these."""
    group = bpy.data.node_groups.get(light_nodes.group_name(scene))
    for material in light_nodes.materials_that_show(group) if group is not None else []:
        if material not in kept_materials:
            light_nodes.hide_in(material)
    for one in scene.objects:
        if one.type == "MESH" and one not in kept_objects and UV_NAME in one.data.uv_layers:
            one.data.uv_layers.remove(one.data.uv_layers[UV_NAME])


def apply(context, objects, folder, report, packs):
    """Shows a bake in the scene. Returns sentences about what it could not."""
    scene = context.scene
    document, binary = gltf_file.read(os.path.join(folder, "baked.glb"))
    baked = gltf_file.triangles_of_nodes(document, binary)
    about, shown = [], []
    for one in objects:
        if changed_by_modifiers(context, one):
            apply_modifiers(context, one)
        if one.name not in baked:
            about.append(f"'{one.name}' has no place in the lightmap.")
            continue
        missing = give_coordinates(context, one, baked[one.name])
        if missing:
            about.append(f"{missing} triangles of '{one.name}' have no place in the lightmap.")
        shown.append(one)
    group = light_nodes.make_group(scene, pictures_of(scene, folder, report, packs))
    materials = own_materials(shown)
    for material in materials:
        light_nodes.show_in(material, group)
    forget(scene, shown, materials)
    light_nodes.set_shown(scene, scene.luxel.show)
    return about
