"""What a command of luxel says of itself with --help, in parts: for the man pages and the completions.

make_options_page.py reads the options; this adds what stands around them.
"""
import pathlib
import re
import subprocess
import sys

sys.dont_write_bytecode = True  # nothing is left beside the sources
from make_options_page import Option, helps, read_help

SUBCOMMAND = re.compile(r"^  ([a-z][a-z-]*) {2,}(\S.*)$")
# A positional's row looks as an option's, without the dash: "  SCENE TEXT REQUIRED   The scene".
POSITIONAL = re.compile(r"^  ([A-Z]\S*.*?)(?:(?:  +|(?<=^.{29}) )(\S.*))?$")
# "How light is computed: gather, hemicube, matrix": choices that stand in the text alone.
LISTED = re.compile(r": ([a-z0-9]+(?:, [a-z0-9]+)+)$")
CHOICE = re.compile(r"^[a-z0-9][a-z0-9-]*$")


class Command:
    """name ("luxel bake"), summary, usage, positionals and groups of Options, subcommands, and the last lines."""

    def __init__(self, name, text):
        lines = text.splitlines()
        self.name, self.summary = name, lines[0].rstrip(".")
        self.usage = next(line[len("Usage: "):] for line in lines if line.startswith("Usage: "))
        self.positionals = read_positionals(lines)
        self.groups = read_help(text)
        self.subcommands = read_subcommands(lines)
        self.exit_codes = read_exit_codes(lines)

    def page(self):
        """The name of its man page: luxel-bake."""
        return self.name.replace(" ", "-")

    def options(self):
        return [option for _, options in self.groups for option in options]


def block(lines, heading):
    """The lines below "heading:", up to an empty one."""
    if f"{heading}:" not in lines:
        return []
    rest = lines[lines.index(f"{heading}:") + 1:]
    return rest[:rest.index("") if "" in rest else None]


def read_positionals(lines):
    found = []
    for line in block(lines, "Positionals"):
        row = POSITIONAL.match(line)
        # "SCENE TEXT Excludes: --play glTF, ... file": the text follows a single space.
        squeezed = re.match(r"^  ([A-Z]\S* .*?(?:Excludes|Needs): \S+) (\S.*)$", line)
        if squeezed:
            row = squeezed
        if row:
            found.append(Option(row.group(1), row.group(2)))
        elif found:
            found[-1].text = (found[-1].text + " " + line.strip()).strip()
    return found


def read_subcommands(lines):
    rows = (SUBCOMMAND.match(line) for line in block(lines, "Subcommands"))
    return [row.groups() for row in rows if row]


def read_exit_codes(lines):
    """[(code, meaning)] from "Exit codes: 0 done; 1 a file is wrong." """
    at = next((i for i, line in enumerate(lines) if line.startswith("Exit codes: ")), None)
    if at is None:
        return []
    text = " ".join(lines[at:]).strip().removeprefix("Exit codes: ").rstrip(".")
    return [tuple(part.split(" ", 1)) for part in text.split("; ")]


def read_all(luxel):
    """The Command of luxel, of each of its commands, and of luxel-view."""
    own = subprocess.run([luxel, "--help"], check=True, capture_output=True, text=True).stdout
    return [Command("luxel", own)] + [Command(name, text) for name, text in helps(luxel)]


def version(luxel):
    said = subprocess.run([luxel, "--version"], check=True, capture_output=True, text=True).stdout
    return re.match(r"luxel ([\d.]+)", said).group(1)


def choices(option):
    """The words that an option takes, as far as its help names them."""
    words = [word for word in option.value.split("|") if CHOICE.match(word)] if "|" in option.value else []
    listed = LISTED.search(re.sub(r" \(.*$", "", option.text))
    if option.value in ("NAME", "SOLVER") and listed:
        words = listed.group(1).split(", ")
    return words


def takes(option):
    """What is completed after an option: "" for a switch, "choices", "folders", "files" or "nothing"."""
    value = option.value
    if not value:
        return ""
    if re.search(r"\b(DIR|FOLDER)\b", value):
        return "folders"
    if value == "text" or "FILE" in value:
        return "files"
    return "choices" if choices(option) else "nothing"


def run_script(usage, self_test, write):
    """What a script does that makes files of the help of a program: write(LUXEL, FOLDER). Returns its exit code."""
    name, arguments = pathlib.Path(sys.argv[0]).stem, sys.argv[1:]
    if arguments == ["--self-test"]:
        return self_test()
    if len(arguments) != 2 or arguments[0].startswith("-"):
        print(usage)
        return 2
    luxel, folder = arguments
    if not pathlib.Path(luxel).exists():
        print(f"{name}: there is no program {luxel}", file=sys.stderr)
        return 1
    write(luxel, pathlib.Path(folder))
    return 0
