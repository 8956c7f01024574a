#!/usr/bin/env python3
"""Takes a lightmap's picture out of a baked .glb: tools/lightmap_png.py BAKED.glb OUT.png [PAGE]

The picture is E / intensity as 8-bit sRGB (docs/format/bake.md); lightmap.exr has the full range."""
import json
import struct
import sys


def lightmap_png(glb, page):
    length = struct.unpack_from("<I", glb, 12)[0]
    document = json.loads(glb[20:20 + length])
    binary = glb[20 + length + 8:]
    pages = sorted({material["extensions"]["MOZ_lightmap"]["index"]
                    for material in document["materials"]
                    if "MOZ_lightmap" in material.get("extensions", {})})
    if not pages:
        raise SystemExit("no material has a MOZ_lightmap: not a file that luxel bake wrote")
    if not 0 <= page < len(pages):
        raise SystemExit(f"there is no page {page}: the file has {len(pages)}, the first is 0")
    image = document["images"][document["textures"][pages[page]]["source"]]
    view = document["bufferViews"][image["bufferView"]]
    start = view.get("byteOffset", 0)
    return binary[start:start + view["byteLength"]]


if __name__ == "__main__":
    if len(sys.argv) not in (3, 4):
        raise SystemExit(__doc__)
    with open(sys.argv[1], "rb") as source:
        picture = lightmap_png(source.read(), int(sys.argv[3]) if len(sys.argv) == 4 else 0)
    with open(sys.argv[2], "wb") as out:
        out.write(picture)
