"""Two scenes of the comparison that no folder has: two rooms with a lamp behind a door, and a courtyard with leaves.

Both are quads with a lightmap layout in TEXCOORD_1: each has a rectangle of whole texels of its own, two texels from
the next. Lengths are in metres, y is up. Plain Python 3, no packages.
"""
import json
import math
import random
import struct

import png

RESOLUTION, GAP = 256, 2
LEAF = {"name": "leaf", "colour": (0.25, 0.45, 0.12), "mask": True}
MASK_SIDE = 128


def plus(a, b, scale=1.0):
    return tuple(x + scale * y for x, y in zip(a, b))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def length(a):
    return math.sqrt(sum(x * x for x in a))


def quad(material, corner, along, up, mirrored=False):
    """A parallelogram that is seen from where along x up points."""
    return {"material": material, "corner": corner, "along": along, "up": up, "mirrored": mirrored}


def box(material, low, high, faces="xXyYzZ", inside=False):
    """Faces of a box, by the axis that they face: x towards -x, X towards +x."""
    size = tuple(h - l for l, h in zip(low, high))
    out = []
    for face in faces:
        axis = "xyz".index(face.lower())
        a, b = [0.0] * 3, [0.0] * 3
        a[(axis + 1) % 3], b[(axis + 2) % 3] = size[(axis + 1) % 3], size[(axis + 2) % 3]
        corner = list(low)
        if face.isupper():
            corner[axis] = high[axis]
        if face.isupper() == inside:
            a, b = b, a
        out.append(quad(material, tuple(corner), tuple(a), tuple(b)))
    return out


def two_rooms():
    wall, floor = {"name": "wall", "colour": (0.75, 0.73, 0.7)}, {"name": "floor", "colour": (0.45, 0.3, 0.2)}
    blue = {"name": "blue", "colour": (0.2, 0.3, 0.6)}
    lamp = {"name": "lamp", "colour": (0.5, 0.5, 0.5), "radiance": (30, 27, 22)}
    quads = []
    for x0, x1, open_side in ((0, 4, "X"), (4.1, 8, "x")):
        quads += box(floor, (x0, 0, 0), (x1, 2.7, 3), "y", inside=True)
        quads += box(wall, (x0, 0, 0), (x1, 2.7, 3), "xXYzZ".replace(open_side, ""), inside=True)
    for z0, z1, y0 in ((0, 1, 0), (1.9, 3, 0), (1, 1.9, 2.1)):  # beside the door and above it
        quads += box(wall, (4, y0, z0), (4.1, 2.7, z1), "xX")
    quads += box(wall, (4, 0, 1), (4.1, 2.1, 1.9), "YzZ", inside=True)
    quads += box(floor, (4, 0, 1), (4.1, 2.1, 1.9), "y", inside=True)
    quads += box(blue, (1, 0, 0.6), (2.2, 0.7, 1.4), "xXYzZ")
    quads.append(quad(lamp, (6.6, 2.6, 0.3), (0.6, 0, 0), (0, 0, 0.6)))
    return quads, None


