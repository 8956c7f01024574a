#include "luxel/view/read_scene.h"

#include <tuple>

#include "luxel/pipeline/bake/camera.h"
#include "luxel/pipeline/bake/preview.h"
#include "luxel/view/open_bake.h"

namespace luxel::view {

namespace {

/// That of --sky, or of the day that lights what has no light.
std::optional<SkySun> sky_sun_of(const scene::Scene& scene, const pipeline::OutsideLight& outside) {
  if (!outside.sky && !pipeline::is_lit_by_default_day(outside, scene)) return std::nullopt;
  const pipeline::SkySetting sky = outside.sky.value_or(pipeline::kDefaultSky);
  if (scene.lights.empty()) return std::nullopt;
  // It was added last.
  const auto last = uint32_t(scene.lights.size() - 1);
  const bool is_it =
      scene.lights[last].kind == scene::PunctualLight::Kind::directional &&
      length(scene.lights[last].direction + pipeline::sky_params(sky).towards_sun) < 1e-5f;
  return is_it ? std::optional(SkySun{last, sky}) : std::nullopt;
}

}  // namespace

Result<std::shared_ptr<const ReadScene>> read_scene(scene::Scene scene,
                                                    const pipeline::BakeSettings& settings,
                                                    TracedFor traced) {
  auto out = std::make_shared<ReadScene>();
  out->scene = std::move(scene);
  LUXEL_TRY(trace::RayTracer tracer, traced == TracedFor::edits
                                         ? trace::RayTracer::build_apart(out->scene)
                                         : trace::RayTracer::build(out->scene));
  out->tracer.emplace(std::move(tracer));
  LUXEL_TRY(out->first.camera,
            pipeline::choose_camera({.view = settings.view, .aspect = pipeline::kPreviewAspect},
                                    out->scene, *out->tracer, settings.scene.string()));
  out->light_unit = light_unit_of(out->scene, settings);
  out->sun = sky_sun_of(out->scene, settings.outside);
  std::tie(out->width, out->height) = pipeline::preview_size(out->first.camera);
  return out;
}

Result<std::shared_ptr<const ReadScene>> read_scene(scene::Scene scene, const ReadScene& before) {
  auto out = std::make_shared<ReadScene>();
  out->scene = std::move(scene);
  LUXEL_TRY(trace::RayTracer tracer, before.tracer->moved(out->scene));
  out->tracer.emplace(std::move(tracer));
  out->first = before.first, out->light_unit = before.light_unit, out->sun = before.sun;
  out->width = before.width, out->height = before.height;
  return out;
}

}  // namespace luxel::view
