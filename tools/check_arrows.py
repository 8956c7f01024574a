#!/usr/bin/env python3
"""Compares the includes between rooms with the table of rooms in ARCHITECTURE.md.

    tools/check_arrows.py [ROOT]        exit 1 and one line per fault
    tools/check_arrows.py --self-test   proves on made-up trees that each kind of fault is found

The rule: a room includes itself, base, the rooms of its row, and what those may include in turn;
its CMakeLists.txt links only rooms of its row. Rooms lie in luxel/, but for the programs and bench.
Folders within a room do not include one another in circles. Programs print in their print.cpp alone, and JSON becomes
text in luxel/base/shown_text.h alone. Structs of *_shared.h, which are luxel::on_device, have names of their own.
"""
import pathlib
import re
import sys
import tempfile

OUTSIDE = ("tests", "tools")  # may include every room but the programs
PROGRAMS = ("apps", "bindings", "examples")  # may print and exit; nothing includes them
INCLUDE = re.compile(r'^\s*#\s*include\s*(["<])([^">]+)[">]', re.MULTILINE)
PRINT = re.compile(r"\bstd::(cout|cerr|clog)\b|(?<![\w.>])(?:std::)?"
                   r"(printf|fprintf|vprintf|puts|fputs|putchar|perror|exit|_exit|quick_exit|abort)\s*\(")
# What a file or a user gave reaches a terminal or JSON through one function of luxel/base/shown_text.h.
PRINT_APPS = re.compile(r"\bstd::(cout|cerr|clog)\b|(?<![\w.>])(?:std::)?"
                        r"(printf|fprintf|vprintf|puts|fputs|putchar|fwrite|perror)\s*\(|\bfmt::print\b")
PRINT_APPS_ONLY = {"apps/cli/print.cpp", "apps/view/print.cpp"}
JSON_TEXT = re.compile(r"(\.|->)dump\s*\(")
JSON_TEXT_EXCEPT = "luxel/base/shown_text.h"
JSON_READERS = "import"  # the room dumps only what it has parsed, which is valid
PRINT_EXCEPT = {"luxel/base/check.cpp",  # says which contract broke, then aborts
                "bench/child.cpp"}  # ends the child process that it forked to measure
TBB_ONLY = {"luxel/base/parallel.h", "luxel/base/parallel.cpp"}
CGAL_ONLY = "luxel/base/exact_predicates.cpp"
SHARED = re.compile(r"^(?:struct |(?:IN_)?BLOCK\(|PUSH\()(\w+)\)? \{", re.MULTILINE)
TOP = ("apps", "bench", "bindings", "examples")  # rooms that do not lie in luxel/


class Table:
    """Rooms in the order of the table: `direct` rooms of each row, and which are planned."""

    def __init__(self, text):
        self.direct, self.planned = {}, set()
        in_table = False
        for line in text.splitlines():
            cells = [c.strip() for c in line.strip().strip("|").split("|")]
            if cells[0] == "room" and cells[-1] == "may include":
                in_table = True
            elif in_table and not line.startswith("|"):
                break
            elif in_table and not cells[0].startswith("---"):
                self.add_row(cells[0], cells[-1])
        if not self.direct:
            raise SystemExit("ARCHITECTURE.md: no table with the columns room ... may include")
        for room, rooms in self.direct.items():
            for other in rooms - self.direct.keys():
                raise SystemExit(f"ARCHITECTURE.md: the row of {room} names {other}, which has no row")

    def add_row(self, name, allowed):
        room = name.split()[0]
        if "(planned)" in name:
            self.planned.add(room)
        if allowed == "all of the above":
            self.direct[room] = set(self.direct)
        else:
            self.direct[room] = {r.strip() for r in allowed.split(",")} - {"-", ""}

    def may_include(self, room):
        found, todo = set(), [room, "base"]
        while todo:
            r = todo.pop()
            if r not in found:
                found.add(r)
                todo += self.direct.get(r, ())
        return found

    def room_of(self, path):
        """The room, `tests`, `bench`, or None when the path's folder is neither."""
        parts = path.split("/")
        if parts[0] in OUTSIDE:
            return parts[0]
        if parts[0] == "luxel":
            parts = parts[1:]
        elif parts[0] not in TOP:
            return None
        if not parts:
            return None
        two = "/".join(parts[:2])
        return two if two in self.direct else parts[0] if parts[0] in self.direct else None


