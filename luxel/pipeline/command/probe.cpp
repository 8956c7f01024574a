#include "luxel/pipeline/command/probe.h"

#include "luxel/base/output_folder.h"
#include "luxel/base/parallel.h"
#include "luxel/scene/brightness.h"

namespace luxel::pipeline {
namespace {

Status check_method(const ProbeSettings& s) {
  if (s.method == ProbeMethod::hierarchical) {
    if (!s.from.empty())
      return fail(ErrorCode::bad_setting,
                  "--solver hierarchical does not use --from; leave one of them out");
    if (s.in_air)
      return fail(
          ErrorCode::bad_setting,
          "--solver hierarchical computes light on surfaces only; leave out --in-air or --solver");
    return check_all(hierarchical_options(), s.hierarchical);
  }
  if (!s.output.empty())
    return fail(ErrorCode::bad_setting,
                "-o {}: only --solver hierarchical draws what the point sees of each source; add "
                "it, or leave out -o",
                s.output.string());
  return {};
}

Status check_probe(const ProbeSettings& s) {
  if (!s.output.empty() && s.output.extension() != ".png")
    return fail(ErrorCode::bad_setting, "-o {}: the name of the picture must end in .png",
                s.output.string());
  if (s.normal && !(length(*s.normal) > 0))
    return fail(ErrorCode::bad_setting, "--normal 0,0,0 is not a direction");
  if (!(s.max_error > 0 && s.max_error <= 1))
    return fail(
        ErrorCode::bad_setting,
        "--max-error {} is not above 0 and up to 1; give the relative error to reach, as 0.005",
        s.max_error);
  if (!(s.time_budget_s > 0 && s.time_budget_s <= 1e7))
    return fail(ErrorCode::bad_setting, "--time-budget {} is not a time; give seconds, as 10",
                s.time_budget_s);
  LUXEL_TRY_STATUS(check_method(s));
  return s.output.empty() ? Status{} : check_output_file(s.output);
}

}  // namespace

Error far_from_surfaces(const ProbeSettings& s, double diagonal_m, double distance_m) {
  return {ErrorCode::bad_setting,
          fmt::format("--at {},{},{}: no surface{} within {:.3g} m; the nearest is {:.3g} m away",
                      s.at.x, s.at.y, s.at.z, s.normal ? " that faces there" : "",
                      kFarFromSurfaces * diagonal_m, distance_m)};
}

std::string name_of(const scene::Scene& scene, uint32_t instance) {
  const std::string& name = scene.instances[instance].name;
  return name.empty() ? fmt::format("instance {}", instance) : name;
}

Result<scene::Scene> read_probe_scene(const ProbeSettings& s, Probed& out) {
  LUXEL_TRY(import::Imported imported, import::import_scene(s.scene, s.reading));
  out.warnings = std::move(imported.warnings);
  out.unit = unit_of_light(s.scene, imported.scene, s.outside);
  LUXEL_TRY(const std::vector<std::string> light,
            add_outside_light(s.outside, imported.scene, imported.about_lost_lights));
  if (is_lit_by_default_day(s.outside, imported.scene)) out.unit = unit_of_default_day();
  out.warnings.insert(out.warnings.end(), light.begin(), light.end());
  return std::move(imported.scene);
}

Status check_held(const scene::Scene& scene, Vec3 place, const Probed& out) {
  return scene::check_held(scene, {&out.irradiance, 1}, [&](size_t) { return place; });
}

Result<Probed> probe(const ProbeSettings& s, Progress& progress) {
  LUXEL_TRY_STATUS(check_probe(s));
  const ThreadLimit threads(s.threads);
  switch (s.method) {
    case ProbeMethod::paths:
      return probe_by_paths(s, progress);
    case ProbeMethod::bake:
      return probe_in_bake(s, progress);
    case ProbeMethod::hierarchical:
      break;
  }
  return probe_by_faces(s, progress);
}

}  // namespace luxel::pipeline
