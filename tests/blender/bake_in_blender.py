"""Run by Blender: bakes scenes through the add-on as its users do, and holds the results against what is known.

    blender -b --factory-startup --python tests/blender/bake_in_blender.py -- ADDON.zip LUXEL FOLDER

Ends with code 0 and the word "passed", or with the first thing that is wrong.
"""
import json
import math
import os
import subprocess
import sys
import traceback

import bpy
import numpy

ADDON, LUXEL, FOLDER = sys.argv[sys.argv.index("--") + 1:]
LUMENS_PER_WATT = 683
SIZE = 160, 120


def check(holds, sentence):
    if not holds:
        raise AssertionError(sentence)


def near(found, expected, tolerance, what):
    check(abs(found - expected) <= tolerance * abs(expected), f"{what}: {found}, expected {expected} within {tolerance}")


def new_scene(name, resolution=64):
    """Empty, black, with the settings of a quick bake."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.preferences.addon_enable(module="luxel_bake")
    bpy.context.preferences.addons["luxel_bake"].preferences.program = LUXEL
    scene = bpy.context.scene
    scene.name = name
    settings = scene.luxel
    settings.folder = os.path.join(FOLDER, "baked")
    settings.resolution, settings.quality = resolution, "draft"
    return scene


def material(name, color, emission=0):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    shader = made.node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (*color, 1)
    for names in (("Specular IOR Level", "Specular"), ("Emission Color", "Emission")):  # Blender 4 has renamed them
        socket = next(shader.inputs[name] for name in names if name in shader.inputs)
        socket.default_value = 0 if "Specular" in names else (1, 1, 1, 1)
    shader.inputs["Emission Strength"].default_value = emission
    return made


def plane(name, size, place, color, turn=(0, 0, 0)):
    bpy.ops.mesh.primitive_plane_add(size=size, location=place, rotation=turn)
    thing = bpy.context.object
    thing.name = name
    thing.data.materials.append(material(name, color))
    return thing


def lamp(kind, place, energy, **properties):
    data = bpy.data.lights.new(kind.lower(), kind)
    data.energy = energy
    for key, value in properties.items():
        setattr(data, key, value)
    made = bpy.data.objects.new(kind.lower(), data)
    made.location = place
    bpy.context.collection.objects.link(made)
    return made


def camera(place, target):
    data = bpy.data.cameras.new("camera")
    made = bpy.data.objects.new("camera", data)
    made.location = place
    bpy.context.collection.objects.link(made)
    aim = bpy.data.objects.new("aim", None)
    aim.location = target
    bpy.context.collection.objects.link(aim)
    track = made.constraints.new("TRACK_TO")
    track.target = aim
    bpy.context.scene.camera = made


def bake():
    """Through the operator, which waits where there is no window."""
    try:
        ended = bpy.ops.luxel.bake()
    except RuntimeError as error:  # what it reports as an error
        return str(error)
    check(ended == {"FINISHED"}, f"the bake ended with {ended}")
    return ""


def results():
    return os.path.join(FOLDER, "baked", bpy.context.scene.name)


def report():
    with open(os.path.join(results(), "bake.json")) as file:
        return json.load(file)


def light_at(thing, place, layer="all light"):
    """The lightmap [lux] at a place (x, y) of a plane in its own space, by its UV coordinates alone."""
    mesh = thing.data
    uv = mesh.uv_layers["Luxel"].data
    loops = list(mesh.polygons[0].loop_indices)
    points = numpy.array([[*mesh.vertices[mesh.loops[loop].vertex_index].co[:2], 1] for loop in loops[:3]])
    there = numpy.linalg.solve(points.T, [*place, 1]) @ numpy.array([uv[loop].uv for loop in loops[:3]])
    image = bpy.data.images[f"{bpy.context.scene.name} {layer}"]
    width, height = image.size
    pixels = numpy.empty(width * height * 4, numpy.float32)
    image.pixels.foreach_get(pixels)
    column, row = (int(part * side) for part, side in zip(there, (width, height)))
    return float(pixels.reshape(height, width, 4)[row, column, 0])


def draw(name, show, exposure=0):
    """By Cycles, as sRGB without a film's curve."""
    scene = bpy.context.scene
    scene.luxel.show = show
    scene.view_settings.exposure = exposure
    scene.render.engine = "CYCLES"
    scene.cycles.samples = 4 if show != "SCENE" else 256
    scene.cycles.use_denoising = False
    scene.render.resolution_x, scene.render.resolution_y = SIZE
    scene.view_settings.view_transform = "Standard"
    scene.render.filepath = os.path.join(FOLDER, name)
    bpy.ops.render.render(write_still=True)
    return scene.render.filepath