def folder_of_room(room):
    return room if room.startswith(TOP) else "luxel/" + room


def without_comments_and_strings(code):
    pattern = r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])\''
    return re.sub(pattern, lambda m: "\n" * m.group().count("\n"), code, flags=re.DOTALL)


def include_faults(table, path, room, code):
    for match in INCLUDE.finditer(code):
        where = f"{path}:{code.count(chr(10), 0, match.start(2)) + 1}"
        quote, name = match.groups()
        if re.match(r"(oneapi/)?tbb/|execution$", name) and path not in TBB_ONLY:
            yield f"{where}: includes <{name}>; only luxel/base/parallel.* may (use its loops)"
        if name.startswith("CGAL/") and path != CGAL_ONLY:
            yield f"{where}: includes <{name}>; only {CGAL_ONLY} may"
        if quote != '"':
            continue
        target = table.room_of(name)
        if target is None:
            yield f'{where}: "{name}" names no room; write the path from the root'
        elif target in OUTSIDE:
            if room not in OUTSIDE and not path.endswith("_test.cpp"):
                yield f"{where}: {room} includes {target}/; only tests may"
        elif target.startswith(PROGRAMS) and target != room:
            yield f"{where}: {room} includes {target}; nothing includes a program"
        elif room not in OUTSIDE and target not in table.may_include(room):
            yield f"{where}: {room} may not include {target} (table of rooms in ARCHITECTURE.md)"


def shown_faults(path, room, code):
    """Text of files and users that goes past luxel/base/shown_text.h."""
    if room in OUTSIDE or path.endswith("_test.cpp") or "/test_" in path or "_test_" in path:
        return
    code = without_comments_and_strings(code)
    kinds = []
    if room.startswith("apps") and path not in PRINT_APPS_ONLY:
        kinds.append((PRINT_APPS, "prints; only print.cpp may (use print_line)"))
    if path != JSON_TEXT_EXCEPT and room != JSON_READERS:
        kinds.append((JSON_TEXT, "dumps JSON, which throws where a name is no UTF-8; use json_text()"))
    for pattern, what in kinds:
        for match in pattern.finditer(code):
            yield f"{path}:{code.count(chr(10), 0, match.start()) + 1}: {what}"


def print_faults(path, room, code):
    if room.startswith(PROGRAMS) or room in OUTSIDE or path in PRINT_EXCEPT or path.endswith("_test.cpp"):
        return
    code = without_comments_and_strings(code)
    for match in PRINT.finditer(code):
        line = code.count("\n", 0, match.start()) + 1
        yield f"{path}:{line}: a library prints or exits ({match.group().strip()}); return a Result"


def shared_faults(path, code, shared):
    """`shared`: the files in which structs stand so far. The linker would take two of one name for one."""
    for name in SHARED.findall(code) if path.endswith("_shared.h") else []:
        if shared.setdefault(name, path) != path:
            yield f"{path}: on_device::{name} stands in {shared[name]}, too"


def link_faults(table, path, code):
    for name, rest in re.findall(r"luxel_room\(\s*(\S+?)[\s)]([^)]*)", re.sub(r"#[^\n]*", "", code)):
        if name not in table.direct:
            yield f"{path}: room {name} has no row in ARCHITECTURE.md"
            continue
        uses = re.search(r"\bUSES\b(.*?)(\bLIBS\b|$)", rest, re.DOTALL)
        allowed = {r.replace("/", "_") for r in table.direct[name] | {"base"}}
        for used in uses.group(1).split() if uses else []:
            if used.replace("/", "_") not in allowed:
                yield f"{path}: {name} links {used}, which is not in its row"


def folder_of(path, room):
    """The folder of a room that a file lies in, "" on its top."""
    inside = path[len(folder_of_room(room)) + 1:]
    return inside.split("/")[0] if "/" in inside else ""


