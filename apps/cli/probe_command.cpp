// `luxel probe SCENE --at x,y,z`: irradiance at a point, and where it comes from.
#include <cstdio>

#include "apps/cli/cli.h"
#include "luxel/pipeline/command/probe.h"

namespace luxel::cli {
namespace {

struct ProbeOptions {
  Common common;
  Given reading, outside, hierarchical;
  std::string at, normal;
  pipeline::ProbeSettings settings;
};

Result<pipeline::ProbeSettings> settings_from(const ProbeOptions& options) {
  pipeline::ProbeSettings s = options.settings;
  s.threads = options.common.threads;
  LUXEL_TRY(s.at, parse_point("--at", options.at));
  if (!options.normal.empty()) {
    LUXEL_TRY(s.normal, parse_point("--normal", options.normal));
  }
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
      {"position", rgb_json(p.position)},
      {"normal", rgb_json(p.normal)},
      {"distance_m", p.distance_m},
      {"irradiance", rgb_json(p.exact)},
      {"irradiance_interpolated", rgb_json(p.interpolated)},
      {"irradiance_of_punctual_lights_and_background", rgb_json(p.punctual_and_background)},
      // The key before; it goes with version 0.2.
      {"irradiance_of_lamps_and_background", rgb_json(p.punctual_and_background)},
      {"sources", nlohmann::json::array()},
      {"warnings", p.warnings}};
  for (const pipeline::ProbedSource& source : p.sources)
    json["sources"].push_back({{"surface", source.name},
                               {"material", source.material},
                               {"form_factor", source.form_factor},
                               {"visible", source.visible},
                               {"irradiance", rgb_json(source.irradiance)}});
  return json;
}

std::string rgb_text(Rgb c) { return fmt::format("{:10.5g} {:10.5g} {:10.5g}", c.x, c.y, c.z); }

void print(const pipeline::Probed& p) {
  std::printf("%s\n",
              fmt::format("on {} ({}) at {:.4f}, {:.4f}, {:.4f}, {:.2g} m from the point", p.name,
                          p.material, p.position.x, p.position.y, p.position.z, p.distance_m)
                  .c_str());
  std::printf("E exact         %s W/m^2\n", rgb_text(p.exact).c_str());
  std::printf("E interpolated  %s\n", rgb_text(p.interpolated).c_str());
  std::printf("lights, sky     %s\n\n", rgb_text(p.punctual_and_background).c_str());
  std::printf("%-28s %9s %9s   %s\n", "source", "factor", "visible", "E");
  for (const pipeline::ProbedSource& source : p.sources)
    std::printf("%s\n",
                fmt::format("{:28.28} {:9.6f} {:7.2f} %  {}", source.name, source.form_factor,
                            100 * source.visible, rgb_text(source.irradiance))
                    .c_str());
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
  if (options.common.json)
    std::printf("%s\n", json_of(probed).dump(2).c_str());
  else
    print(probed);
  return kDone;
}

}  // namespace

void register_probe(CLI::App& app, Action& action) {
  CLI::App* probe =
      app.add_subcommand("probe", "Say how much light arrives at a point, and where it comes from");
  auto options = std::make_shared<ProbeOptions>();
  pipeline::ProbeSettings& s = options->settings;
  probe->add_option("SCENE", s.scene, "glTF, OBJ, FBX, ... file")->required();
  probe->add_option("--at", options->at, "The point; the nearest surface is looked at")
      ->type_name("X,Y,Z")
      ->required();
  probe->add_option("--normal", options->normal, "Only surfaces that face about there")
      ->type_name("X,Y,Z");
  probe->add_option("-o,--output", s.output,
                    "A .png with the brightest sources: what the point sees of them is white");
  add_options(*probe, pipeline::hierarchical_options(), {}, options->hierarchical,
              pipeline::kHierarchicalHeading);
  add_import(*probe, options->reading);
  add_outside_light(*probe, options->outside);
  add_common(*probe, options->common);
  probe->callback([options, &action] { action = [options] { return run_probe(*options); }; });
}

}  // namespace luxel::cli