def flip(first, second):
    found = subprocess.run([LUXEL, "compare", first, second, "--json"], check=True, capture_output=True)
    return json.loads(found.stdout)["flip"]


def mean_of(path):
    """Of the picture's linear light."""
    image = bpy.data.images.load(path)
    pixels = numpy.array(image.pixels[:]).reshape(-1, 4)[:, :3]
    bpy.data.images.remove(image)
    return float(numpy.where(pixels <= 0.04045, pixels / 12.92, ((pixels + 0.055) / 1.055) ** 2.4).mean())


# E = I / d^2 below a lamp of I candela, with nothing that reflects light back.
def lamp_of_known_lux():
    new_scene("known", 256)
    floor = plane("floor", 4, (0, 0, 0), (0.5, 0.5, 0.5))
    candela, height = 100, 2
    lamp("POINT", (0, 0, height), candela * 4 * math.pi / LUMENS_PER_WATT, shadow_soft_size=0)
    check(bake() == "", "the bake failed")
    near(light_at(floor, (0, 0)), candela / height**2, 0.01, "lux below the lamp")
    # At 45 degrees: cos^3 of it.
    near(light_at(floor, (1.4, 1.4)), candela / height**2 * (height / math.hypot(height, 1.4 * math.sqrt(2)))**3, 0.02,
         "lux aside of the lamp")


# A sun of S W/m^2 gives S times the cosine; a small area lamp of P watts P / (4 d^2) on its axis, as in Cycles.
def other_lamps():
    new_scene("lamps")
    floor = plane("floor", 4, (0, 0, 0), (0.5, 0.5, 0.5))
    sun = lamp("SUN", (0, 0, 5), 2, angle=0.01)
    sun.rotation_euler = (math.radians(60), 0, 0)
    check(bake() == "", "the bake failed")
    near(light_at(floor, (0.5, 0.5)), 2 * 0.5 * LUMENS_PER_WATT, 0.01, "lux of the sun")
    for shape in ("SQUARE", "RECTANGLE", "DISK", "ELLIPSE"):
        new_scene("lamps")
        floor = plane("floor", 4, (0, 0, 0), (0.5, 0.5, 0.5))
        area = lamp("AREA", (0, 0, 2), 10, shape=shape, size=0.05)
        if shape in ("RECTANGLE", "ELLIPSE"):
            area.data.size_y = 0.1
        check(bake() == "", "the bake failed")
        near(light_at(floor, (0, 0)), 10 * LUMENS_PER_WATT / (4 * 4), 0.02, f"lux of an area lamp, {shape}")
        left = [name for kind in (bpy.data.meshes, bpy.data.materials, bpy.data.objects) for name in kind.keys()
                if name.startswith("luxel area lamp")]
        check(not left, f"the lamp's surface has stayed in the scene: {left}")


def room(resolution):
    """Open in front: surfaces of several kinds under lamps of all kinds, and a little sky."""
    scene = new_scene("room", resolution)
    plane("floor", 4, (0, 0, 0), (0.6, 0.6, 0.6))
    plane("back", 4, (0, 2, 2), (0.7, 0.3, 0.2), (math.radians(90), 0, 0))
    plane("left", 4, (-2, 0, 2), (0.2, 0.5, 0.3), (0, math.radians(90), 0))
    bpy.ops.mesh.primitive_uv_sphere_add(radius=0.6, location=(0.6, 0.2, 0.6), segments=16, ring_count=8)
    ball = bpy.context.object
    ball.name = "ball"
    bpy.ops.object.shade_smooth()
    bpy.ops.mesh.primitive_cube_add(size=0.8, location=(-0.9, 0.3, 0.4), rotation=(0, 0, 0.4))
    cube = bpy.context.object
    cube.name = "cube"
    cube.data.materials.append(material("cube", (0.3, 0.3, 0.7)))
    cube.data.materials.append(material("shining", (0, 0, 0), 3))
    cube.data.polygons[0].material_index = 1
    lamp("POINT", (0.5, -1.2, 1.6), 20, shadow_soft_size=0)
    lamp("AREA", (0, 0, 3), 60, shape="SQUARE", size=0.8)
    sun = lamp("SUN", (0, 0, 5), 0.6, angle=0.02)
    sun.rotation_euler = (math.radians(40), math.radians(-20), 0)
    world = bpy.data.worlds.new("world")
    scene.world = world
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.3, 0.4, 0.6, 1)
    world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.5
    camera((1.5, -4.5, 2.2), (-0.2, 0.5, 0.8))
    return scene, cube


