#!/usr/bin/env python3
"""Writes docs/bench/tests.csv: the tests that take longest, and what each one guards.

    make test
    tools/slow_tests.py build/release/tests.xml --machine NAME > baked/tests.csv   each test above 4 s, the longest first
    tools/slow_tests.py build/release/tests.xml --check                            fails if a test above 5 s has no row

Columns: machine, test, seconds, guards. A new table keeps what docs/bench/tests.csv says that a test guards.
--check prints the seconds of all tests. Its limit is 2.5 times higher for noise, and higher on a slower machine than that of
the table: by the median of the tests' ratios. --self-test checks this program.
"""

import argparse
import csv
import pathlib
import statistics
import sys
import xml.etree.ElementTree as xml

TABLE = pathlib.Path(__file__).resolve().parent.parent / "docs/bench/tests.csv"
WRITTEN_S, LIMIT_S = 4, 5
NOISE = 2.5  # of wall time, while another test may take both cores


def seconds_of(junit):
    """{name: seconds} of the tests that ran, of a JUnit file's text."""
    cases = xml.fromstring(junit).iter("testcase")
    # A test with a parameter is called "Suite.Test/name  # GetParam() = value".
    return {case.get("name").split("  # ")[0]: float(case.get("time")) for case in cases if case.get("status") == "run"}


def table_of(text):
    return {row["test"]: row for row in csv.DictReader(text.splitlines())}


def new_table(seconds, old, machine, out):
    table = csv.writer(out, lineterminator="\n")
    table.writerow(["machine", "test", "seconds", "guards"])
    for name, took in sorted(seconds.items(), key=lambda test: (-test[1], test[0])):
        if took >= WRITTEN_S:
            table.writerow([machine, name, f"{took:.1f}", old.get(name, {}).get("guards", "")])


def without_row(seconds, table):
    """(name, seconds) of the tests above the limit that have no row, or one that does not say what they guard."""
    ratios = [took / float(table[name]["seconds"]) for name, took in seconds.items() if name in table]
    limit = NOISE * LIMIT_S * max(1.0, statistics.median(ratios or [1.0]))
    return [(name, took) for name, took in seconds.items() if took > limit and not table.get(name, {}).get("guards")]


def self_test():
    junit = """<testsuite>
<testcase name="A.Quick" time="0.04" status="run"/>
<testcase name="B.Slow  # GetParam() = 3" time="24.68" status="run"/>
<testcase name="C.Left" time="99" status="disabled"/>
<testcase name="D.New" time="13.7" status="run"/></testsuite>"""
    seconds = seconds_of(junit)
    assert seconds == {"A.Quick": 0.04, "B.Slow": 24.68, "D.New": 13.7}, seconds
    table = "machine,test,seconds,guards\nm,B.Slow,{},a law\n"
    assert without_row(seconds, table_of(table.format("24"))) == [("D.New", 13.7)]
    assert without_row(seconds, table_of(table.format("12"))) == []  # a machine half as fast
    assert without_row(seconds, table_of(table.format("24").replace("a law", ""))) == [("B.Slow", 24.68), ("D.New", 13.7)]

    class Lines(list):
        write = list.append

    lines = Lines()
    new_table(seconds, table_of(table.format("12")), "n", lines)
    assert lines == ["machine,test,seconds,guards\n", "n,B.Slow,24.7,a law\n", "n,D.New,13.7,\n"], lines


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("junit", nargs="?", type=pathlib.Path)
    parser.add_argument("--machine", default="")
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--self-test", action="store_true")
    options = parser.parse_args()
    if options.self_test:
        return self_test()
    if not options.junit:
        parser.error("a JUnit file of ctest is needed")
    seconds = seconds_of(options.junit.read_text(encoding="utf-8"))
    table = table_of(TABLE.read_text(encoding="utf-8"))
    if not options.check:
        return new_table(seconds, table, options.machine, sys.stdout)
    print(f"slow_tests: {len(seconds)} tests, {sum(seconds.values()):.0f} s")
    faults = without_row(seconds, table)
    for name, took in faults:
        print(f"slow_tests: {name} takes {took:.1f} s; make it faster, or say in docs/bench/tests.csv what it guards")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
