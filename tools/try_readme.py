#!/usr/bin/env python3
"""Runs README's first commands in a tree in which nothing was built by hand.

    tools/try_readme.py              runs them; exit 1 at the first that fails, or where a program is missing
    tools/try_readme.py --self-test  tests this program

It runs the commands of README up to the end of the section Start, in order; luxel-view with --help, because it would
wait for its user. After that, each program that README, the guide or `make demo` names as build/release/bin/NAME must
be there, but luxel-bench, which `make luxel-bench` builds. Warnings of the compiler are failures.
"""
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
PROGRAM = re.compile(r"build/release/bin/[\w-]+")


def first_commands(readme):
    """The commands up to the end of the section Start, without comments, and with continued lines joined."""
    screen = re.split(r"^## (?!Start$)", readme, flags=re.M)[0]
    lines = re.sub(r" \\\n\s+", " ", screen).splitlines()
    return [line[4:].split(" # ")[0].rstrip() for line in lines if re.match(r"    (make|build/release/bin/)", line)]


def as_run(command):
    """The command as this program runs it."""
    view = re.match(r"(\S*/luxel-view)\b", command)
    return f"{view.group(1)} --help" if view else command


def self_test():
    text = ("intro\n\n    make demo    # builds\n    make test\n\n## Start\n\n    build/release/bin/luxel bake a \\\n"
            "      -o b\n    build/release/bin/luxel-view b\n\n## Ten things\n\n    build/release/bin/luxel never\n")
    commands = first_commands(text)
    assert commands == ["make demo", "make test", "build/release/bin/luxel bake a -o b",
                        "build/release/bin/luxel-view b"], commands
    assert [as_run(c) for c in commands] == ["make demo", "make test", "build/release/bin/luxel bake a -o b",
                                             "build/release/bin/luxel-view --help"]
    assert PROGRAM.findall("`build/release/bin/luxel-view x`, build/release/bin/luxel.") == [
        "build/release/bin/luxel-view", "build/release/bin/luxel"]
    print("tools/try_readme.py: all tests passed")


def main():
    if sys.argv[1:] == ["--self-test"]:
        return self_test()
    printed = ""
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    for command in map(as_run, first_commands(readme)):
        print(f"$ {command}", flush=True)
        done = subprocess.run(command, shell=True, cwd=ROOT, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True)
        printed += done.stdout
        if done.returncode != 0:
            print(done.stdout)
            sys.exit(f"try_readme: '{command}' ended with code {done.returncode}")
    warnings = re.findall(r"^.*\bwarning: .*$", printed, re.M)
    if warnings:
        sys.exit("try_readme: building printed warnings:\n" + "\n".join(warnings))
    for page in [readme] + [p.read_text(encoding="utf-8") for p in sorted((ROOT / "docs/guide").glob("*.md"))] + [printed]:
        for program in set(PROGRAM.findall(page)) - {"build/release/bin/luxel-bench"}:
            if not (ROOT / program).exists():
                sys.exit(f"try_readme: there is no {program}, which README, the guide or the demo names")
    print("try_readme: README's first commands work, and each program is there")


if __name__ == "__main__":
    main()
