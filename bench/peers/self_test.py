"""Tests of the comparison's arithmetic and files against known numbers, without Blender and without luxel."""
import array
import math
import pathlib
import random
import struct
import tempfile
import zlib

import compare
import exr
import measure
import png
import scenes


def near(value, wanted, tolerance=1e-9):
    assert abs(value - wanted) <= tolerance * max(1, abs(wanted)), (value, wanted)


def picture(values):
    return {**{c: list(values) for c in "RGB"}, "A": [1.0] * len(values)}


def test_seconds():
    # 1 over the root, then 1 over the time.
    runs = [(4, 1, 0.08), (16, 4, 0.04), (64, 16, 0.02), (256, 64, 0.005)]
    near(measure.seconds_to(0.02, runs)[0], 16)
    near(measure.seconds_to(0.01, runs)[0], 32)  # half the error in twice the seconds
    assert not measure.seconds_to(0.01, runs)[1]
    seconds, beyond = measure.seconds_to(0.01, runs[:3])
    near(seconds, 64)
    assert beyond
    assert measure.seconds_to(0.1, runs) == (1, False)
    # Half the error takes four times the samples, whatever a sample costs: 256 of them, 192 more at a half second.
    near(measure.seconds_to(0.01, [(16, 6, 0.04), (64, 30, 0.02)])[0], 30 + 192 / 2)
    # The second falls by samples too slowly, though a larger part of its seconds is fixed.
    for runs in ([(1, 1, 0.03), (4, 4, 0.029)], [(4, 2, 0.028), (16, 3, 0.025)], [(1, 1, 0.03), (4, 4, 0.031)], [(1, 1, 0.03)]):
        assert measure.seconds_to(0.01, runs) == (None, True)
    near(measure.geometric_mean([1, 10, 100]), 10)


def test_errors():
    chance = random.Random(1)
    count = 40000
    truth = [1 + (k % 7) for k in range(count)]

    def noisy(spread, offset=0.0):
        return picture([t + offset + chance.gauss(0, spread) for t in truth])

    a, b = noisy(0.5), noisy(0.5)
    of = range(count)
    near(measure.mean(picture(truth), of), sum(truth) / count)
    near(measure.noise(a, b, of), 0.5, 0.01)
    # The references are five times as noisy as what is measured, and one part in a hundred is left of that.
    near(measure.error([noisy(0.1)], a, b, of), 0.1, 0.1)
    near(measure.error([noisy(0.1, 0.2), noisy(0.1, 0.2)], a, b, of), math.hypot(0.1, 0.2), 0.05)
    near(measure.bias(noisy(0.3, 0.2), noisy(0.3, 0.2), a, b, of), 0.2, 0.05)
    near(measure.without(5, 3), 4)
    assert measure.without(3, 5) == 0
    assert measure.error([picture(truth)], a, a, of) > 0.4  # one reference twice would count its noise


def test_counted():
    a, b, cycles = (picture([1.0] * 7) for _ in range(3))
    a["A"][0], cycles["A"][1] = 0.5, 0.25
    for channel in "RGB":
        a[channel][2] = b[channel][2] = b[channel][3] = 0.0
    texels = bytes([200] * 12 + [0] * 3 + [40, 190, 70] + [95, 105, 140])
    assert measure.counted(a, b, cycles, texels) == [3, 6]


def test_rows():
    """A ratio stands only where both bakers have the same light in the mean."""
    def series(runs, noises, mean):
        out = compare.Series("hall", 4)
        out.runs, out.noises, out.mean, out.memory, out.lasting, out.of = runs, noises, mean, 3e6, 0.02, range(5)
        return out

    slow = series([(4, 10, 0.02), (16, 40, 0.01)], None, 0.995)
    quick = series([(4, 1, 0.02), (16, 4, 0.01), (64, 9, 0.005)], [(4, 1, 0.02), (16, 2, 0.01)], 1.001)
    row, ratios = compare.row_of("hall", slow, quick, "quick")
    near(ratios[0], 10)
    near(ratios[1], 20)
    assert row == ["hall", "40.0", "4.00", "10.0", "2.00", "20.0", "1.00", "0.50", "0.9950", "1.0010", "2.0", "3",
                   "3", "5", "quick"], row
    assert len(row) == len(compare.COLUMNS)
    row = compare.mean_row([ratios, [40, None], [None, None]], "quick")
    assert row[0] == "geometric mean of 2 and 1" and row[3:6] == ["20.0", "", "20.0"], row
    row, alone = compare.row_of("hall (denoised)", None, quick, "quick")
    assert alone == [None, None] and row[1:7] == ["-", "4.00", "-", "2.00", "-", "-"] and row[-2] == "5", row
    quick.mean = 1.02
    row, ratios = compare.row_of("hall", slow, quick, "quick")
    assert ratios == [None, None] and row[1:6] == ["40.0", "4.00", "-", "2.00", "-"]