def state_of_scene():
    """What an export must leave as it was."""
    return (sorted(bpy.data.objects.keys()), sorted(bpy.data.materials.keys()), sorted(bpy.data.meshes.keys()),
            [(one.name, one.data.uv_layers.keys(), len(one.data.vertices)) for one in bpy.data.objects if one.type == "MESH"])


# What Cycles draws of the lightmap is what luxel draws, and what Cycles draws of the scene itself.
def cycles_shows_what_luxel_shows():
    scene, cube = room(256)
    before = state_of_scene()
    check(bake() == "", "the bake failed")
    after = state_of_scene()
    check(set(after[0]) == set(before[0]), f"objects have changed: {before[0]} to {after[0]}")
    baked = draw("baked.png", "BAKED")
    luxel = os.path.join(FOLDER, "luxel.png")
    subprocess.run([LUXEL, "render", os.path.join(results(), "scene.glb"), "--from", results(), "--camera", "camera", "--quiet",
                    "--size", "{}x{}".format(*SIZE), "--tone-map", "clamp", "--exposure",
                    f"{-math.log2(LUMENS_PER_WATT):.5f}", "-o", luxel], check=True)
    mean = flip(baked, luxel)
    print(f"FLIP of Cycles and luxel: {mean:.4f}")
    check(mean < 0.06, f"Cycles draws another picture than luxel: FLIP {mean}")
    scene_itself = draw("scene.png", "SCENE")
    near(mean_of(baked), mean_of(scene_itself), 0.04, "the baked picture's mean light beside that of the scene's")
    light = draw("light.png", "LIGHT")
    check(mean_of(light) > 1.2 * mean_of(baked), "light alone is not on white surfaces")
    # The first bake has cut the floor under the cube, so that the second starts anew. A third one, after an edit, builds
    # on it, with its layout, and shows the new colour.
    check(bake() == "", "the second bake failed")
    uv = [tuple(one.uv) for one in cube.data.uv_layers["Luxel"].data]
    scene.luxel.show = "BAKED"
    bpy.data.objects["ball"].location.x += 0.1
    bpy.data.materials["cube"].node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (1, 0, 0, 1)
    check(bake() == "", "the third bake failed")
    check(report()["cache"]["built_on"], f"nothing was kept: {report()['cache']}")
    check(uv == [tuple(one.uv) for one in cube.data.uv_layers["Luxel"].data], "the third bake has another layout")
    fed = bpy.data.materials["cube"].node_tree.nodes["Luxel"].inputs["Colour"].default_value
    check(tuple(fed)[:3] == (1, 0, 0), f"the cube's colour is shown as {tuple(fed)}")
    check([node.name for node in cube.material_slots[0].material.node_tree.nodes].count("Luxel Mix") == 1,
          "the third bake has added its nodes once more")


def layers_are_mixed():
    scene, _ = room(256)
    scene.luxel.layers = "per-light"
    check(bake() == "", "the bake failed")
    from luxel_bake import light_nodes
    mixers = dict(light_nodes.layer_mixers(scene))
    check(len(mixers) >= 4, f"there are few layers: {list(mixers)}")
    whole = mean_of(draw("all.png", "LIGHT", -4))
    parts = []
    for name in mixers:
        for other, socket in mixers.items():
            socket.default_value = (1, 1, 1, 1) if other == name else (0, 0, 0, 1)
        parts.append(mean_of(draw("layer.png", "LIGHT", -4)))
    near(sum(parts), whole, 0.03, "the layers' sum")
    # The next bake leaves the mixers as they are.
    last = list(mixers)[-1]
    check(bake() == "", "the second bake failed")
    found = {name: tuple(socket.default_value) for name, socket in light_nodes.layer_mixers(scene)}
    check(found[last] == (1, 1, 1, 1) and found[list(mixers)[0]] == (0, 0, 0, 1), f"the mixers were set back: {found}")


