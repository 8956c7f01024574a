#!/usr/bin/env python3
"""Prints how long frames of luxel-view take: docs/bench/view.MACHINE.csv.

    tools/view_times.py build/release/bin > docs/bench/view.MACHINE.csv     on an idle machine
    tools/view_times.py --self-test

Each row is a play in a window of 640 x 480 on a virtual display (Xvfb): a bake of scenes/office.glb seen in each
way, solvers that are looked into when they have come to rest, a scene that is baked meanwhile, an object that
is moved, until its first light is seen, an object and a lamp that are dragged, and for the lamp also what the update of
its light alone takes. Without ../shared the living room and the city are left out.
Columns: what, frames, the median and the 95th percentile of their times [ms], the share under 150 ms [%], and the
largest change of brightness from one frame to the next [%], of plays in which the camera stands still.
"""
import argparse
import csv
import json
import pathlib
import subprocess
import sys
import tempfile

SIZE = "640x480"
FRAMES_PER_S = 30  # of plays while something is baked: so they take about as long as they pretend to
UPDATE = ("direct_ms", "bounces_ms", "places_ms")
KINDS = ("both", "light", "colour", "irradiance", "checker", "density", "charts", "seams", "overlaps")
INSIDE = {"hierarchical": ("flat", "gouraud", "gouraud-disc", "interpolant"),
          "hemicube": ("c", "cad", "cads", "cads-pixel", "normals", "radiosity-vertex", "radiosity")}
SCENES = pathlib.Path(__file__).parents[2] / "shared/scenes"
ROOM, CITY = SCENES / "living_room/living_room.glb", SCENES / "kaykit_city/kaykit_city.glb"


def turning(seconds, frames_per_s, kinds, first=()):
    """A play that turns the camera to and fro, so many seconds for each kind of picture."""
    events = [{"at": 0, **event} for event in first]
    events += [{"at": 0, "pointer": [320, 240]}, {"at": 0, "press": "right"}]
    for frame in range(int(seconds * frames_per_s) * len(kinds)):
        kind, of_kind = divmod(frame, int(seconds * frames_per_s))
        if of_kind == 0:
            events.append({"at": frame / frames_per_s, "show": kinds[kind]})
        aside = abs(frame % 40 - 20)
        events.append({"at": frame / frames_per_s, "pointer": [320 + 4 * aside, 240 + 2 * aside]})
    return {"frames_per_s": frames_per_s, "end": seconds * len(kinds), "events": events}


def walking(seconds, frames_per_s):
    """Ahead, round a corner, and back a little, again and again."""
    events = []
    for start in range(0, seconds, 5):
        events += [{"at": start, "key": "w"}, {"at": start + 1.5, "key_up": "w"},
                   {"at": start + 1.6, "pointer": [320, 240]}, {"at": start + 1.6, "press": "left"}]
        aside = 6 if start % 15 else -6
        events += [{"at": start + 1.7 + k / 10, "pointer": [320 + aside * k, 240]} for k in range(20)]
        events += [{"at": start + 3.9, "release": "left"}, {"at": start + 4, "key": "s"},
                   {"at": start + 4.8, "key_up": "s"}]
    return {"frames_per_s": frames_per_s, "end": seconds, "events": events}


def dragging(seconds, frames_per_s):
    """A point lamp under the ceiling of the Cornell box, to and fro."""
    events = [{"at": 0, "material": "light", "radiance": [0, 0, 0]},
              {"at": 0, "new_lamp": "point", "to": [0.1, 0.45, 0.3], "intensity": [0.07, 0.06, 0.05]}]
    for frame in range(1, int(seconds * frames_per_s)):
        aside = abs(frame % 40 - 20) / 20
        events.append({"at": frame / frames_per_s, "lamp": 0, "to": [0.1 + 0.35 * aside, 0.45, 0.3]})
    return {"frames_per_s": frames_per_s, "end": seconds, "events": events}


