// `luxel lux SCENE --from BAKE`: illuminance on work planes.
#include "apps/cli/cli.h"
#include "apps/cli/print.h"
#include "luxel/pipeline/command/lux.h"
#include "luxel/scene/origin.h"

namespace luxel::cli {
namespace {

/// Smaller rooms are doorways and niches; --json has them.
constexpr double kSmallRoom_m2 = 1;

struct LuxOptions {
  Common common;
  Given reading, outside;
  double spacing_m = 0;
  CLI::Option* spacing = nullptr;
  pipeline::LuxSettings settings;
};

nlohmann::json json_of(const pipeline::RoomLight& room, DVec3 origin) {
  return {{"points", room.points},
          {"area_m2", room.area_m2},
          {"mean", room.mean},
          {"minimum", room.minimum},
          {"maximum", room.maximum},
          {"uniformity", room.uniformity()},
          {"standard_error_of_mean", room.standard_error},
          {"largest_standard_error", room.largest_error},
          {"minimum_at", point_json(scene::in_world(origin, room.minimum_at))},
          {"maximum_at", point_json(scene::in_world(origin, room.maximum_at))}};
}

nlohmann::json json_of(const pipeline::LuxSettings& s, const pipeline::LuxReport& report) {
  nlohmann::json out{{"unit", report.unit.symbol},  {"unit_known_by", report.unit.reason},
                     {"plane_m", s.plane.plane_m},  {"boundary_m", s.plane.boundary_m},
                     {"rays", report.rays},         {"floors", nlohmann::json::array()},
                     {"warnings", report.warnings}, {"files", nlohmann::json::array()}};
  for (const pipeline::LitFloor& lit : report.floors) {
    const pipeline::Floor& floor = lit.floor;
    nlohmann::json one = json_of(lit.all, report.origin);
    const DVec3 o = report.origin;
    one["y"] = floor.y + o.y;
    one["bounds_xz"] = {{floor.x0 + o.x, floor.z0 + o.z}, {floor.x1 + o.x, floor.z1 + o.z}};
    one["spacing_xz_m"] = {floor.cell_x(), floor.cell_z()};
    one["left_out"] = {{"in_solids", floor.in_solids}, {"in_boundary", floor.in_boundary}};
    for (const pipeline::RoomLight& room : lit.rooms)
      one["rooms"].push_back(json_of(room, report.origin));
    out["floors"].push_back(std::move(one));
  }
  for (const std::filesystem::path& output : s.outputs) out["files"].push_back(output.string());
  return out;
}

void print_room(const std::string& name, const pipeline::RoomLight& room) {
  print_line(stdout, fmt::format("{:10} {:7} {:8.2f} {:10.5g} {:10.5g} {:10.5g} {:8.3f} {:10.2g}",
                                 name, room.points, room.area_m2, room.mean, room.minimum,
                                 room.maximum, room.uniformity(), room.standard_error));
}

void print_floor(size_t number, const pipeline::LuxSettings& s, const pipeline::LitFloor& lit,
                 double origin_y) {
  const pipeline::Floor& floor = lit.floor;
  print_line(stdout, "");
  print_line(
      stdout,
      fmt::format("floor {} at Y = {:.3f} m, plane {:g} m above it, points {:.3g} m by {:.3g} m "
                  "apart; left out: {} in solids, {} within {:g} m of walls",
                  number, floor.y + origin_y, s.plane.plane_m, floor.cell_x(), floor.cell_z(),
                  floor.in_solids, floor.in_boundary, s.plane.boundary_m));
  print_line(stdout, fmt::format("{:10} {:>7} {:>8} {:>10} {:>10} {:>10} {:>8} {:>10}", "",
                                 "points", "m^2", "mean", "minimum", "maximum", "U0", "error"));
  size_t small = 0;
  for (size_t k = 0; k < lit.rooms.size(); ++k)
    if (lit.rooms[k].area_m2 >= kSmallRoom_m2 || lit.rooms.size() == 1)
      print_room(fmt::format("room {}", k + 1), lit.rooms[k]);
    else
      ++small;
  if (lit.rooms.size() > 1) print_room("floor", lit.all);
  if (small > 0)
    print_line(stdout, fmt::format("not listed: {} rooms and doorways below {:g} m^2", small,
                                   kSmallRoom_m2));
}

void print(const pipeline::LuxSettings& s, const pipeline::LuxReport& report) {
  print_line(stdout, fmt::format("unit: {}; {}", report.unit.symbol, report.unit.reason));
  for (size_t f = 0; f < report.floors.size(); ++f)
    print_floor(f + 1, s, report.floors[f], report.origin.y);
  print_own(stdout,
            "\nU0: minimum / mean; error: standard error of the mean due to this command's rays\n");
}

int run_lux(const LuxOptions& options) {
  pipeline::LuxSettings settings = options.settings;
  settings.threads = options.common.threads;
  if (options.spacing->count() > 0) settings.plane.spacing_m = options.spacing_m;
  if (const Status read =
          read_given(options.outside, pipeline::outside_light_options(), settings.outside);
      !read)
    return report(read.error(), options.common);
  if (const Status read = read_given(options.reading, pipeline::import_options(), settings.reading);
      !read)
    return report(read.error(), options.common);
  pipeline::LuxReport lit;
  const Status done = run_with_progress(options.common, [&](Progress& progress) -> Status {
    LUXEL_TRY(lit, pipeline::lux(settings, progress));
    return {};
  });
  if (!done) return report(done.error(), options.common);
  print_warnings(lit.warnings, options.common);
  if (options.common.json)
    print_json(stdout, json_of(settings, lit));
  else
    print(settings, lit);
  for (const std::filesystem::path& output : settings.outputs)
    if (!options.common.quiet) print_line(stderr, "wrote " + output.string());
  return kDone;
}

}  // namespace

void register_lux(CLI::App& app, Action& action) {
  CLI::App* lux = app.add_subcommand(
      "lux", "Compute illuminance on work planes above the floors of a baked scene");
  auto options = std::make_shared<LuxOptions>();
  pipeline::LuxSettings& s = options->settings;
  lux->add_option("SCENE", s.scene, "The scene that was baked")->required();
  lux->add_option("--from", s.from, "Output folder of the bake; its light is used")->required();
  lux->add_option("-o,--output", s.outputs,
                  "File to write: .csv with x, y, z, E, standard error, floor and room of each "
                  "point, or .png with floor plans; repeatable")
      ->allow_extra_args(false);
  lux->add_option("--plane", s.plane.plane_m, "Height of the points above each floor")
      ->type_name("METRES")
      ->capture_default_str();
  options->spacing =
      lux->add_option("--spacing", options->spacing_m,
                      "Largest distance between points (default: as EN 12464-1 requires)")
          ->type_name("METRES");
  lux->add_option("--boundary", s.plane.boundary_m, "Leave out points closer to a wall than this")
      ->type_name("METRES")
      ->capture_default_str();
  lux->add_option("--floor", s.plane.floors,
                  "Height Y of a floor to use; repeatable (default: all floors found)")
      ->type_name("Y")
      ->allow_extra_args(false);
  lux->add_option("--samples", s.samples, "Rays per point")->capture_default_str();
  lux->add_option("--seed", s.seed, "Random seed")->check(whole_number())->capture_default_str();
  add_import(*lux, options->reading);
  add_outside_light(*lux, options->outside);
  add_common(*lux, options->common);
  lux->callback([options, &action] { action = [options] { return run_lux(*options); }; });
}

}  // namespace luxel::cli
