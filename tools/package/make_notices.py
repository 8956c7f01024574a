#!/usr/bin/env python3
"""Makes the notice of all licences in a package: luxel's own, and those of what is compiled or linked into it.

    tools/package/make_notices.py PACKAGE OUT [THREE]   writes OUT for luxel, luxel-view, libluxel-dev or python3-luxel;
                                                        THREE is three.js's LICENSE, if view.html's page was bundled
    tools/package/make_notices.py --check               exit 1 when luxel includes a library that is not listed here
    tools/package/make_notices.py --self-test           proves that copyright files are read right

The form is Debian's machine-readable copyright file. Notices come from /usr/share/doc/*/copyright of the packages that
luxel is built from. Shared libraries are not in it: their own packages bring their notices.
"""
import os
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
DOCUMENTS = pathlib.Path("/usr/share/doc")
PROGRAMS = {"luxel", "luxel-view", "python3-luxel"}
ALL = PROGRAMS | {"libluxel-dev"}


class Part:
    """A library in luxel: its name, Debian's package, the packages of luxel that hold it, whether as "headers" or
    "archive", and which stanzas of its copyright file are about that, by the first word of their Files."""

    def __init__(self, name, package, within, how, stanzas=("*",)):
        self.name, self.package, self.within, self.how, self.stanzas = name, package, within, how, stanzas


PARTS = [
    Part("Draco", "libdraco-dev", ALL, "archive"),
    Part("TinyGLTF", "libtinygltf-dev", ALL, "headers"),
    Part("stb", "libstb-dev", ALL, "headers"),
    Part("meshoptimizer", "libmeshoptimizer-dev", ALL, "headers"),
    Part("tinyobjloader", "libtinyobjloader-dev", ALL, "headers"),
    Part("pugixml", "libpugixml-dev", ALL, "headers", ("*", "src/pugiconfig.hpp")),
    Part("JSON for Modern C++", "nlohmann-json3-dev", ALL, "headers",
         ("*", "include/nlohmann/detail/conversions/to_chars.hpp", "include/nlohmann/detail/output/serializer.hpp")),
    Part("fmt", "libfmt-dev", ALL, "headers"),
    Part("Eigen", "libeigen3-dev", ALL, "headers", ("*", "unsupported/test/mpreal/*", "Eigen/src/Cholesky/LLT_LAPACKE.h")),
    Part("Boost", "libboost1.74-dev", ALL, "headers"),  # CGAL includes it
    Part("oneTBB", "libtbb-dev", ALL, "headers"),
    Part("OpenEXR", "libopenexr-dev", ALL, "headers"),
    Part("Imath", "libimath-dev", ALL, "headers"),
    Part("CLI11", "libcli11-dev", PROGRAMS, "headers"),
    Part("toml++", "libtomlplusplus-dev", PROGRAMS, "headers", ("*", "include/toml++/impl/unicode.h")),
    Part("volk", "libvulkan-volk-dev", {"luxel", "luxel-view"}, "headers"),
    Part("Dear ImGui", "libimgui-dev", {"luxel-view"}, "archive", ("*", "imstb_*.h")),
    Part("pybind11", "pybind11-dev", {"python3-luxel"}, "headers"),
]

# The first part of what luxel includes in angle brackets, and whose it is. "" is a shared library behind a C
# interface, or the system: nothing of it is in luxel's files.
INCLUDED = {
    "draco": "Draco", "tiny_gltf.h": "TinyGLTF", "stb": "stb", "meshoptimizer.h": "meshoptimizer",
    "tiny_obj_loader.h": "tinyobjloader", "pugixml.hpp": "pugixml",
    "nlohmann": "JSON for Modern C++", "fmt": "fmt", "Eigen": "Eigen", "CGAL": "CGAL",
    "tbb": "oneTBB", "OpenEXR": "OpenEXR", "Imath": "Imath", "CLI": "CLI11", "toml++": "toml++", "volk.h": "volk",
    "imgui.h": "Dear ImGui", "backends": "Dear ImGui", "pybind11": "pybind11",
    "assimp": "", "embree3": "", "GLFW": "", "jpeglib.h": "", "jerror.h": "", "mpi.h": "", "vulkan": "", "webp": "",
    "zlib.h": "", "OpenImageDenoise": "", "sanitizer": "", "sys": "",
}
SYSTEM = re.compile(r"^[a-z]+\.h$")  # <unistd.h>