def what_is_left_alone():
    scene, cube = room(64)
    scene.luxel.objects = "SELECTED"
    bpy.ops.object.select_all(action="DESELECT")
    check("No mesh is selected" in bake(), "a bake of nothing")
    cube.select_set(True)
    # An object of the same mesh data gets its own.
    twin = bpy.data.objects.new("twin", cube.data)
    twin.location = (0, -1, 0.4)
    bpy.context.collection.objects.link(twin)
    twin.select_set(True)
    check(bake() == "", "the bake failed")
    check("Luxel" in cube.data.uv_layers, "the cube has no lightmap")
    check("Luxel" not in bpy.data.objects["floor"].data.uv_layers, "the floor has a lightmap")
    check(twin.data != cube.data, "two objects share their coordinates")
    # Children do not take after their parents, nor pictures in a collection after their originals.
    cube.select_set(False)
    twin.parent = cube
    check(bake() == "", "the bake failed")
    check("Luxel" in twin.data.uv_layers, "the child of an object that is left out has no lightmap")
    check("Luxel" not in cube.data.uv_layers, "the lightmap of an earlier bake has stayed")
    check("Luxel" not in [node.name for node in bpy.data.materials["floor"].node_tree.nodes], "the floor shows a lightmap")
    bpy.ops.luxel.remove()
    check("Luxel" not in twin.data.uv_layers, "the lightmap was not removed")


# Faces of which luxel's charts part the triangles, n-gons, mirrored objects, and a floor under thin walls.
def every_face_has_its_place():
    scene = new_scene("faces", 256)
    floor = plane("floor", 6, (0, 0, 0), (0.6, 0.6, 0.6))
    plane("wall", 2, (0.3, 0, 1), (0.6, 0.6, 0.6), (math.radians(90), 0, 0.3))
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=6, y_subdivisions=6, size=1.5, location=(-2, 2, 0.8))
    bent = bpy.context.object
    bent.name = "bent"
    for number, vertex in enumerate(bent.data.vertices):  # quads that are not flat
        vertex.co.z = 0.35 * math.sin(7.3 * number)
    bpy.ops.mesh.primitive_cylinder_add(vertices=12, radius=0.5, location=(2, 2, 0.6), end_fill_type="NGON")
    drum = bpy.context.object
    drum.name, drum.scale = "drum", (-1, 1, 1)
    lamp("POINT", (1.4, -1.2, 2.5), 200, shadow_soft_size=0)
    faces = {one.name: len(one.data.polygons) for one in bpy.data.objects if one.type == "MESH"}
    check(bake() == "", "the bake failed")
    check("no place in the lightmap" not in bpy.context.window_manager.luxel.warnings,
          f"faces were lost: {bpy.context.window_manager.luxel.warnings}")
    print("faces before and after:", {name: (count, len(bpy.data.objects[name].data.polygons)) for name, count in faces.items()})
    for name in faces:
        uv = numpy.array([one.uv for one in bpy.data.objects[name].data.uv_layers["Luxel"].data])
        outside = numpy.flatnonzero(((uv < 0) | (uv > 1)).any(axis=1) | (uv == 0).all(axis=1))  # 0, 0: it got none
        check(not len(outside), f"of {len(uv)} coordinates of '{name}' some lie outside: {uv[outside][:3]}")
    area = sum(face.area for face in floor.data.polygons)
    near(area, 36, 1e-4, "the floor's area after it was cut")


def other_shaders():
    scene = new_scene("shaders")
    floor = plane("floor", 4, (0, 0, 0), (0.5, 0.5, 0.5))
    tree = floor.data.materials[0].node_tree
    diffuse = tree.nodes.new("ShaderNodeBsdfDiffuse")
    diffuse.inputs["Color"].default_value = (0.9, 0.1, 0.1, 1)
    tree.links.new(diffuse.outputs[0], tree.get_output_node("ALL").inputs["Surface"])
    wall = plane("wall", 4, (0, 2, 2), (0.5, 0.5, 0.5), (math.radians(90), 0, 0))
    wall.data.materials.clear()
    lamp("POINT", (0, 0, 1), 30, shadow_soft_size=0)
    check(bake() == "", "the bake failed")
    with open(os.path.join(results(), "scene.glb"), "rb") as file:
        data = file.read()
    document = json.loads(data[20:20 + int.from_bytes(data[12:16], "little")])
    colors = {one["name"]: one["pbrMetallicRoughness"].get("baseColorFactor") for one in document["materials"]}
    near(colors["floor"][0], 0.9, 1e-6, "a Diffuse shader's red")
    near(colors["Luxel Grey"][0], 0.8, 1e-6, "the grey of a mesh without a material")
    nodes = floor.data.materials[0].node_tree.nodes
    check([node.type for node in nodes].count("BSDF_PRINCIPLED") == 1, "the exporter's stand-in has stayed")
    check(nodes["Luxel Mix"].inputs[1].links[0].from_node == diffuse, "the material has lost its shader")


