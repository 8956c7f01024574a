"""The arithmetic of the comparison: which texels count, errors, and the seconds to an error. Plain Python 3.

A picture is a dictionary of channels R, G, B, A, each a list of floats, as exr.read gives it. Two references a and b
have independent noise of mean 0. So the mean of (x - a) (x - b) is the squared error of x without their noise.
"""
import math

NO_LIGHT_OF_THEIR_OWN = {(0, 0, 0), (240, 200, 40), (40, 190, 70), (220, 30, 200)}
"""Colours of texels.png: hidden, refilled, sample moved out of a solid, shared by charts."""


def counted(a, b, cycles, texels):
    """Numbers of the texels whose centre lies on a surface in both bakers, wholly outside solids, and lit.

    `texels`: bytes of texels.png, three per texel. Outside of all light the references are 0 without error.
    """
    def lit(k):
        return any(picture[c][k] > 0 for picture in (a, b) for c in "RGB")

    return [k for k in range(len(a["A"])) if a["A"][k] == 1 and cycles["A"][k] == 1 and lit(k)
            and tuple(texels[3 * k:3 * k + 3]) not in NO_LIGHT_OF_THEIR_OWN]


def mean(picture, of):
    return sum(picture[c][k] for c in "RGB" for k in of) / (3 * len(of))


def product(x, y, of):
    """The mean of x times y, given as functions of channel and texel."""
    return sum(x(c, k) * y(c, k) for c in "RGB" for k in of) / (3 * len(of))


def difference(x, y):
    return lambda c, k: x[c][k] - y[c][k]


def root(square):
    """The root, of what may be below 0 by its own noise."""
    return math.sqrt(max(0.0, square))


def noise(first, second, of):
    """RMS noise of one of two bakes of different seeds."""
    d = difference(first, second)
    return root(product(d, d, of) / 2)


def error(pictures, a, b, of):
    """RMS error against the truth that a and b know with noise; of several pictures the root mean square."""
    squares = [product(difference(x, a), difference(x, b), of) for x in pictures]
    return root(sum(squares) / len(squares))


def bias(first, second, a, b, of):
    """RMS of what more samples do not mend: two seeds have no common noise."""
    return root(product(difference(first, a), difference(second, b), of))


def without(whole, part):
    """What is left of an error when an independent part of it is taken away."""
    return root(whole ** 2 - part ** 2)


def seconds_to(target, runs):
    """Seconds in which the error falls to `target`, and whether this is an extrapolation; None where it never does.

    `runs`: samples, seconds and error, by samples. Between two runs log(error) is a straight line in log(seconds).
    Beyond the last run it goes on in log(samples) as between the last two, and seconds grow linearly with samples. If
    the error falls there by less than a tenth of a decade per decade of samples, more samples do not help. The first
    run is taken whole if its error is below the target already.
    """
    if runs[0][2] <= target:
        return runs[0][1], False
    for (_, t0, e0), (_, t1, e1) in zip(runs, runs[1:]):
        if e1 <= target < e0:
            return on_line(target, (t0, e0), (t1, e1)), False
    if len(runs) < 2:
        return None, True
    (n0, t0, e0), (n1, t1, e1) = runs[-2:]
    if slope((n0, e0), (n1, e1)) > -0.1:
        return None, True
    samples = on_line(target, (n0, e0), (n1, e1))
    return t1 + (samples - n1) * max(t1 - t0, 0) / (n1 - n0), True


def slope(first, second):
    return math.log(second[1] / first[1]) / math.log(second[0] / first[0])


def on_line(target, first, second):
    """Where a straight line through two points in log(error) over log(seconds) or log(samples) meets the target."""
    if second[0] == first[0]:
        return second[0]
    return second[0] * (target / second[1]) ** (1 / slope(first, second))


def geometric_mean(values):
    return math.exp(sum(math.log(value) for value in values) / len(values))
