#!/usr/bin/env python3
"""Has clang look at every unit of a build that g++ has made: no error and no warning.

    tools/clang_check.py build/release [PART...]   all units, or those whose path has one of the parts

Clang generates no code (-fsyntax-only). The precompiled headers are made anew in clang's form, in BUILD/clang.
"""
import concurrent.futures
import json
import os
import pathlib
import shlex
import subprocess
import sys

ONLY_GCC = {"-fno-semantic-interposition", "-fpch-preprocess", "-Winvalid-pch", "-Wno-maybe-uninitialized"}


def arguments_of(command):
    """Clang's arguments for a unit, and the header that it precompiles; None where there is none."""
    words = [word for word in shlex.split(command) if word not in ONLY_GCC and not word.startswith("-O")]
    while os.path.basename(words[0]) == "ccache":
        del words[0]
    del words[0]  # the compiler
    at = words.index("-o")
    del words[at:at + 2]
    header = None
    if "-include" in words and words[words.index("-include") + 1].endswith("cmake_pch.hxx"):
        at = words.index("-include")
        header = words[at + 1]
        del words[at:at + 2]
    return words, header


def precompile(header, units, folder):
    """The header in clang's form, with the arguments that all its units share."""
    out = folder / (pathlib.Path(header).parent.name + ".pch")
    shared = [word for word in units[0] if all(word in words for words in units)]
    made = subprocess.run(["clang++", *shared[:shared.index("-c")], "-w", "-x", "c++-header", header, "-o", out], capture_output=True,
                          text=True)
    if made.returncode != 0:
        sys.exit(f"clang_check: {header}:\n{made.stderr}")
    return out


def main():
    if len(sys.argv) < 2 or sys.argv[1].startswith("-"):
        sys.exit(__doc__)
    build, parts = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2:]
    folder = build / "clang"
    folder.mkdir(exist_ok=True)
    units = json.loads((build / "compile_commands.json").read_text(encoding="utf-8"))
    units = [unit for unit in units if unit["file"].endswith((".cpp", ".cxx")) and "cmake_pch" not in unit["file"]
             and (not parts or any(part in unit["file"] for part in parts))]
    parsed = [arguments_of(unit["command"]) for unit in units]
    headers = {header: precompile(header, [words for words, own in parsed if own == header], folder)
               for header in {own for _, own in parsed if own}}

    def look_at(unit, arguments):
        words, header = arguments
        pch = ["-include-pch", str(headers[header])] if header else []
        return subprocess.run(["clang++", *pch, *words, "-fsyntax-only"], cwd=unit["directory"],
                              capture_output=True, text=True)

    wrong = 0
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for unit, seen in zip(units, pool.map(look_at, units, parsed)):
            if seen.returncode != 0 or seen.stderr:
                print(f"{unit['file']}\n{seen.stderr}")
                wrong += 1
    print(f"clang_check: {len(units)} units, {wrong} with errors or warnings")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