def circle_faults(arrows):
    """`arrows`: (room, folder, folder) -> where. One fault for each pair that include each other,
    directly or through others."""
    def reaches(room, start, end):
        found, todo = set(), [start]
        while todo:
            at = todo.pop()
            for r, a, b in arrows:
                if r == room and a == at and b not in found:
                    found.add(b)
                    todo.append(b)
        return end in found
    found = set()
    for (room, a, b), where in sorted(arrows.items()):
        if (room, b, a) not in found and reaches(room, b, a):
            found.add((room, a, b))
            yield f"{where}: within {room}, {a or 'its top'} includes {b or 'its top'}, which includes it"


def faults(root):
    table = Table((root / "ARCHITECTURE.md").read_text())
    for room in table.direct:
        if (room in table.planned) == (root / folder_of_room(room) / "CMakeLists.txt").exists():
            yield f"ARCHITECTURE.md: {room} is " + (
                "marked (planned), but is here" if room in table.planned else "not here; mark it (planned)")
    arrows, shared = {}, {}
    for file in sorted(root.rglob("*")):
        path = file.relative_to(root).as_posix()
        top = path.split("/")[0]
        if top in ("build", "tools", "baked") or top.startswith(".") or not file.is_file():
            continue
        if file.name == "CMakeLists.txt" and top != path:
            yield from link_faults(table, path, file.read_text())
        if file.suffix not in (".h", ".cpp"):
            continue
        room = table.room_of(path)
        if room is None:
            yield f"{path}: lies in no room of ARCHITECTURE.md"
            continue
        code = file.read_text()
        yield from include_faults(table, path, room, code)
        yield from print_faults(path, room, code)
        yield from shown_faults(path, room, code)
        yield from shared_faults(path, code, shared)
        if room in table.direct and not path.endswith("_test.cpp") and "_test_" not in path:
            for match in INCLUDE.finditer(code):
                if match.group(1) == '"' and table.room_of(match.group(2)) == room:
                    a, b = folder_of(path, room), folder_of(match.group(2), room)
                    if a != b:
                        arrows.setdefault((room, a, b), f"{path}:{code.count(chr(10), 0, match.start(2)) + 1}")
    yield from circle_faults(arrows)


