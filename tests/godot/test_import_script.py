#!/usr/bin/env python3
"""Holds addons/godot/luxel/import_baked.gd against what is known of Godot, and baked.glb against what the script needs.

    tests/godot/test_import_script.py LUXEL

Godot 4 is in no Debian, so nothing here runs the script. Every name that it takes from Godot must stand in
seen_in_godot.txt, with the place where it was seen, and every name there must be used. Bakes of the Cornell box must
have the keys, coordinates and files that the script reads.
"""
import json
import pathlib
import re
import struct
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
SCRIPT = ROOT / "addons/godot/luxel/import_baked.gd"
WORDS = set("extends const var func return if elif else for in is not and or null true false class_name"
            " void bool int float vec2 vec3 vec4 min".split())  # of GDScript, and of GLSL
GLB_JSON, TRIANGLE = 0x4E4F534A, 3


def check(holds, sentence):
    if not holds:
        raise AssertionError(sentence)


# The script.

def seen_names(text):
    """The first words of the lines."""
    return {line.split()[0] for line in text.splitlines() if line.strip() and not line.startswith("#")}


def own_names(code, shader):
    """What the script and its shader call by names of their own."""
    own = set(re.findall(r"\b(?:func|var|const|for)\s+(?!_post_import\b)(\w+)", code))  # which Godot calls
    for parameters in re.findall(r"\bfunc\s+\w+\(([^)]*)\)", code):
        own |= set(re.findall(r"(\w+)\s*:", parameters))
    return own | set(re.findall(r"\b(?:uniform\s+)?(?:bool|float|vec\d|sampler2D)\s+(\w+)\s*[:=;]", shader))


def used_names(text):
    """The names that the script has from Godot, those of its shader included."""
    code = re.sub(r"(?m)#.*$", "", text)
    shader = re.search(r'"""(.*?)"""', code, re.S)
    check(shader, "the shader has gone")
    shader_code, code = shader.group(1).replace("%s", ""), code.replace(shader.group(0), "SHADER")
    strings = re.findall(r'"((?:[^"\\]|\\.)*)"', code)
    parameters = set(re.findall(r'set_shader_parameter\("(\w+)"', code))
    plain = re.sub(r'"(?:[^"\\]|\\.)*"', " ", code)
    own = own_names(plain, shader_code)
    members = set(re.findall(r"\.(\w+)", plain))  # a member may have the name of a variable
    words = members | {word for word in re.findall(r"@?\b[A-Za-z_]\w*", plain) if word not in own}
    # Words that go into the shader by strings, as lines of it.
    added = " ".join(s for s in strings if "ALPHA" in s or s.startswith("cull_"))
    added = added.replace("\\n", " ").replace("\\t", " ")
    shader_words = re.findall(r"(?<!\.)\b[A-Za-z_]\w*", shader_code + " " + added)
    words |= {word for word in shader_words if word not in own}
    undeclared = parameters - set(re.findall(r"uniform\s+\w+\s+(\w+)", shader_code))
    check(not undeclared, f"the shader has no uniform {sorted(undeclared)}")
    words |= {f'"{s}"' for s in strings if s == "extras"}
    return {word for word in words if word not in WORDS}


def check_script(text, seen):
    used = used_names(text)
    check(used <= seen, f"not in seen_in_godot.txt: {sorted(used - seen)}")
    check(seen <= used, f"in seen_in_godot.txt, but not used: {sorted(seen - used)}")
    code = text.replace('"""', "")
    check(re.search(r"(?m)^@tool\n", text), "without @tool the script does not run in the editor")
    for opening, closing in ("()", "[]", "{}"):
        check(code.count(opening) == code.count(closing), f"{opening} and {closing} do not match")
    check(not re.search(r"(?m)^ +\S", text), "GDScript is indented by tabs")
    return len(used)


def self_test(text, seen):
    """Each kind of fault is found."""
    faults = [text.replace("surface_set_material", "set_surface_material"),  # Godot 3
              text.replace("albedo_texture)", "albedo_map)"),
              text.replace("return scene", "return PackedScene.new()"),
              text.replace("texture(lightmap, UV2)", "texture(lightmap, UV3)"),
              text.replace("loaded.emission_energy_multiplier", "2.0"),
              text.replace('"lightmap", lightmap)', '"light_map", lightmap)')]
    for fault in faults:
        check(fault != text, "the script has changed, and a fault could not be made up")
        try:
            check_script(fault, seen)
        except AssertionError:
            continue
        raise AssertionError("a made-up fault is not found")


# The bakes.

def glb_parts(path):
    data = path.read_bytes()
    check(data[:4] == b"glTF", f"{path.name} is no .glb")
    length, kind = struct.unpack_from("<II", data, 12)
    check(kind == GLB_JSON, f"{path.name}: its first chunk is not JSON")
    return json.loads(data[20:20 + length]), data[20 + length + 8:]


