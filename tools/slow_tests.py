#!/usr/bin/env python3
"""Writes docs/bench/tests.csv: the seconds of the slowest tests.

    make test
    tools/slow_tests.py build/release/tests.xml --machine NAME > docs/bench/tests.csv

Columns: machine, test, seconds. The longest comes first. --self-test checks this program.
"""

import argparse
import csv
import sys
import xml.etree.ElementTree as xml


def slowest(junit, count):
    """(name, seconds) of the tests that ran, of a JUnit file's text, longest first."""
    cases = xml.fromstring(junit).iter("testcase")
    # A test with a parameter is called "Suite.Test/name  # GetParam() = value".
    ran = [(case.get("name").split("  # ")[0], float(case.get("time"))) for case in cases
           if case.get("status") == "run"]
    return sorted(ran, key=lambda test: (-test[1], test[0]))[:count]


def write_csv(rows, machine, out):
    table = csv.writer(out, lineterminator="\n")
    table.writerow(["machine", "test", "seconds"])
    for name, seconds in rows:
        table.writerow([machine, name, f"{seconds:.1f}"])


def self_test():
    junit = """<testsuite>
<testcase name="A.Quick" time="0.04" status="run"/>
<testcase name="B.Slow  # GetParam() = 3" time="12.34" status="run"/>
<testcase name="C.Left" time="99" status="disabled"/>
<testcase name="D.Slow" time="12.34" status="run"/></testsuite>"""
    assert slowest(junit, 2) == [("B.Slow", 12.34), ("D.Slow", 12.34)], slowest(junit, 2)
    assert slowest(junit, 9)[-1] == ("A.Quick", 0.04)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("junit", nargs="?")
    parser.add_argument("--machine", default="")
    parser.add_argument("--count", type=int, default=30)
    parser.add_argument("--self-test", action="store_true")
    options = parser.parse_args()
    if options.self_test:
        return self_test()
    if not options.junit:
        parser.error("a JUnit file of ctest is needed")
    with open(options.junit, encoding="utf-8") as file:
        write_csv(slowest(file.read(), options.count), options.machine, sys.stdout)


if __name__ == "__main__":
    main()
