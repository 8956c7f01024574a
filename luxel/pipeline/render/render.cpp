#include "luxel/pipeline/render/render.h"

#include <algorithm>

#include "luxel/base/file.h"
#include "luxel/base/output_folder.h"
#include "luxel/display/contact_sheet.h"
#include "luxel/display/draw.h"
#include "luxel/image/codec.h"
#include "luxel/import/import.h"
#include "luxel/pipeline/bake/baked_folder.h"
#include "luxel/pipeline/bake/camera.h"
#include "luxel/pipeline/render/render_check.h"
#include "luxel/pipeline/render/techniques.h"
#include "luxel/trace/ray_tracer.h"

namespace luxel::pipeline {
namespace {

/// Colours of a screen are shown as they are, light over the shoulder, unless it was said
/// otherwise.
image::Image8 shown(const Technique& technique, const Subject& subject, const RenderSettings& s,
                    float exposure, const image::Image& picture) {
  using display::ToneMap;
  return technique.is_light
             ? display::on_screen(subject.scene, picture, exposure,
                                  s.tone_map.value_or(ToneMap::shoulder))
             : display::tone_map(picture, exposure, s.tone_map.value_or(ToneMap::clamp));
}

/// Lines over a picture, as a screen shows them.
void lay_over(const Subject& subject, std::span<const display::Line> lines, image::Image8& picture,
              Progress& progress) {
  const image::Image drawn = display::draw_lines(subject.scene, subject.tracer, subject.camera,
                                                 picture.width, picture.height, lines, progress);
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const float share = drawn.at(x, y)[3];
      uint8_t* pixel = picture.data.data() + picture.channels * (y * picture.width + x);
      for (int c = 0; c < 3; ++c)
        pixel[c] = uint8_t(float(pixel[c]) * (1 - share) + 255 * drawn.at(x, y)[c] * share + 0.5f);
    }
}

float exposure_for(const Technique& technique, const RenderSettings& s,
                   const image::Image& picture) {
  const Exposure as_it_is{.automatic = false};
  return exposure_factor(s.exposure.value_or(technique.is_light ? Exposure{} : as_it_is), picture);
}

/// True: the picture shows surfaces, and all of them are black.
bool is_black(const image::Image& picture) {
  bool found = false;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      if (picture.at(x, y)[3] < 1) continue;  // the sky shows beside the surface
      if (max_component(picture.rgb(x, y)) > 0) return false;
      found = true;
    }
  return found;
}

/// The bytes of settings.output.
Result<std::vector<std::byte>> one_picture(const Technique& technique, const Subject& subject,
                                           const RenderSettings& s, Rendered& out,
                                           Progress& progress) {
  LUXEL_TRY(const image::Image picture, technique.draw(subject, s, out, progress));
  LUXEL_TRY_STATUS(check_picture(subject.scene, subject.tracer, subject.camera, picture));
  out.width = picture.width, out.height = picture.height;
  if (technique.is_light && is_black(picture))
    out.warnings.push_back(no_light_arrives("every surface in the picture"));
  const std::string extension = s.output.extension().string();
  if (extension == ".exr") return image::encode_exr(picture);
  if (extension == ".hdr") return image::encode_hdr(picture);
  if (technique.show) {
    const image::Image8 values = technique.show(subject, picture);
    out.width = values.width, out.height = values.height;
    return image::encode_png(values);
  }
  out.exposure = exposure_for(technique, s, picture);
  image::Image8 on_screen = shown(technique, subject, s, out.exposure, picture);
  if (!out.overlay.empty()) lay_over(subject, out.overlay, on_screen, progress);
  return image::encode_png(on_screen);
}

/// Pictures of light share the exposure of the first, so that they can be held against each other.
/// A technique that cannot be drawn is left out, and the reason is a warning; but what the user
/// named must be there.
Result<std::vector<std::byte>> contact_sheet(const Subject& subject, const RenderSettings& s,
                                             Rendered& out, Progress& progress) {
  std::vector<display::Tile> tiles;
  std::optional<float> exposure_of_light;
  for (const Technique& technique : techniques()) {
    if (!technique.on_sheet) continue;
    const Result<image::Image> picture = technique.draw(subject, s, out, progress);
    if (!picture) {
      const bool asked_for = technique.needs_bake && !s.from.empty();
      if (asked_for || picture.error().code == ErrorCode::cancelled)
        return Failure{picture.error()};
      out.warnings.push_back(
          fmt::format("{} is left out: {}", technique.name, picture.error().message));
      continue;
    }
    LUXEL_TRY_STATUS(check_picture(subject.scene, subject.tracer, subject.camera, *picture));
    float exposure = exposure_for(technique, s, *picture);
    if (technique.is_light) {
      if (!exposure_of_light) exposure_of_light = exposure;
      exposure = out.exposure = *exposure_of_light;
    }
    out.tiles.emplace_back(technique.name);
    tiles.push_back(
        {std::string(technique.name), shown(technique, subject, s, exposure, *picture)});
  }
  const image::Image8 sheet = display::contact_sheet(tiles);
  out.width = sheet.width, out.height = sheet.height;
  return image::encode_png(sheet);
}

}  // namespace

Result<Rendered> render(const RenderSettings& s, Progress& progress, const BakeDevice* device) {
  LUXEL_TRY_STATUS(check(s));
  const Technique* technique = find_technique(s.technique);  // none: all
  if (device && !device->is_optional && technique && !technique->has_device)
    return fail(ErrorCode::bad_setting,
                "--device is for --technique path and radiosity, not for {}; leave it out",
                s.technique);
  progress.begin("import", 0);
  LUXEL_TRY(import::Imported imported, import::import_scene(s.scene, s.reading));
  Rendered out;
  out.warnings = std::move(imported.warnings);
  const OutsideLight outside = outside_light_of_bake(s.from, s.outside, out.warnings);
  LightUnit unit = unit_of_light(s.scene, imported.scene, outside);
  LUXEL_TRY(const std::vector<std::string> light,
            add_outside_light(outside, imported.scene, imported.about_lost_lights));
  if (is_lit_by_default_day(outside, imported.scene)) unit = unit_of_default_day();
  const bool computes_light = !technique || (technique->is_light && !technique->needs_bake);
  if (computes_light) out.warnings.insert(out.warnings.end(), light.begin(), light.end());
  LUXEL_TRY(const trace::RayTracer tracer, trace::RayTracer::build(imported.scene));
  LUXEL_TRY(const scene::Camera camera,
            choose_camera({.view = s.view,
                           .name = s.camera,
                           .eye = s.eye,
                           .look_at = s.look_at,
                           .fov_deg = s.fov_deg,
                           .aspect = float(s.width) / float(s.height)},
                          imported.scene, tracer, s.scene.string(), &out.warnings));
  const Subject subject{imported.scene, tracer, camera, unit, device};
  LUXEL_TRY(const std::vector<std::byte> bytes,
            technique ? one_picture(*technique, subject, s, out, progress)
                      : contact_sheet(subject, s, out, progress));
  progress.begin(kWriteStage, 0);
  LUXEL_TRY_STATUS(write_file_atomically(s.output, bytes));
  return out;
}

}  // namespace luxel::pipeline
