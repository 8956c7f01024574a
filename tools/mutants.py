#!/usr/bin/env python3
"""Gives luxel damaged files of every format that it reads, and prints a row per format.

    tools/mutants.py LUXEL [--count 2000] [--seed 1] [--format FORMAT ...] [--keep FOLDER] [--sanitized]

Each mutant is a small file with a few bytes, numbers or blocks changed, and the same for the same seed. luxel bakes it
(a picture, an environment, a lamp's profile or settings: with a square that uses it). A run must end with a code from 0
to 3, within 20 s, below 1.1 times --max-memory, and with valid JSON on stdout. Files of runs that do not are kept. Ends
with 1 if there are any. Of a program with sanitizers (build/asan/bin/luxel) neither memory nor seconds say anything.
"""
import argparse
import base64
import concurrent.futures
import json
import os
import pathlib
import random
import re
import struct
import subprocess
import sys
import tempfile
import threading
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
CORPUS = ROOT / "tests/fuzz/corpus"
MAX_MIB, MAX_SECONDS = 300, 20
# The corpora whose files are whole files, as somebody would send them.
SCENES = {"glb", "gltf", "obj", "fbx", "dae", "ply", "stl", "x"}
PICTURES = {"png", "jpg", "webp", "bmp", "tga"}
OTHERS = {"hdr", "exr", "ies", "json", "toml"}
SETTINGS = b"[bake]\nresolution = 32\nsamples = 4\nbackground = \"0.5,0.5,1\"\nlayers = \"groups\"\n# light\n"
EXTREMES = [b"0", b"-1", b"1e309", b"nan", b"4294967296", b"-2147483649", b"99999999999999999999", b"1e-320", b""]


def seeds_of(ending):
    """Files to change: those of the corpora, and scenes of the repository that are small."""
    files = [f for f in sorted(CORPUS.rglob(f"*.{ending}")) if f.parent.name not in ("option_texts", "parts")]
    if ending == "glb":
        files += sorted(f for f in (ROOT / "scenes").glob("*.glb") if f.stat().st_size < 100_000)
    if ending == "json":
        files = sorted((CORPUS / "settings").glob("*.json"))
    return [SETTINGS] if ending == "toml" else [f.read_bytes() for f in files]


def change(data, rng):
    """The data with one change."""
    if not data:
        return b"x"
    at, kind = rng.randrange(len(data)), rng.randrange(8)
    if kind == 0:
        return data[:at] + bytes([data[at] ^ (1 << rng.randrange(8))]) + data[at + 1:]
    if kind == 1:
        return data[:at] + bytes([rng.randrange(256)]) + data[at + 1:]
    if kind == 2:
        return data[:at]
    end = min(len(data), at + 1 + int(rng.expovariate(1 / 16)))
    if kind == 3:
        return data[:at] + data[end:]
    if kind == 4:
        return data[:at] + data[at:end] * rng.choice([2, 3, 1000]) + data[at:]
    if kind == 5:
        value = rng.choice([0, 1, 0x7F, 0xFF, 0x7FFF, 0xFFFF, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 0x01000000])
        return data[:at] + struct.pack("<I", value) + data[at + 4:]
    numbers = list(re.finditer(rb"-?\d+(\.\d+)?", data[:20_000]))
    if kind == 6 and numbers:
        number = rng.choice(numbers)
        return data[:number.start()] + rng.choice(EXTREMES) + data[number.end():]
    other = rng.randrange(len(data))
    return data[:at] + data[other:other + end - at] + data[end:]


def mutant(seeds, rng):
    data = rng.choice(seeds)
    for _ in range(1 + int(rng.expovariate(0.7))):
        data = change(data, rng)
    return data


def host(picture):
    """A square under a lamp, with a picture."""
    corners = struct.pack("<12f", 0, 0, 0, 1, 0, 0, 1, 0, -1, 0, 0, -1)
    uvs, indices = struct.pack("<8f", 0, 0, 1, 0, 1, 1, 0, 1), struct.pack("<6H", 0, 1, 2, 0, 2, 3)
    uri = "data:application/octet-stream;base64," + base64.b64encode(corners + uvs + indices).decode()
    views = [(0, 48), (48, 32), (80, 12)]
    return json.dumps({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
        "nodes": [{"mesh": 0}, {"name": "lamp", "translation": [0.5, 1, -0.5],
                                "extensions": {"KHR_lights_punctual": {"light": 0}}}],
        "extensionsUsed": ["KHR_lights_punctual"],
        "extensions": {"KHR_lights_punctual": {"lights": [{"name": "lamp", "type": "point", "intensity": 100}]}},
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2, "material": 0}]}],
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}} if picture else {}],
        **({"textures": [{"source": 0}], "images": [{"uri": picture}]} if picture else {}),
        "buffers": [{"uri": uri, "byteLength": 92}],
        "bufferViews": [{"buffer": 0, "byteOffset": o, "byteLength": n} for o, n in views],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, -1], "max": [1, 0, 0]},
            {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2"},
            {"bufferView": 2, "componentType": 5123, "count": 6, "type": "SCALAR"}]})


