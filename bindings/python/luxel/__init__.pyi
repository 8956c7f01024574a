# Types of luxel. The options between "begin" and "end" are written by make_stub.py from luxel's tables.
import os
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import scipy.sparse

__all__ = [
    "Bake", "Error", "Hits", "Relighter", "Relit", "Scene", "Tracer", "bake", "compare", "load",
    "occluded", "trace", "view_factors",
]
__version__: str

Path = str | os.PathLike[str]
Value = str | float | os.PathLike[str] | Sequence[Any]  # as the command line has it; lists for commas
Values = Value
Progress = Callable[[str, float | None, float | None], object]  # stage, share of it, seconds left of all
Floats = npt.NDArray[np.float32]

class Error(RuntimeError): ...

class Scene:
    def __init__(self) -> None: ...
    def add_material(
        self, name: str, color: npt.ArrayLike, *, emission: npt.ArrayLike = ..., double_sided: bool = ...
    ) -> int: ...
    def add_mesh(
        self, positions: npt.ArrayLike, triangles: npt.ArrayLike, material: int | npt.ArrayLike, *, name: str = ...,
        normals: npt.ArrayLike | None = ..., uv: npt.ArrayLike | None = ...,
        lightmap_uv: npt.ArrayLike | None = ..., transform: npt.ArrayLike | None = ...
    ) -> None: ...
    def add_point_light(self, position: npt.ArrayLike, intensity: npt.ArrayLike, *, name: str = ...) -> None: ...
    def add_spot_light(
        self, position: npt.ArrayLike, direction: npt.ArrayLike, intensity: npt.ArrayLike, cone_deg: float, *,
        inner_cone_deg: float = ..., name: str = ...
    ) -> None: ...
    def add_sun(
        self, direction: npt.ArrayLike, irradiance: npt.ArrayLike, *, angular_radius_deg: float = ..., name: str = ...
    ) -> None: ...
    @property
    def background(self) -> list[float]: ...
    @background.setter
    def background(self, color: npt.ArrayLike) -> None: ...
    @property
    def instances(self) -> list[str]: ...
    @property
    def materials(self) -> list[str]: ...
    @property
    def triangles(self) -> Floats: ...
    @property
    def first_triangle(self) -> npt.NDArray[np.int64]: ...

def load(
    path: Path,
    *,
    # begin: load
    smooth_normals: float | None = ...,  # Meshes without normals: smooth across edges that bend by at most this angle, 0: flat; by default 30 for OBJ and PLY, else flat (0 to 180)
    search_path: Values | None = ...,  # A folder besides the scene's own in which pictures and buffers may lie that the scene names; may be given for several
    trust_paths: bool | None = ...,  # Read files that the scene names wherever they lie, outside of its folder too
    # end: load
) -> Scene: ...

class Tracer:
    def __init__(self, scene: Scene) -> None: ...

class Hits(NamedTuple):
    t: Floats
    instance: npt.NDArray[np.int64]
    triangle: npt.NDArray[np.int64]
    barycentric: Floats
    back_face: npt.NDArray[np.bool_]

def trace(
    scene: Scene | Tracer, origins: npt.ArrayLike, directions: npt.ArrayLike, *, t_min: float = ..., t_max: float = ...
) -> Hits: ...
def occluded(
    scene: Scene | Tracer, origins: npt.ArrayLike, directions: npt.ArrayLike, *, t_min: float = ..., t_max: float = ...
) -> npt.NDArray[np.bool_]: ...

class Bake:
    @property
    def lightmap(self) -> Floats: ...
    def page(self, number: int) -> Floats: ...
    @property
    def pages(self) -> list[list[int]]: ...
    @property
    def texel_map(self) -> npt.NDArray[np.int32]: ...
    @property
    def texels(self) -> npt.NDArray[np.void]: ...
    @property
    def positions(self) -> Floats: ...
    @property
    def irradiance(self) -> Floats: ...
    @property
    def error(self) -> Floats | None: ...
    @property
    def texel_corners(self) -> Floats: ...
    @property
    def preview(self) -> npt.NDArray[np.uint8]: ...
    @property
    def scene(self) -> Scene: ...
    @property
    def relative_error(self) -> float: ...
    @property
    def warnings(self) -> list[str]: ...
    def on_map(self, values: npt.ArrayLike, fill: float = ...) -> npt.NDArray[Any]: ...
    def save(self, folder: Path, *, progress: Progress | None = ...) -> dict[str, Any]: ...

