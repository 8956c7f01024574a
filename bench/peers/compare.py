#!/usr/bin/env python3
"""Bakes scenes with luxel and with Blender's Cycles on one lightmap layout, and prints what an error of 1 % takes.

    bench/peers/compare.py build/release/bin                          all scenes, about a quarter of an hour
    bench/peers/compare.py build/release/bin --scene two_rooms        one of them, or a .glb with TEXCOORD_1
    bench/peers/compare.py build/release/bin --mode full > docs/bench/peers.MACHINE.csv
    bench/peers/compare.py --self-test                                the arithmetic, without Blender

The table goes to the output as CSV; what was run goes to the error output. README.md beside this file defines every
column. Blender is not a part of luxel's tools: Debian's packages blender and python3-numpy bring what is needed.
"""
import argparse
import csv
import hashlib
import json
import math
import os
import pathlib
import shlex
import shutil
import subprocess
import sys
import tempfile

import exr
import measure
import png
import scenes

HERE = pathlib.Path(__file__).resolve().parent
SHARED = {"cornell_box": "cornell_box/cornell_box.glb",
          "tile_game_room": "tile_game_room/tile_game_room_lit_uv1.glb",
          "living_room": "living_room/living_room_lit_uv1.glb"}
NAMES = ("cornell_box", "tile_game_room", "two_rooms", "living_room", "courtyard")
NOT_LIGHT = ("import", "draw", "write files")
TARGET, FAIR = 0.01, 0.01
"""The error that is asked for, and how far the two bakers' light may differ in the mean."""
FIRST_ASKED, LEAST_ASKED = 0.04, 0.004
"""Errors that luxel is asked for: 4 %, 2 %, 1 %, and 0.5 % where the error is still above 1 %."""
MODES = {"quick": {"paths": 256, "cycles": 256, "luxel": 1024},
         "full": {"paths": 2048, "cycles": 16384, "luxel": 16384}}
"""Paths per texel of each of the two references, and the most samples per texel of each baker."""
COLUMNS = ("scene", "Cycles [s]", "luxel [s]", "ratio", "luxel, noise alone [s]", "ratio, noise alone",
           "Cycles' least error [%]", "luxel's least error [%]", "Cycles' mean over the reference's",
           "luxel's mean over the reference's", "Cycles' lasting difference [%]",
           "Cycles' memory [MB]", "luxel's memory [MB]", "texels", "mode")


class Fault(Exception):
    """A sentence for who runs this."""


def say(text):
    print(text, file=sys.stderr, flush=True)


def beside(program):
    """The environment in which a program finds first what lies beside it: Debian's Blender takes that python3 for its
    own."""
    folder = pathlib.Path(shutil.which(str(program)) or program).parent
    return {**os.environ, "PATH": f"{folder}{os.pathsep}{os.environ.get('PATH', '')}"}


def run(command, log):
    """Runs a program to its end. Returns the largest memory that it has held, in bytes."""
    with open(log, "wb") as out:
        child = subprocess.Popen([str(part) for part in command], stdout=out, stderr=subprocess.STDOUT,
                                 env=beside(command[0]))
        _, status, usage = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    if child.returncode:
        lines = log.read_text(encoding="utf-8", errors="replace").splitlines()
        raise Fault(f"{command[0]} failed: {lines[-1] if lines else 'without a word'} ({log})")
    return 1024 * usage.ru_maxrss


