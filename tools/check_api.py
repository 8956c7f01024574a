#!/usr/bin/env python3
"""The API is the headers that the table of docs/guide/library.md names. This checks them.

    tools/check_api.py                      every header of the table is there
    tools/check_api.py --headers            prints them, one per line
    tools/check_api.py --installed PREFIX   they are installed; installed headers include only installed
                                            ones; no installed text names a folder of this machine
    tools/check_api.py --pages FOLDER       runs Doxygen; fails when a function or type has no comment
    tools/check_api.py --self-test          proves on made-up trees that each kind of fault is found

A member variable needs none where its name and type say all; operators mean what they do in mathematics, and
moving is what it always is. Exit 1 and one line per fault.
"""
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAGE = "docs/guide/library.md"
HEADER = re.compile(r"`(luxel/[\w/.]+\.h)`")
INCLUDE = re.compile(r'^\s*#\s*include\s*"([^"]+)"', re.MULTILINE)
WARNING = re.compile(r"(\S+?):(\d+): (?:warning|error): (.*)")
NEEDS_NONE = re.compile(r"\((variable|enumvalue)\)|LUXEL_CONCAT|operator\W|Member (\w+)\(\2 &&\)")


def headers_of(root):
    rows = [line for line in (root / PAGE).read_text().splitlines() if line.startswith("|")]
    return [header for row in rows for header in HEADER.findall(row)]


def missing(root):
    headers = headers_of(root)
    if not headers:
        yield f"{PAGE}: no table of headers"
    for header in headers:
        if not (root / header).is_file():
            yield f"{PAGE}: {header} is not there; was it renamed?"


def install_faults(root, prefix):
    """`prefix` holds bin, include and lib."""
    include = prefix / "include"
    for header in headers_of(root):
        if not (include / header).is_file():
            yield f"{header} is in the table of {PAGE}, but not installed"
    for header in sorted(include.rglob("*.h")):
        name = header.relative_to(include).as_posix()
        for included in INCLUDE.findall(header.read_text()):
            if not (include / included).is_file():
                yield f'{name} includes "{included}", which is not installed'
        if re.search(r"_test[_.]|/test_|/validate/", name):
            yield f"{name} is for tests, and installed"
    for text in sorted([*include.rglob("*.h"), *prefix.rglob("*.cmake")]):
        for folder in {str(root), str(prefix)}:
            if folder in text.read_text():
                yield f"{text.relative_to(prefix)} names {folder}, a folder of this machine"


def undocumented(warnings, root):
    """Doxygen's warnings as faults: each once, without what needs no comment."""
    found = {}
    for path, line, text in WARNING.findall(warnings):
        if not NEEDS_NONE.search(text):
            path = path.removeprefix(str(root) + "/")
            found[(path, int(line))] = f"{path}:{line}: {text}"
    return [found[where] for where in sorted(found)]


def make_pages(root, folder):
    folder.mkdir(parents=True, exist_ok=True)
    values = {"CMAKE_SOURCE_DIR": root, "API_FOLDER": folder,
              "API_HEADERS": " \\\n    ".join(str(root / h) for h in headers_of(root))}
    text = (root / "docs/Doxyfile.in").read_text()
    for name, value in values.items():
        text = text.replace(f"@{name}@", str(value))
    (folder / "Doxyfile").write_text(text)
    (folder / "warnings.txt").write_text("")
    try:
        subprocess.run(["doxygen", folder / "Doxyfile"], check=True, stdout=subprocess.DEVNULL)
    except FileNotFoundError:
        return ["doxygen is not installed: tools/setup.sh docs"]
    except subprocess.CalledProcessError as error:
        return [f"doxygen: {error}"]
    return undocumented((folder / "warnings.txt").read_text(), root)


GOOD = {
    PAGE: "| header | holds |\n|---|---|\n| `luxel/a/a.h` | a |\n",
    "luxel/a/a.h": "",
    "p/include/luxel/a/a.h": '#include "luxel/a/b.h"\n#include <vector>\n',
    "p/include/luxel/a/b.h": "",
    "p/lib/cmake/luxel/luxelConfig.cmake": "set(prefix ${CMAKE_CURRENT_LIST_DIR})",
}
# Each changes the good tree into one with exactly one fault; None takes a file away.
BAD = [
    ("luxel/a/a.h", None, "luxel/a/a.h is not there"),
    (PAGE, "no table", "no table of headers"),
    ("p/include/luxel/a/a.h", None, "luxel/a/a.h is in the table"),
    ("p/include/luxel/a/b.h", None, "luxel/a/b.h\", which is not installed"),
    ("p/include/luxel/a/a_test.h", "", "is for tests"),
    ("p/include/luxel/a/c.h", "// ROOT/x", "a folder of this machine"),
    ("p/lib/cmake/luxel/x.cmake", "ROOT/build", "a folder of this machine"),
]
WARNINGS = """R/luxel/a/a.h:3: warning: Member f() (function) of namespace luxel is not documented.
R/luxel/a/a.h:3: warning: Member f() (function) of namespace luxel::base is not documented.
R/luxel/a/a.h:4: warning: Member x (variable) of struct luxel::A is not documented.
R/luxel/a/a.h:5: warning: Member operator+(A a, A b) (function) of namespace luxel is not documented.
R/luxel/a/a.h:6: warning: Member A(A &&) noexcept (function) of class luxel::A is not documented.
R/luxel/a/a.h:1: warning: Compound luxel::A is not documented.
"""


def self_test():
    wrong = 0
    for path, text, expected in [(None, None, None)] + BAD:
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder).resolve()
            files = dict(GOOD) if path is None else {**GOOD, path: text}
            for name, content in files.items():
                if content is not None:
                    (root / name).parent.mkdir(parents=True, exist_ok=True)
                    (root / name).write_text(content.replace("ROOT", str(root)))
            found = [*missing(root), *install_faults(root, root / "p")]
            right = not found if path is None else len(found) == 1 and expected in found[0]
            wrong += not right
            if not right:
                print(f"self-test: {path}: {text!r}: expected {expected}, found {found}")
    lines = undocumented(WARNINGS, "R")
    if len(lines) != 2 or ":1: Compound" not in lines[0] or ":3: Member f()" not in lines[1]:
        wrong += 1
        print(f"self-test: warnings: {lines}")
    print(f"check_api --self-test: {len(BAD) + 2 - wrong} of {len(BAD) + 2} right")
    return wrong


def main():
    action = sys.argv[1] if len(sys.argv) > 1 else ""
    if action == "--self-test":
        return 1 if self_test() else 0
    if action == "--headers":
        print("\n".join(headers_of(ROOT)))
        return 0
    found = list(missing(ROOT))
    if action == "--installed" and not found:
        found = list(install_faults(ROOT, pathlib.Path(sys.argv[2]).resolve()))
    elif action == "--pages" and not found:
        found = make_pages(ROOT, pathlib.Path(sys.argv[2]).resolve())
    for fault in found:
        print(fault)
    print(f"check_api: {len(found)} faults")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