# Debian has these texts in /usr/share/common-licenses; a copyright file names them.
COMMON = {"Apache-2": "Apache-2.0", "Apache-2.0": "Apache-2.0", "MPL-2": "MPL-2.0", "CC0-1.0": "CC0-1.0",
          "LGPL-2.1+": "LGPL-2.1", "LGPL-3+": "LGPL-3"}
COMMON_TITLES = {"Apache-2.0": "the Apache License, Version 2.0", "MPL-2.0": "the Mozilla Public License, Version 2.0",
                 "CC0-1.0": "the CC0 1.0 Universal dedication", "LGPL-2.1": "the GNU Lesser General Public License, version 2.1",
                 "LGPL-3": "the GNU Lesser General Public License, version 3"}

HEADER = """Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/
Upstream-Name: luxel
Comment:
 luxel itself is under the Apache License 2.0. This package also has code of other
 libraries in it, compiled from their headers or linked from their archives. Each one
 has a paragraph below: libfoo-dev/* stands for the files of Debian's package libfoo-dev.
 Shared libraries that it uses are packages of their own, with notices of their own.
 .
 CGAL is used, and its use is covered by the GNU Lesser General Public License: code of
 its headers is compiled in. Section 3 of that license permits to pass the result on under
 other terms, with this notice and the texts of that license and of the GNU General Public
 License, version 3, which it refers to. Nothing here is under the latter.
 .
 Code of GCC's runtime libraries is under the GCC Runtime Library Exception and asks for
 nothing.

Files: *
Copyright: 2026 the luxel authors
License: Apache-2.0
"""
# CGAL's own copyright file is not machine-readable.
CGAL = """Files: libcgal-dev/*
Copyright: 1996-2022 Utrecht University (The Netherlands), ETH Zurich (Switzerland),
           INRIA Sophia-Antipolis (France), Max-Planck-Institute Saarbruecken (Germany),
           and Tel-Aviv University (Israel)
           2008-2022 GeometryFactory (France)
License: LGPL-3+
Comment: CGAL, compiled in from its headers: its kernels and number types. Its other parts,
 under other licences, are not included.
"""
EXTRA_COMMENTS = {"Dear ImGui": "Its font ProggyClean.ttf is Copyright 2004, 2005 Tristan Grimmer, License: Expat."}


def stanzas(text):
    """The paragraphs of a machine-readable file: [{field: value}]; a value keeps its lines."""
    found = []
    for paragraph in re.split(r"\n\s*\n", text):
        fields, name = {}, None
        for line in paragraph.splitlines():
            field = re.match(r"^([A-Za-z-]+):[ \t]*(.*)$", line)
            if field:
                name = field.group(1)
                if name in fields:  # a second Copyright: in one paragraph
                    fields[name] += "\n " + field.group(2)
                else:
                    fields[name] = field.group(2)
            elif name and line[:1] in " \t":
                fields[name] += "\n" + line
        if fields:
            found.append(fields)
    return found


def words(text):
    return " ".join(re.sub(r"[\"'`*.]", " ", text).split()).lower()


class Licences:
    """The texts of all licences, each under a name of its own."""

    def __init__(self):
        self.texts = {}

    def common(self, name):
        short, file = re.sub(r"^(Apache|MPL)-2$", r"\1-2.0", name), COMMON[name]
        self.texts[short] = (f" On Debian systems, the text of {COMMON_TITLES[file]},\n"
                             f" is in /usr/share/common-licenses/{file}.")
        if file == "LGPL-3":
            self.texts[short] += ("\n It refers to the GNU General Public License, version 3,"
                                  "\n in /usr/share/common-licenses/GPL-3.")
        return short

    def add(self, name, text, part):
        """The name under which the text stands here: its own, unless that is another text's."""
        if name in COMMON:
            return self.common(name)
        name = name.replace(" ", "-")
        for candidate in (name, f"{name}-{part.replace(' ', '-')}"):
            if candidate not in self.texts or words(self.texts[candidate]) == words(text):
                self.texts.setdefault(candidate, text)
                return candidate
        raise SystemExit(f"make_notices: two texts of {name} in {part}")


