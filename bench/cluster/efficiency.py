#!/usr/bin/env python3
"""How well processes share a bake out: measured on this machine, and what that means on a cluster.

    bench/cluster/efficiency.py SCENE [--resolution 1024] [--processes 1,2,4] [--luxel PROGRAM] [--keep FOLDER]

With --keep the numbers of each run stay in FOLDER as N.json, and a run whose numbers are there is not made again.
Each process has one thread. Two tables are printed:

- measured: seconds of the wall clock, and of processors over all processes. Their ratio to those of
  one process is the efficiency by processor time. It holds the work that every process repeats, and
  what it takes to send and receive. More processes than cores have no wall clock of their own.
- a model of P nodes with one process each: T = serial + shared / P + exchanges * latency * log2(P) +
  bytes / bandwidth. `serial` are the stages that one process does alone, and what is serial of those
  that are shared in part: serial + shared takes t1 with one process, serial + shared / 2 takes t2 with
  two, so it is 2 t2 - t1. Bytes and exchanges are those that two processes had: every node receives
  about all of them, whatever P is.
"""

import argparse
import hashlib
import json
import math
import os
import pathlib
import resource
import subprocess
import sys
import tempfile
import time

# Stages that the first process does alone, or every process for itself.
SERIAL = {"import", "charts", "build ray tracer", "draw"}
# Stages of which a part is shared out: rasterising, the rays of seams, compressing lightmap.exr.
PARTLY_SERIAL = {"packing", "seams", "write files"}
# Name, bytes per second, seconds: what a node gets of 10 Gbit/s by TCP, and of 200 Gbit/s.
NETWORKS = [("10 GbE", 1.1e9, 50e-6), ("InfiniBand HDR", 2.2e10, 2e-6)]


def run(luxel, processes, arguments, folder):
    """Bakes, and returns seconds of the wall clock, of processors and of stages, what was exchanged, and a digest of
    the lightmap."""
    command = [luxel, "bake", *arguments, "-o", folder, "--threads", "1", "--quiet",
               "--processes-per-node", str(processes)]
    if processes > 1:
        command = ["mpirun", "-n", str(processes), "--bind-to", "none", *command]
    environment = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1",
                       OMPI_MCA_rmaps_base_oversubscribe="1")
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    start = time.monotonic()
    subprocess.run(command, check=True, env=environment)
    wall = time.monotonic() - start
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    report = json.loads(pathlib.Path(folder, "bake.json").read_text())
    return {"wall": wall, "cpu": cpu, "stages": {k: v for k, v in report["seconds"].items() if k != "total"},
            "team": report["team"] or {"exchanges": 0, "bytes": 0},
            "lightmap": hashlib.sha256(pathlib.Path(folder, "lightmap.exr").read_bytes()).hexdigest()}


def run_or_kept(luxel, processes, arguments, folder, keep):
    kept = pathlib.Path(keep, f"{processes}.json") if keep else None
    if kept and kept.exists():
        return json.loads(kept.read_text())
    found = run(luxel, processes, arguments, folder)
    if kept:
        kept.parent.mkdir(parents=True, exist_ok=True)
        kept.write_text(json.dumps(found, indent=1))
    print(f"{processes} done", file=sys.stderr)
    return found


def serial_parts(one, two):
    """Seconds of each stage that do not become fewer with more processes, from the seconds of the
    stages of one process and of two."""
    # A team compresses lightmap.exr before it writes files.
    two = dict(two, **{"write files": two.get("write files", 0) + two.get("compress", 0)})
    parts = {name: s for name, s in one.items() if name in SERIAL}
    for name in PARTLY_SERIAL & set(one):
        parts[name] = min(one[name], max(0.0, 2 * two.get(name, one[name]) - one[name]))
    return parts


def predicted(total, serial, team, nodes, bandwidth, latency):
    """Seconds on so many nodes, from those on one."""
    if nodes == 1:
        return total
    talk = team["exchanges"] * latency * math.log2(nodes) + team["bytes"] / bandwidth
    return serial + (total - serial) / nodes + talk


def self_test():
    parts = serial_parts({"import": 3.0, "packing": 10.0, "seams": 4.0, "trace rays": 990.0},
                         {"import": 5.0, "packing": 7.0, "seams": 1.5, "trace rays": 500.0})
    assert parts == {"import": 3.0, "packing": 4.0, "seams": 0.0}, parts
    team = {"exchanges": 0, "bytes": 0}
    assert predicted(1000, 10, team, 1, 1, 1) == 1000
    assert predicted(1000, 10, team, 99, 1, 1) == 20
    assert predicted(1000, 10, {"exchanges": 100, "bytes": 5e9}, 8, 1e9, 1e-2) == 10 + 990 / 8 + 3 + 5


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", nargs="?")
    parser.add_argument("--resolution", default="1024")
    parser.add_argument("--processes", default="1,2,4")
    parser.add_argument("--luxel", default="build/release/bin/luxel")
    parser.add_argument("--keep")
    parser.add_argument("--self-test", action="store_true")
    options = parser.parse_args()
    if options.self_test:
        return self_test()
    if not options.scene:
        parser.error("give a SCENE")
    counts = sorted({1, 2} | {int(n) for n in options.processes.split(",")})
    found = {}
    with tempfile.TemporaryDirectory() as folder:
        for n in counts:
            found[n] = run_or_kept(options.luxel, n, [options.scene, "--resolution", options.resolution],
                                   os.path.join(folder, str(n)), options.keep)
    are_equal = len({found[n]["lightmap"] for n in counts}) == 1
    print(f"The lightmaps of {', '.join(map(str, counts))} processes are "
          f"{'the same' if are_equal else 'NOT the same'}, bit by bit.\n")
    print("| processes | wall clock [s] | processors [s] | efficiency by processor time | exchanges | "
          "bytes exchanged |")
    print("|---|---|---|---|---|---|")
    for n in counts:
        of = found[n]
        print(f"| {n} | {of['wall']:.1f} | {of['cpu']:.1f} | {100 * found[1]['cpu'] / of['cpu']:.0f} % | "
              f"{of['team']['exchanges']} | {of['team']['bytes'] / 1e6:.0f}M |")
    one, two, team = found[1]["stages"], found[2]["stages"], found[2]["team"]
    serial = serial_parts(one, two)
    total, alone = sum(one.values()), sum(serial.values())
    print("\nSerial: " + ", ".join(f"{k} {v:.2f} s" for k, v in serial.items()) +
          f"; {alone:.1f} s of {total:.1f} s.\n")
    print("Stages of one process and of two [s]: " +
          ", ".join(f"{k} {v:.2f} and {two.get(k, 0):.2f}" for k, v in one.items()) + ".\n")
    print("| nodes | " + " | ".join(f"{name} [s] | efficiency" for name, _, _ in NETWORKS) + " |")
    print("|---|" + "---|---|" * len(NETWORKS))
    for nodes in (8, 64, 1024):
        cells = []
        for _, bandwidth, latency in NETWORKS:
            t = predicted(total, alone, team, nodes, bandwidth, latency)
            cells += [f"{t:.1f}", f"{100 * total / nodes / t:.0f} %"]
        print(f"| {nodes} | " + " | ".join(cells) + " |")


if __name__ == "__main__":
    main()
