#!/usr/bin/env python3
"""The numbers that luxel/image/flip_test.cpp expects: tools/flip_reference.py (half a minute)

FLIP [Andersson20] and HDR-FLIP [Andersson21], written from the papers' equations and apart from image/flip*:
double precision, whole YCxCz and L*a*b*, dense two-dimensional kernels, nothing separated, trimmed or left out."""
import math
from operator import mul

WIDTH, HEIGHT = 64, 48
PIXELS = [(0, 0), (32, 24), (31, 19), (24, 20), (63, 47), (40, 12)]
PPD = 0.7 * (3840 / 0.7) * math.pi / 180  # distance times pixels per metre times metres per degree
XYZ = [[0.412386563, 0.357591491, 0.180450491],  # sRGB's primaries, white D65 at (0.31271, 0.32902)
       [0.212636822, 0.715182982, 0.072180196],
       [0.019330620, 0.119197164, 0.950372587]]
WHITE = [sum(row) for row in XYZ]
Q_COLOR, Q_FEATURE, P_COLOR, P_THRESHOLD, FEATURE_WIDTH = 0.7, 0.5, 0.4, 0.95, 0.082


def times(matrix, v):
    return [sum(map(mul, row, v)) for row in matrix]


def solved(matrix, v):
    """x with matrix x = v (Cramer's rule)."""
    def det(m):
        return (m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
                + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]))
    return [det([[v[i] if j == k else matrix[i][j] for j in range(3)] for i in range(3)]) / det(matrix)
            for k in range(3)]


INVERSE = [list(column) for column in zip(*(solved(XYZ, [float(i == k) for i in range(3)]) for k in range(3)))]


def clamped(c):
    return [min(max(v, 0.0), 1.0) for v in c]


def ycxcz(rgb):
    x, y, z = (v / w for v, w in zip(times(XYZ, rgb), WHITE))
    return [116 * y - 16, 500 * (x - y), 200 * (y - z)]


def rgb_of(c):
    y = (c[0] + 16) / 116
    return times(INVERSE, [(y + c[1] / 500) * WHITE[0], y * WHITE[1], (y - c[2] / 200) * WHITE[2]])


def hunt_lab(rgb):
    def f(t):
        return t ** (1 / 3) if t > (6 / 29) ** 3 else t / (3 * (6 / 29) ** 2) + 4 / 29
    x, y, z = (f(v / w) for v, w in zip(times(XYZ, rgb), WHITE))
    lightness = 116 * y - 16
    return [lightness, 0.01 * lightness * 500 * (x - y), 0.01 * lightness * 200 * (y - z)]


def hyab(a, b):
    return abs(a[0] - b[0]) + math.hypot(a[1] - b[1], a[2] - b[2])


def kernel(function, radius):
    return [[function(x, y) for x in range(-radius, radius + 1)] for y in range(-radius, radius + 1)]


def with_sums_of_one(k):
    """Positive weights sum to 1, negative ones to -1."""
    plus = sum(v for row in k for v in row if v > 0)
    minus = -sum(v for row in k for v in row if v < 0)
    return [[v / plus if v > 0 else v / minus if v < 0 else 0.0 for v in row] for row in k]


def sensitivity(a1, b1, a2, b2):
    radius = math.ceil(3 * math.sqrt(0.04 / (2 * math.pi ** 2)) * PPD)

    def at(x, y):
        d2 = (x * x + y * y) / PPD ** 2  # degrees squared
        return (a1 * math.sqrt(math.pi / b1) * math.exp(-math.pi ** 2 * d2 / b1)
                + a2 * math.sqrt(math.pi / b2) * math.exp(-math.pi ** 2 * d2 / b2))
    return with_sums_of_one(kernel(at, radius))


def detector(point):
    sigma = 0.5 * FEATURE_WIDTH * PPD

    def at(x, y):
        g = math.exp(-(x * x + y * y) / (2 * sigma * sigma))
        return (x * x / sigma ** 2 - 1) * g if point else -x * g
    return with_sums_of_one(kernel(at, math.ceil(3 * sigma)))


def convolved(plane, k):
    """Outside the picture its border goes on."""
    r = len(k) // 2
    rows = [[row[0]] * r + row + [row[-1]] * r for row in plane]
    rows = [rows[0]] * r + rows + [rows[-1]] * r
    return [[sum(sum(map(mul, k[j], rows[y + j][x:x + 2 * r + 1])) for j in range(2 * r + 1))
             for x in range(len(plane[0]))] for y in range(len(plane))]


SENSITIVITY = [sensitivity(1, 0.0047, 0, 1e-5), sensitivity(1, 0.0053, 0, 1e-5), sensitivity(34.1, 0.04, 13.5, 0.025)]
DETECTORS = [detector(False), detector(True)]


