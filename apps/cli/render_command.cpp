#include <cstdio>
#include <filesystem>

#include "apps/cli/cli.h"
#include "base/parallel.h"
#include "pipeline/render.h"

namespace luxel::cli {
namespace {

struct RenderOptions {
  Common common;
  OutsideText outside;
  std::string size = "960x720", eye, look_at, bounces = "inf";
  pipeline::RenderSettings settings;
};

Result<Vec3> parse_point(const char* option, const std::string& text) {
  Vec3 p;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%f,%f,%f%c", &p.x, &p.y, &p.z, &rest) == 3 && is_finite(p))
    return p;
  return fail(ErrorCode::bad_setting, "{} '{}' is not a point; give x,y,z in metres", option, text);
}

Result<pipeline::RenderSettings> settings_from(const RenderOptions& options) {
  pipeline::RenderSettings s = options.settings;
  char rest = 0;
  if (std::sscanf(options.size.c_str(), "%dx%d%c", &s.width, &s.height, &rest) != 2)
    return fail(ErrorCode::bad_setting, "--size '{}' is not WIDTHxHEIGHT, as in 960x720",
                options.size);
  if (!options.eye.empty()) {
    LUXEL_TRY(s.eye, parse_point("--eye", options.eye));
    LUXEL_TRY(s.look_at, parse_point("--look-at", options.look_at));
  }
  LUXEL_TRY(s.bounces, pipeline::parse_bounces(options.bounces));
  LUXEL_TRY(s.outside, parse_outside_light(options.outside));
  return s;
}

int run_render(const RenderOptions& options) {
  const auto settings = settings_from(options);
  if (!settings) return report(settings.error());
  pipeline::Rendered rendered;
  const Status done = run_with_progress(options.common, [&](Progress& progress) -> Status {
    const ThreadLimit threads(options.common.threads);
    LUXEL_TRY(rendered, pipeline::render(*settings, progress));
    return {};
  });
  if (!done) return report(done.error());
  print_warnings(rendered.warnings, options.common);
  const std::string image = settings->output.string();
  const bool paths = settings->technique == "path";
  if (options.common.json) {
    nlohmann::json json{{"image", image}, {"width", rendered.width}, {"height", rendered.height}};
    if (paths) json["rays"] = rendered.rays, json["relative_error"] = rendered.relative_error;
    std::printf("%s\n", json.dump(2).c_str());
  } else if (!options.common.quiet) {
    if (paths)
      std::fprintf(stderr, "%s\n",
                   fmt::format("{} paths per pixel, {} rays, standard error {:.2f} %",
                               settings->samples, rendered.rays, 100 * rendered.relative_error)
                       .c_str());
    std::fprintf(stderr, "wrote %s\n", image.c_str());
  }
  return kDone;
}

}  // namespace

void register_render(CLI::App& app, Action& action) {
  CLI::App* render =
      app.add_subcommand("render", "Draw a baked scene, or trace its light path by path");
  auto options = std::make_shared<RenderOptions>();
  pipeline::RenderSettings& s = options->settings;
  render->add_option("SCENE", s.scene, "The scene; with --from, the one that was baked")
      ->required();
  render->add_option("-o,--output", s.output, "Picture to write: .png or .exr")->required();
  render->add_option("--from", s.from, "Folder that `luxel bake` left (lightmap)");
  render
      ->add_option("--technique", s.technique,
                   "lightmap = draw a bake, path = trace paths, no bake needed")
      ->check(CLI::IsMember({"lightmap", "path"}))
      ->capture_default_str();
  auto* camera = render->add_option("--camera", s.camera, "Name of a camera of the scene");
  auto* eye = render->add_option("--eye", options->eye, "Where the camera stands")
                  ->type_name("X,Y,Z")
                  ->excludes(camera);
  auto* look_at = render->add_option("--look-at", options->look_at, "The point it looks at")
                      ->type_name("X,Y,Z")
                      ->needs(eye);
  eye->needs(look_at);
  render->add_option("--fov-deg", s.fov_deg, "Vertical field of view")
      ->check(CLI::Range(1.0, 170.0))
      ->capture_default_str();
  render->add_option("--size", options->size, "Size of the picture")
      ->type_name("WxH")
      ->capture_default_str();
  render->add_option("--samples", s.samples, "Paths per pixel (path)")->capture_default_str();
  render->add_option("--bounces", options->bounces, "Reflections to count, or inf (path)")
      ->capture_default_str();
  render->add_option("--seed", s.seed, "Seed of all random numbers (path)")->capture_default_str();
  add_outside_light(*render, options->outside);
  add_common(*render, options->common);
  render->callback([options, &action] { action = [options] { return run_render(*options); }; });
}

}  // namespace luxel::cli
