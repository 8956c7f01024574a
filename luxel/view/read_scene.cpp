#include "luxel/view/read_scene.h"

#include <tuple>

#include "luxel/pipeline/bake/camera.h"
#include "luxel/pipeline/bake/finish_bake.h"
#include "luxel/view/open_bake.h"

namespace luxel::view {

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
  std::tie(out->width, out->height) = pipeline::preview_size(out->first.camera);
  return out;
}

Result<std::shared_ptr<const ReadScene>> read_scene(scene::Scene scene, const ReadScene& before) {
  auto out = std::make_shared<ReadScene>();
  out->scene = std::move(scene);
  LUXEL_TRY(trace::RayTracer tracer, before.tracer->moved(out->scene));
  out->tracer.emplace(std::move(tracer));
  out->first = before.first, out->light_unit = before.light_unit;
  out->width = before.width, out->height = before.height;
  return out;
}

}  // namespace luxel::view
