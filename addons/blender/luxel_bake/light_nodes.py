"""Materials that show a lightmap: a node group for each scene, and what each material feeds it."""
import contextlib
import math

import bpy

LUMENS_PER_WATT = 683
UV_NAME = "Luxel"
NODE, MIX, GREY = "Luxel", "Luxel Mix", "Luxel Grey"
SHOWN, WHITE = "Luxel Shown", "Luxel White"
LAYER = "Luxel Layer "
LONGEST_NAME = 63  # of anything in Blender
INPUTS = (("Colour", "NodeSocketColor", (0.8, 0.8, 0.8, 1)), ("Metallic", "NodeSocketFloat", 0),
          ("Emission", "NodeSocketColor", (0, 0, 0, 1)), ("Emission Strength", "NodeSocketFloat", 1),
          ("Alpha", "NodeSocketFloat", 1))
OUTPUTS = (("Baked", "NodeSocketShader"), ("Shown", "NodeSocketFloat"))


def principled(material):
    """A material's, made where it has no shader that is known."""
    nodes = material.node_tree.nodes
    return next((node for node in nodes if node.type == "BSDF_PRINCIPLED"), None) or nodes.new("ShaderNodeBsdfPrincipled")


def grey_material():
    """Of meshes without a material, as Blender draws them."""
    material = bpy.data.materials.get(GREY)
    if material is None:
        material = bpy.data.materials.new(GREY)
        material.use_nodes = True
        principled(material).inputs["Base Color"].default_value = (0.8, 0.8, 0.8, 1)
    return material


def socket_of(node, *names):
    """The input that has the first of these names which there is; Blender 4 has renamed some."""
    return next((node.inputs[name] for name in names if name in node.inputs), None)


def source_of(socket):
    """What feeds an input: another socket, or its own value."""
    return socket.links[0].from_socket if socket.is_linked else socket.default_value


def original_shader(material):
    """The node of a material's own shader, behind what a bake has added; None: it has none."""
    if not material.use_nodes:
        return None
    output = material.node_tree.get_output_node("ALL")
    surface = material.node_tree.nodes[MIX].inputs[1] if MIX in material.node_tree.nodes else \
        output.inputs["Surface"] if output is not None else None
    return surface.links[0].from_node if surface is not None and surface.is_linked else None


def known_shader(node, depth=0):
    """A shader that luxel knows: the node itself, or the first above it; None: there is none."""
    if node is None or depth > 20:
        return None
    if node.type in {"BSDF_PRINCIPLED", "BSDF_DIFFUSE", "EMISSION"}:
        return node
    for socket in node.inputs:
        if socket.type == "SHADER" and socket.is_linked:
            found = known_shader(socket.links[0].from_node, depth + 1)
            if found is not None:
                return found
    return None


def properties_of(shader):
    """What a group's inputs get of a shader: name -> its socket."""
    kind = shader.type if shader is not None else ""
    if kind == "BSDF_PRINCIPLED":
        found = {"Colour": socket_of(shader, "Base Color"), "Metallic": socket_of(shader, "Metallic"),
                 "Emission": socket_of(shader, "Emission Color", "Emission"),
                 "Emission Strength": socket_of(shader, "Emission Strength"), "Alpha": socket_of(shader, "Alpha")}
        return {name: socket for name, socket in found.items() if socket is not None}
    if kind == "BSDF_DIFFUSE":
        return {"Colour": shader.inputs["Color"]}
    if kind == "EMISSION":
        return {"Emission": shader.inputs["Color"], "Emission Strength": shader.inputs["Strength"]}
    return {}


def shines(material):
    found = properties_of(known_shader(original_shader(material)))
    color, strength = found.get("Emission"), found.get("Emission Strength")
    if color is None or (strength is not None and not strength.is_linked and strength.default_value == 0):
        return False
    return color.is_linked or any(list(color.default_value)[:3])


class Builder:
    """Nodes of one tree, from left to right."""

    def __init__(self, tree):
        self.nodes, self.links, self.column = tree.nodes, tree.links, 0

    def node(self, kind, name="", **properties):
        node = self.nodes.new(kind)
        node.location = (200 * self.column, -160 * (len(self.nodes) % 5))
        self.column += 1
        if name:
            node.name = node.label = name
        for key, value in properties.items():
            setattr(node, key, value)
        return node

    def feed(self, socket, source):
        """By another socket, or a constant."""
        for link in list(socket.links):
            self.links.remove(link)
        if isinstance(source, bpy.types.NodeSocket):
            self.links.new(source, socket)
        else:
            socket.default_value = source

    def vector_math(self, operation, first, second):
        node = self.node("ShaderNodeVectorMath", operation=operation)
        self.feed(node.inputs[0], first)
        self.feed(node.inputs["Scale"] if operation == "SCALE" else node.inputs[1], second)
        return node.outputs[0]

    def value(self, name, number):
        node = self.node("ShaderNodeValue", name)
        node.outputs[0].default_value = number
        return node.outputs[0]


