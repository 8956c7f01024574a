#!/usr/bin/env python3
"""Builds luxel and luxel-view in a new folder and writes docs/bench/build.csv: processor seconds of every room.

    tools/build_seconds.py baked/build --machine NAME > baked/build.csv

Columns: machine, room, processor seconds (user and system), units. Shaders and linking have rows of their own.
ccache takes no part. --self-test checks this program.
"""

import argparse
import collections
import csv
import os
import pathlib
import re
import resource
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
ROOM = re.compile(r"(?:^|/)((?:luxel|apps|bench)\b[\w/]*?)/CMakeFiles/")


def processor_seconds():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def launch(log, command):
    """Runs a compiler and notes its seconds and what it makes, as a line of the log."""
    status = subprocess.run(command).returncode
    made = command[command.index("-o") + 1] if "-o" in command else ""
    line = f"{processor_seconds():.3f}\t{made}\n"
    with open(log, "a", encoding="utf-8") as file:  # short lines: processes do not mix theirs
        file.write(line)
    return status


def room_of(made):
    match = ROOM.search(made)
    return match.group(1).removeprefix("luxel/") if match else "precompiled header"


def rows_of(log, total):
    """(room, seconds, units), the longest first; then what no compiler took: shaders, linking, ninja."""
    seconds, units = collections.Counter(), collections.Counter()
    for line in log.splitlines():
        took, made = line.split("\t")
        seconds[room_of(made)] += float(took)
        units[room_of(made)] += 1
    rows = [(room, took, units[room]) for room, took in seconds.most_common()]
    return rows + [("shaders and linking", total - sum(seconds.values()), ""), ("all", total, sum(units.values()))]


def self_test():
    log = ("1.5\tluxel/base/CMakeFiles/luxel_base.dir/Unity/unity_0_cxx.cxx.o\n"
           "4\tCMakeFiles/luxel_precompiled.dir/cmake_pch.hxx.gch\n"
           "2\tluxel/solve/gather/CMakeFiles/luxel_solve_gather.dir/Unity/unity_1_cxx.cxx.o\n"
           "3\tluxel/solve/gather/CMakeFiles/luxel_solve_gather.dir/Unity/unity_0_cxx.cxx.o\n"
           "1\tapps/cli/CMakeFiles/luxel.dir/Unity/unity_0_cxx.cxx.o\n")
    assert rows_of(log, 12) == [("solve/gather", 5, 2), ("precompiled header", 4, 1), ("base", 1.5, 1), ("apps/cli", 1, 1),
                                ("shaders and linking", 0.5, ""), ("all", 12, 5)], rows_of(log, 12)
    print("tools/build_seconds.py: all tests passed")


def main():
    if sys.argv[1:2] == ["--launch"]:
        return launch(sys.argv[2], sys.argv[3:])
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("folder", nargs="?", type=pathlib.Path)
    parser.add_argument("--machine", default="")
    parser.add_argument("--self-test", action="store_true")
    options = parser.parse_args()
    if options.self_test:
        return self_test()
    if not options.folder or options.folder.exists():
        parser.error("a folder is needed that does not exist yet")
    log = options.folder.resolve() / "seconds"
    subprocess.run(["cmake", "--preset", "release", "-B", options.folder,
                    f"-DCMAKE_CXX_COMPILER_LAUNCHER={ROOT}/tools/build_seconds.py;--launch;{log}"],
                   cwd=ROOT, check=True, stdout=sys.stderr, env=dict(os.environ, CCACHE_DISABLE="1"))
    before = processor_seconds()
    subprocess.run(["cmake", "--build", options.folder, "--parallel", str(os.cpu_count()), "--target", "luxel", "luxel-view"],
                   cwd=ROOT, check=True, stdout=sys.stderr)
    table = csv.writer(sys.stdout, lineterminator="\n")
    table.writerow(["machine", "room", "seconds of processors", "units"])
    for room, seconds, units in rows_of(log.read_text(encoding="utf-8"), processor_seconds() - before):
        table.writerow([options.machine, room, f"{seconds:.1f}", units])
    return 0


if __name__ == "__main__":
    sys.exit(main())
