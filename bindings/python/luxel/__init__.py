"""luxel computes diffuse global illumination: how much light every surface of a scene receives.

A white square metre under an even sky of radiance 1 receives E = pi:

>>> import luxel
>>> scene = luxel.Scene()
>>> white = scene.add_material("white", (0.5, 0.5, 0.5))
>>> scene.add_mesh([(0, 0, 0), (1, 0, 0), (1, 0, -1), (0, 0, -1)], [(0, 1, 2), (0, 2, 3)], white)
>>> scene.background = (1, 1, 1)
>>> bake = luxel.bake(scene, resolution=16, samples=64)
>>> bake.lightmap.shape
(16, 16, 4)
>>> round(float(bake.irradiance.mean()), 2)
3.14

A ray from above meets it, and leaves it on its way to the sky:

>>> hits = luxel.trace(scene, [(0.5, 1, -0.5)], [(0, -1, 0)])
>>> float(hits.t[0]), int(hits.triangle[0]) >= 0
(1.0, True)
>>> luxel.occluded(scene, [(0.5, 1, -0.5)], [(0, 1, 0)])
array([False])

docs/guide/python.md is the guide.
"""
import json as _json
import os as _os
from typing import NamedTuple as _NamedTuple

import numpy as _numpy

from . import _luxel
from ._luxel import Bake, Error, Relighter, Scene, Tracer, __version__, bake, load

__all__ = [
    "Bake", "Error", "Hits", "Relighter", "Relit", "Scene", "Tracer", "bake", "compare", "load",
    "occluded", "trace", "view_factors",
]


class Hits(_NamedTuple):
    """What rays meet first, an entry for each ray. instance and triangle are -1 for a ray that meets nothing."""

    t: _numpy.ndarray  # in lengths of its direction; infinite where it meets nothing
    instance: _numpy.ndarray  # of Scene.instances
    triangle: _numpy.ndarray  # of the instance's mesh
    barycentric: _numpy.ndarray  # (n, 2): weights of the triangle's second and third corner
    back_face: _numpy.ndarray  # the ray came from behind the front


def _tracer(scene):
    return scene if isinstance(scene, Tracer) else Tracer(scene)


def trace(scene, origins, directions, *, t_min=0.0, t_max=float("inf")):
    """The closest hits of rays from origins (n, 3) along directions (n, 3), as Hits.

    scene is a Scene or, for many calls, a Tracer. Directions need not be of unit length.
    """
    return Hits(*_tracer(scene)._closest_hits(origins, directions, t_min, t_max))


def occluded(scene, origins, directions, *, t_min=0.0, t_max=float("inf")):
    """Whether anything solid lies on each ray between t_min and t_max, an array of bool. Otherwise as trace().

    With directions = ends - origins and t_max=1 it tells which pairs of points do not see each other.
    """
    return _tracer(scene)._occluded(origins, directions, t_min, t_max)


def _on_map(self, values, fill=_numpy.nan):
    """A picture (side, side, ...) of values that belong to texels, as error or irradiance do, or any (n, ...)."""
    values = _numpy.asarray(values)
    if values.shape[:1] != self.texels.shape:
        raise ValueError(f"values must have an entry for each of {len(self.texels)} texels")
    out = _numpy.full(self.texel_map.shape + values.shape[1:], fill, values.dtype if values.dtype.kind == "f" else None)
    covered = self.texel_map >= 0
    out[covered] = values[self.texel_map[covered]]
    return out


def _save(self, folder, *, progress=None):
    """Writes what `luxel bake -o folder` leaves: lightmap.exr, baked.glb, preview.png, ... Returns bake.json."""
    return _json.loads(self._save(folder, progress))


for _name, _function in {"on_map": _on_map, "save": _save}.items():
    _function.__name__, _function.__qualname__ = _name, "Bake." + _name
    setattr(Bake, _name, _function)


class Relit(_NamedTuple):
    """Irradiance [W/m^2] by Relighter.update(), (n, 3) of the patches and (m, 3) of the places."""

    direct: _numpy.ndarray  # straight from punctual lights
    indirect: _numpy.ndarray  # from surfaces and from the background
    direct_at_places: _numpy.ndarray
    indirect_at_places: _numpy.ndarray


def _update(self, lights, *, emission=None):
    """The light of all patches and places, after all bounces, as Relit.

    Takes the punctual lights and the background of a Scene. emission is the radiance of each of `materials`, (k, 3)
    [W/(sr m^2)]; None: as they were.
    """
    return Relit(*self._update(lights, emission))


_update.__name__, _update.__qualname__ = "update", "Relighter.update"
Relighter.update = _update


def __getattr__(name):
    if name == "ViewFactors":  # later than the rest: without scipy everything else works
        try:
            from ._factors import ViewFactors
        except ImportError as error:
            raise AttributeError(f"luxel.ViewFactors needs scipy: {error}") from error
        return ViewFactors
    raise AttributeError(f"module 'luxel' has no attribute {name!r}")


def view_factors(scene, *, method="analytic", tolerance=None, samples=None, hemicube=None, smooth=False, seed=1,
                 threads=0, progress=None):
    """View factors between the surfaces of a Scene or of a file, as ViewFactors, a scipy.sparse.csr_matrix.

    It has attributes besides: names and areas [m^2] of the surfaces, error (n, n) of each factor, estimated, and
    closed: whether every row sums to 1. The other options are those of `luxel factors`.
    """
    from ._factors import ViewFactors
    names, areas, factors, errors, closed = _luxel._view_factors(
        scene, method, tolerance, samples, hemicube, smooth, seed, threads, progress)
    out = ViewFactors(factors)
    out.names, out.areas, out.error, out.closed = names, areas, errors, closed
    return out


def compare(a, b, *, report=None, exposure=None, progress=None):
    """How far picture or bake a is from b, the reference: the measures of `luxel compare --json`, a dict.

    Each is a file, the folder of a bake, a Bake, or an array (height, width, 3 or 4) of light. report is a folder in
    which report.html is written, and for files only.
    """
    a, b = (x.lightmap if isinstance(x, Bake) else x for x in (a, b))
    are_files = [isinstance(x, (str, _os.PathLike)) for x in (a, b)]
    if all(are_files):
        return _json.loads(_luxel._compare_files(a, b, report, exposure, progress))
    if any(are_files):
        raise TypeError("a and b must both be files, or both be arrays or bakes")
    if report is not None:
        raise TypeError("a report is made of files only; Bake.save() writes them")
    return _json.loads(_luxel._compare_arrays(a, b, exposure, progress))
