"""Binary glTF files: read, changed and written. Knows nothing of Blender."""
import json
import struct

import numpy

MAGIC, VERSION, JSON_CHUNK, BINARY_CHUNK = 0x46546C67, 2, 0x4E4F534A, 0x004E4942
COMPONENTS = {5120: numpy.int8, 5121: numpy.uint8, 5122: numpy.int16, 5123: numpy.uint16,
              5125: numpy.uint32, 5126: numpy.float32}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}


def read(path):
    """The document and the bytes of its buffer."""
    with open(path, "rb") as file:
        data = file.read()
    if len(data) < 20 or struct.unpack_from("<II", data) != (MAGIC, VERSION):
        raise ValueError(f"{path} is not a binary glTF file")
    document, binary, at = None, b"", 12
    while at + 8 <= len(data):
        size, kind = struct.unpack_from("<II", data, at)
        chunk = data[at + 8:at + 8 + size]
        if kind == JSON_CHUNK:
            document = json.loads(chunk)
        elif kind == BINARY_CHUNK:
            binary = chunk
        at += 8 + size
    if document is None:
        raise ValueError(f"{path} contains no JSON")
    return document, binary


def write(path, document, binary):
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    binary = bytes(binary) + b"\0" * (-len(binary) % 4)
    chunks = struct.pack("<II", len(text), JSON_CHUNK) + text
    if binary:
        chunks += struct.pack("<II", len(binary), BINARY_CHUNK) + binary
    with open(path, "wb") as file:
        file.write(struct.pack("<III", MAGIC, VERSION, 12 + len(chunks)) + chunks)


def accessor(document, binary, number):
    """A row for each element, as numbers of the type that the file has."""
    about = document["accessors"][number]
    view = document["bufferViews"][about["bufferView"]]
    kind, width, count = numpy.dtype(COMPONENTS[about["componentType"]]), WIDTHS[about["type"]], about["count"]
    begin = view.get("byteOffset", 0) + about.get("byteOffset", 0)
    stride = view.get("byteStride", kind.itemsize * width)
    return numpy.ndarray((count, width), kind, binary, begin, (stride, kind.itemsize))


def triangles_of_nodes(document, binary):
    """Per name of a node with a mesh: positions (n, 3, 3) and TEXCOORD_1 (n, 3, 2) of its triangles' corners."""
    found = {}
    for node in document.get("nodes", []):
        if "mesh" not in node:
            continue
        positions, coordinates = [], []
        for primitive in document["meshes"][node["mesh"]]["primitives"]:
            attributes = primitive["attributes"]
            if "TEXCOORD_1" not in attributes:
                continue
            corners = accessor(document, binary, primitive["indices"]).reshape(-1, 3)
            positions.append(accessor(document, binary, attributes["POSITION"])[corners])
            coordinates.append(accessor(document, binary, attributes["TEXCOORD_1"])[corners])
        if positions:
            found[node["name"]] = numpy.concatenate(positions), numpy.concatenate(coordinates)
    return found
