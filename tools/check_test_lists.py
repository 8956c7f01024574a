#!/usr/bin/env python3
"""Checks the lists of gtest filters in tests/: every filter names tests that there are.

    tools/check_test_lists.py    the lists against the sources; fails when a filter has gone stale

A test that was renamed would leave its filter behind, and run where it should not. --self-test checks
this program.
"""

import fnmatch
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
LISTS = ["tests/not_under_sanitizers.txt", "tests/only_in_test_all.txt"]
TEST = re.compile(r"^TEST(?:_F|_P)?\(\s*(\w+)\s*,\s*(\w+)\s*\)", re.MULTILINE)


def tests_of(source):
    """Suite.Name of the tests in a C++ source."""
    return {f"{suite}.{name}" for suite, name in TEST.findall(source)}


def filters_of(text):
    """The filters of a list, with their line numbers."""
    for number, line in enumerate(text.splitlines(), 1):
        if re.match(r"[^# ]", line):
            yield number, line.split(" ")[0]


def is_stale(gtest_filter, tests, sources):
    """Prefix/Suite.Name/Parameter: prefix and parameter are given where tests have parameters."""
    match = re.fullmatch(r"(?:\w+/)?([^/]+)(?:/(\w+))?", gtest_filter)
    suite_and_name, parameter = match.groups()
    known = any(fnmatch.fnmatchcase(test, suite_and_name) for test in tests)
    if parameter is None:
        return not known
    # Names of scenes have spaces, which no test's name may have.
    names = (parameter, parameter.replace("_", " "))
    return not known or not any(f'"{name}"' in sources for name in names)


def stale(text, sources):
    tests = tests_of(sources)
    return [(number, f) for number, f in filters_of(text) if is_stale(f, tests, sources)]


def self_test():
    sources = ('TEST(Rooms, AreLit) {}\nTEST_P(Edits, Hold) {}\n'
               'Case cases[] = {{"LampOff"}, {"sky map"}};\n')
    good = ("# Rooms.Gone\nRooms.AreLit  a reason\nAll/Edits.*/LampOff  another\n"
            "All/Edits.*/sky_map  a third\n")
    assert stale(good, sources) == [], stale(good, sources)
    bad = good + "Rooms.AreDark  renamed\nAll/Edits.*/LampOn  not a case\nGone.*  no suite\n"
    assert [f for _, f in stale(bad, sources)] == ["Rooms.AreDark", "All/Edits.*/LampOn", "Gone.*"]


def main():
    if sys.argv[1:] == ["--self-test"]:
        return self_test()
    files = [file for pattern in ("luxel/**/*_test.cpp", "luxel/validate/*.cpp", "tests/**/*_test.cpp")
             for file in sorted(ROOT.glob(pattern))]
    sources = "\n".join(file.read_text(encoding="utf-8") for file in files)
    faults = [f"{name}:{number}: no test matches {f}" for name in LISTS
              for number, f in stale((ROOT / name).read_text(encoding="utf-8"), sources)]
    print("\n".join(faults) or "check_test_lists: every filter names a test")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