def group_name(scene):
    return f"{NODE} {scene.name}"[:LONGEST_NAME]


def add_sockets(group):
    if hasattr(group, "interface"):  # since Blender 4.0
        for name, kind, default in INPUTS:
            group.interface.new_socket(name, in_out="INPUT", socket_type=kind).default_value = default
        for name, kind in OUTPUTS:
            group.interface.new_socket(name, in_out="OUTPUT", socket_type=kind)
        return
    for name, kind, default in INPUTS:
        group.inputs.new(kind, name).default_value = default
    for name, kind in OUTPUTS:
        group.outputs.new(kind, name)


def mixed_layers(build, pictures, coordinates, mixers):
    """The sum of the pictures' light, each times a colour that the panel shows."""
    total = None
    for name, image in pictures:
        picture = build.node("ShaderNodeTexImage", name, image=image, extension="EXTEND")
        build.feed(picture.inputs["Vector"], coordinates)
        light = picture.outputs["Color"]
        if len(pictures) > 1:
            mixer = build.node("ShaderNodeRGB", LAYER + name)
            mixer.outputs[0].default_value = mixers.get(LAYER + name, (1, 1, 1, 1))
            light = build.vector_math("MULTIPLY", light, mixer.outputs[0])
        total = light if total is None else build.vector_math("ADD", total, light)
    return total


def make_group(scene, pictures):
    """The group that shows a scene's lightmaps: (layer's name, image) each; one of them: all light. It replaces that of
    an earlier bake in all materials, and keeps the colours of its layers."""
    group = bpy.data.node_groups.get(group_name(scene))
    if group is None:
        group = bpy.data.node_groups.new(group_name(scene), "ShaderNodeTree")
        add_sockets(group)
    mixers = {node.name: tuple(node.outputs[0].default_value) for node in group.nodes if node.name.startswith(LAYER)}
    group.nodes.clear()
    build = Builder(group)
    given, result = build.node("NodeGroupInput"), build.node("NodeGroupOutput")
    coordinates = build.node("ShaderNodeUVMap", uv_map=UV_NAME).outputs[0]
    # A diffuse surface sends E / pi times its colour. The lightmap is in lux, Blender's light in watts.
    light = build.vector_math("SCALE", mixed_layers(build, pictures, coordinates, mixers), 1 / (math.pi * LUMENS_PER_WATT))
    diffuse = build.node("ShaderNodeMath", operation="SUBTRACT")  # metals have no diffuse colour
    build.feed(diffuse.inputs[0], 1.0)
    build.feed(diffuse.inputs[1], given.outputs["Metallic"])
    surface = build.node("ShaderNodeMixRGB")
    build.feed(surface.inputs[0], build.value(WHITE, 0))
    build.feed(surface.inputs[1], build.vector_math("SCALE", given.outputs["Colour"], diffuse.outputs[0]))
    build.feed(surface.inputs[2], (1, 1, 1, 1))
    reflected = build.vector_math("MULTIPLY", light, surface.outputs[0])
    own = build.vector_math("SCALE", given.outputs["Emission"], given.outputs["Emission Strength"])
    emission = build.node("ShaderNodeEmission")
    build.feed(emission.inputs["Color"], build.vector_math("ADD", reflected, own))
    seen = build.node("ShaderNodeMixShader")
    build.feed(seen.inputs[0], given.outputs["Alpha"])
    build.feed(seen.inputs[1], build.node("ShaderNodeBsdfTransparent").outputs[0])
    build.feed(seen.inputs[2], emission.outputs[0])
    build.feed(result.inputs["Baked"], seen.outputs[0])
    build.feed(result.inputs["Shown"], build.value(SHOWN, 1))
    result.location = (200 * build.column, 0)
    return group


def feed_from(build, target, shader):
    """Gives the group what the material's shader has."""
    found = properties_of(known_shader(shader))
    if "Emission" in found and "Colour" not in found:
        target.inputs["Colour"].default_value = (0, 0, 0, 1)
    for name, socket in found.items():
        build.feed(target.inputs[name], source_of(socket))


