#!/usr/bin/env python3
"""Makes the man pages from what the programs say of their own options.

    tools/make_man_pages.py LUXEL FOLDER    writes luxel.1, luxel-bake.1, ..., luxel-view.1; luxel-view lies beside LUXEL
    tools/make_man_pages.py --self-test     proves that help becomes a page that man reads without a warning
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

from command_help import Command, read_all, run_script, version

# What troff would take for a minus, a quote or an accent of its own.
SPECIAL = {"\\": "\\e", "-": "\\-", "'": "\\(aq", "`": "\\(ga", "^": "\\(ha", "~": "\\(ti"}
SCENES = "luxel reads glTF, OBJ, FBX, .x, Collada and PLY. Lengths are in metres and y is up."


def plain(text):
    return "".join(SPECIAL.get(c, c) for c in text)


def words(text):
    """A line of text: what stands in backticks becomes bold, and no full stop begins it as a request."""
    parts = re.split(r"`([^`]+)`", text)
    line = "".join(f"\\fB{plain(part)}\\fR" if i % 2 else plain(part) for i, part in enumerate(parts))
    return f"\\&{line}" if line.startswith(".") else line


def usage(command):
    """The name in bold, and what is to be put in its place in italics."""
    rest = command.usage[len(command.name):]
    rest = re.sub(r"[A-Z_]{2,}", lambda m: f"\0{m.group(0)}\1", rest)
    return f"\\fB{plain(command.name)}\\fR" + plain(rest).replace("\0", "\\fI").replace("\1", "\\fR")


def entry(option):
    """An option or a positional, what it takes and what it means."""
    names = option.names if option.names[0].startswith("-") else []
    head = ", ".join(f"\\fB{plain(name)}\\fR" for name in names) or f"\\fI{plain(option.names[0])}\\fR"
    if names and option.value:
        head += f" \\fI{plain(option.value)}\\fR"
    meaning = option.text.rstrip(".") or "See its name"
    if not names and "|" in option.value:
        meaning += f" (one of {option.value.replace('|', ', ')})"
    if option.required and names:
        meaning += " (required)"
    if option.default:
        meaning += f" (default: {option.default.strip()})"
    return [".TP", head, words(meaning) + "."]


def section(title, lines):
    return [f'.SH "{plain(title.upper())}"'] + lines if lines else []


def page(command, number, others):
    """The page of one Command; `others` are the names of all pages."""
    name = command.page()
    summary = command.summary.removeprefix("luxel: ")
    first = summary.split(". ")[0]
    lines = [f'.TH "{plain(name.upper())}" 1 "" "luxel {number}" "User Commands"',
             ".ad l",  # a long name of a file leaves no blanks to stretch
             ".SH NAME", f"{plain(name)} \\- {words(first[0].lower() + first[1:])}",
             ".SH SYNOPSIS", usage(command)]
    about = [words(summary[0].upper() + summary[1:] + ".")]
    if any(option.names[0] == "SCENE" for option in command.positionals):
        about += [".PP", SCENES]
    lines += section("Description", about)
    lines += section("Commands", [line for subcommand, text in command.subcommands
                                  for line in (".TP", f"\\fBluxel {plain(subcommand)}\\fR", words(text) + ".")])
    lines += section("Arguments", [line for option in command.positionals for line in entry(option)])
    for title, options in command.groups:
        if title != "Positionals":
            lines += section(title, [line for option in options for line in entry(option)])
    lines += section("Exit status", [line for code, text in command.exit_codes
                                     for line in (".TP", code, words(text) + ".")])
    related = [f"\\fB{plain(other)}\\fR(1)" for other in others if other != name]
    return "\n".join(lines + section("See also", [", ".join(related)])) + "\n"


def write(folder, name, text):
    """Whole or not at all."""
    partial = folder / f"{name}.partial-{os.getpid()}"
    partial.write_text(text, encoding="utf-8")
    partial.replace(folder / name)


def write_pages(luxel, folder):
    commands, number = read_all(luxel), version(luxel)
    names = [command.page() for command in commands]
    folder.mkdir(parents=True, exist_ok=True)
    for command in commands:
        write(folder, f"{command.page()}.1", page(command, number, names))


HELP = """Bake light, as `luxel bake` does
Usage: luxel bake [OPTIONS] [SCENE]

