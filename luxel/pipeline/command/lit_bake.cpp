#include "luxel/pipeline/command/lit_bake.h"

#include <algorithm>
#include <cmath>

#include "luxel/base/check.h"
#include "luxel/display/lightmap_lookup.h"
#include "luxel/import/import.h"
#include "luxel/light/direct_light.h"
#include "luxel/scene/brightness.h"

namespace luxel::pipeline {
namespace {

/// Boxes of a scene and of its bake differ by no more than rounding, as a part of the diagonal.
constexpr float kSameBox = 1e-3f;
/// Estimates that are worked out at a time: what they need stays below 100 MB.
constexpr size_t kEstimatesAtOnce = 1 << 18;

Status check_same_scene(const LitBake& bake, const std::filesystem::path& scene,
                        const std::filesystem::path& folder) {
  const Box3 own = scene::world_bounds(bake.scene), baked = scene::world_bounds(bake.baked);
  const float allowed = kSameBox * own.diagonal();
  if (length(own.lower - baked.lower) <= allowed && length(own.upper - baked.upper) <= allowed)
    return {};
  return fail(ErrorCode::bad_input,
              "{} is not the scene that was baked to {}: their sizes differ; bake it again",
              scene.string(), folder.string());
}

/// Each place `times` times.
MappedVector<Vec3> repeated(std::span<const Vec3> places, size_t times) {
  MappedVector<Vec3> out;
  out.reserve(places.size() * times);
  for (const Vec3& p : places) out.insert(out.end(), times, p);
  return out;
}

/// The mean of a place's estimates and its standard error.
void sum_up(std::span<const Rgb> estimates, PlacesLight& out) {
  const double n = double(estimates.size());
  std::array<double, 4> sum{}, squares{};
  for (const Rgb& e : estimates) {
    const std::array<double, 4> v{double(e.x), double(e.y), double(e.z), double(luminance(e))};
    for (size_t c = 0; c < 4; ++c) sum[c] += v[c];
  }
  for (const Rgb& e : estimates) {
    const std::array<double, 4> v{double(e.x), double(e.y), double(e.z), double(luminance(e))};
    for (size_t c = 0; c < 4; ++c) squares[c] += std::pow(v[c] - sum[c] / n, 2);
  }
  const auto error = [&](size_t c) { return float(std::sqrt(squares[c] / (n * (n - 1)))); };
  out.irradiance.push_back({float(sum[0] / n), float(sum[1] / n), float(sum[2] / n)});
  out.standard_error.push_back({error(0), error(1), error(2)});
  out.luminance_error.push_back(error(3));
}

/// Appends the light at some places to `out`.
Status add_light(const LitBake& bake, std::span<const Vec3> positions,
                 std::span<const Vec3> normals, const PlacesParams& params, PlacesLight& out,
                 Progress& progress) {
  const size_t times = size_t(params.estimates);
  transport::Elements elements;
  elements.position = repeated(positions, times), elements.normal = repeated(normals, times);
  elements.geometric_normal = elements.normal;
  elements.reflectance.resize(elements.position.size());
  LUXEL_TRY(const light::DirectLight direct,
            light::direct_light(bake.scene, elements, bake.lights, *bake.tracer,
                                {params.direct_samples, params.seed}, progress));
  const light::LitScene lit{bake.baked, *bake.baked_tracer, bake.lights_around,
                            [&](const scene::SurfacePoint& p) { return lightmap_of(bake, p); }};
  const light::AroundParams around{params.samples, params.direct_samples, hash64(params.seed, 1)};
  LUXEL_TRY(const light::Arriving arriving,
            light::arriving_light(lit, elements.position, elements.normal, around, progress));
  out.rays += direct.rays + arriving.rays;
  std::vector<Rgb> estimates(times);
  for (size_t i = 0; i < positions.size(); ++i) {
    Rgb straight{};
    float backs = 0;
    for (size_t k = 0; k < times; ++k) {
      const size_t at = i * times + k;
      estimates[k] = direct.irradiance[at] + arriving.reflected[at] + arriving.sky[at];
      straight += (direct.irradiance[at] + arriving.sky[at]) / float(times);
      backs += arriving.backs[at] / float(times);
    }
    sum_up(estimates, out);
    out.direct.push_back(straight), out.backs.push_back(backs);
  }
  return {};
}

}  // namespace

Result<std::unique_ptr<LitBake>> read_lit_bake(const std::filesystem::path& scene,
                                               const import::ImportParams& reading,
                                               const std::filesystem::path& folder,
                                               const OutsideLight& given) {
  auto bake = std::make_unique<LitBake>();
  LUXEL_TRY(import::Imported imported, import::import_scene(scene, reading));
  bake->scene = std::move(imported.scene), bake->warnings = std::move(imported.warnings);
  LUXEL_TRY_STATUS(check_has_colors(folder));
  LUXEL_TRY_STATUS(check_has_all_light(folder));
  LUXEL_TRY(bake->baked, scene_of_bake(folder, bake->scene.origin));
  LUXEL_TRY(bake->lightmaps, read_pages(folder, bake->baked.materials.size(), read_lightmap));
  LUXEL_TRY_STATUS(check_same_scene(*bake, scene, folder));
  const OutsideLight outside = outside_light_of_bake(folder, given, bake->warnings);
  bake->unit = unit_of_light(scene, bake->scene, outside);
  LUXEL_TRY(const std::vector<std::string> light,
            add_outside_light(outside, bake->scene, imported.about_lost_lights));
  if (is_lit_by_default_day(outside, bake->scene)) bake->unit = unit_of_default_day();
  bake->warnings.insert(bake->warnings.end(), light.begin(), light.end());
  bake->baked.background = bake->scene.background;
  bake->baked.environment = bake->scene.environment;
  LUXEL_TRY(bake->tracer, trace::RayTracer::build(bake->scene));
  LUXEL_TRY(bake->baked_tracer, trace::RayTracer::build(bake->baked));
  bake->lights = light::collect_lights(bake->scene);
  bake->lights_around.around = light::surroundings_of(bake->baked);
  return bake;
}

Rgb lightmap_of(const LitBake& bake, const scene::SurfacePoint& p) {
  return display::lightmap_at(bake.baked, bake.lightmaps.of(bake.baked, p), p);
}

Result<PlacesLight> light_at_places(const LitBake& bake, std::span<const Vec3> positions,
                                    std::span<const Vec3> normals, const PlacesParams& params,
                                    Progress& progress) {
  LUXEL_CHECK(positions.size() == normals.size() && params.estimates >= 2);
  PlacesLight out;
  const size_t at_once = std::max<size_t>(1, kEstimatesAtOnce / size_t(params.estimates));
  for (size_t first = 0; first < positions.size(); first += at_once) {
    const size_t count = std::min(at_once, positions.size() - first);
    PlacesParams some = params;
    some.seed = hash64(params.seed, first);
    LUXEL_TRY_STATUS(add_light(bake, positions.subspan(first, count), normals.subspan(first, count),
                               some, out, progress));
  }
  LUXEL_TRY_STATUS(
      scene::check_held(bake.scene, out.irradiance, [&](size_t i) { return positions[i]; }));
  return out;
}

}  // namespace luxel::pipeline
