#include "luxel/view/relight/open_lxr.h"

#include "luxel/display/draw.h"
#include "luxel/display/lightmap_lookup.h"
#include "luxel/import/import.h"
#include "luxel/pipeline/bake/camera.h"
#include "luxel/pipeline/render/exposure.h"
#include "luxel/scene/off_surface.h"
#include "luxel/solve/matrix/live_light.h"
#include "luxel/solve/matrix/lxr.h"

namespace luxel::view {
namespace {

/// The first picture is so many times smaller where it only tells how bright the scene is.
constexpr int kSmaller = 6;

Status check_texels(const matrix::RelightData& data, const std::string& name) {
  if (!data.scene_glb.empty() && data.target.kind == matrix::Target::Kind::texels) return {};
  return fail(ErrorCode::bad_input,
              "{}: it was made without texels to light, so there is nothing to draw; make it by "
              "`luxel relight` with --target texels",
              name);
}

/// The exposure that `luxel render` would choose for the first view.
Result<float> first_exposure(const ReadScene& read, const Lamps& lamps,
                             const image::Image& indirect) {
  const std::vector<scene::PunctualLight> lights = shining(lamps);
  const auto irradiance = [&](const scene::SurfacePoint& p) {
    const Vec3 normal = scene::shading_normal(read.scene, p);
    const Vec3 geometric = scene::front_normal(read.scene, p.instance, p.triangle);
    const Vec3 position = scene::off_surface(read.scene, p, geometric);
    return display::lightmap_at(read.scene, indirect, p) +
           matrix::live_light_at({{&position, 1}, {&normal, 1}, {&geometric, 1}}, 0, lights,
                                 *read.tracer);
  };
  display::DrawParams params;
  params.width = read.width / kSmaller, params.height = read.height / kSmaller;
  params.samples_per_axis = 1;
  Progress progress;
  LUXEL_TRY(const image::Image picture, display::draw(read.scene, *read.tracer, read.first.camera,
                                                      irradiance, params, progress));
  return pipeline::exposure_factor({}, picture);
}

}  // namespace

bool is_lxr(const std::filesystem::path& file) { return file.extension() == ".lxr"; }

Result<OpenedLxr> open_lxr(const std::filesystem::path& file) {
  LUXEL_TRY(matrix::RelightData data, matrix::read_lxr(file));
  return opened_lxr(std::move(data), file, nullptr);
}

Result<OpenedLxr> opened_lxr(matrix::RelightData data, const std::filesystem::path& file,
                             const ReadScene* before) {
  const std::string name = file.string();
  LUXEL_TRY_STATUS(check_texels(data, name));
  LUXEL_TRY(import::Imported imported,
            import::import_glb(data.scene_glb, name, {.origin = DVec3{}}));
  auto read = std::make_shared<ReadScene>();
  read->scene = std::move(imported.scene);
  read->scene.background = data.background, read->scene.origin = data.origin;
  Lamps lamps = lamps_of(data);
  LUXEL_TRY(RelitLight light, make_relit_light(std::move(data)));
  relight(lamps, light);
  LUXEL_TRY(read->tracer, trace::RayTracer::build(read->scene));
  if (before) {
    read->first.camera = before->first.camera, read->light_unit = before->light_unit;
    read->width = before->width, read->height = before->height;
  } else {
    LUXEL_TRY(read->first.camera, pipeline::choose_camera({}, read->scene, *read->tracer, name));
  }
  LUXEL_TRY(read->first.exposure, first_exposure(*read, lamps, light.indirect));
  return OpenedLxr{file, std::move(read), std::move(light), std::move(lamps)};
}

}  // namespace luxel::view