class Bench:
    """Runs of one comparison: where they lie, and what all of them share."""

    def __init__(self, options):
        self.options, self.folder = options, options.work.resolve()
        self.luxel = options.bin.resolve() / "luxel"
        self.folder.mkdir(parents=True, exist_ok=True)

    def bake_by_luxel(self, scene, folder, *more):
        """The light of one bake, its seconds, and its memory."""
        folder.mkdir(parents=True, exist_ok=True)
        memory = run([self.luxel, "bake", scene, "-o", folder, "--uv", "keep", "--resolution", scenes.RESOLUTION,
                      "--no-stitch", "--threads", self.options.threads, *more], folder.with_suffix(".log"))
        with open(folder / "bake.json", encoding="utf-8") as file:
            seconds = json.load(file)["seconds"]
        spent = seconds["total"] - sum(seconds.get(part, 0) for part in NOT_LIGHT)
        return exr.read(folder / "lightmap.exr")[2], spent, memory

    def bake_by_cycles(self, scene, name, samples, seed, denoise):
        job = {"scene": str(scene), "resolution": scenes.RESOLUTION, "samples": samples, "seed": seed,
               "threads": self.options.threads, "denoise": denoise, "image": str(self.folder / f"{name}.exr"),
               "report": str(self.folder / f"{name}.json")}
        path = self.folder / f"{name}.job.json"
        path.write_text(json.dumps(job), encoding="utf-8")
        memory = run([self.options.blender, "-b", "--factory-startup", "--python", HERE / "cycles_bake.py", "--", path],
                     self.folder / f"{name}.log")
        with open(job["report"], encoding="utf-8") as file:
            report = json.load(file)
        picture = exr.read(pathlib.Path(job["image"]))[2]
        for channel in "RGB":
            picture[channel] = [math.pi * value for value in picture[channel]]
        return picture, report, memory

    def reference(self, scene, name, seed):
        """The path tracer's bake and its texels.png, kept from run to run under what they depend on."""
        paths = self.options.reference_paths
        digest = hashlib.sha256(scene.read_bytes()).hexdigest()[:12]
        folder = self.folder / f"reference-{name}-{digest}-{paths}-{seed}"
        if not (folder / "bake.json").exists():
            say(f"{name}: reference of {paths} paths per texel, seed {seed}")
            self.bake_by_luxel(scene, folder, "--solver", "reference", "--samples", paths, "--seed", seed, "--texels",
                               "--no-denoise")
        return exr.read(folder / "lightmap.exr")[2], png.read(folder / "texels.png")[3]

    def scene_file(self, name):
        if name in scenes.MADE:
            scenes.write(name, self.folder / f"{name}.glb")
            return self.folder / f"{name}.glb"
        return self.options.shared / "scenes" / SHARED[name] if name in SHARED else pathlib.Path(name).resolve()


class Series:
    """Bakes of one baker with more and more samples: seconds, errors, and what was seen on the way."""

    def __init__(self, name, most):
        self.name = name
        self.runs, self.noises, self.most, self.memory, self.samples = [], [], most, 0, 4

    def wants_more(self):
        return self.samples <= self.most and (not self.runs or self.runs[-1][2] > TARGET)

    def settings(self):
        return f"{self.samples} samples"

    def add(self, seconds, error, noise, memory):
        self.runs.append((self.samples, min(seconds), error))
        self.noises.append((self.samples, min(seconds), noise))
        say(f"{self.name}, {self.settings()}: {min(seconds):.2f} s, error {100 * error:.2f} %, "
            f"noise {100 * noise:.2f} %")
        self.memory = max(self.memory, *memory)
        self.samples *= 4


class AskingSeries(Series):
    """Bakes with luxel's `--max-error`, half of it from bake to bake. What is written down as samples goes with them:
    errors of independent samples fall like their root."""

    def asked(self):
        return FIRST_ASKED * math.sqrt(4 / self.samples)

    def wants_more(self):
        return self.asked() > LEAST_ASKED and (not self.runs or self.runs[-1][2] > TARGET)

    def settings(self):
        return f"--max-error {self.asked():g}"


def cycles_series(bench, scene, name, a, b, texels, forgiven=None):
    """With `forgiven` Cycles denoises: then its error is its difference from the reference, but for that much."""
    series = Series(f"{name}: Cycles", bench.options.cycles_samples)
    while series.wants_more():
        bakes = [bench.bake_by_cycles(scene, f"{name}-cycles-{seed}", series.samples, seed, forgiven is not None)
                 for seed in (1, 2)]
        first, second = (picture for picture, _, _ in bakes)
        of = measure.counted(a, b, first, texels)
        light = (measure.mean(a, of) + measure.mean(b, of)) / 2
        noise = measure.noise(first, second, of) / light
        if forgiven is not None:
            noise = measure.without(measure.error([first, second], a, b, of) / light, forgiven)
        series.add([report["seconds"] for _, report, _ in bakes], noise, noise, [memory for _, _, memory in bakes])
        series.mean = (measure.mean(first, of) + measure.mean(second, of)) / 2 / light
        series.lasting = measure.bias(first, second, a, b, of) / light
    series.of, series.can_denoise = of, bakes[0][1]["can_denoise"]
    return series