def read_stanza(part, fields, texts, licences):
    """A paragraph about one part, with the names of licences as they stand here."""
    first, _, inline = fields["License"].partition("\n")
    first = first.strip()
    # "A or B and C"; "Expat with embedded exception" is one name.
    names = [first] if first in texts or inline else re.split(r",? (?:or|and) ", first)
    for name in names:
        text = inline if inline and name == first else texts.get(name)
        if text is None and name not in COMMON:
            raise SystemExit(f"make_notices: {part.package}: the text of {name} is missing")
        first = first.replace(name, licences.add(name, text, part.name))
    files = " ".join(f"{part.package}/{file}" for file in fields["Files"].split())
    comment = f"{part.name}, " + {"headers": "compiled in from its headers.", "archive": "linked in."}[part.how]
    if part.name in EXTRA_COMMENTS:
        comment += "\n " + EXTRA_COMMENTS[part.name]
    holders = re.sub(r"\n\s*", "\n           ", re.sub(r",\n\s*", ", ", fields["Copyright"].strip()))
    return f"Files: {files}\nCopyright: {holders}\nLicense: {first}\nComment: {comment}\n"


def part_paragraphs(part, text, licences):
    """What the copyright file of a part's package says about what is in luxel."""
    parsed = stanzas(text)
    texts = {f["License"].split("\n")[0].strip(): f["License"].partition("\n")[2] for f in parsed
             if "License" in f and "\n" in f["License"]}
    found = []
    for wanted in part.stanzas:
        fields = next((f for f in parsed if f.get("Files", "").split()[:1] == [wanted]), None)
        if fields is None:
            raise SystemExit(f"make_notices: the copyright file of {part.package} has no paragraph about {wanted}")
        found.append(read_stanza(part, fields, texts, licences))
    return found


def three_paragraph(text, licences):
    """three.js's LICENSE: a title, the holders, the text."""
    paragraphs = [" ".join(p.split()) for p in text.strip().split("\n\n")]
    holders = re.sub(r"^Copyright\s*(©|\(c\))?\s*", "", paragraphs[1])
    body = "\n .\n".join("\n".join(f" {line}" for line in p.splitlines()) for p in text.strip().split("\n\n")[2:])
    return (f"Files: three/*\nCopyright: {holders}\nLicense: {licences.add('Expat', body, 'three.js')}\n"
            "Comment: three.js, in the page view.html that `luxel bake --html` writes.\n")


def notice(package, copyright_of, three):
    """The whole file. copyright_of(package) is the text of Debian's file."""
    licences = Licences()
    licences.common("Apache-2.0")
    licences.common("LGPL-3+")
    paragraphs = [HEADER, CGAL]
    for part in PARTS:
        if package in part.within:
            paragraphs += part_paragraphs(part, copyright_of(part.package), licences)
    if three:
        paragraphs.append(three_paragraph(three, licences))
    paragraphs += [f"License: {name}\n{text.rstrip()}\n" for name, text in sorted(licences.texts.items())]
    return "\n".join(paragraphs)


def copyright_file(package):
    file = DOCUMENTS / package / "copyright"
    if not file.exists():
        raise SystemExit(f"make_notices: {file} is missing: install {package}")
    return file.read_text(encoding="utf-8")


def sources():
    for folder in ("luxel", "apps", "bindings", "bench"):
        for file in sorted((ROOT / folder).rglob("*")):
            if file.suffix in (".h", ".cpp") and not re.search("_test|^test_", file.name) and "node_modules" not in file.parts:
                yield file


def unlisted(includes):
    """Sentences about roots of includes that nobody has listed."""
    names = {part.name for part in PARTS} | {"CGAL", ""}
    for root, file in includes:
        if root in INCLUDED:
            if INCLUDED[root] not in names:
                yield f"{root}: {INCLUDED[root]} is not in PARTS"
        elif not SYSTEM.match(root):
            yield f"{file}: <{root}> is not listed: add it to INCLUDED, and to PARTS if its code gets into luxel"