Positionals:
  SCENE TEXT REQUIRED         .glb file

Options:
  -h,--help                   Print this help message and exit
  -o,--output TEXT REQUIRED   Folder
  --uv auto|keep|unwrap=auto  keep = the file's


Hemicube radiosity:
  --smooth                    .5 \\ ^ ~ smoother

Exit codes: 0 done; 1 a file is wrong;
3 stopped by Ctrl-C.
"""
WANTED = """.TH "LUXEL\\-BAKE" 1 "" "luxel 0.1.0" "User Commands"
.ad l
.SH NAME
luxel\\-bake \\- bake light, as \\fBluxel bake\\fR does
.SH SYNOPSIS
\\fBluxel bake\\fR [\\fIOPTIONS\\fR] [\\fISCENE\\fR]
.SH "DESCRIPTION"
Bake light, as \\fBluxel bake\\fR does.
.PP
luxel reads glTF, OBJ, FBX, .x, Collada and PLY. Lengths are in metres and y is up.
.SH "ARGUMENTS"
.TP
\\fISCENE\\fR
\\&.glb file.
.SH "OPTIONS"
.TP
\\fB\\-h\\fR, \\fB\\-\\-help\\fR
Print this help message and exit.
.TP
\\fB\\-o\\fR, \\fB\\-\\-output\\fR \\fItext\\fR
Folder (required).
.TP
\\fB\\-\\-uv\\fR \\fIauto|keep|unwrap\\fR
keep = the file\\(aqs (default: auto).
.SH "HEMICUBE RADIOSITY"
.TP
\\fB\\-\\-smooth\\fR
\\&.5 \\e \\(ha \\(ti smoother.
.SH "EXIT STATUS"
.TP
0
done.
.TP
1
a file is wrong.
.TP
3
stopped by Ctrl\\-C.
.SH "SEE ALSO"
\\fBluxel\\fR(1)
"""


def self_test():
    got = page(Command("luxel bake", HELP), "0.1.0", ["luxel", "luxel-bake"])
    wrong = [(g, w) for g, w in zip(got.splitlines() + [None], WANTED.splitlines() + [None]) if g != w]
    for g, w in wrong[:5]:
        print(f"self-test: {g!r}, expected {w!r}")
    if shutil.which("man"):
        with tempfile.TemporaryDirectory() as folder:
            write(pathlib.Path(folder), "luxel-bake.1", got)
            warnings = man_warnings(pathlib.Path(folder) / "luxel-bake.1")
            write(pathlib.Path(folder), "bad.1", got + ".nosuchrequest\n")
            if warnings or not man_warnings(pathlib.Path(folder) / "bad.1"):
                wrong.append((warnings, "no warning, and one of a request that is none"))
                print(f"self-test: {warnings!r}: man should warn of the bad page alone")
    else:
        print("self-test: man is not installed, and did not read the page")
    print("make_man_pages --self-test:", "wrong" if wrong else "right")
    return 1 if wrong else 0


def man_warnings(file):
    """What man says against a page."""
    environment = dict(os.environ, MANROFFSEQ="", MANWIDTH="80", LC_ALL="C.UTF-8")
    run = subprocess.run(["man", "--warnings", "-E", "UTF-8", "-l", "-Tutf8", "-Z", str(file)], env=environment,
                         stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    return run.stderr.strip() or ("" if run.returncode == 0 else f"man ended with code {run.returncode}")


if __name__ == "__main__":
    sys.exit(run_script(__doc__, self_test, write_pages))