def pairs(document, binary, accessor):
    """The vectors of an accessor of VEC2, floats."""
    accessor = document["accessors"][accessor]
    check(accessor["type"] == "VEC2" and accessor["componentType"] == 5126, "coordinates are not floats")
    view = document["bufferViews"][accessor["bufferView"]]
    start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
    check("byteStride" not in view or view["byteStride"] == 8, "coordinates are interleaved")
    return list(struct.iter_unpack("<2f", binary[start:start + 8 * accessor["count"]]))


def exr_header(path):
    """The attributes of an EXR file of one part, as bytes."""
    data = path.read_bytes()
    magic, version = struct.unpack_from("<II", data)
    check(magic == 20000630, f"{path.name} is no EXR file")
    check(version & ~0xFF == 0, f"{path.name} is tiled, deep or of several parts")
    at, attributes = 8, {}
    while data[at]:
        name_end = data.index(0, at)
        type_end = data.index(0, name_end + 1)
        (size,) = struct.unpack_from("<I", data, type_end + 1)
        attributes[data[at:name_end].decode()] = data[type_end + 5:type_end + 5 + size]
        at = type_end + 5 + size
    return attributes


def check_lightmap(path, side):
    header = exr_header(path)
    channels = header["channels"]
    names = [channels[i:i + 1].decode() for i in range(0, len(channels) - 1, 18)]
    check(names == ["A", "B", "G", "R"], f"{path.name} has the channels {names}")
    check(header["compression"][0] in range(5), f"{path.name}: tinyexr does not know its compression")
    window = struct.unpack("<4i", header["dataWindow"])
    check(window == (0, 0, side - 1, side - 1), f"{path.name} has the window {window}, not {side} x {side}")


def check_bake(folder):
    """What the script reads of a bake. Returns how many surfaces have a lightmap."""
    document, binary = glb_parts(folder / "baked.glb")
    report = json.loads((folder / "bake.json").read_text())
    sides = {page["file"]: page["resolution"] for page in report["atlas"]["pages"]}
    check(report["preview"]["exposure"] > 0, "bake.json has no exposure")
    lit = 0
    for node in document["nodes"]:
        if "mesh" not in node:
            continue
        for primitive in document["meshes"][node["mesh"]]["primitives"]:
            check(primitive.get("mode", 4) == 4, "a primitive is no list of triangles")
            material = document["materials"][primitive["material"]]
            extras = material.get("extras", {}).get("luxel", {})
            unlit = "KHR_materials_unlit" in material.get("extensions", {})
            check(unlit or "lightmap" in extras, f"the material {material.get('name')} names no lightmap")
            kept = node.get("extras", {}).get("luxel", {}).get("bake", True)
            check(kept == ("MOZ_lightmap" in material.get("extensions", {})), "extras and MOZ_lightmap disagree")
            if unlit or not kept:
                continue
            lit += 1
            attributes = primitive["attributes"]
            check("TEXCOORD_1" in attributes, f"{node['name']} has no TEXCOORD_1")
            places = pairs(document, binary, attributes["TEXCOORD_1"])
            check(places and all(0 <= u <= 1 and 0 <= v <= 1 for u, v in places), "places outside of the lightmap")
            check(len(set(places)) >= TRIANGLE, f"{node['name']} lies in one point of the lightmap")
            check(extras["lightmap"] in sides, f"{extras['lightmap']} is no page of bake.json")
    for file, side in sides.items():
        check(file in report["files"], f"bake.json does not list {file}")
        check_lightmap(folder / file, side)
    return lit


def with_extras(source, path):
    """The Cornell box, its short block left out of the lightmap."""
    document, binary = glb_parts(source)
    left_out = 0
    for node in document["nodes"]:
        if "mesh" in node and "short" in node.get("name", ""):
            node["extras"] = {"luxel": {"bake": False}}
            left_out += 1
    check(left_out == 1, "the Cornell box has no short block")
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    rest = struct.pack("<II", len(binary), 0x004E4942) + binary
    path.write_bytes(struct.pack("<4sIIII", b"glTF", 2, 20 + len(text) + len(rest), len(text), GLB_JSON) + text + rest)


def bake(luxel, scene, folder, *options):
    subprocess.run([luxel, "bake", scene, "-o", folder, "--resolution", "64", "--samples", "4", "--quiet", *options],
                   check=True)
    return check_bake(folder)


def main():
    if len(sys.argv) != 2 or not pathlib.Path(sys.argv[1]).exists():
        print("skipped: give the path of the program luxel")
        return 77
    luxel = sys.argv[1]
    text, seen = SCRIPT.read_text(), seen_names((HERE / "seen_in_godot.txt").read_text())
    print(f"{check_script(text, seen)} names of Godot, each seen")
    self_test(text, seen)
    box = ROOT / "scenes/cornell-box.glb"
    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)
        all_lit = bake(luxel, box, scratch / "box")
        print(f"cornell-box.glb: {all_lit} surfaces with a lightmap")
        with_extras(box, scratch / "extras.glb")
        lit = bake(luxel, scratch / "extras.glb", scratch / "extras")
        check(0 < lit < all_lit, "luxel.bake = false leaves nothing out")
        check(bake(luxel, box, scratch / "pages", "--pages", "2") > 0, "two pages light nothing")
    print("passed")
    return 0


if __name__ == "__main__":
    sys.exit(main())