def licences_of_cgal():
    """{licence: a header} of the CGAL headers that luxel is compiled from, as each header names it."""
    source = ROOT / "luxel/base/exact_predicates.cpp"
    rule = subprocess.run([os.environ.get("CXX", "c++"), "-std=c++20", "-M", "-DCGAL_DISABLE_GMP", f"-I{ROOT}", source],
                          check=True, capture_output=True, text=True).stdout
    found = {}
    for header in re.findall(r"\S+/CGAL/\S+", rule):
        named = re.search(r"SPDX-License-Identifier: (\S+)", pathlib.Path(header).read_text(encoding="utf-8"))
        found[named[1] if named else "none"] = header
    return found


def check():
    includes = {}
    for file in sources():
        for path in re.findall(r"^#include <([^>]+)>", file.read_text(encoding="utf-8"), re.MULTILINE):
            if "/" in path or path.endswith(".h"):
                includes.setdefault(path.split("/")[0], file.relative_to(ROOT))
    faults = list(unlisted(includes.items()))
    faults += [f"{header} is under {licence}" for licence, header in licences_of_cgal().items()
               if licence not in ("LGPL-3.0-or-later", "BSL-1.0")]
    for fault in faults:
        print("make_notices:", fault)
    print(f"make_notices --check: {len(includes)} libraries and system headers, {len(faults)} faults")
    return 1 if faults else 0


FILE = """Format: x

Files: *
Copyright: 2020 A
           2021 B
License: Expat or BSL-1

Files: debian/*
Copyright: C
License: Expat

Files: x/y.h
Copyright: D
License: MPL-2

License: Expat
 Permission is "granted".
 .
 No warranty.

License: BSL-1
 Boost.

License: MPL-2
 Long.
"""


def self_test():
    faults = []

    def expect(got, wanted):
        if got != wanted:
            faults.append(f"{got!r}, expected {wanted!r}")

    licences, part = Licences(), Part("A b", "liba-dev", ALL, "headers", ("*", "x/y.h"))
    got = part_paragraphs(part, FILE, licences)
    expect(got[0], "Files: liba-dev/*\nCopyright: 2020 A\n           2021 B\nLicense: Expat or BSL-1\n"
                   "Comment: A b, compiled in from its headers.\n")
    expect(got[1].splitlines()[:3], ["Files: liba-dev/x/y.h", "Copyright: D", "License: MPL-2.0"])
    expect(sorted(licences.texts), ["BSL-1", "Expat", "MPL-2.0"])
    expect("Long." in licences.texts["MPL-2.0"], False)
    expect(licences.add("Expat", " Permission is\n ``granted''.\n .\n No warranty.", "B"), "Expat")
    expect(licences.add("Expat", " Other words.", "B c"), "Expat-B-c")
    three = three_paragraph("The MIT License\n\nCopyright © 2010 three\n\nPermission\n\nNone", licences)
    expect(three.splitlines()[1:3], ["Copyright: 2010 three", "License: Expat-three.js"])
    expect(len(list(unlisted([("new_library", "a.cpp"), ("fmt", "a.cpp"), ("unistd.h", "a.cpp")]))), 1)
    try:
        part_paragraphs(Part("A", "liba-dev", ALL, "headers", ("none/*",)), FILE, Licences())
        faults.append("a paragraph that is missing was not missed")
    except SystemExit:
        pass
    for fault in faults:
        print("self-test:", fault)
    print("make_notices --self-test:", "wrong" if faults else "right")
    return 1 if faults else 0


def main():
    arguments = sys.argv[1:]
    if arguments == ["--self-test"]:
        return self_test()
    if arguments == ["--check"]:
        return check()
    if len(arguments) not in (2, 3) or arguments[0] not in ALL:
        print(__doc__)
        return 2
    three = pathlib.Path(arguments[2]).read_text(encoding="utf-8") if len(arguments) == 3 else None
    text = notice(arguments[0], copyright_file, three)
    out = pathlib.Path(arguments[1])
    out.parent.mkdir(parents=True, exist_ok=True)
    partial = out.with_name(f"{out.name}.partial-{os.getpid()}")  # whole or not at all
    partial.write_text(text, encoding="utf-8")
    partial.replace(out)
    return 0


if __name__ == "__main__":
    sys.exit(main())