def courtyard():
    stone, ground = {"name": "stone", "colour": (0.6, 0.55, 0.5)}, {"name": "ground", "colour": (0.4, 0.38, 0.33)}
    quads = box(ground, (0, 0, 0), (10, 3.5, 10), "y", inside=True)
    quads += box(stone, (0, 0, 0), (10, 3.5, 10), "xXzZ", inside=True)
    quads += box(stone, (0.01, 2.8, 0.01), (9.99, 3.1, 2), "yYZ")
    for x in (1.5, 4.8, 8.1):
        quads += box(stone, (x, 0, 1.6), (x + 0.4, 2.8, 2), "xXzZ")
    quads += box(stone, (6, 0, 5), (8, 0.5, 5.6), "xXYzZ")
    chance = random.Random(29)
    for k in range(9):
        turn, tilt = chance.uniform(0, 2 * math.pi), chance.uniform(-0.4, 0.4)
        along = (1.6 * math.cos(turn), 0.0, 1.6 * math.sin(turn))
        up = (1.6 * math.sin(turn) * math.cos(tilt), 1.6 * math.sin(tilt), -1.6 * math.cos(turn) * math.cos(tilt))
        middle = (2.2 + 2.1 * (k % 3), chance.uniform(1.6, 2.6), 3.9 + 1.8 * (k // 3))
        quads += leaf(plus(plus(middle, along, -0.5), up, -0.5), along, up)
    return quads, {"direction": (0.45, -0.8, 0.35), "colour": (1, 0.93, 0.8), "lux": 100}


def leaf(corner, along, up):
    """Two sides, 2 cm apart, so that each has texels of its own; their holes lie upon each other."""
    normal = cross(along, up)
    below = plus(plus(corner, along), normal, -0.02 / length(normal))
    return [quad(LEAF, corner, along, up), quad(LEAF, below, tuple(-x for x in along), up, mirrored=True)]


def leaf_mask():
    """Forty leaflets on a twig: RGBA, white, alpha 255 or 0."""
    chance = random.Random(7)
    leaflets = [(chance.uniform(0.12, 0.88), chance.uniform(0.12, 0.88), chance.uniform(0, math.pi)) for _ in range(40)]
    pixels = bytearray()
    for j in range(MASK_SIDE):
        for i in range(MASK_SIDE):
            x, y = (i + 0.5) / MASK_SIDE, (j + 0.5) / MASK_SIDE
            seen = any(math.hypot(((x - u) * math.cos(t) + (y - v) * math.sin(t)) / 0.1,
                                  ((y - v) * math.cos(t) - (x - u) * math.sin(t)) / 0.045) < 1
                       for u, v, t in leaflets)
            pixels += bytes((255, 255, 255, 255 if seen else 0))
    return png.encoded(MASK_SIDE, MASK_SIDE, 4, bytes(pixels))


def rectangles(quads, density):
    """Where each quad lies, as x, y, width, height in texels, in rows; or None where they do not fit."""
    sizes = [tuple(max(2, round(length(q[edge]) * density)) for edge in ("along", "up")) for q in quads]
    out, x, y, row = [None] * len(quads), GAP, GAP, 0
    for k in sorted(range(len(quads)), key=lambda k: -sizes[k][1]):
        width, height = sizes[k]
        if x + width + GAP > RESOLUTION:
            x, y, row = GAP, y + row + GAP, 0
        if x + width + GAP > RESOLUTION or y + height + GAP > RESOLUTION:
            return None
        out[k], x, row = (x, y, width, height), x + width + GAP, max(row, height)
    return out


def layout(quads):
    """The densest layout in steps of a hundredth."""
    density = 200.0
    while (out := rectangles(quads, density)) is None:
        density *= 0.99
    return out


def corners_of(q, place):
    """Position, normal, TEXCOORD_0 and TEXCOORD_1 of four corners."""
    normal = cross(q["along"], q["up"])
    normal = tuple(x / length(normal) for x in normal)
    for s, t in ((0, 0), (1, 0), (1, 1), (0, 1)):
        position = plus(plus(q["corner"], q["along"], s), q["up"], t)
        uv1 = ((place[0] + s * place[2]) / RESOLUTION, (place[1] + t * place[3]) / RESOLUTION)
        yield position, normal, (1 - s if q["mirrored"] else s, t), uv1


class Glb:
    """A binary glTF file in the making."""

    def __init__(self):
        self.bytes = bytearray()
        self.json = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "bufferViews": [],
                     "accessors": [], "materials": [], "meshes": [{"name": "all", "primitives": []}],
                     "nodes": [{"name": "all", "mesh": 0}], "extensionsUsed": []}

    def view(self, data):
        self.bytes += b"\0" * (-len(self.bytes) % 4)
        self.json["bufferViews"].append({"buffer": 0, "byteOffset": len(self.bytes), "byteLength": len(data)})
        self.bytes += data
        return len(self.json["bufferViews"]) - 1

    def accessor(self, rows, kind, letter="f"):
        data = b"".join(struct.pack(f"<{len(row)}{letter}", *row) for row in rows)
        accessor = {"bufferView": self.view(data), "componentType": 5126 if letter == "f" else 5125,
                    "count": len(rows), "type": kind}
        if kind == "VEC3":
            columns = list(zip(*[struct.unpack("<3f", struct.pack("<3f", *row)) for row in rows]))
            accessor["min"], accessor["max"] = [min(c) for c in columns], [max(c) for c in columns]
        self.json["accessors"].append(accessor)
        return len(self.json["accessors"]) - 1

    def extension(self, name):
        if name not in self.json["extensionsUsed"]:
            self.json["extensionsUsed"].append(name)

    def material(self, m):
        out = {"name": m["name"], "pbrMetallicRoughness": {"baseColorFactor": [*m["colour"], 1], "metallicFactor": 0}}
        if "radiance" in m:
            strength = max(m["radiance"])
            out["emissiveFactor"] = [x / strength for x in m["radiance"]]
            out["extensions"] = {"KHR_materials_emissive_strength": {"emissiveStrength": strength}}
            self.extension("KHR_materials_emissive_strength")
        if m.get("mask"):
            out["alphaMode"] = "MASK"
            out["pbrMetallicRoughness"]["baseColorTexture"] = {"index": 0}
            self.json["images"] = [{"bufferView": self.view(leaf_mask()), "mimeType": "image/png"}]
            self.json["samplers"] = [{"magFilter": 9729, "minFilter": 9729, "wrapS": 33071, "wrapT": 33071}]
            self.json["textures"] = [{"source": 0, "sampler": 0}]
        self.json["materials"].append(out)
        return len(self.json["materials"]) - 1

    def primitive(self, material, corners):
        parts = [self.accessor(rows, kind) for rows, kind in zip(zip(*corners), ("VEC3", "VEC3", "VEC2", "VEC2"))]
        names = ("POSITION", "NORMAL", "TEXCOORD_0", "TEXCOORD_1")
        triangles = [(4 * k + i,) for k in range(len(corners) // 4) for i in (0, 1, 2, 0, 2, 3)]
        self.json["meshes"][0]["primitives"].append(
            {"attributes": dict(zip(names, parts)), "indices": self.accessor(triangles, "SCALAR", "I"),
             "material": self.material(material)})

    def sun(self, sun):
        """A node whose -z is the way the light travels."""
        d = tuple(x / length(sun["direction"]) for x in sun["direction"])
        x, y, w = d[1], -d[0], 1 - d[2]  # the shortest turn of (0, 0, -1) to d
        size = math.sqrt(x * x + y * y + w * w)
        self.extension("KHR_lights_punctual")
        self.json["extensions"] = {"KHR_lights_punctual": {"lights": [
            {"type": "directional", "name": "sun", "color": sun["colour"], "intensity": sun["lux"]}]}}
        self.json["nodes"].append({"name": "sun", "rotation": [x / size, y / size, 0, w / size],
                                   "extensions": {"KHR_lights_punctual": {"light": 0}}})
        self.json["scenes"][0]["nodes"].append(1)

    def encoded(self):
        self.bytes += b"\0" * (-len(self.bytes) % 4)
        self.json["buffers"] = [{"byteLength": len(self.bytes)}]
        text = json.dumps(self.json).encode()
        text += b" " * (-len(text) % 4)
        chunks = b"".join(struct.pack("<I4s", len(data), kind) + bytes(data)
                          for data, kind in ((text, b"JSON"), (self.bytes, b"BIN\0")))
        return struct.pack("<4s2I", b"glTF", 2, 12 + len(chunks)) + chunks


def glb(quads, sun):
    out = Glb()
    by_material = {}
    for q, place in zip(quads, layout(quads)):
        by_material.setdefault(q["material"]["name"], (q["material"], []))[1].extend(corners_of(q, place))
    for material, corners in by_material.values():
        out.primitive(material, corners)
    if sun:
        out.sun(sun)
    return out.encoded()


MADE = {"two_rooms": two_rooms, "courtyard": courtyard}


def write(name, path):
    path.write_bytes(glb(*MADE[name]()))