def dragging_block(seconds, frames_per_s):
    """The tall block of the Cornell box, to and fro."""
    events = [{"at": 0, "wait": "bake"}]
    for frame in range(1, int(seconds * frames_per_s)):
        aside = abs(frame % 40 - 20) / 20
        events.append({"at": frame / frames_per_s, "instance": "tall block", "to": [0.25 + 0.12 * aside, 0.165, 0.35]})
    return {"frames_per_s": frames_per_s, "end": seconds, "events": events}


def moving(times, name, places):
    """An object stands elsewhere, again and again, each time once the bake has ended; the hand rests meanwhile."""
    events = [{"at": 0, "wait": "bake"}]
    for k in range(times):
        events += [{"at": 2 * k + 1, "instance": name, "to": places[k % 2]}, {"at": 2 * k + 1, "wait": "bake"}]
    return {"frames_per_s": 20, "end": 2 * times, "events": events}


def first_lights(frames):
    """Seconds from each edit to the frame that has the first light of it: that of no ray of the bake."""
    edited, out = None, []
    for before, frame in zip(frames, frames[1:]):
        if frame["edits"] != before["edits"]:
            edited = float(frame["at_s"]) - float(frame["milliseconds"]) / 1000
        if edited is not None and frame["rays_per_texel"] == "0":
            out.append(float(frame["at_s"]) - edited)
            edited = None
    return out


def row_of(what, frames, stands, digits=0):
    """`frames`: rows of --frame-times as dictionaries. `stands`: the camera does not move."""
    times = sorted(float(frame["milliseconds"]) for frame in frames)
    jumps = [abs(float(b["brightness"]) / float(a["brightness"]) - 1)
             for a, b in zip(frames, frames[1:]) if stands and a["has_light"] == "1"]
    return [what, len(times), f"{times[len(times) // 2]:.{digits}f}", f"{times[len(times) * 95 // 100]:.{digits}f}",
            f"{100 * sum(time < 150 for time in times) / len(times):.1f}",
            f"{100 * max(jumps):.2f}" if stands else "-"]


