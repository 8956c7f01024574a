#!/usr/bin/env python3
"""How well processes share a bake out: measured on this machine, and what that means on a cluster.

    bench/cluster/efficiency.py SCENE [--resolution 1024] [--processes 1,2,4] [--luxel PROGRAM]

Each process has one thread. Two tables are printed:

- measured: seconds of the wall clock, and of processors over all processes. Their ratio to those of
  one process is the efficiency by processor time. It holds the work that every process repeats, and
  what it takes to send and receive. More processes than cores have no wall clock of their own.
- a model of P nodes with one process each: T = serial + shared / P + exchanges * latency * log2(P) +
  bytes / bandwidth. `serial` are the stages below, as one process takes them; bytes and exchanges are
  those that two processes had: every node receives about all of them, whatever P is.
"""

import argparse
import json
import math
import os
import resource
import subprocess
import sys
import tempfile
import time

# Stages that the first process does alone, or every process for itself.
SERIAL = {"import", "charts", "packing", "build ray tracer", "seams", "draw", "write files"}
# Name, bytes per second, seconds: what a node gets of 10 Gbit/s by TCP, and of 200 Gbit/s.
NETWORKS = [("10 GbE", 1.1e9, 50e-6), ("InfiniBand HDR", 2.2e10, 2e-6)]


def run(luxel, processes, arguments, folder):
    """Returns bake.json, seconds of the wall clock and of processors."""
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
    with open(os.path.join(folder, "bake.json")) as file:
        return json.load(file), wall, cpu


def predicted(stages, team, nodes, bandwidth, latency):
    """Seconds on so many nodes."""
    serial = sum(s for name, s in stages.items() if name in SERIAL)
    shared = sum(s for name, s in stages.items() if name not in SERIAL)
    if nodes == 1:
        return serial + shared
    talk = team["exchanges"] * latency * math.log2(nodes) + team["bytes"] / bandwidth
    return serial + shared / nodes + talk


def self_test():
    stages = {"packing": 10.0, "trace rays": 990.0}
    team = {"exchanges": 0, "bytes": 0}
    assert predicted(stages, team, 1, 1, 1) == 1000
    assert predicted(stages, team, 99, 1, 1) == 20
    assert predicted(stages, {"exchanges": 100, "bytes": 5e9}, 8, 1e9, 1e-2) == 10 + 990 / 8 + 3 + 5


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", nargs="?")
    parser.add_argument("--resolution", default="1024")
    parser.add_argument("--processes", default="1,2,4")
    parser.add_argument("--luxel", default="build/release/bin/luxel")
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
            found[n] = run(options.luxel, n, [options.scene, "--resolution", options.resolution],
                           os.path.join(folder, str(n)))
            print(f"{n} done", file=sys.stderr)
        results = {open(os.path.join(folder, str(n), "lightmap.exr"), "rb").read() for n in counts}
    print(f"The lightmaps of {', '.join(map(str, counts))} processes are "
          f"{'the same' if len(results) == 1 else 'NOT the same'}, bit by bit.\n")
    print("| processes | wall clock [s] | processors [s] | efficiency by processor time | exchanges | "
          "bytes exchanged |")
    print("|---|---|---|---|---|---|")
    for n in counts:
        report, wall, cpu = found[n]
        team = report["team"] or {"exchanges": 0, "bytes": 0}
        print(f"| {n} | {wall:.1f} | {cpu:.1f} | {100 * found[1][2] / cpu:.0f} % | "
              f"{team['exchanges']} | {team['bytes'] / 1e6:.0f}M |")
    stages = {k: v for k, v in found[1][0]["seconds"].items() if k != "total"}
    team = found[2][0]["team"]
    serial = {k: v for k, v in stages.items() if k in SERIAL}
    print("\nSerial stages: " + ", ".join(f"{k} {v:.2f} s" for k, v in serial.items()) +
          f"; {sum(serial.values()):.1f} s of {sum(stages.values()):.1f} s.\n")
    print("| nodes | " + " | ".join(f"{name} [s] | efficiency" for name, _, _ in NETWORKS) + " |")
    print("|---|" + "---|---|" * len(NETWORKS))
    for nodes in (8, 64, 1024):
        cells = []
        for _, bandwidth, latency in NETWORKS:
            t = predicted(stages, team, nodes, bandwidth, latency)
            cells += [f"{t:.1f}", f"{100 * sum(stages.values()) / nodes / t:.0f} %"]
        print(f"| {nodes} | " + " | ".join(cells) + " |")


if __name__ == "__main__":
    main()
