#include "luxel/pipeline/render/techniques.h"

#include <algorithm>
#include <array>

#include "luxel/display/local_light.h"
#include "luxel/display/normals_view.h"
#include "luxel/pipeline/render/draw_bake.h"
#include "luxel/pipeline/render/draw_hierarchical.h"
#include "luxel/pipeline/solver/on_device.h"
#include "luxel/reference/path_device.h"

namespace luxel::pipeline {
namespace {

using display::LocalTechnique;

/// Colours of a screen before a background that a screen can show.
display::DrawParams params_for_colors(const RenderSettings& settings) {
  display::DrawParams params;
  params.width = settings.width, params.height = settings.height;
  params.brightest_behind = 1;
  return params;
}

template <LocalTechnique technique>
Result<image::Image> draw_local(const Subject& subject, const RenderSettings& settings, Rendered&,
                                Progress& progress) {
  const display::LocalLights lights = display::local_lights(subject.scene, subject.camera);
  const display::Viewer viewer(subject.camera);
  const auto seen_at = [&](const trace::Hit& hit) {
    return display::local_light_at(subject.scene, hit, technique, lights, viewer);
  };
  return display::draw_seen(subject.scene, subject.tracer, subject.camera, seen_at,
                            params_for_colors(settings), progress);
}

Result<image::Image> draw_normals(const Subject& subject, const RenderSettings& settings, Rendered&,
                                  Progress& progress) {
  return display::draw_normals(subject.scene, subject.tracer, subject.camera,
                               params_for_colors(settings), progress);
}

/// The hemicube solver's own answer, without a lightmap in between.
Result<image::Image> draw_radiosity(const Subject& subject, const RenderSettings& settings,
                                    Rendered& out, Progress& progress) {
  hemicube::HemicubeParams params = settings.hemicube.value_or(hemicube::HemicubeParams{});
  params.bounces = settings.bounces.value_or(params.bounces);
  const light::Lights lights = light::collect_lights(subject.scene);
  const auto solve = [&](const BakeDevice* on) {
    params.device = on ? on->look : nullptr;
    return hemicube::solve(subject.scene, lights, subject.tracer, params, progress);
  };
  LUXEL_TRY(const hemicube::Solution solution, run_on_any(subject.device, solve, out));
  display::DrawParams draw;
  draw.width = settings.width, draw.height = settings.height;
  const auto irradiance = [&](const scene::SurfacePoint& p) {
    return hemicube::irradiance_at(solution.field, p);
  };
  return display::draw(subject.scene, subject.tracer, subject.camera, irradiance, draw, progress);
}

Result<image::Image> draw_paths(const Subject& subject, const RenderSettings& s, Rendered& out,
                                Progress& progress) {
  reference::PathParams params;
  params.samples = s.samples.value_or(kDefaultPathSamples);
  params.bounces = s.bounces.value_or(-1), params.seed = s.seed.value_or(1);
  const auto follow = [&](const BakeDevice* on) {
    return on ? on->paths->radiance(subject.scene, subject.tracer, subject.camera, s.width,
                                    s.height, params, progress)
              : reference::radiance_by_paths(subject.scene, subject.tracer, subject.camera, s.width,
                                             s.height, params, progress);
  };
  LUXEL_TRY(reference::Picture picture, run_on_any(subject.device, follow, out));
  out.rays = picture.rays, out.relative_error = picture.relative_error;
  return std::move(picture.radiance);
}

/// Pictures of one solution: a contact sheet would show six nearly alike.
constexpr Technique hierarchical(std::string_view name, std::string_view help, DrawFunction draw) {
  return {.name = name,
          .help = help,
          .draw = draw,
          .counts_bounces = true,
          .has_links = true,
          .has_lights = true,
          .on_sheet = false};
}

constexpr std::array kTechniques{
    Technique{.name = "c",
              .help = "material colour",
              .draw = draw_local<LocalTechnique::c>,
              .is_light = false},
    Technique{.name = "ca",
              .help = "colour under ambient light",
              .draw = draw_local<LocalTechnique::ca>,
              .is_light = false},
    Technique{.name = "cad",
              .help = "ambient and diffuse light, per vertex",
              .draw = draw_local<LocalTechnique::cad>,
              .is_light = false,
              .has_lights = true},
    Technique{.name = "cas",
              .help = "ambient and specular light, per vertex",
              .draw = draw_local<LocalTechnique::cas>,
              .is_light = false,
              .has_lights = true},
    Technique{.name = "cads",
              .help = "ambient, diffuse and specular light, per vertex",
              .draw = draw_local<LocalTechnique::cads>,
              .is_light = false,
              .has_lights = true},
    Technique{.name = "cas-pixel",
              .help = "cas per pixel",
              .draw = draw_local<LocalTechnique::cas_pixel>,
              .is_light = false,
              .has_lights = true},
    Technique{.name = "cads-pixel",
              .help = "cads per pixel",
              .draw = draw_local<LocalTechnique::cads_pixel>,
              .is_light = false,
              .has_lights = true},
    Technique{.name = "normals",
              .help = "shading normals as red lines",
              .draw = draw_normals,
              .is_light = false},
    Technique{.name = "radiosity",
              .help = "hemicube radiosity",
              .draw = draw_radiosity,
              .counts_bounces = true,
              .has_elements = true,
              .has_lights = true,
              .has_device = true},
    hierarchical("flat", "hierarchical radiosity: one value per element", draw_flat),
    hierarchical("gouraud", "exact light at element corners, interpolated linearly", draw_gouraud),
    hierarchical("gouraud-disc", "as gouraud, but cut along shadow edges", draw_gouraud_disc),
    hierarchical("interpolant", "quadratic light, sampled at pixel centres", draw_interpolant),
    hierarchical("lerpshade", "quadratic light, four rays per pixel", draw_lerpshade),
    hierarchical("rayshade", "exact light at every pixel", draw_rayshade),
    Technique{.name = "lightmap",
              .help = "the lightmap of a bake",
              .draw = draw_lightmap,
              .needs_bake = true},
    Technique{.name = "irradiance",
              .help = "irradiance of a bake as false colours, isolines and a legend, in lux if its "
                      "lights are (.exr: the values)",
              .draw = draw_irradiance_of_bake,
              .is_light = false,
              .needs_bake = true,
              .on_sheet = false,
              .show = show_irradiance},
    Technique{
        .name = "texels",
        .help = "texels of a bake: density, chart borders, moved texels, refilled texels, seams",
        .draw = draw_texels_of_bake,
        .is_light = false,
        .needs_bake = true,
        .bakes_itself = true,
        .on_sheet = false},
    Technique{.name = "error",
              .help = "relative standard error of a bake's texels, from dark (0.1 %) to bright (10 "
                      "% and more)",
              .draw = draw_errors_of_bake,
              .is_light = false,
              .needs_bake = true,
              .bakes_itself = true,
              .on_sheet = false},
    Technique{.name = "path",
              .help = "path tracing",
              .draw = draw_paths,
              .traces_paths = true,
              .counts_bounces = true,
              .has_lights = true,
              .has_device = true},
};

}  // namespace

std::span<const Technique> techniques() { return kTechniques; }

const Technique* find_technique(std::string_view name) {
  const auto found = std::find_if(kTechniques.begin(), kTechniques.end(),
                                  [name](const Technique& t) { return t.name == name; });
  return found == kTechniques.end() ? nullptr : &*found;
}

std::string technique_names() {
  std::string names;
  for (const Technique& technique : kTechniques) names += std::string(technique.name) + ", ";
  return names + std::string(kAllTechniques);
}

}  // namespace luxel::pipeline