def seen(picture):
    """Colours behind the eye's filters, and lengths of edges and points, per pixel."""
    opponent = [[ycxcz(clamped(c)) for c in row] for row in picture]
    planes = [[[c[i] for c in row] for row in opponent] for i in range(3)]
    blurred = [convolved(planes[i], SENSITIVITY[i]) for i in range(3)]
    colors = [[hunt_lab(clamped(rgb_of(c))) for c in zip(*rows)] for rows in zip(*blurred)]
    brightness = [[(v + 16) / 116 for v in row] for row in planes[0]]
    features = []
    for k in DETECTORS:
        along_x, along_y = convolved(brightness, k), convolved(brightness, [list(c) for c in zip(*k)])
        features.append([[math.hypot(x, y) for x, y in zip(*rows)] for rows in zip(along_x, along_y)])
    return colors, features


def flip(a, b):
    (color_a, feature_a), (color_b, feature_b) = seen(a), seen(b)
    largest = hyab(hunt_lab([0, 1, 0]), hunt_lab([0, 0, 1])) ** Q_COLOR
    out = []
    for y in range(HEIGHT):
        out.append([])
        for x in range(WIDTH):
            e = hyab(color_a[y][x], color_b[y][x]) ** Q_COLOR
            knee = P_COLOR * largest
            e = e * P_THRESHOLD / knee if e < knee else \
                P_THRESHOLD + (e - knee) / (largest - knee) * (1 - P_THRESHOLD)
            feature = max(abs(fa[y][x] - fb[y][x]) for fa, fb in zip(feature_a, feature_b))
            out[-1].append(e ** (1 - (feature / math.sqrt(2)) ** Q_FEATURE))
    return out


CURVE = [0.6 * 0.6 * 2.51, 0.6 * 0.03, 0, 0.6 * 0.6 * 2.43, 0.6 * 0.59, 0.14]  # ACES, exposure 0.6 inside


def filmic(x):
    k = CURVE
    return min(max((k[0] * x * x + k[1] * x + k[2]) / (k[3] * x * x + k[4] * x + k[5]), 0), 1)


def exposures(b):
    k, t = CURVE, 0.85
    p, q, r = k[0] - t * k[3], k[1] - t * k[4], k[2] - t * k[5]
    x = (-q + math.sqrt(q * q - 4 * p * r)) / (2 * p)
    light = sorted(sum(map(mul, (0.2126, 0.7152, 0.0722), c)) for row in b for c in row)
    median = (light[(len(light) - 1) // 2] + light[len(light) // 2]) / 2
    start, stop = math.log2(x / light[-1]), math.log2(x / median)
    return start, stop, max(2, math.ceil(stop - start))


def hdr_flip(a, b):
    start, stop, count = exposures(b)
    print(f"  exposures {start:.7f} to {stop:.7f}, {count} of them")
    out = [[0.0] * WIDTH for _ in range(HEIGHT)]
    for i in range(count):
        factor = 2 ** (start + i * (stop - start) / (count - 1))
        shown = [[[[filmic(factor * v) for v in c] for c in row] for row in p] for p in (a, b)]
        out = [list(map(max, *rows)) for rows in zip(out, flip(*shown))]
    return out


def linear(v):
    return v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4


def picture(color_at):
    return [[color_at(x, y) for x in range(WIDTH)] for y in range(HEIGHT)]


def show(name, values):
    mean = sum(map(sum, values)) / (WIDTH * HEIGHT)
    print(f"{name}\n  mean {mean:.7f}, at the pixels " + ", ".join(f"{values[y][x]:.6f}" for x, y in PIXELS))


if __name__ == "__main__":
    ramps = picture(lambda x, y: [linear(x / 63), linear(y / 47), linear((x + 2 * y) % 16 / 15)])
    square = picture(lambda x, y: [0.25] * 3 if 24 <= x < 40 and 20 <= y < 28 else ramps[y][x])
    checker = picture(lambda x, y: [float((x // 4 + y // 4) % 2)] * 3)
    spot = picture(lambda x, y: [0.02 + (60 if math.hypot(x - 40, y - 12) < 3 else 0) + 4 * v ** 3 for v in ramps[y][x]])
    show("a grey square on ramps", flip(square, ramps))
    show("swapped channels", flip([[c[::-1] for c in row] for row in ramps], ramps))
    show("a checker against its mean", flip(checker, picture(lambda x, y: [0.5] * 3)))
    show("a bright spot", hdr_flip([[[1.1 * r, 1.1 * g + 0.05, 1.1 * b] for r, g, b in row] for row in spot], spot))