def luxel_series(bench, scene, name, a, b, of, denoise):
    asks = bench.options.luxel_asks == "error"
    series = (AskingSeries if asks else Series)(f"{name}: luxel", bench.options.luxel_samples)
    light = (measure.mean(a, of) + measure.mean(b, of)) / 2
    while series.wants_more():
        asked = (["--max-error", series.asked(), "--error-measure", "rms"] if asks else
                 ["--samples", series.samples])
        options = [*asked, "--denoise" if denoise else "--no-denoise",
                   *shlex.split(bench.options.luxel_options)]
        bakes = [bench.bake_by_luxel(scene, bench.folder / f"{name}-luxel-{seed}", "--seed", seed, *options)
                 for seed in (11, 12)]
        pictures = [picture for picture, _, _ in bakes]
        error = measure.error(pictures, a, b, of) / light
        noise = error if denoise else measure.noise(*pictures, of) / light
        series.add([seconds for _, seconds, _ in bakes], error, noise, [memory for _, _, memory in bakes])
        series.mean = sum(measure.mean(picture, of) for picture in pictures) / len(pictures) / light
    series.of = of
    return series


def number(value, digits):
    return f"{value:.{digits}f}" if value is not None else "-"


def row_of(name, cycles, luxel, mode):
    """A row of the table and its ratios: None where the bakers' light differs, or one of them never gets there.
    `cycles` may be None: then its columns are empty."""
    who = [("Cycles", cycles)] * bool(cycles) + [("luxel", luxel)]
    fair = all(abs(series.mean - 1) <= FAIR for _, series in who)
    slow = measure.seconds_to(TARGET, cycles.runs) if cycles else (None, False)
    quick, noise = (measure.seconds_to(TARGET, runs) for runs in (luxel.runs, luxel.noises))
    ratios = [slow[0] / fast[0] if fair and slow[0] and fast[0] else None for fast in (quick, noise)]
    for (whose, series), (seconds, beyond) in zip(who, [slow] * bool(cycles) + [quick]):
        if seconds is None:
            say(f"{name}: {whose} does not reach {100 * TARGET:g} %")
        elif beyond:
            say(f"{name}: the seconds of {whose} are extrapolated from {100 * series.runs[-1][2]:.2f} %")
    if not fair:
        say(f"{name}: the light differs in the mean by more than {100 * FAIR:g} %: no ratio")
    least, mean, lasting, memory = ((100 * cycles.runs[-1][2], cycles.mean, 100 * cycles.lasting, cycles.memory / 1e6)
                                    if cycles else (None,) * 4)
    return [name, number(slow[0], 1), number(quick[0], 2), number(ratios[0], 1), number(noise[0], 2),
            number(ratios[1], 1), number(least, 2), number(100 * luxel.runs[-1][2], 2), number(mean, 4),
            number(luxel.mean, 4), number(lasting, 1), number(memory, 0), number(luxel.memory / 1e6, 0),
            str(len(luxel.of)), mode], ratios


def compared(bench, name):
    """Rows of one scene with their ratios: without denoiser, and with each one's own; Debian's Cycles has none."""
    scene, mode = bench.scene_file(name), bench.options.mode
    name = name if name in NAMES else scene.stem
    (a, texels), (b, _) = (bench.reference(scene, name, seed) for seed in (1, 2))
    cycles = cycles_series(bench, scene, name, a, b, texels)
    noise = measure.noise(a, b, cycles.of) / math.sqrt(2) / measure.mean(a, cycles.of)
    say(f"{name}: the mean of both references has {100 * noise:.2f} % noise, which is taken away")
    yield row_of(name, cycles, luxel_series(bench, scene, name, a, b, cycles.of, denoise=False), mode)
    of = cycles.of
    if cycles.can_denoise:
        cycles = cycles_series(bench, scene, name, a, b, texels, cycles.lasting)
    else:
        say(f"{name}: this Blender has no denoiser: luxel's alone")
        cycles = None
    yield row_of(f"{name} (denoised)", cycles, luxel_series(bench, scene, name, a, b, of, denoise=True), mode)


