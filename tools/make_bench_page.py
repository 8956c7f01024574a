#!/usr/bin/env python3
"""Makes docs/bench/benchmarks.md from benchmarks.in.md and the CSV files beside it.

    tools/make_bench_page.py              write the page
    tools/make_bench_page.py --check      fail when the page is not what the files give
    tools/make_bench_page.py --self-test  test this program

Each line "<!-- table NAME.MACHINE.csv -->" of benchmarks.in.md becomes the description of the machine (machines.csv)
and the table of that CSV file: a header row with units, then one row of plain numbers and names per line. Numbers are
printed as they stand in the file. Plain Python 3, no packages.
"""
import argparse
import csv
import difflib
import pathlib
import re
import sys
import tempfile

TEMPLATE, PAGE, MACHINES = "benchmarks.in.md", "benchmarks.md", "machines.csv"
NOTE = f"<!-- Made by tools/make_bench_page.py from {TEMPLATE} and the CSV files: edit those. -->\n\n"
PLACEHOLDER = re.compile(r"<!-- table (\S+) -->")
TABLE_FILE = re.compile(r"([^.]+)\.([^.]+)\.csv")
NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")


class Fault(Exception):
    """A sentence that says which file is wrong, where, and how."""


def read_rows(path):
    """The rows of a CSV file: as many cells in each as in the header."""
    try:
        with open(path, newline="", encoding="utf-8") as file:
            rows = list(csv.reader(file, strict=True))
    except FileNotFoundError:
        raise Fault(f"{path}: there is no such file") from None
    except (csv.Error, UnicodeDecodeError) as error:
        raise Fault(f"{path}: is not CSV: {error}") from None
    if len(rows) < 2:
        raise Fault(f"{path}: has no row below its header")
    for line, row in enumerate(rows, 1):
        if len(row) != len(rows[0]):
            raise Fault(f"{path}: row {line} has {len(row)} cells, the header has {len(rows[0])}")
        for cell in row:
            if cell != cell.strip() or "|" in cell or "\n" in cell:
                raise Fault(f"{path}: row {line}: the cell {cell!r} cannot stand in a table")
    if not all(rows[0]) or len(set(rows[0])) != len(rows[0]):
        raise Fault(f"{path}: a column has no name, or that of another")
    return rows


def read_machines(folder):
    """machine -> description."""
    rows = read_rows(folder / MACHINES)
    if rows[0] != ["machine", "description"]:
        raise Fault(f"{folder / MACHINES}: the header must be machine,description")
    return dict(rows[1:])


def table_text(rows):
    """A Markdown table. Columns of numbers are aligned right."""
    def is_number_column(column):
        cells = [row[column] for row in rows[1:] if row[column]]
        return bool(cells) and all(NUMBER.fullmatch(cell) for cell in cells)

    rules = ["---:" if is_number_column(k) else "---" for k in range(len(rows[0]))]
    return "".join("| " + " | ".join(row) + " |\n" for row in [rows[0], rules, *rows[1:]])


def page_text(folder):
    """What the page must be."""
    machines = read_machines(folder)
    used = set()
    out = [NOTE]
    for number, line in enumerate((folder / TEMPLATE).read_text(encoding="utf-8").splitlines(), 1):
        where = f"{folder / TEMPLATE}: line {number}"
        match = PLACEHOLDER.fullmatch(line.strip())
        if not match:
            if "<!-- table" in line:
                raise Fault(f"{where}: must be <!-- table NAME.MACHINE.csv --> alone")
            out.append(line + "\n")
            continue
        name = TABLE_FILE.fullmatch(match[1])
        if not name or name[2] not in machines:
            raise Fault(f"{where}: {match[1]} is not NAME.MACHINE.csv with a machine of {MACHINES}")
        used.add(match[1])
        out.append(machines[name[2]] + "\n\n" + table_text(read_rows(folder / match[1])))
    for path in sorted(folder.glob("*.csv")):
        if TABLE_FILE.fullmatch(path.name) and path.name not in used:
            raise Fault(f"{path}: no line of {TEMPLATE} names it")
    return "".join(out)


