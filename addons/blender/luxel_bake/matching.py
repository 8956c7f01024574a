"""Which triangle of a mesh is which of a baked file. Knows nothing of Blender."""
import numpy


def from_lowest(triangles):
    """For each triangle (n, 3, 3) the numbers of its corners from the lowest place on, in their turn: luxel and Blender
    begin a triangle at any of its corners."""
    rows, first = numpy.arange(len(triangles)), numpy.zeros(len(triangles), int)
    for k in (1, 2):
        best, other = triangles[rows, first], triangles[:, k]
        axis = (best != other).argmax(axis=1)
        first = numpy.where(other[rows, axis] < best[rows, axis], k, first)
    return (first[:, None] + numpy.arange(3)) % 3


def keys_of(positions):
    """A number for each different triangle of several arrays (n, 3, 3), by the bits of its corners."""
    counts = [len(one) for one in positions]
    # 0 and -0 are one number.
    rows = numpy.ascontiguousarray(numpy.concatenate(positions).reshape(-1, 9).astype(numpy.float32) + 0.0)
    _, numbers = numpy.unique(rows.view(numpy.dtype((numpy.void, 36))).ravel(), return_inverse=True)
    return numpy.split(numbers.reshape(-1), numpy.cumsum(counts)[:-1])


def repeats_of(keys):
    """How many of the same key stand before each."""
    order = numpy.argsort(keys, kind="stable")
    ordered = keys[order]
    first = numpy.r_[True, ordered[1:] != ordered[:-1]]
    begins = numpy.maximum.accumulate(numpy.where(first, numpy.arange(len(keys)), 0))
    repeats = numpy.empty(len(keys), int)
    repeats[order] = numpy.arange(len(keys)) - begins
    return repeats


def match(mesh, baked):
    """The number of the baked triangle for each of the mesh, -1 for none. Both are corners (n, 3, 3), from the lowest
    on. Triangles with the same corners go together in their order."""
    if not len(mesh) or not len(baked):
        return numpy.full(len(mesh), -1)
    in_mesh, in_baked = keys_of([mesh, baked])
    widest = max(len(mesh), len(baked)) + 1
    wanted = in_mesh * widest + repeats_of(in_mesh)
    there = in_baked * widest + repeats_of(in_baked)
    order = numpy.argsort(there)
    at = numpy.minimum(numpy.searchsorted(there[order], wanted), len(there) - 1)
    return numpy.where(there[order][at] == wanted, order[at], -1)


def normals_of(triangles):
    """Of the length of twice their areas."""
    return numpy.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])


def areas_of(triangles):
    return numpy.linalg.norm(normals_of(triangles), axis=1) / 2


def lies_in(places, triangle, tolerance=1e-4):
    """Which of the places (n, 3) lie in a triangle (3, 3), to a part of its size."""
    a, u, v = triangle[0], triangle[1] - triangle[0], triangle[2] - triangle[0]
    normal = numpy.cross(u, v)
    size = numpy.linalg.norm(normal)
    if size == 0:
        return numpy.zeros(len(places), bool)
    offset = places - a
    off_plane = numpy.abs(offset @ normal) / size
    second = numpy.cross(offset, v) @ normal / size**2
    third = numpy.cross(u, offset) @ normal / size**2
    return ((off_plane < tolerance * numpy.sqrt(size)) & (second > -tolerance) & (third > -tolerance) &
            (second + third < 1 + tolerance))
