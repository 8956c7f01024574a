#!/usr/bin/env python3
"""Checks tools/package/Containerfile as far as that goes without a network: no container is built.

    tests/packages/check_containerfile.py               exit 1 and one line per fault
    tests/packages/check_containerfile.py --self-test   proves that each kind of fault is found

The rules: it has only instructions that are known; images are plain names, without a host; a shell can read what RUN
runs, and finds its commands; `make` makes targets that the Makefile has; COPY --from names a stage; the program that
starts has its package installed.
"""
import json
import pathlib
import re
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
FILE = ROOT / "tools" / "package" / "Containerfile"
KNOWN = {"FROM", "RUN", "COPY", "WORKDIR", "ENTRYPOINT", "CMD", "ENV", "USER"}


def instructions(text):
    """[(name, arguments)], with continued lines joined and comments left out."""
    lines = [line for line in text.splitlines() if not line.startswith("#")]
    joined = re.sub(r"\\\n\s*", "", "\n".join(lines))
    return [tuple((line.split(None, 1) + [""])[:2]) for line in joined.splitlines() if line.strip()]


def faults_of_run(script, makefile):
    read = subprocess.run(["sh", "-n", "-c", script], capture_output=True, text=True)
    if read.returncode != 0:
        yield f"a shell cannot read {script!r}: {read.stderr.strip()}"
        return
    for command in re.split(r"&&|\|\||;|\|", script):
        words = [word for word in command.split() if not re.match(r"^[A-Z_]+=", word)]
        if not words or not shutil.which(words[0]):
            yield f"there is no command {words[0] if words else ''!r}"
        elif words[0] == "make":
            yield from (f"the Makefile has no target {target}" for target in words[1:]
                        if not re.search(rf"^{re.escape(target)}:", makefile, re.MULTILINE))


def faults(text, makefile):
    stages = set()
    for name, arguments in instructions(text):
        if name not in KNOWN:
            yield f"{name} is no instruction that is known"
        elif name == "FROM":
            image, *rest = arguments.split()
            if not re.fullmatch(r"[a-z]+:[0-9]+", image):
                yield f"the image {image} is not a plain name"
            if rest:
                stages.add(rest[1])
        elif name == "RUN":
            yield from faults_of_run(arguments, makefile)
        elif name == "COPY":
            stage = re.match(r"--from=(\S+)", arguments)
            if stage and stage.group(1) not in stages:
                yield f"there is no stage {stage.group(1)} to copy from"
        elif name in ("ENTRYPOINT", "CMD"):
            try:
                words = json.loads(arguments)
            except ValueError:
                yield f"{name} {arguments} is not a list of words"
                continue
            if name == "ENTRYPOINT" and f"/{words[0]}_*.deb" not in text:
                yield f"the package of {words[0]} is not installed"


GOOD = """# A comment
FROM debian:12 AS build
RUN true && \\
    X=y make it
FROM debian:12
COPY --from=build /a/luxel_*.deb /b/
ENTRYPOINT ["luxel"]
"""
BAD = [("FROM debian:12\n", "FROM host.example/debian:12\n"), ("RUN true", "RUN no_such_command"), ("make it", "make that"),
       ("true && \\\n", "true && (\\\n"), ("from=build", "from=built"), ('["luxel"]', "luxel"),
       ('["luxel"]', '["other"]'), ("COPY", "COPIE")]


def self_test():
    wrong = list(faults(GOOD, "it: that\n"))
    for old, new in BAD:
        if len(list(faults(GOOD.replace(old, new), "it: that\n"))) != 1:
            wrong.append(f"{new!r} was not found")
    for line in wrong:
        print("self-test:", line)
    print("check_containerfile --self-test:", "wrong" if wrong else "right")
    return 1 if wrong else 0


def main():
    if sys.argv[1:] == ["--self-test"]:
        return self_test()
    found = list(faults(FILE.read_text(), (ROOT / "Makefile").read_text()))
    for fault in found:
        print("Containerfile:", fault)
    print(f"check_containerfile: {len(found)} faults")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