def print_table(bench):
    table = csv.writer(sys.stdout, lineterminator="\n")
    table.writerow(COLUMNS)
    ratios = []
    for name in bench.options.scene or NAMES:
        if not bench.scene_file(name).exists():
            if bench.options.scene:
                raise Fault(f"{bench.scene_file(name)}: there is no such scene.")
            say(f"{bench.scene_file(name)} is not on this machine: left out")
            continue
        for row, of_row in compared(bench, name):
            table.writerow(row)
            sys.stdout.flush()
            if "(denoised)" not in row[0]:
                ratios.append(of_row)
    if ratios:
        table.writerow(mean_row(ratios, bench.options.mode))


def mean_row(ratios, mode):
    """Geometric means over the scenes that have a ratio, and over how many."""
    by_error, by_noise = ([ratio for ratio in column if ratio] for column in zip(*ratios))
    row = dict.fromkeys(COLUMNS, "") | {"scene": f"geometric mean of {len(by_error)} and {len(by_noise)}", "mode": mode}
    for column, values in (("ratio", by_error), ("ratio, noise alone", by_noise)):
        row[column] = number(measure.geometric_mean(values) if values else None, 1)
    return list(row.values())


def check_tools(options):
    """Whether Blender and what its importer needs are here."""
    if not shutil.which(options.blender):
        raise Fault(f"{options.blender} is not installed: Debian's packages blender and python3-numpy bring it.")
    probe = subprocess.run([options.blender, "-b", "--factory-startup", "--python-exit-code", "3", "--python-expr",
                            "import numpy"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False,
                           env=beside(options.blender))
    if probe.returncode:
        raise Fault(f"{options.blender} has no numpy, which its importer needs: Debian's package python3-numpy "
                    "brings it.")
    if not (options.bin / "luxel").exists():
        raise Fault(f"{options.bin / 'luxel'} is missing: name the folder of luxel, as build/release/bin.")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("bin", nargs="?", type=pathlib.Path, help="the folder of luxel")
    parser.add_argument("--scene", action="append", help=f"{', '.join(NAMES)}, or a .glb; may be given for several")
    parser.add_argument("--mode", choices=MODES, default="quick", help="full: samples until 1 %% is measured; hours")
    parser.add_argument("--reference-paths", type=int, help="paths per texel of each reference")
    parser.add_argument("--cycles-samples", type=int, help="the most samples per texel of Cycles")
    parser.add_argument("--luxel-samples", type=int, help="the most samples per texel of luxel")
    parser.add_argument("--luxel-asks", choices=("error", "samples"), default="error",
                        help="what luxel is asked for: an RMS error of 4 %%, 2 %%, 1 %%, or samples as Cycles")
    parser.add_argument("--luxel-options", default="", help="more options for luxel, as '--supersample 64'")
    parser.add_argument("--threads", type=int, default=2, help="threads of both (2)")
    parser.add_argument("--work", type=pathlib.Path, default=pathlib.Path(tempfile.gettempdir()) / "luxel-peers",
                        help="folder of the bakes; references found there are used again")
    parser.add_argument("--shared", type=pathlib.Path, default=HERE.parents[2] / "shared", help="folder with scenes/")
    parser.add_argument("--blender", default="blender")
    parser.add_argument("--self-test", action="store_true")
    options = parser.parse_args()
    if options.self_test:
        import self_test
        return self_test.run()
    if not options.bin:
        parser.error("the folder of luxel is needed")
    mode = MODES[options.mode]
    options.reference_paths = options.reference_paths or mode["paths"]
    options.cycles_samples = options.cycles_samples or mode["cycles"]
    options.luxel_samples = options.luxel_samples or mode["luxel"]
    try:
        check_tools(options)
        print_table(Bench(options))
    except (Fault, OSError, ValueError) as fault:
        sys.exit(str(fault))
    return 0


if __name__ == "__main__":
    sys.exit(main())
