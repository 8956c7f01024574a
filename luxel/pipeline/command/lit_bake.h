// A scene in the light of a bake: what `luxel probe --from` and `luxel lux` ask.
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/import/import.h"
#include "luxel/light/light_around.h"
#include "luxel/light/lights.h"
#include "luxel/pipeline/bake/baked_folder.h"
#include "luxel/pipeline/settings/light_unit.h"
#include "luxel/trace/ray_tracer.h"

namespace luxel::pipeline {

/// The scene as its file has it, whose lights shine, and as it was baked, whose lightmaps say what
/// its surfaces send on. Not copied nor moved: tracers refer to the scenes.
struct LitBake {
  scene::Scene scene, baked;  ///< both with light from outside
  LightmapPages lightmaps;
  std::optional<trace::RayTracer> tracer, baked_tracer;
  light::Lights lights, lights_around;  ///< the second without lamps: what rays see that leave
  LightUnit unit;
  std::vector<std::string> warnings;

  LitBake() = default;
  LitBake(const LitBake&) = delete;
  LitBake& operator=(const LitBake&) = delete;
};

/// `given` replaces the light from outside that bake.json names. Errors: files, a bake of another
/// scene, a bake without lightmaps.
Result<std::unique_ptr<LitBake>> read_lit_bake(const std::filesystem::path& scene,
                                               const import::ImportParams& reading,
                                               const std::filesystem::path& folder,
                                               const OutsideLight& given);

/// E of a bake's lightmap at a point of its scene.
Rgb lightmap_of(const LitBake& bake, const scene::SurfacePoint& p);

/// Number of estimates of E at a place, and of rays per estimate.
struct PlacesParams {
  int estimates = 16;       ///< independent ones; at least 2
  int samples = 64;         ///< rays of each
  int direct_samples = 16;  ///< shadow rays of each towards area lights and suns
  uint64_t seed = 1;
};

/// E [W/m^2] at places: the mean of the estimates, and how much they scatter.
struct PlacesLight {
  std::vector<Rgb> irradiance;
  std::vector<Rgb> standard_error;     ///< of the mean: their standard deviation / sqrt(estimates)
  std::vector<float> luminance_error;  ///< that of the luminance
  std::vector<Rgb> direct;             ///< the part of E that comes straight from lights
  std::vector<float> backs;            ///< as light::Arriving
  uint64_t rays = 0;
};

/// E at places, on surfaces or in the air, for the normals given: light from lights by shadow rays
/// in the scene, light from surfaces by one gather of rays that end on the bake's lightmaps. The
/// standard error is that of these rays; what the lightmaps are off by comes on top. Spans are of
/// one length. Errors: cancelled.
Result<PlacesLight> light_at_places(const LitBake& bake, std::span<const Vec3> positions,
                                    std::span<const Vec3> normals, const PlacesParams& params,
                                    Progress& progress);

}  // namespace luxel::pipeline