GOOD = {
    "ARCHITECTURE.md": "| room | holds | may include |\n|---|---|---|\n| base | b | - |\n"
                       "| scene | s | base |\n| transport | t | scene |\n| solve/a | a | transport |\n"
                       "| solve/b | b | transport |\n| later (planned) | l | solve/a |\n"
                       "| pipeline | p | all of the above |\n| examples/e | e | all of the above |\n"
                       "| apps/cli | c | pipeline |\n",
    "luxel/base/CMakeLists.txt": "luxel_room(base LIBS fmt::fmt)",
    "luxel/base/parallel.cpp": "#include <tbb/parallel_for.h>",
    "luxel/base/exact_predicates.cpp": "#include <CGAL/kernel.h>",
    "luxel/base/check.cpp": "std::fprintf(stderr, text); std::abort();",
    "luxel/scene/CMakeLists.txt": "luxel_room(scene USES base LIBS a::b)",
    "luxel/scene/scene.h": '#include "luxel/base/vec.h"\n// printf() is not for us\nauto s = "exit(1)"; snprintf(a);',
    "luxel/scene/scene_test.cpp": '#include "tests/support.h"\nprintf("x");',
    "luxel/scene/s_shared.h": "struct Pixel {\n};",
    "luxel/transport/CMakeLists.txt": "luxel_room(transport USES scene)",
    "luxel/solve/a/CMakeLists.txt": "luxel_room(solve/a USES transport)",
    "luxel/solve/a/a.cpp": '#include "luxel/solve/a/a.h"\n#include "luxel/scene/scene.h"\n#include <vector>',
    "luxel/solve/b/CMakeLists.txt": "luxel_room(solve/b USES transport)",
    "luxel/pipeline/CMakeLists.txt": "luxel_room(pipeline USES solve_a solve_b)",
    "luxel/pipeline/p.cpp": '#include "luxel/solve/a/a.h"\n#include "luxel/pipeline/high/h.h"',
    "luxel/pipeline/high/h.h": '#include "luxel/pipeline/low/l.h"',
    "luxel/pipeline/low/l.h": "",
    "apps/cli/CMakeLists.txt": "add_executable(luxel main.cpp)",
    "apps/cli/main.cpp": '#include "luxel/pipeline/p.h"\n#include "luxel/base/vec.h"\nint main() { std::exit(1); }',
    "apps/cli/print.cpp": "void print_line() { std::fwrite(1); }",
    "luxel/base/shown_text.h": "json.dump(1);",
    "examples/e/CMakeLists.txt": "add_executable(example main.cpp)",
    "examples/e/main.cpp": '#include "luxel/solve/a/a.h"\nint main() { std::printf("x"); }',
    "tests/agree_test.cpp": '#include "luxel/solve/a/a.h"\n#include "luxel/solve/b/b.h"',
}
# Each changes the good tree into one with exactly one fault, whose line contains the text.
BAD = [
    ("luxel/solve/b/b.cpp", '#include "luxel/solve/a/a.h"', "solve/b may not include solve/a"),
    ("luxel/scene/s.cpp", '\n#include "luxel/transport/t.h"', "luxel/scene/s.cpp:2: scene may not include transport"),
    ("luxel/base/b.cpp", '#  include "luxel/scene/scene.h"', "base may not include scene"),
    ("luxel/pipeline/q.cpp", '#include "apps/cli/cli.h"', "nothing includes a program"),
    ("tests/e_test.cpp", '#include "examples/e/e.h"', "nothing includes a program"),
    ("tests/cli_test.cpp", '#include "apps/cli/cli.h"', "nothing includes a program"),
    ("luxel/scene/s.cpp", '#include "tests/support.h"', "only tests may"),
    ("luxel/scene/s.cpp", "#include <tbb/task_group.h>", "only luxel/base/parallel.* may"),
    ("luxel/scene/s.cpp", "#include <CGAL/kernel.h>", "only luxel/base/exact_predicates.cpp may"),
    ("luxel/scene/s_test.cpp", "#include <oneapi/tbb/mutex.h>", "only luxel/base/parallel.* may"),
    ("luxel/scene/s.cpp", '#include "vec.h"', "names no room"),
    ("luxel/scene/s.cpp", "std::cout << 1;", "prints or exits"),
    ("luxel/scene/s.cpp", 'std::printf("x");', "prints or exits"),
    ("luxel/scene/s.cpp", "std::exit(1);", "prints or exits"),
    ("luxel/pipeline/low/l.h", '#include "luxel/pipeline/high/h.h"', "within pipeline, high includes low"),
    ("apps/cli/a.cpp", 'std::fputs(name, stderr);', "only print.cpp may"),
    ("luxel/scene/s.cpp", "json.dump(2);", "use json_text()"),
    ("luxel/transport/t_shared.h", "BLOCK(Pixel) {\n};", "on_device::Pixel stands in luxel/scene/s_shared.h"),
    ("luxel/attic/a.cpp", "", "lies in no room"),
    ("luxel/attic/CMakeLists.txt", "luxel_room(attic USES base)", "room attic has no row"),
    ("luxel/scene/CMakeLists.txt", "luxel_room(scene\n USES base transport\n LIBS a)", "scene links transport"),
    ("luxel/solve/b/CMakeLists.txt", "luxel_room(solve/b USES transport solve_a)", "solve/b links solve_a"),
    ("luxel/later/CMakeLists.txt", "luxel_room(later)", "marked (planned), but is here"),
]


def write_tree(root, files):
    for path, text in files.items():
        (root / path).parent.mkdir(parents=True, exist_ok=True)
        (root / path).write_text(text)


def self_test():
    wrong = 0
    for path, text, expected in [(None, None, None)] + BAD:
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            write_tree(root, GOOD if path is None else {**GOOD, path: text})
            found = list(faults(root))
            right = not found if path is None else len(found) == 1 and expected in found[0]
            wrong += not right
            if not right:
                print(f"self-test: {path}: {text!r}: expected {expected}, found {found}")
    print(f"check_arrows --self-test: {len(BAD) + 1 - wrong} of {len(BAD) + 1} right")
    return wrong


def main():
    if sys.argv[1:] == ["--self-test"]:
        return 1 if self_test() else 0
    default = pathlib.Path(__file__).resolve().parent.parent
    found = list(faults(pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else default))
    for fault in found:
        print(fault)
    print(f"check_arrows: {len(found)} faults")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