# The frame that is seen is baked, and stays as it is.
def the_frame_that_is_seen():
    scene = new_scene("frames")
    plane("floor", 4, (0, 0, 0), (0.5, 0.5, 0.5))
    moving = lamp("POINT", (0, 0, 2), 100 * 4 * math.pi / LUMENS_PER_WATT, shadow_soft_size=0)
    for frame, height in ((1, 2), (50, 1)):
        moving.location.z = height
        moving.keyframe_insert("location", frame=frame)
    scene.frame_set(50)
    check(bake() == "", "the bake failed")
    near(light_at(bpy.data.objects["floor"], (0, 0)), 100, 0.01, "lux below a lamp that has come down")
    check(scene.frame_current == 50, "the frame has changed")


# Two scenes of one file have a lightmap each.
def two_scenes():
    first = new_scene("one")
    plane("floor", 4, (0, 0, 0), (0.5, 0.5, 0.5))
    lamp("POINT", (0, 0, 2), 30, shadow_soft_size=0)
    check(bake() == "", "the bake failed")
    from luxel_bake import light_nodes
    check(light_nodes.group_name(first) in bpy.data.node_groups, "the scene has no group")
    bpy.ops.scene.new(type="FULL_COPY")
    bpy.context.scene.name = "two"
    bpy.context.scene.luxel.resolution = 32
    check(bake() == "", "the second scene's bake failed")
    check(bpy.data.images["one all light"].size[0] == 64, "the first scene has another lightmap now")
    check(bpy.data.images["two all light"].size[0] == 32, "the second scene has none of its own")


def modifiers():
    scene, cube = room(64)
    cube.modifiers.new("bevel", "BEVEL")
    check("Modifiers change the faces of 'cube'" in bake(), "a bevel was not noticed")
    scene.luxel.apply_modifiers = True
    check(bake() == "", "the bake failed")
    check(not cube.modifiers and len(cube.data.polygons) > 6, "the bevel was not applied")
    uv = numpy.array([one.uv for one in cube.data.uv_layers["Luxel"].data])
    check((uv >= 0).all() and (uv <= 1).all() and uv.std() > 0.001, "the cube has no places in the lightmap")


def what_is_no_mesh_is_named():
    new_scene("no meshes", 32)
    floor = plane("floor", 4, (0, 0, 0), (0.5, 0.5, 0.5))
    lamp("POINT", (0, 0, 2), 100)
    check(bake() == "", "the bake failed")
    check("Left" not in bpy.context.window_manager.luxel.warnings, "a plane alone is named")
    bpy.ops.object.text_add(location=(0, 0, 1))
    bpy.context.object.name = "Title"
    for name, bevel in (("Rail", 0.1), ("Path", 0)):  # a path without thickness has no surface
        bpy.ops.curve.primitive_bezier_curve_add(location=(0, 0, 1))
        bpy.context.object.name, bpy.context.object.data.bevel_depth = name, bevel
    bpy.ops.object.metaball_add(location=(0, 0, 1))
    bpy.context.object.name = "Drop"
    collection = bpy.data.collections.new("trees")
    collection.objects.link(bpy.data.objects.new("tree", floor.data))
    forest = bpy.data.objects.new("Forest", None)
    forest.instance_type, forest.instance_collection = "COLLECTION", collection
    bpy.context.collection.objects.link(forest)
    check(bake() == "", "the bake failed")
    said = bpy.context.window_manager.luxel.warnings
    for part in ("Left without a lightmap: text 'Title', curve 'Rail'; ", "Left out of the bake: metaball 'Drop'; ",
                 "Left without a lightmap: the instances of 'Forest'; "):
        check(part in said, f"'{part}' is not said: {said}")
    check("Path" not in said and "floor" not in said, f"what has a lightmap or no surface is named: {said}")


