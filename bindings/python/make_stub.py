#!/usr/bin/env python3
"""Writes the options of luxel's functions into luxel/__init__.pyi, from what the built module says of its tables.

    PYTHONPATH=build/release/python bindings/python/make_stub.py --write
    PYTHONPATH=build/release/python bindings/python/make_stub.py --check    exit 1 when the file has other options
"""
import pathlib
import re
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.remove(str(HERE))  # its luxel/ is the source of the package, which is not built
from luxel import _luxel  # noqa: E402

STUB = HERE / "luxel" / "__init__.pyi"
TABLES = {"load": _luxel._options_of_load, "bake": _luxel._options_of_bake, "relighter": _luxel._options_of_relighter}
BY_HAND = {"bake": [("solver", "str", "Solver that computes the light", "gather"),
                    ("settings", "Value", "Read scene and settings from the bake.json of an earlier bake", "")],
           "relighter": [("threads", "int", "Number of threads; 0: all cores", "0")]}


def lines_of(name, indent):
    known, out = set(), []
    for option, kind, meaning, default in BY_HAND.get(name, []) + TABLES[name]():
        if option in known:  # "--denoise" and "--no-denoise"
            continue
        known.add(option)
        default = f"; {default}" if default else ""
        out.append(f"{indent}{option}: {kind} | None = ...,  # {meaning}{default}\n")
    return "".join(out)


def with_options(text):
    for name in TABLES:
        block = re.compile(rf"( *)# begin: {name}\n(?:.*\n)*?( *# end: {name}\n)")
        if not block.search(text):
            sys.exit(f"{STUB}: there is no '# begin: {name}' with an end")
        text = block.sub(lambda m: f"{m[1]}# begin: {name}\n{lines_of(name, m[1])}{m[2]}", text)
    return text


def main():
    if sys.argv[1:] not in (["--write"], ["--check"]):
        sys.exit(__doc__)
    old = STUB.read_text()
    new = with_options(old)
    if sys.argv[1] == "--write":
        STUB.write_text(new)
    elif new != old:
        sys.exit(f"{STUB} has other options than luxel; bindings/python/make_stub.py --write mends it")


main()