def show_in(material, group):
    """Lets a material show the lightmap with the colours that it has now."""
    if not material.use_nodes:
        color = list(material.diffuse_color)
        material.use_nodes = True
        principled(material).inputs["Base Color"].default_value = color
    tree = material.node_tree
    build = Builder(tree)
    if MIX in tree.nodes:
        tree.nodes[NODE].node_tree = group
        feed_from(build, tree.nodes[NODE], original_shader(material))
        return
    output = tree.get_output_node("ALL") or tree.nodes.new("ShaderNodeOutputMaterial")
    surface = output.inputs["Surface"]
    original = surface.links[0].from_socket if surface.is_linked else None
    target = build.node("ShaderNodeGroup", NODE, node_tree=group)
    mix = build.node("ShaderNodeMixShader", MIX)
    target.location = (output.location.x, output.location.y - 250)
    mix.location = (output.location.x + 200, output.location.y)
    output.location.x += 400
    feed_from(build, target, original.node if original is not None else None)
    build.feed(mix.inputs[0], target.outputs["Shown"])
    if original is not None:
        build.feed(mix.inputs[1], original)
    build.feed(mix.inputs[2], target.outputs["Baked"])
    build.feed(surface, mix.outputs[0])


def hide_in(material):
    """Takes what show_in() has added."""
    tree = material.node_tree
    mix, output = tree.nodes[MIX], tree.get_output_node("ALL")
    if output is not None and mix.inputs[1].is_linked:
        tree.links.new(mix.inputs[1].links[0].from_socket, output.inputs["Surface"])
    for name in (MIX, NODE):
        tree.nodes.remove(tree.nodes[name])


def materials_that_show(group=None):
    """The lightmaps of a group, or any."""
    return [one for one in bpy.data.materials if one.use_nodes and one.node_tree and MIX in one.node_tree.nodes and
            (group is None or one.node_tree.nodes[NODE].node_tree == group)]


class Stand:
    """Puts a shader in front of a material's output, and takes it away again."""

    def __init__(self, material):
        self.tree = material.node_tree
        self.output = self.tree.get_output_node("ALL")
        surface = self.output.inputs["Surface"]
        self.before, self.made = surface.links[0].from_socket if surface.is_linked else None, None

    def show(self, socket):
        self.tree.links.new(socket, self.output.inputs["Surface"])

    def show_as_principled(self, shader):
        """For exporters, which know no other shader with a colour."""
        self.made = self.tree.nodes.new("ShaderNodeBsdfPrincipled")
        color = properties_of(shader).get("Colour") if shader is not None else None
        build = Builder(self.tree)
        build.feed(self.made.inputs["Base Color"], source_of(color) if color is not None else (0.8, 0.8, 0.8, 1))
        self.show(self.made.outputs[0])

    def end(self):
        if self.made is not None:
            self.tree.nodes.remove(self.made)
        if self.before is not None:
            self.show(self.before)


@contextlib.contextmanager
def scene_materials():
    """Materials as they were before a bake, for a while, and as exporters understand them. Yields sentences about
    shaders that luxel does not know."""
    stands, about = [], []
    try:
        for material in bpy.data.materials:
            if not material.use_nodes or material.node_tree is None or material.node_tree.get_output_node("ALL") is None:
                continue
            original = original_shader(material)
            known = known_shader(original)
            if original is None:
                continue
            stand = Stand(material)
            stands.append(stand)
            if MIX in material.node_tree.nodes:
                stand.show(material.node_tree.nodes[MIX].inputs[1].links[0].from_socket)
            if known is None or known.type == "BSDF_DIFFUSE":
                stand.show_as_principled(known)
            if known is None:
                about.append(f"luxel does not know the shader of '{material.name}' and bakes it as grey.")
        yield about
    finally:
        for stand in stands:
            stand.end()


def set_shown(scene, show):
    """'BAKED', 'LIGHT' or 'SCENE', in all materials of a scene at once."""
    group = bpy.data.node_groups.get(group_name(scene))
    if group is None or SHOWN not in group.nodes:
        return
    group.nodes[SHOWN].outputs[0].default_value = 0 if show == "SCENE" else 1
    group.nodes[WHITE].outputs[0].default_value = 1 if show == "LIGHT" else 0


def layer_mixers(scene):
    """(name, socket) of each layer's colour, for the panel."""
    group = bpy.data.node_groups.get(group_name(scene))
    nodes = group.nodes if group is not None else []
    return [(node.name[len(LAYER):], node.outputs[0]) for node in nodes if node.name.startswith(LAYER)]
