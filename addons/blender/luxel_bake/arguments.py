"""The command line of a bake. Knows nothing of Blender."""
import math


def size(settings):
    if settings.size_by == "DENSITY":
        return ["--texels-per-metre", f"{settings.density:g}"]
    return ["--resolution", str(settings.resolution)]


def quality(settings):
    """Only what the solver looks at."""
    if settings.solver == "gather":
        return {"QUALITY": ["--quality", settings.quality], "SAMPLES": ["--samples", str(settings.samples)],
                "ERROR": ["--max-error", f"{settings.max_error:g}"]}[settings.quality_by]
    if settings.solver == "reference":
        return ["--samples", str(settings.samples)]
    return []


def has_layers(settings):
    return settings.solver == "gather" and settings.layers != "none"


def can_denoise(settings):
    return settings.solver in ("gather", "matrix", "reference") and not has_layers(settings)


def bake(settings, scene, folder, light_from_outside):
    """For settings as LuxelSettings has them. `light_from_outside`: what the scene's world became."""
    out = [scene, "-o", folder, "--solver", settings.solver, "--uv", "unwrap", "--settings", "none"]
    out += size(settings) + quality(settings)
    if can_denoise(settings):
        out.append("--denoise" if settings.denoise else "--no-denoise")
    if has_layers(settings):
        out += ["--layers", settings.layers]
    if settings.solver == "gather" and settings.keep:
        out.append("--keep")
    if settings.sky == "SKY":
        azimuth, elevation = math.degrees(settings.sun_azimuth), math.degrees(settings.sun_elevation)
        return out + ["--sky", f"{azimuth % 360:.4f},{elevation:.4f}"]
    return out + light_from_outside
