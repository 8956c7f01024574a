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
    def origin(self) -> npt.NDArray[np.float64]: ...
    @property
    def triangles(self) -> Floats: ...
    @property
    def first_triangle(self) -> npt.NDArray[np.int64]: ...

def load(
    path: Path,
    *,
    # begin: load
    smooth_normals: float | None = ...,  # For meshes without normals: smooth across edges that bend by at most this angle; 0: flat; default: 60 for OBJ, PLY and STL, else flat (0 to 180)
    up: Value | None = ...,  # Axis that points up in a file that does not say (OBJ, PLY, STL, ...); default: y
    unit: Value | None = ...,  # Unit of lengths in a file that does not say (OBJ, PLY, STL, ...); default: m
    search_path: Values | None = ...,  # Also look in this folder for pictures and buffers that the scene names; repeatable
    trust_paths: bool | None = ...,  # Read the files that the scene names even if they lie outside its folder
    any_format: bool | None = ...,  # Also read formats that only Assimp knows (3DS, Blender, IFC, LightWave, ...), in a process of their own
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
    solver: str | None = ...,  # Solver that computes the light; gather
    settings: Value | None = ...,  # Read scene and settings from the bake.json of an earlier bake
    resolution: float | None = ...,  # Lightmap side in texels; default: as fine as the scene needs, up to about 2 million texels (1 to 16384)
    texels_per_metre: float | None = ...,  # Texel density; the lightmap side becomes the smallest power of two that fits the scene
    pages: Value | None = ...,  # Number of lightmaps; auto: as many as the density needs; mesh: one per mesh; 1
    uv: Value | None = ...,  # Lightmap layout: keep (the file's TEXCOORD_1), unwrap (a new layout), or auto (keep if it can hold the light, else unwrap); auto
    leak_repair: bool | None = ...,  # False: Do not cut charts under thin walls or move samples out of solids; True
    quality: Value | None = ...,  # Preset for --samples, --direct-samples, --supersample and --denoise where you do not set them; default: good
    samples: float | None = ...,  # Indirect rays per texel; for gather, the default comes from --quality (1 to 65535); 256
    direct_samples: float | None = ...,  # Shadow rays per texel to area lights; auto: derived from --samples, so that direct light is as accurate as indirect light (1 to 65535); 64
    supersample: float | None = ...,  # Points in each texel across which direct light varies; 1: no supersampling; auto: derived from --samples (1 to 1024); 16
    bounces: Value | None = ...,  # Number of bounces, or inf; inf
    max_error: float | None = ...,  # Add rays until the relative error of the light is below this, e.g. 0.02 (0.0001 to 1)
    error_measure: Value | None = ...,  # What --max-error limits: p95 (the relative error that 95 % of the texels stay below) or rms (the root mean square error of all texels, over their mean light); p95
    time_budget: float | None = ...,  # Time for the whole bake. gather: reach the lowest error in about this many seconds, or stop at --max-error; hierarchical: refine less if time is short; all but gather exit with code 3 when time runs out
    seed: float | None = ...,  # Random seed (>= 0); 1
    directional: Value | None = ...,  # Also write how irradiance changes with the normal, for normal maps: dominant (a direction) or sh1 (spherical harmonics)
    probes: float | None = ...,  # Also write light probes on a grid of this spacing in metres
    layers: Value | None = ...,  # Also write a lightmap for each light (per-light), or for each group of lights whose names differ only in a trailing number (groups)
    light: Value | None = ...,  # Light in the lightmap: all, direct, indirect (bounced at least once), or no-punctual (all but the direct light of point, spot and directional lights, for engines that add it themselves); all
    shadow_mask: Value | None = ...,  # Also write shadow-mask.png and .exr: how much each texel sees of up to four point, spot or directional lights; auto: the first four
    ambient_occlusion: Value | None = ...,  # Also write ambient-occlusion.png and .exr: the share of directions that nothing blocks within this distance in metres, or inf
    denoise: bool | None = ...,  # Denoise the light, and keep shadow edges
    stitch: bool | None = ...,  # False: Do not blend charts along seams; True
    attach: Value | None = ...,  # How baked.glb carries the light: lightmap (for viewers that support MOZ_lightmap), or, for any viewer, combined (unlit colour times light) or emissive (emission); lightmap
    vertex_colors: bool | None = ...,  # Store light per vertex in COLOR_0 of baked.glb instead of the lightmap
    texels: bool | None = ...,  # Also write texels.png: how each texel was treated (luxel render --technique texels)
    error_map: bool | None = ...,  # Also write error.png: the relative standard error of each texel (luxel render --technique error)
    formats: Value | None = ...,  # Lightmap formats, separated by commas: exr (always written), hdr, rgbm, rgbe, half, ktx2; exr
    html: bool | None = ...,  # Also write view.html: a single page to walk through the baked scene
    view: Value | None = ...,  # Viewpoint of the picture: interior, exterior, front (looking along -Z), top, or a camera of the scene; default: its first camera, else interior for lit rooms and exterior for other scenes
    max_memory: Value | None = ...,  # Memory limit, e.g. 900M or 1.5G (default: most of the free memory)
    threads: float | None = ...,  # Number of threads; 0: all cores (0 to 1024)
    smooth_normals: float | None = ...,  # For meshes without normals: smooth across edges that bend by at most this angle; 0: flat; default: 60 for OBJ, PLY and STL, else flat (0 to 180)
    up: Value | None = ...,  # Axis that points up in a file that does not say (OBJ, PLY, STL, ...); default: y
    unit: Value | None = ...,  # Unit of lengths in a file that does not say (OBJ, PLY, STL, ...); default: m
    search_path: Values | None = ...,  # Also look in this folder for pictures and buffers that the scene names; repeatable
    trust_paths: bool | None = ...,  # Read the files that the scene names even if they lie outside its folder
    any_format: bool | None = ...,  # Also read formats that only Assimp knows (3DS, Blender, IFC, LightWave, ...), in a process of their own
    background: Value | None = ...,  # Background radiance as r,g,b
    sun: Value | None = ...,  # Add a sun: azimuth (0 = -Z, 90 = +X), elevation, and illuminance on a surface that faces it
    environment: Value | None = ...,  # Environment map: an equirectangular .hdr or .exr, rotated and scaled
    sky: Value | None = ...,  # Add a clear sky with its sun, in lux, by the sun's azimuth and elevation or by date, time and place (2026-06-21T15:30+02:00,48.85,2.35); turbidity: 1 to 10 (default: 2)
    ies: Values | None = ...,  # Give a point or spot light the distribution in an IES file; repeatable
    elements: Value | None = ...,  # Compute light per vertex or per triangle; vertex
    hemicube: float | None = ...,  # Pixels along an edge of the hemicube's top; an even number (2 to 2048); 64
    element_size: float | None = ...,  # Size of the initial triangles in metres (default: from --max-elements)
    max_elements: float | None = ...,  # Largest number of vertices or triangles (default: 20000, more for large scenes) (1 to 67108864)
    smooth: bool | None = ...,  # Interpolate light computed per triangle
    patches: float | None = ...,  # Approximate number of patches (1 to 1048576); 8192
    rays: float | None = ...,  # Rays per patch to estimate its form factors (1 to 65535); 2048
    eps: float | None = ...,  # Error limit of a link, in W/m^2 on an element of mean size (default: 1 % of the mean light)
    min_area: float | None = ...,  # Do not subdivide elements below this area in m^2 (default: from the scene)
    discontinuities: bool | None = ...,  # False: Do not mesh along shadow edges; True
    max_leaf_lines: float | None = ...,  # Largest number of shadow edges through an element (0 to 1000); 10
    min_weight: float | None = ...,  # Leave out shadow edges across which light changes by less than this, in W/m^2 per m, or in W/m^2 with --ranking nearness (default: from the light in the scene)
    ranking: Value | None = ...,  # How to rank shadow edges: slope (by how much light changes per metre) or nearness (by how close the blocker is to the surface); slope
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
        threads: int | None = ...,  # Number of threads; 0: all cores; 0
        target: Value | None = ...,  # Where to compute light: texels of a lightmap, vertices, or none; texels
        resolution: float | None = ...,  # Lightmap side in texels (1 to 16384); 256
        texels_per_metre: float | None = ...,  # Texel density; the lightmap side becomes the smallest power of two that fits the scene
        uv: Value | None = ...,  # Lightmap layout: keep (the file's TEXCOORD_1), unwrap (a new layout), or auto (keep if it can hold the light, else unwrap); auto
        patches: float | None = ...,  # Approximate number of patches (1 to 1048576); 8192
        rays: float | None = ...,  # Rays per patch to estimate its form factors (1 to 65535); 8192
        codec: Value | None = ...,  # Codec that compresses the matrix: hierarchical, lowrank, bc1, dense32, dense16; hierarchical
        max_error: float | None = ...,  # Largest relative RMS error of indirect light due to the codec; 0.01
        bounces: Value | None = ...,  # Number of bounces, or inf; inf
        max_memory: Value | None = ...,  # Memory limit, e.g. 900M or 1.5G (default: most of the free memory)
        seed: float | None = ...,  # Random seed (>= 0); 1
        smooth_normals: float | None = ...,  # For meshes without normals: smooth across edges that bend by at most this angle; 0: flat; default: 60 for OBJ, PLY and STL, else flat (0 to 180)
        up: Value | None = ...,  # Axis that points up in a file that does not say (OBJ, PLY, STL, ...); default: y
        unit: Value | None = ...,  # Unit of lengths in a file that does not say (OBJ, PLY, STL, ...); default: m
        search_path: Values | None = ...,  # Also look in this folder for pictures and buffers that the scene names; repeatable
        trust_paths: bool | None = ...,  # Read the files that the scene names even if they lie outside its folder
        any_format: bool | None = ...,  # Also read formats that only Assimp knows (3DS, Blender, IFC, LightWave, ...), in a process of their own
        background: Value | None = ...,  # Background radiance as r,g,b
        sun: Value | None = ...,  # Add a sun: azimuth (0 = -Z, 90 = +X), elevation, and illuminance on a surface that faces it
        environment: Value | None = ...,  # Environment map: an equirectangular .hdr or .exr, rotated and scaled
        sky: Value | None = ...,  # Add a clear sky with its sun, in lux, by the sun's azimuth and elevation or by date, time and place (2026-06-21T15:30+02:00,48.85,2.35); turbidity: 1 to 10 (default: 2)
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