def errors_are_sentences():
    new_scene("errors")
    plane("floor", 4, (0, 0, 0), (0.5, 0.5, 0.5))
    lamp("POINT", (0, 0, 2), 30)
    bpy.context.preferences.addons["luxel_bake"].preferences.program = "/no/such/luxel"
    check("'/no/such/luxel' was not found" in bake(), "a program that is not there")
    bpy.context.preferences.addons["luxel_bake"].preferences.program = LUXEL
    bpy.context.scene.luxel.size_by, bpy.context.scene.luxel.density = "DENSITY", 10000
    error = bake()
    check("texels" in error.lower() or "--texels-per-metre" in error, f"an impossible density: {error}")
    panel = bpy.context.window_manager.luxel.error
    check(panel and panel in error, f"the panel says something else: {panel}")
    bpy.data.objects.remove(bpy.data.objects["floor"])
    check("There is no visible mesh" in bake(), "a scene without meshes")
    plane("floor", 4, (0, 0, 0), (0.5, 0.5, 0.5))
    bpy.data.objects.remove(bpy.data.objects["point"])
    check("There is no light in the scene" in bake(), "a scene without light")


def a_bake_that_is_stopped():
    new_scene("stopped")
    plane("floor", 4, (0, 0, 0), (0.5, 0.5, 0.5))
    lamp("POINT", (0, 0, 2), 30)
    bpy.context.scene.luxel.quality = "best"
    bpy.context.scene.luxel.resolution = 2048
    from luxel_bake import operators, process
    work = operators.Work(bpy.context)
    work.bake.cancel()
    try:
        work.take(bpy.context)
    except process.Stopped:
        return
    check(False, "the bake did not stop")


# A picture of the surroundings with a bright patch towards +X, towards +Y, and towards +X but turned by 90 degrees: the
# wall that faces it is lit most.
def the_sky_is_where_it_was():
    for column, turn, facing in ((28, 0, "+X"), (12, 0, "+Y"), (28, 90, "-Y")):
        scene = new_scene("sky")
        walls = {"+X": plane("east", 1, (0, 0, 0), (0, 0, 0), (0, math.radians(90), 0)),
                 "-X": plane("west", 1, (-3, 0, 0), (0, 0, 0), (0, math.radians(-90), 0)),
                 "+Y": plane("north", 1, (0, 5, 0), (0, 0, 0), (math.radians(-90), 0, 0)),
                 "-Y": plane("south", 1, (0, -5, 0), (0, 0, 0), (math.radians(90), 0, 0))}
        picture = bpy.data.images.new("sky", 64, 32, float_buffer=True)
        pixels = numpy.zeros((32, 64, 4), numpy.float32)
        pixels[..., 3] = 1
        # The middle column is +X in Blender, the quarter to its left +Y.
        pixels[12:20, column:column + 8, :3] = 10
        picture.pixels.foreach_set(pixels.ravel())
        world = bpy.data.worlds.new("world")
        scene.world = world
        world.use_nodes = True
        tree = world.node_tree
        node = tree.nodes.new("ShaderNodeTexEnvironment")
        node.image = picture
        tree.links.new(node.outputs[0], tree.nodes["Background"].inputs["Color"])
        if turn:
            coordinates, mapping = tree.nodes.new("ShaderNodeTexCoord"), tree.nodes.new("ShaderNodeMapping")
            mapping.inputs["Rotation"].default_value[2] = math.radians(turn)
            tree.links.new(coordinates.outputs["Generated"], mapping.inputs["Vector"])
            tree.links.new(mapping.outputs["Vector"], node.inputs["Vector"])
        check(bake() == "", "the bake failed")
        light = {side: light_at(wall, (0, 0)) for side, wall in walls.items()}
        brightest = max(light, key=light.get)
        check(brightest == facing, f"column {column}, turned by {turn}: the brightest wall is {brightest}: {light}")


def main():
    bpy.ops.preferences.addon_install(filepath=ADDON, overwrite=True)
    for test in (lamp_of_known_lux, other_lamps, cycles_shows_what_luxel_shows, layers_are_mixed, what_is_left_alone,
                 every_face_has_its_place, other_shaders, the_frame_that_is_seen, two_scenes, modifiers,
                 what_is_no_mesh_is_named, errors_are_sentences, a_bake_that_is_stopped, the_sky_is_where_it_was):
        test()
        print(f"{test.__name__} holds", flush=True)
    print("passed")


try:
    main()
except Exception:
    traceback.print_exc()
    sys.exit(1)
