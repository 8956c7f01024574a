#!/usr/bin/env python3
"""Takes the lightmap's picture out of a baked .glb: tools/lightmap_png.py BAKED.glb OUT.png

The picture is E / intensity as 8-bit sRGB (docs/bake.md); lightmap.exr has the full range."""
import json
import struct
import sys


def lightmap_png(glb):
    length = struct.unpack_from("<I", glb, 12)[0]
    document = json.loads(glb[20:20 + length])
    binary = glb[20 + length + 8:]
    for material in document["materials"]:
        lightmap = material.get("extensions", {}).get("MOZ_lightmap")
        if lightmap:
            image = document["images"][document["textures"][lightmap["index"]]["source"]]
            view = document["bufferViews"][image["bufferView"]]
            start = view.get("byteOffset", 0)
            return binary[start:start + view["byteLength"]]
    raise SystemExit("no material has a MOZ_lightmap: not a file that luxel bake wrote")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        raise SystemExit(__doc__)
    with open(sys.argv[1], "rb") as source:
        picture = lightmap_png(source.read())
    with open(sys.argv[2], "wb") as out:
        out.write(picture)