def test_asking():
    """luxel is asked for 4 %, 2 %, 1 % and 0.5 %, or until the error is 1 %."""
    series, asked = compare.AskingSeries("hall", 4), []
    while series.wants_more():
        asked.append(series.asked())
        series.add([1], 0.02, 0.02, [1])
    assert asked == [0.04, 0.02, 0.01, 0.005], asked
    series = compare.AskingSeries("hall", 4)
    series.add([1], 0.01, 0.01, [1])
    assert not series.wants_more()


def encoded_exr(width, height, channels):
    """A picture of scan lines in ZIP blocks, written from OpenEXR's description. `channels`: name, kind, values."""
    def attribute(name, kind, body):
        return name + b"\0" + kind + b"\0" + struct.pack("<i", len(body)) + body

    names = b"".join(name + b"\0" + struct.pack("<4i", kind, 0, 1, 1) for name, kind, _ in channels) + b"\0"
    head = struct.pack("<2i", 20000630, 2) + attribute(b"channels", b"chlist", names)
    head += attribute(b"compression", b"compression", b"\3")
    head += attribute(b"dataWindow", b"box2i", struct.pack("<4i", 0, 0, width - 1, height - 1)) + b"\0"
    blocks = []
    for first in range(0, height, 16):
        raw = b"".join(struct.pack("<%d%s" % (width, "fe"[kind == exr.HALF]), *values[y * width:(y + 1) * width])
                       for y in range(first, min(height, first + 16)) for _, kind, values in channels)
        mixed = raw[0::2] + raw[1::2]
        steps = bytes([mixed[0]] + [(y - x + 128) & 255 for x, y in zip(mixed, mixed[1:])])
        packed = zlib.compress(steps)
        blocks.append(struct.pack("<2i", first, len(packed)) + packed)
    at, table = len(head) + 8 * len(blocks), b""
    for block in blocks:
        table, at = table + struct.pack("<Q", at), at + len(block)
    return head + table + b"".join(blocks)


def test_pictures(folder):
    width, height = 30, 21
    a = [0.25 * (k % 9) for k in range(width * height)]
    r = array.array("f", [math.sin(k) * 1e3 for k in range(width * height)]).tolist()
    (folder / "x.exr").write_bytes(encoded_exr(width, height, [(b"A", exr.HALF, a), (b"R", exr.FLOAT, r)]))
    w, h, channels = exr.read(folder / "x.exr")
    assert (w, h) == (width, height) and channels["A"].tolist() == a and channels["R"].tolist() == r
    (folder / "x.exr").write_bytes(b"x" * 40)
    try:
        exr.read(folder / "x.exr")
        raise AssertionError("a picture of nothing was read")
    except ValueError as error:
        assert "cannot be read" in str(error)
    pixels = bytes(7 * k % 251 for k in range(3 * 5 * 4))
    (folder / "x.png").write_bytes(png.encoded(5, 4, 3, pixels))
    assert png.read(folder / "x.png") == (5, 4, 3, pixels)
    # By hand: each byte is filtered by what PNG's table of filters says.
    assert [png.predicted(kind, 10, 20, 12) for kind in range(5)] == [0, 10, 20, 15, 20]
    assert png.predicted(4, 10, 20, 21) == 10 and png.predicted(4, 10, 30, 20) == 20
    assert png.predicted(4, 6, 18, 10) == 18  # as far as the corner: up comes first
    assert png.encoded(1, 1, 1, b"x").endswith(b"IEND\xae\x42\x60\x82")


def test_layouts():
    for make in scenes.MADE.values():
        quads, _ = make()
        used = set()
        for x, y, width, height in scenes.layout(quads):
            own = {(i, j) for i in range(x - 1, x + width + 1) for j in range(y - 1, y + height + 1)}
            assert all(0 <= k < scenes.RESOLUTION for place in own for k in place)
            assert not used & own
            used |= own
        assert len(used) > 0.6 * scenes.RESOLUTION ** 2


def test_faces():
    """Normals of a box point out of it, or into it."""
    for inside in (False, True):
        for face in scenes.box({}, (1, 2, 3), (2, 4, 6), inside=inside):
            middle = scenes.plus(scenes.plus(face["corner"], face["along"], 0.5), face["up"], 0.5)
            outwards = scenes.plus(middle, (1.5, 3, 4.5), -1)
            assert (sum(x * y for x, y in zip(scenes.cross(face["along"], face["up"]), outwards)) > 0) != inside


def run():
    test_seconds()
    test_errors()
    test_counted()
    test_rows()
    test_asking()
    test_layouts()
    test_faces()
    with tempfile.TemporaryDirectory() as name:
        test_pictures(pathlib.Path(name))
    print("bench/peers/compare.py: all tests passed")
    return 0