def bake(
    scene: Scene | Path,
    *,
    progress: Progress | None = ...,
    # begin: bake
    solver: str | None = ...,  # How light is computed; gather
    settings: Value | None = ...,  # Take scene and settings from the bake.json of an earlier bake
    resolution: float | None = ...,  # Side of a lightmap in texels; without it, as fine as the scene deserves, up to some 2 million texels (1 to 16384)
    texels_per_metre: float | None = ...,  # Density; the side becomes the smallest power of two that holds the scene
    pages: Value | None = ...,  # Number of lightmaps; auto: as many as the density needs; mesh: one per mesh; 1
    uv: Value | None = ...,  # keep = the file's TEXCOORD_1, unwrap = a new layout, auto = keep if it can hold the light; auto
    leak_repair: bool | None = ...,  # False: Do not cut charts under thin walls, nor move samples out of solids; True
    quality: Value | None = ...,  # How good the light is: sets --samples, --direct-samples, --supersample and --denoise where they are not given; good if nothing else is said
    samples: float | None = ...,  # Indirect rays per texel; gather has --quality's where none is given (1 to 65535); 256
    direct_samples: float | None = ...,  # Shadow rays per texel towards area lights; auto: as --samples asks for, so that direct light is as well known as the rest (1 to 65535); 64
    supersample: float | None = ...,  # Points per texel across which direct light varies; 1: none; auto: as --samples asks for (1 to 1024); 16
    bounces: Value | None = ...,  # Reflections to count, or inf; inf
    max_error: float | None = ...,  # Add rays until the light errs by less than this part of itself, e.g. 0.02 (0.0001 to 1)
    error_measure: Value | None = ...,  # What --max-error says: p95: 95 % of texels err by less than this part of their own light; rms: the root mean square error of all texels, over their mean light; p95
    time_budget: float | None = ...,  # gather: the lowest error within about this many seconds in total; with --max-error until either is reached. hierarchical: less refinement where that helps. All but gather end with code 3 when it is over
    seed: float | None = ...,  # Seed of all random numbers (>= 0); 1
    directional: Value | None = ...,  # Also store how irradiance changes with the normal: dominant or sh1
    probes: float | None = ...,  # Also write light probes on a grid of this spacing in metres
    layers: Value | None = ...,  # Also write a lightmap of each light (per-light), or of each group of lights whose names differ only by a number at the end (groups)
    light: Value | None = ...,  # The light of the lightmap: all; direct; indirect, reflected at least once; or no-punctual, all but what comes straight from point, spot and directional lights, for engines that add those themselves; all
    shadow_mask: Value | None = ...,  # Also write shadow-mask.png and .exr: how much of up to four point, spot or directional lights each texel sees; auto: the first four
    ambient_occlusion: Value | None = ...,  # Also write ambient-occlusion.png and .exr: the share of directions in which nothing is nearer than this many metres, or inf
    denoise: bool | None = ...,  # Remove the noise of few samples; edges of shadows stay
    stitch: bool | None = ...,  # False: Do not blend charts along seams; True
    attach: Value | None = ...,  # How baked.glb shows the light: lightmap needs a viewer that knows MOZ_lightmap; combined (unlit colour times light) and emissive (emission) show in any; lightmap
    vertex_colors: bool | None = ...,  # baked.glb gets light per vertex in COLOR_0 instead of the lightmap
    texels: bool | None = ...,  # Also write texels.png: how each texel was treated (luxel render --technique texels)
    error_map: bool | None = ...,  # Also write error.png: the relative standard error of each texel (luxel render --technique error)
    formats: Value | None = ...,  # The lightmap as exr (always), hdr, rgbm, rgbe, half and ktx2, with commas between them; exr
    html: bool | None = ...,  # Also write view.html: the baked scene as one page to walk around in
    view: Value | None = ...,  # Where the picture is taken from: inside, outside, the front (looking along -Z), the top, or a camera of the scene; by default its first, else inside of lit rooms and outside of all else
    max_memory: Value | None = ...,  # Memory to stay under, as 900M or 1.5G (default: most of what is free)
    threads: float | None = ...,  # Threads to use; 0 = all cores (0 to 1024)
    smooth_normals: float | None = ...,  # Meshes without normals: smooth across edges that bend by at most this angle, 0: flat; by default 30 for OBJ and PLY, else flat (0 to 180)
    search_path: Values | None = ...,  # A folder besides the scene's own in which pictures and buffers may lie that the scene names; may be given for several
    trust_paths: bool | None = ...,  # Read files that the scene names wherever they lie, outside of its folder too
    background: Value | None = ...,  # Radiance of the surroundings as r,g,b
    sun: Value | None = ...,  # A sun: bearing (0 = -Z, 90 = +X), elevation, illuminance facing it
    environment: Value | None = ...,  # Equirectangular .hdr or .exr of the surroundings, turned and scaled
    sky: Value | None = ...,  # A clear sky with its sun in lux, by the sun's bearing and elevation or by date, time and place (2026-06-21T15:30+02:00,48.85,2.35); turbidity 1 to 10 (2)
    ies: Values | None = ...,  # The distribution of a point or spot light from an IES file; may be given for several
    elements: Value | None = ...,  # Light per vertex or per triangle; vertex
    hemicube: float | None = ...,  # Pixels along an edge of the hemicube's top, even (2 to 2048); 64
    element_size: float | None = ...,  # Size of the first triangles in metres (default: by --max-elements)
    max_elements: float | None = ...,  # Vertices or triangles at most (default: 20000, more for large scenes) (1 to 67108864)
    smooth: bool | None = ...,  # Interpolate light that is per triangle
    patches: float | None = ...,  # Approximate number of patches that exchange light (1 to 1048576); 8192
    rays: float | None = ...,  # Rays per patch that estimate its form factors (1 to 65535); 2048
    eps: float | None = ...,  # How much the light over a link may be off, in W/m^2 on an element of mean size (default: a hundredth of the mean light)
    min_area: float | None = ...,  # Elements are not divided below this, in m^2 (default: by the scene)
    discontinuities: bool | None = ...,  # False: Do not mesh along the edges of shadows; True
    max_leaf_lines: float | None = ...,  # Edges of shadows through an element, at most (0 to 1000); 10
    min_weight: float | None = ...,  # Edges over which light changes by less are left out, in W/m^2 per m; with --ranking nearness in W/m^2 (default: by the light there is)
    ranking: Value | None = ...,  # Which edges of shadows come first: slope, by how much light changes per metre; nearness, by how near to the surface what throws them is; slope
    # end: bake
) -> Bake: ...

