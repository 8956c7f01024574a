#!/usr/bin/env python3
"""Makes docs/options.md from what the program says of its own options.

    tools/make_options_page.py LUXEL            prints the page; LUXEL is the program, luxel-view lies beside it
    tools/make_options_page.py LUXEL --write    writes docs/options.md
    tools/make_options_page.py LUXEL --check    exit 1 when docs/options.md is another page
    tools/make_options_page.py LUXEL --names    prints the names of all options, one a line
    tools/make_options_page.py --self-test      proves that help is read right
"""
import pathlib
import re
import subprocess
import sys

PAGE = pathlib.Path(__file__).resolve().parent.parent / "docs" / "options.md"
COMMANDS = ("info", "bake", "merge", "render", "compare", "factors", "relight", "probe", "lux", "bench", "doctor")
HEADING = re.compile(r"^(\S.*):$")
# The meaning begins in column 30; before it there is a single space where the option fills what is before.
ROW = re.compile(r"^  (-\S.*?)(?:(?:  +| \.\.\. |(?<=^.{29}) )(\S.*))?$")
TEXT = re.compile(r"^ {10,}(\S.*)$")


class Option:
    def __init__(self, head, text):
        head = re.sub(r" (Excludes|Needs):.*$", "", head.replace("{false}", ""))
        names, *rest = head.split(" ", 1)
        self.names = names.split(",")
        rest = rest[0] if rest else ""
        # "TEXELS=512" or "TEXT:{auto,keep}=auto": what may be given, and the default. What names
        # an argument of two parts, as in "LIGHT=FILE", is in capitals.
        typed = re.match(r"(.*?)=([^A-Z].*)$", rest)
        self.default = typed.group(2) if typed else ""
        value = typed.group(1) if typed else rest
        choices = re.search(r":\{(.*)\}", value)
        kind = value.split(":")[0] if choices else value
        kind = kind.replace("REQUIRED", "").replace("...", "").strip()
        if choices:
            kind = choices.group(1).replace(",", "|")
        self.value = {"TEXT": "text", "INT": "integer", "UINT": "integer", "FLOAT": "number"}.get(kind, kind)
        self.required = "REQUIRED" in rest
        self.text = text or ""

    def row(self):
        name = ", ".join(f"`{n}`" for n in reversed(self.names))
        default = "required" if self.required else f"`{self.default.strip()}`" if self.default else ""
        cells = [name, self.value, default, self.text]
        return "| " + " | ".join(c.replace("|", "\\|").strip() for c in cells) + " |"


def read_help(text):
    """[(group, [Option])] from a command's --help."""
    groups, group = [], None
    for line in text.splitlines():
        heading, row, more = HEADING.match(line), ROW.match(line), TEXT.match(line)
        if heading:
            title = heading.group(1)
            title = "Options" if title.lower() == "options" else title
            group = next((g for g in groups if g[0] == title), None)
            if group is None:
                group = (title, [])
                groups.append(group)
        elif row and group is not None:
            group[1].append(Option(row.group(1), row.group(2)))
        elif more and group is not None and group[1]:
            option = group[1][-1]
            option.text = (option.text + " " + more.group(1)).strip()
    return [g for g in groups if g[1]]


def helps(luxel):
    """[(name, help)] of every command, and of the window's program."""
    programs = [(f"luxel {command}", [luxel, command]) for command in COMMANDS] + [("luxel-view", [f"{luxel}-view"])]
    return [(name, subprocess.run(program + ["--help"], check=True, capture_output=True, text=True).stdout)
            for name, program in programs]


def page(luxel):
    lines = ["# Options", "",
             "Every option of every command, as `luxel COMMAND --help` prints them. This page is made from that text by",
             "`tools/make_options_page.py`, and a test compares the two. The guides in [guide/](guide/README.md) say when to use",
             "which; the pages in `method/` say what each one steers."]
    for name, text in helps(luxel):
        lines += ["", f"## {name}", "", text.splitlines()[0].rstrip(".") + "."]
        for title, options in read_help(text):
            lines += [""] if title == "Options" else ["", f"{title}:", ""]
            lines += ["| option | value | default | meaning |", "|---|---|---|---|"]
            lines += [o.row() for o in options if "--help" not in o.names]
    return "\n".join(lines) + "\n"


def names(luxel):
    found = {n for _, text in helps(luxel) for _, options in read_help(text) for o in options for n in o.names}
    return sorted(found)


def self_test():
    text = ("Bake\nUsage: x\n\nOptions:\n  -o,--output TEXT REQUIRED   Folder\n  --uv TEXT:{auto,keep}=auto\n"
            "                              keep = the file's\n  --no-stitch{false}          Do not\n"
            "  --sky A|B Excludes: --sun   A sky\n"
            "  --ies LIGHT=FILE ... A file\n  --samples RAYS=256          Rays\n"
            "  --error-measure p95|rms=p95 What: of all\n\nOPTIONS:\n  --max-error FLOAT=0.01      Error\n")
    groups = read_help(text)
    rows = [o.row() for _, options in groups for o in options]
    wanted = ["| `--output`, `-o` | text | required | Folder |",
              "| `--uv` | auto\\|keep | `auto` | keep = the file's |",
              "| `--no-stitch` |  |  | Do not |",
              "| `--sky` | A\\|B |  | A sky |",
              "| `--ies` | LIGHT=FILE |  | A file |",
              "| `--samples` | RAYS | `256` | Rays |",
              "| `--error-measure` | p95\\|rms | `p95` | What: of all |",
              "| `--max-error` | number | `0.01` | Error |"]
    for got, want in zip(rows, wanted):
        if got != want:
            print(f"self-test: {got!r}, expected {want!r}")
    right = rows == wanted and len(groups) == 1
    print("make_options_page --self-test:", "right" if right else "wrong")
    return 0 if right else 1


def main():
    arguments = sys.argv[1:]
    if arguments == ["--self-test"]:
        return self_test()
    if len(arguments) not in (1, 2) or (len(arguments) == 2 and arguments[1] not in ("--write", "--check", "--names")):
        print(__doc__)
        return 2
    luxel, action = arguments[0], arguments[1] if len(arguments) == 2 else ""
    if action == "--names":
        print("\n".join(names(luxel)))
    elif action == "--write":
        PAGE.write_text(page(luxel))
    elif action == "--check":
        if not PAGE.exists() or PAGE.read_text() != page(luxel):
            print(f"docs/options.md is not what {luxel} says; run tools/make_options_page.py {luxel} --write")
            return 1
    else:
        print(page(luxel), end="")
    return 0


if __name__ == "__main__":
    sys.exit(main())
