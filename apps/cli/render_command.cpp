#include <cstdio>
#include <filesystem>

#include "apps/cli/cli.h"
#include "apps/cli/device_option.h"
#include "apps/cli/print.h"
#include "luxel/base/parallel.h"
#include "luxel/pipeline/render/overlays.h"
#include "luxel/pipeline/render/render.h"
#include "luxel/pipeline/render/techniques.h"
#include "luxel/pipeline/settings/bake_settings_options.h"

namespace luxel::cli {
namespace {

struct RenderOptions {
  Common common;
  Given reading, outside, hemicube, hierarchical;
  std::string size, eye, look_at, bounces, exposure, tone_map, overlay, device = "cpu";
  pipeline::RenderSettings settings;
};

Status parse_size(const RenderOptions& options, pipeline::RenderSettings& s) {
  if (s.technique == pipeline::kAllTechniques) s.width = 320, s.height = 240;
  char rest = 0;
  if (options.size.empty() ||
      std::sscanf(options.size.c_str(), "%dx%d%c", &s.width, &s.height, &rest) == 2)
    return {};
  return fail(ErrorCode::bad_setting, "--size '{}' is not WIDTHxHEIGHT, as in 960x720",
              options.size);
}

Result<display::ToneMap> parse_tone_map(const std::string& name) {
  if (const auto curve = display::find_tone_map(name)) return *curve;
  std::string names;
  for (const auto& known : display::kToneMaps)
    names += (names.empty() ? "" : ", ") + std::string(known.name);
  return fail(ErrorCode::bad_setting, "--tone-map {} is not known; choose from: {}", name, names);
}

Result<pipeline::RenderSettings> settings_from(const RenderOptions& options) {
  pipeline::RenderSettings s = options.settings;
  LUXEL_TRY_STATUS(parse_size(options, s));
  if (!options.eye.empty()) {
    LUXEL_TRY(s.eye, parse_point("--eye", options.eye));
    LUXEL_TRY(s.look_at, parse_point("--look-at", options.look_at));
  }
  if (!options.bounces.empty()) {
    LUXEL_TRY(s.bounces, pipeline::parse_bounces(options.bounces));
  }
  if (!options.exposure.empty()) {
    LUXEL_TRY(s.exposure, pipeline::parse_exposure(options.exposure));
  }
  if (!options.tone_map.empty()) {
    LUXEL_TRY(s.tone_map, parse_tone_map(options.tone_map));
  }
  if (!options.hemicube.empty())
    LUXEL_TRY_STATUS(
        read_given(options.hemicube, pipeline::hemicube_options(), s.hemicube.emplace()));
  if (!options.hierarchical.empty())
    LUXEL_TRY_STATUS(read_given(options.hierarchical, pipeline::hierarchical_options(),
                                s.hierarchical.emplace()));
  LUXEL_TRY(s.overlays, pipeline::parse_overlays(options.overlay));
  LUXEL_TRY_STATUS(read_given(options.reading, pipeline::import_options(), s.reading));
  LUXEL_TRY_STATUS(read_given(options.outside, pipeline::outside_light_options(), s.outside));
  return s;
}

nlohmann::json json_of(const pipeline::RenderSettings& s, const pipeline::Rendered& rendered) {
  nlohmann::json json{{"image", s.output.string()},
                      {"technique", s.technique},
                      {"width", rendered.width},
                      {"height", rendered.height}};
  if (s.output.extension() == ".png") json["exposure"] = rendered.exposure;
  if (!rendered.device.empty()) json["device"] = rendered.device;
  if (rendered.rays > 0)
    json["rays"] = rendered.rays, json["relative_error"] = rendered.relative_error;
  if (!rendered.tiles.empty()) json["tiles"] = rendered.tiles;
  return json;
}

void print_report(const pipeline::RenderSettings& s, const pipeline::Rendered& rendered,
                  const Common& common) {
  if (common.quiet) return;
  if (rendered.rays > 0)
    print_line(stderr, fmt::format("{} paths per pixel, {} rays, standard error {:.2f} %",
                                   s.samples.value_or(pipeline::kDefaultPathSamples), rendered.rays,
                                   100 * rendered.relative_error));
  print_line(stderr, "wrote " + s.output.string());
}

int run_render(const RenderOptions& options) {
  const auto settings = settings_from(options);
  if (!settings) return report(settings.error(), options.common);
  const auto device = open_device(options.device, options.common);
  if (!device) return report(device.error(), options.common);
  const pipeline::BakeDevice* for_render = *device ? &(*device)->for_pipeline : nullptr;
  pipeline::Rendered rendered;
  const Status done = run_with_progress(options.common, [&](Progress& progress) -> Status {
    const ThreadLimit threads(options.common.threads);
    LUXEL_TRY(rendered, pipeline::render(*settings, progress, for_render));
    return {};
  });
  if (!done) return report(done.error(), options.common);
  print_warnings(rendered.warnings, options.common);
  if (options.common.json)
    print_json(stdout, json_of(*settings, rendered));
  else
    print_report(*settings, rendered, options.common);
  return kDone;
}

std::string technique_help() {
  std::string help;
  for (const pipeline::Technique& t : pipeline::techniques())
    help += fmt::format("{} = {}\n", t.name, t.help);
  return help + std::string(pipeline::kAllTechniques) + " = a contact sheet of all of these";
}

std::vector<std::string> technique_names() {
  std::vector<std::string> names;
  for (const pipeline::Technique& t : pipeline::techniques()) names.emplace_back(t.name);
  names.emplace_back(pipeline::kAllTechniques);
  return names;
}

}  // namespace

void register_render(CLI::App& app, Action& action) {
  CLI::App* render = app.add_subcommand(
      "render", "Draw a scene with one technique, or a contact sheet of all of them");
  auto options = std::make_shared<RenderOptions>();
  pipeline::RenderSettings& s = options->settings;
  render->add_option("SCENE", s.scene, "The scene; with --from, the one that was baked")
      ->required();
  render->add_option("-o,--output", s.output, "Picture to write: .png, .exr or .hdr")->required();
  render->add_option("--from", s.from, "Output folder of the bake to draw; its sky is used");
  render->add_option("--technique", s.technique, technique_help())
      ->check(CLI::IsMember(technique_names()))
      ->capture_default_str();
  render
      ->add_option("--exposure", options->exposure,
                   "Exposure: auto, auto:PERCENTILE or stops (default: auto for light, else 0)")
      ->type_name("auto|STOPS");
  render
      ->add_option("--tone-map", options->tone_map,
                   "Tone mapping (default: shoulder for light, else clamp)")
      ->type_name("shoulder|ratio|reinhard|filmic|clamp");
  auto* camera = render->add_option("--camera", s.camera, "Camera of the scene to use, by name");
  auto* view = render->add_option("--view", s.view, std::string(pipeline::kViewHelp))
                   ->type_name("interior|exterior|front|top|CAMERA")
                   ->excludes(camera);
  auto* eye = render->add_option("--eye", options->eye, "Camera position")
                  ->type_name("X,Y,Z")
                  ->excludes(camera)
                  ->excludes(view);
  auto* look_at =
      render->add_option("--look-at", options->look_at, "Point that the camera looks at")
          ->type_name("X,Y,Z")
          ->needs(eye);
  eye->needs(look_at);
  render->add_option("--fov-deg", s.fov_deg, "Vertical field of view (1 to 170)")
      ->needs(eye)
      ->check(CLI::Range(1.0, 170.0).description(""))
      ->type_name("DEG")
      ->capture_default_str();
  render
      ->add_option("--size", options->size,
                   "Picture size (default: 960x720), or tile size with all (default: 320x240)")
      ->type_name("WxH");
  render->add_option("--samples", s.samples, "Paths per pixel (for path; default: 64)");
  render->add_option("--bounces", options->bounces,
                     "Number of bounces, or inf (for path; default: inf)");
  render->add_option("--seed", s.seed, "Random seed (for path; default: 1)")->check(whole_number());
  add_device(*render, options->device, "Where to compute paths (path) or hemicubes (radiosity)");
  add_options(*render, pipeline::hemicube_options(), {}, options->hemicube,
              pipeline::kHemicubeHeading);
  add_options(*render, pipeline::hierarchical_options(), {}, options->hierarchical,
              pipeline::kHierarchicalHeading);
  render
      ->add_option(
          "--overlay", options->overlay,
          "Draw these over pictures of hierarchical radiosity: " + pipeline::overlay_names())
      ->type_name("NAME,NAME,...")
      ->group(std::string(pipeline::kHierarchicalHeading));
  add_import(*render, options->reading);
  add_outside_light(*render, options->outside);
  add_common(*render, options->common);
  render->callback([options, &action] { action = [options] { return run_render(*options); }; });
}

}  // namespace luxel::cli