def make(folder):
    (folder / PAGE).write_text(page_text(folder), encoding="utf-8")


def check(folder):
    wanted = page_text(folder)
    path = folder / PAGE
    found = path.read_text(encoding="utf-8") if path.exists() else ""
    if found == wanted:
        return
    difference = difflib.unified_diff(found.splitlines(), wanted.splitlines(), str(path), "wanted", lineterm="", n=0)
    raise Fault("\n".join([*list(difference)[:20],
                           f"{path}: is not what the CSV files give: run tools/make_bench_page.py"]))


def self_test():
    def fault_of(function, folder):
        try:
            function(folder)
        except Fault as fault:
            return str(fault)
        return ""

    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)

        def write(file, text):
            (folder / file).write_text(text, encoding="utf-8")

        write(MACHINES, 'machine,description\nabacus,"An abacus, 2 hands"\n')
        write(TEMPLATE, "# Beads\n\n<!-- table beads.abacus.csv -->\n\nMany.\n")
        write("beads.abacus.csv", 'scene,"time, all [s]",note\nroom,1.50,\nhall,-2e-07,"a, b"\n')
        write("other.csv", "not,a\ntable of the page\n")
        make(folder)
        text = (folder / PAGE).read_text(encoding="utf-8")
        assert text == (NOTE + "# Beads\n\nAn abacus, 2 hands\n\n"
                        "| scene | time, all [s] | note |\n| --- | ---: | --- |\n"
                        "| room | 1.50 |  |\n| hall | -2e-07 | a, b |\n\nMany.\n"), text
        assert not fault_of(check, folder)
        write(PAGE, text.replace("1.50", "1.40"))
        assert "+| room | 1.50 |  |" in fault_of(check, folder)
        (folder / PAGE).unlink()
        assert "is not what the CSV files give" in fault_of(check, folder)
        make(folder)
        write("beads.abacus.csv", "scene,time [s]\nroom,1.60\n")
        assert "is not what the CSV files give" in fault_of(check, folder)
        for bad, sentence in [("scene,time\nroom\n", "row 2 has 1 cells"),
                              ("scene\n", "no row below"),
                              ("", "no row below"),
                              ("a,a\n1,2\n", "a column has no name"),
                              ("a,\n1,2\n", "a column has no name"),
                              ("a,b\n1,2|3\n", "cannot stand in a table"),
                              ('a,b\n"1\n2",3\n', "cannot stand in a table")]:
            write("beads.abacus.csv", bad)
            assert sentence in fault_of(make, folder), (bad, fault_of(make, folder))
        write("beads.abacus.csv", "scene,time [s]\nroom,1.60\n")
        write("more.abacus.csv", "scene,time [s]\nroom,1.60\n")
        assert "no line of" in fault_of(make, folder)
        (folder / "more.abacus.csv").unlink()
        for bad, sentence in [("<!-- table none.abacus.csv -->", "no such file"),
                              ("<!-- table beads.pencil.csv -->", "line 1"),
                              ("<!-- table beads.csv -->", "line 1"),
                              ("See <!-- table beads.abacus.csv -->", "alone")]:
            write(TEMPLATE, bad + "\n")
            assert sentence in fault_of(make, folder), (bad, fault_of(make, folder))
    print("tools/make_bench_page.py: all tests passed")


def main():
    default = pathlib.Path(__file__).resolve().parent.parent / "docs" / "bench"
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="write nothing; fail when the page is out of date")
    parser.add_argument("--self-test", action="store_true", help="test this program")
    parser.add_argument("--folder", type=pathlib.Path, default=default, help="the folder with the files (docs/bench)")
    arguments = parser.parse_args()
    if arguments.self_test:
        return self_test()
    try:
        (check if arguments.check else make)(arguments.folder)
    except (Fault, OSError) as error:
        sys.exit(str(error))


if __name__ == "__main__":
    main()