class Relit(NamedTuple):
    direct: Floats
    indirect: Floats
    direct_at_places: Floats
    indirect_at_places: Floats

class Relighter:
    def __init__(
        self,
        scene: Scene | Path,
        *,
        progress: Progress | None = ...,
        # begin: relighter
        threads: int | None = ...,  # Threads to use; 0 = all cores; 0
        target: Value | None = ...,  # Where light is wanted: texels of a lightmap, vertices, none; texels
        resolution: float | None = ...,  # Side of the lightmap in texels (1 to 16384); 256
        texels_per_metre: float | None = ...,  # Density; the side becomes the smallest power of two that holds the scene
        uv: Value | None = ...,  # keep = the file's TEXCOORD_1, unwrap = a new layout, auto = keep if it can hold the light; auto
        patches: float | None = ...,  # Approximate number of patches that exchange light (1 to 1048576); 8192
        rays: float | None = ...,  # Rays per patch that estimate its form factors (1 to 65535); 8192
        codec: Value | None = ...,  # How it is kept: hierarchical, lowrank, bc1, dense32, dense16; hierarchical
        max_error: float | None = ...,  # What the codec may lose of indirect light, root mean square; 0.01
        bounces: Value | None = ...,  # Reflections to count, or inf; inf
        max_memory: Value | None = ...,  # Memory to stay under, as 900M or 1.5G (default: most of what is free)
        seed: float | None = ...,  # Seed of all random numbers (>= 0); 1
        smooth_normals: float | None = ...,  # Meshes without normals: smooth across edges that bend by at most this angle, 0: flat; by default 30 for OBJ and PLY, else flat (0 to 180)
        search_path: Values | None = ...,  # A folder besides the scene's own in which pictures and buffers may lie that the scene names; may be given for several
        trust_paths: bool | None = ...,  # Read files that the scene names wherever they lie, outside of its folder too
        background: Value | None = ...,  # Radiance of the surroundings as r,g,b
        sun: Value | None = ...,  # A sun: bearing (0 = -Z, 90 = +X), elevation, illuminance facing it
        environment: Value | None = ...,  # Equirectangular .hdr or .exr of the surroundings, turned and scaled
        sky: Value | None = ...,  # A clear sky with its sun in lux, by the sun's bearing and elevation or by date, time and place (2026-06-21T15:30+02:00,48.85,2.35); turbidity 1 to 10 (2)
        # end: relighter
    ) -> None: ...
    def update(self, lights: Scene, *, emission: npt.ArrayLike | None = ...) -> Relit: ...
    def save(self, path: Path) -> None: ...
    @property
    def materials(self) -> list[str]: ...
    @property
    def positions(self) -> Floats: ...
    @property
    def normals(self) -> Floats: ...
    @property
    def areas(self) -> Floats: ...
    @property
    def reflectance(self) -> Floats: ...
    @property
    def material(self) -> npt.NDArray[np.uint32]: ...
    @property
    def places(self) -> Floats: ...
    @property
    def texels(self) -> npt.NDArray[np.uint16]: ...
    @property
    def codec_error(self) -> float: ...

class ViewFactors(scipy.sparse.csr_matrix):
    names: list[str]
    areas: npt.NDArray[np.float64]
    error: npt.NDArray[np.float64]
    closed: bool

def view_factors(
    scene: Scene | Path, *, method: str = ..., tolerance: float | None = ..., samples: int | None = ...,
    hemicube: int | None = ..., smooth: bool = ..., seed: int = ..., threads: int = ...,
    progress: Progress | None = ...
) -> ViewFactors: ...
def compare(
    a: Bake | Path | npt.ArrayLike, b: Bake | Path | npt.ArrayLike, *, report: Path | None = ...,
    exposure: float | None = ..., progress: Progress | None = ...
) -> dict[str, Any]: ...