def run(*arguments):
    subprocess.run([str(a) for a in arguments], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


class Player:
    """Plays in a window, with luxel and luxel-view of the folder `bin`; files go into another folder."""

    def __init__(self, bin, folder):
        self.bin, self.folder = bin, folder
        root = pathlib.Path(__file__).parents[1]
        self.display = root / "tools/on_virtual_display.sh"
        self.office, self.box = root / "scenes/office.glb", root / "scenes/cornell-box.glb"

    def all_frames(self, play, subject, *options):
        (self.folder / "play.json").write_text(json.dumps(play), encoding="utf-8")
        run(self.display, self.bin / "luxel-view", subject, *options, "--size", SIZE,
            "--play", self.folder / "play.json", "--frame-times", self.folder / "frames.csv")
        with open(self.folder / "frames.csv", newline="", encoding="utf-8") as file:
            return list(csv.DictReader(file))

    def played(self, play, subject, *options):
        # Those in which a play waits come first.
        return self.all_frames(play, subject, *options)[-int(play["end"] * play["frames_per_s"]):]

    def turned(self, kinds, what, subject, *options, first=()):
        frames = self.played(turning(4, 20, kinds, first), subject, *options)
        each = len(frames) // len(kinds)
        for kind, name in enumerate(kinds):
            yield row_of(f"{what}: {name}", frames[kind * each:(kind + 1) * each], False)


def baked(p):
    run(p.bin / "luxel", "bake", p.office, "-o", p.folder / "office", "--resolution", "256", "--samples", "64")
    yield from p.turned(KINDS, "office.glb baked", p.folder / "office")


def inside(p):
    for solver, kinds in INSIDE.items():
        yield from p.turned(kinds, f"office.glb inside {solver}", p.office, "--inside", solver,
                            first=[{"wait": "bake"}])


def live(p):
    rooms = [(p.office, [])] + ([(ROOM, ["--sky", "135,45"])] if ROOM.exists() else [])
    for scene, sky in rooms:
        walk = p.played(walking(60, FRAMES_PER_S), scene, *sky)
        yield row_of(f"{scene.name} while it is baked: walking", walk, False)
        stand = {"frames_per_s": FRAMES_PER_S, "end": 60, "events": []}
        yield row_of(f"{scene.name} while it is baked: standing", p.played(stand, scene, *sky), True)


def edited(p):
    block, building = ([0.25, 0.165, 0.35], [0.35, 0.165, 0.35]), ([-0.8, 0.9, -2], [-2, 0.9, -2])
    moved = [(p.box, ["--resolution", "256"], 10, "tall block", block), (p.box, [], 10, "tall block", block)]
    moved += [(CITY, ["--resolution", "512"], 5, "building_D_34", building)] if CITY.exists() else []
    for scene, resolution, times, name, places in moved:
        frames = p.all_frames(moving(times, name, places), scene, *resolution, "--samples", "16")
        lights = [{"milliseconds": 1000 * light} for light in first_lights(frames)]
        what = " ".join([scene.name, *resolution])
        yield row_of(f"{what}: an object is moved (first light)", lights, False)
    yield row_of("cornell-box.glb: an object is dragged", p.played(dragging_block(10, 20), p.box), False)


def lamps(p):
    run(p.bin / "luxel", "relight", p.box, "-o", p.folder / "box.lxr")
    dragged = p.played(dragging(10, 20), p.folder / "box.lxr")
    yield row_of("cornell-box.lxr: a lamp is dragged", dragged, False)
    updates = [{**frame, "milliseconds": sum(float(frame[part]) for part in UPDATE)} for frame in dragged]
    yield row_of("cornell-box.lxr: a lamp is dragged (update)", updates, False, digits=1)


GROUPS = {"baked": baked, "inside": inside, "live": live, "edited": edited, "lamps": lamps}


def self_test():
    frames = [{"milliseconds": str(m), "brightness": b, "has_light": l}
              for m, b, l in ((100, "0.9", "0"), (50, "0.5", "1"), (200, "0.51", "1"), (60, "0.51", "1"))]
    assert row_of("x", frames, True) == ["x", 4, "100", "200", "75.0", "2.00"], row_of("x", frames, True)
    assert row_of("x", frames, False)[5] == "-"
    assert len(turning(4, 20, ("a", "b"))["events"]) == 2 + 2 + 160
    frames = [{"at_s": str(at), "milliseconds": "20", "edits": edits, "rays_per_texel": rays}
              for at, edits, rays in ((1.0, "0", "64"), (1.1, "1", "64"), (1.2, "1", "0"), (1.3, "1", "0"))]
    assert [round(light, 3) for light in first_lights(frames)] == [0.12]
    for play in (turning(4, 20, ("light",)), walking(60, FRAMES_PER_S), dragging(10, 20), dragging_block(10, 20)):
        times = [event["at"] for event in play["events"]]
        assert times == sorted(times) and times[-1] <= play["end"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("bin", nargs="?", type=pathlib.Path)
    parser.add_argument("--only", choices=GROUPS, help="the rows of this part alone")
    parser.add_argument("--self-test", action="store_true")
    options = parser.parse_args()
    if options.self_test:
        return self_test()
    if not options.bin:
        parser.error("the folder of luxel and luxel-view is needed")
    table = csv.writer(sys.stdout, lineterminator="\n")
    table.writerow(["play", "frames", "median [ms]", "95th percentile [ms]", "under 150 ms [%]",
                    "largest change of brightness [%]"])
    with tempfile.TemporaryDirectory() as folder:
        player = Player(options.bin.resolve(), pathlib.Path(folder))
        for name in [options.only] if options.only else GROUPS:
            for row in GROUPS[name](player):
                table.writerow(row)
                sys.stdout.flush()


if __name__ == "__main__":
    main()
