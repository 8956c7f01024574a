#include "luxel/view/open_bake.h"

#include <nlohmann/json.hpp>

#include "luxel/base/file.h"
#include "luxel/export/view_page.h"
#include "luxel/pipeline/bake/camera.h"
#include "luxel/pipeline/settings/light_unit.h"
#include "luxel/pipeline/settings/outside_light.h"
#include "luxel/pipeline/solver/bake_options.h"
#include "luxel/trace/ray_tracer.h"

namespace luxel::view {
namespace {

/// bake.json, or an empty object where it cannot be read.
nlohmann::json report_of(const std::filesystem::path& folder) {
  const Result<std::vector<std::byte>> bytes = read_file(folder / "bake.json");
  if (!bytes) return nlohmann::json::object();
  const auto* text = reinterpret_cast<const char*>(bytes->data());
  auto report = nlohmann::json::parse(text, text + bytes->size(), nullptr, false);
  return report.is_object() ? std::move(report) : nlohmann::json::object();
}

/// The sky and the background that the bake was made under; its lamps are in the lightmap.
Status add_surroundings(const std::filesystem::path& folder, const nlohmann::json& report,
                        OpenedBake& out) {
  pipeline::OutsideLight outside = pipeline::outside_light_of_bake(folder, {}, out.warnings);
  if (report.value("default_day", nlohmann::json()) == true) outside.sky = pipeline::kDefaultSky;
  // Its warnings were given when the bake was made.
  LUXEL_TRY_STATUS(pipeline::add_outside_light(outside, out.scene));
  return {};
}

/// Those that bake.json has; where it cannot be read, those of baked.glb as it is.
pipeline::BakeSettings settings_of_bake(const std::filesystem::path& folder) {
  pipeline::BakeSettings out;
  if (!pipeline::read_settings(folder / "bake.json", out)) out.scene = "baked.glb";
  return out;
}

}  // namespace

std::string light_unit_of(const scene::Scene& scene, const pipeline::BakeSettings& settings) {
  if (pipeline::is_lit_by_default_day(settings.outside, scene))
    return pipeline::unit_of_default_day().symbol;
  scene::Scene own = scene;
  own.environment = {}, own.background = {};  // those of the settings, which are asked, too
  return pipeline::unit_of_light(settings.scene, own, settings.outside).symbol;
}

Result<OpenedBake> open_bake(const std::filesystem::path& folder,
                             const std::optional<DVec3>& origin) {
  std::error_code ignored;
  if (!std::filesystem::exists(folder, ignored))
    return fail(ErrorCode::bad_input, "there is no scene and no bake named {}", folder.string());
  if (!std::filesystem::exists(folder / "baked.glb", ignored))
    return fail(ErrorCode::bad_input,
                "{} is not a bake: it has no baked.glb; `luxel bake SCENE -o FOLDER` makes one",
                folder.string());
  LUXEL_TRY_STATUS(pipeline::check_has_colors(folder));
  OpenedBake out;
  out.folder = folder;
  LUXEL_TRY(out.scene, pipeline::scene_of_bake(folder, origin));
  LUXEL_TRY(out.lightmaps,
            pipeline::read_pages(folder, out.scene.materials.size(), pipeline::read_lightmap));
  const nlohmann::json report = report_of(folder);
  const auto layers = report.find("layers");
  out.has_layers = layers != report.end() && layers->is_array() && !layers->empty();
  out.light_unit = light_unit_of(out.scene, settings_of_bake(folder));
  LUXEL_TRY_STATUS(add_surroundings(folder, report, out));
  if (const auto preview =
          export_::view_of_json(report.value("preview", nlohmann::json()), out.scene.origin)) {
    out.first.camera = preview->camera, out.first.exposure = preview->exposure;
    out.width = preview->width, out.height = preview->height;
    return out;
  }
  LUXEL_TRY(const trace::RayTracer tracer, trace::RayTracer::build(out.scene));
  pipeline::CameraChoice choice;
  choice.aspect = float(out.width) / float(out.height);
  LUXEL_TRY(out.first.camera, pipeline::choose_camera(choice, out.scene, tracer, folder.string()));
  return out;
}

}  // namespace luxel::view
