// `luxel probe SCENE --at x,y,z`: irradiance at a point, and where it comes from.
#include <fmt/format.h>

#include "apps/cli/cli.h"
#include "apps/cli/print.h"
#include "luxel/pipeline/command/probe.h"

namespace luxel::cli {
namespace {

struct ProbeOptions {
  Common common;
  Given reading, outside, hierarchical;
  std::string at, normal, solver = "paths";
  CLI::Option *solver_given = nullptr, *budget_given = nullptr;
  pipeline::ProbeSettings settings;
};

Result<pipeline::ProbeSettings> settings_from(const ProbeOptions& options) {
  pipeline::ProbeSettings s = options.settings;
  s.threads = options.common.threads;
  LUXEL_TRY(s.at, parse_point("--at", options.at));
  if (!options.normal.empty()) {
    LUXEL_TRY(const DVec3 normal, parse_point("--normal", options.normal));
    s.normal = to_float(normal);
  }
  const bool by_faces = options.solver == "hierarchical";
  s.method = by_faces         ? pipeline::ProbeMethod::hierarchical
             : s.from.empty() ? pipeline::ProbeMethod::paths
                              : pipeline::ProbeMethod::bake;
  if (by_faces && options.budget_given->count() == 0)
    s.time_budget_s = pipeline::kUsualSecondsByFaces;
  if (!s.from.empty() && options.solver_given->count() > 0)
    return fail(
        ErrorCode::bad_setting,
        "--from takes the light of a bake, and --solver {} computes it anew; leave one of them out",
        options.solver);
  if (!by_faces && !options.hierarchical.empty())
    return pipeline::not_used(s.from.empty() ? "--solver paths" : "--from",
                              options.hierarchical.values.front().first, "hierarchical");
  LUXEL_TRY_STATUS(
      read_given(options.hierarchical, pipeline::hierarchical_options(), s.hierarchical));
  LUXEL_TRY_STATUS(read_given(options.reading, pipeline::import_options(), s.reading));
  LUXEL_TRY_STATUS(read_given(options.outside, pipeline::outside_light_options(), s.outside));
  return s;
}

nlohmann::json rgb_json(Rgb c) { return {c.x, c.y, c.z}; }

nlohmann::json json_of(const pipeline::Probed& p) {
  nlohmann::json json{
      {"surface", p.name},
      {"material", p.material},
      {"position", point_json(p.position)},
      {"normal", rgb_json(p.normal)},
      {"distance_m", p.distance_m},
      {"irradiance", rgb_json(p.irradiance)},
      {"standard_error", rgb_json(p.standard_error)},
      {"illuminance", luminance(p.irradiance)},
      {"illuminance_standard_error", p.luminance_error},
      {"unit", p.unit.symbol},
      {"unit_known_by", p.unit.reason},
      {"irradiance_of_punctual_lights_and_background", rgb_json(p.punctual_and_background)},
      // The key before; it goes with version 0.2.
      {"irradiance_of_lamps_and_background", rgb_json(p.punctual_and_background)},
      {"sources", nlohmann::json::array()},
      {"warnings", p.warnings}};
  if (p.interpolated) json["irradiance_interpolated"] = rgb_json(*p.interpolated);
  for (const pipeline::ProbedSource& source : p.sources) {
    json["sources"].push_back({{"surface", source.name},
                               {"material", source.material},
                               {"form_factor", source.form_factor},
                               {"irradiance", rgb_json(source.irradiance)}});
    if (source.visible) json["sources"].back()["visible"] = *source.visible;
  }
  return json;
}

std::string rgb_text(Rgb c) { return fmt::format("{:10.5g} {:10.5g} {:10.5g}", c.x, c.y, c.z); }

void print_where(const pipeline::Probed& p) {
  const std::string at =
      fmt::format("{:.4f}, {:.4f}, {:.4f}", p.position.x, p.position.y, p.position.z);
  if (p.name.empty())
    print_line(stdout, fmt::format("in the air at {}, facing {:.3f}, {:.3f}, {:.3f}", at,
                                   p.normal.x, p.normal.y, p.normal.z));
  else
    print_line(stdout, fmt::format("on {} ({}) at {}, {:.2g} m from the point", p.name, p.material,
                                   at, p.distance_m));
}

void print_light(const pipeline::Probed& p, bool by_faces) {
  const float e = luminance(p.irradiance);
  print_line(stdout, fmt::format("{:.5g} {} +- {:.2g} (one standard error)   [{}]", e,
                                 p.unit.symbol, p.luminance_error, p.unit.reason));
  print_line(stdout, fmt::format("{:28}                         {:>10} {:>10} {:>10}", "", "red",
                                 "green", "blue"));
  const auto row = [](const std::string& name, Rgb value) {
    print_line(stdout, fmt::format("{:28}                         {}", name, rgb_text(value)));
  };
  row("E", p.irradiance);
  row("standard error of E", p.standard_error);
  if (p.interpolated) row(by_faces ? "E interpolated" : "E of the lightmap", *p.interpolated);
  row("punctual lights, sky", p.punctual_and_background);
}

void print(const pipeline::Probed& p, bool by_faces) {
  print_where(p);
  print_light(p, by_faces);
  print_line(stdout, "");
  print_line(stdout, fmt::format("{:28} {:>9} {:>11}    E from there", "source", "factor",
                                 by_faces ? "visible" : ""));
  for (const pipeline::ProbedSource& source : p.sources)
    print_line(stdout,
               fmt::format("{:28.28} {:9.6f} {:>11}    {}", source.name, source.form_factor,
                           source.visible ? fmt::format("{:.2f} %", 100 * *source.visible) : "",
                           rgb_text(source.irradiance)));
}

void print_out_of_time(const pipeline::ProbeSettings& s, const pipeline::Probed& p,
                       const Common& common) {
  if (!p.out_of_time || common.quiet) return;
  const float e = luminance(p.irradiance);
  print_line(stderr,
             fmt::format("--time-budget {:g} ran out at a standard error of {:.2g} %, above "
                         "--max-error {:g}; give more time for less noise",
                         s.time_budget_s, e > 0 ? 100 * p.luminance_error / e : 100, s.max_error));
}

int run_probe(const ProbeOptions& options) {
  const auto settings = settings_from(options);
  if (!settings) return report(settings.error(), options.common);
  pipeline::Probed probed;
  const Status done = run_with_progress(options.common, [&](Progress& progress) -> Status {
    LUXEL_TRY(probed, pipeline::probe(*settings, progress));
    return {};
  });
  if (!done) return report(done.error(), options.common);
  print_warnings(probed.warnings, options.common);
  print_out_of_time(*settings, probed, options.common);
  if (options.common.json)
    print_json(stdout, json_of(probed));
  else
    print(probed, settings->method == pipeline::ProbeMethod::hierarchical);
  return kDone;
}

}  // namespace

void register_probe(CLI::App& app, Action& action) {
  CLI::App* probe = app.add_subcommand(
      "probe", "Report how much light arrives at a point and where it comes from");
  auto options = std::make_shared<ProbeOptions>();
  pipeline::ProbeSettings& s = options->settings;
  probe->add_option("SCENE", s.scene, "glTF, OBJ, FBX, ... file")->required();
  probe->add_option("--at", options->at, "Point to probe; luxel takes the nearest surface")
      ->type_name("X,Y,Z")
      ->required();
  probe
      ->add_option("--normal", options->normal, "Consider only surfaces that face roughly this way")
      ->type_name("X,Y,Z");
  probe->add_flag("--in-air", s.in_air,
                  "Probe the point itself, not a surface, facing --normal (default: up)");
  probe->add_option("--from", s.from,
                    "Output folder of a bake: take light from its lightmaps and its sky");
  options->solver_given =
      probe
          ->add_option("--solver", options->solver,
                       "paths: trace paths from the point; hierarchical: solve the scene, then "
                       "compute what the point sees in closed form")
          ->check(CLI::IsMember({"paths", "hierarchical"}))
          ->capture_default_str();
  probe
      ->add_option("--max-error", s.max_error,
                   "Stop at this relative standard error (not for hierarchical)")
      ->type_name("ERROR")
      ->capture_default_str();
  options->budget_given =
      probe
          ->add_option(
              "--time-budget", s.time_budget_s,
              fmt::format("Stop after about this many seconds; hierarchical: stop refining, or "
                          "fail if there is no result by then (default: {:g})",
                          pipeline::kUsualSecondsByFaces))
          ->type_name("SECONDS")
          ->capture_default_str();
  probe->add_option("--seed", s.seed, "Random seed")->check(whole_number())->capture_default_str();
  probe->add_option("-o,--output", s.output,
                    ".png to write: the brightest sources, in white where the point sees them (for "
                    "hierarchical)");
  add_options(*probe, pipeline::hierarchical_options(), {}, options->hierarchical,
              pipeline::kHierarchicalHeading);
  add_import(*probe, options->reading);
  add_outside_light(*probe, options->outside);
  add_common(*probe, options->common);
  probe->callback([options, &action] { action = [options] { return run_probe(*options); }; });
}

}  // namespace luxel::cli