def arguments_for(ending, file, folder):
    """What makes luxel read the file."""
    scene = folder / "host.gltf"
    scene.write_text(host(file.name if ending in PICTURES else None))
    common = ["-o", str(folder / "out"), "--resolution", "16", "--samples", "1", "--max-memory", f"{MAX_MIB}M",
              "--threads", "1", "--quiet", "--json"]
    if ending in SCENES:
        return ["bake", str(file), "--settings", "none", *common]
    if ending in PICTURES:
        return ["bake", str(scene), "--settings", "none", *common]
    if ending in ("hdr", "exr"):
        return ["bake", str(scene), "--settings", "none", "--environment", str(file), *common]
    if ending == "ies":
        return ["bake", str(scene), "--settings", "none", "--ies", f"lamp={file}", *common]
    return ["bake", str(scene), "--settings", str(file), *common]


def run(luxel, ending, data, sanitized):
    """What is wrong with luxel's end, empty if nothing is; its seconds and MiB."""
    with tempfile.TemporaryDirectory(prefix="luxel-mutant-") as name:
        folder = pathlib.Path(name)
        file = folder / f"mutant.{ending}"
        file.write_bytes(data)
        start = time.monotonic()
        with open(folder / "stdout", "wb") as out, open(folder / "stderr", "wb") as err:
            child = subprocess.Popen([luxel, *arguments_for(ending, file, folder)], stdout=out, stderr=err)
            killer = threading.Timer((10 if sanitized else 1) * MAX_SECONDS, child.kill)
            killer.start()
            _, status, usage = os.wait4(child.pid, 0)
            killer.cancel()
        child.returncode = 0  # it has been waited for
        seconds, mib = time.monotonic() - start, usage.ru_maxrss / 1024
        said = (folder / "stdout").read_bytes()
        wrong = []
        if os.WIFSIGNALED(status):
            wrong.append("took too long" if os.WTERMSIG(status) == 9 else f"signal {os.WTERMSIG(status)}")
        elif os.WEXITSTATUS(status) > 3:
            wrong.append(f"code {os.WEXITSTATUS(status)}")
        if b"internal error" in (folder / "stderr").read_bytes():
            wrong.append("internal error")
        if mib > 1.1 * MAX_MIB and not sanitized:
            wrong.append(f"{mib:.0f} MiB")
        try:
            json.loads(said.decode("utf-8"))
        except ValueError:
            if not os.WIFSIGNALED(status):
                wrong.append("no JSON")
        return ", ".join(wrong), seconds, mib


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("luxel")
    parser.add_argument("--count", type=int, default=2000, help="mutants of each format")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--format", nargs="*", default=sorted(SCENES | PICTURES | OTHERS))
    parser.add_argument("--keep", default="build/mutants", help="where files of wrong runs go")
    parser.add_argument("--sanitized", action="store_true")
    options = parser.parse_args()
    luxel, failed = os.path.abspath(options.luxel), 0
    print("format,mutants,wrong,slowest [s],most memory [MiB]", flush=True)
    for ending in options.format:
        seeds = seeds_of(ending)
        make = lambda i: mutant(seeds, random.Random(f"{options.seed} {ending} {i}"))
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            ends = list(pool.map(lambda i: run(luxel, ending, make(i), options.sanitized), range(options.count)))
        wrong = [i for i, end in enumerate(ends) if end[0]]
        for i in wrong:
            pathlib.Path(options.keep).mkdir(parents=True, exist_ok=True)
            kept = pathlib.Path(options.keep) / f"{options.seed}-{i}.{ending}"
            kept.write_bytes(make(i))
            print(f"{kept}: {ends[i][0]}", file=sys.stderr, flush=True)
        failed += len(wrong)
        print(f"{ending},{options.count},{len(wrong)},{max(e[1] for e in ends):.1f},{max(e[2] for e in ends):.0f}",
              flush=True)
    return failed > 0


if __name__ == "__main__":
    sys.exit(main())
