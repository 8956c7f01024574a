#include "luxel/view/relight/open_lxr.h"

#include "luxel/display/draw.h"
#include "luxel/display/lightmap_lookup.h"
#include "luxel/import/import.h"
#include "luxel/pipeline/bake/camera.h"
#include "luxel/pipeline/render/exposure.h"
#include "luxel/solve/matrix/live_light.h"
#include "luxel/solve/matrix/lxr.h"

namespace luxel::view {
namespace {

/// Small, and enough to see how bright the scene is.
constexpr int kFirstWidth = kLxrWidth / 6, kFirstHeight = kLxrHeight / 6;

Status check_texels(const matrix::RelightData& data, const std::string& name) {
  if (!data.scene_glb.empty() && data.target.kind == matrix::Target::Kind::texels) return {};
  return fail(ErrorCode::bad_input,
              "{}: it was made without texels to light, so there is nothing to draw; make it by "
              "`luxel relight` with --target texels",
              name);
}

/// The exposure that `luxel render` would choose for the first view.
Result<float> first_exposure(const OpenedLxr& opened, const trace::RayTracer& tracer) {
  const std::vector<scene::PunctualLight> lights = shining(opened.lamps);
  const float diagonal_m = scene::world_bounds(opened.scene).diagonal();
  const auto irradiance = [&](const scene::SurfacePoint& p) {
    const Vec3 position = scene::world_position(opened.scene, p);
    const Vec3 normal = scene::shading_normal(opened.scene, p);
    const Vec3 geometric = scene::front_normal(opened.scene, p.instance, p.triangle);
    return display::lightmap_at(opened.scene, opened.light.indirect, p) +
           matrix::live_light_at({{&position, 1}, {&normal, 1}, {&geometric, 1}}, 0, lights, tracer,
                                 diagonal_m);
  };
  display::DrawParams params;
  params.width = kFirstWidth, params.height = kFirstHeight, params.samples_per_axis = 1;
  Progress progress;
  LUXEL_TRY(const image::Image picture,
            display::draw(opened.scene, tracer, opened.first.camera, irradiance, params, progress));
  return pipeline::exposure_factor({}, picture);
}

}  // namespace

Result<std::unique_ptr<OpenedLxr>> open_lxr(const std::filesystem::path& file) {
  const std::string name = file.string();
  LUXEL_TRY(matrix::RelightData data, matrix::read_lxr(file));
  LUXEL_TRY_STATUS(check_texels(data, name));
  LUXEL_TRY(import::Imported imported, import::import_glb(data.scene_glb, name));
  imported.scene.background = data.background;
  Lamps lamps = lamps_of(data);
  LUXEL_TRY(RelitLight light, make_relit_light(std::move(data)));
  std::unique_ptr<OpenedLxr> out(
      new OpenedLxr{std::move(imported.scene), std::move(light), std::move(lamps), {}});
  relight(out->lamps, out->light);
  LUXEL_TRY(const trace::RayTracer tracer, trace::RayTracer::build(out->scene));
  LUXEL_TRY(out->first.camera, pipeline::choose_camera({}, out->scene, tracer, name));
  LUXEL_TRY(out->first.exposure, first_exposure(*out, tracer));
  return out;
}

}  // namespace luxel::view
