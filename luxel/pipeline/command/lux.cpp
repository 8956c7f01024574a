#include "luxel/pipeline/command/lux.h"

#include <algorithm>
#include <cmath>

#include "luxel/base/file.h"
#include "luxel/base/output_folder.h"
#include "luxel/base/parallel.h"
#include "luxel/pipeline/command/lit_bake.h"
#include "luxel/pipeline/command/lux_plan.h"
#include "luxel/scene/origin.h"

namespace luxel::pipeline {
namespace {

constexpr int kEstimates = 16;
/// Shadow rays are dearer than others, and lights seen whole need few.
constexpr int kRaysPerShadowRay = 4;

Status check_lux(const LuxSettings& s) {
  if (!(s.plane.plane_m > 0 && s.plane.plane_m < 1e4))
    return fail(ErrorCode::bad_setting,
                "--plane {} is not a height above a floor; give metres > 0, as 0.85",
                s.plane.plane_m);
  if (s.plane.spacing_m && !(*s.plane.spacing_m > 0 && std::isfinite(*s.plane.spacing_m)))
    return fail(ErrorCode::bad_setting, "--spacing {} is not a spacing; give metres > 0, as 0.5",
                *s.plane.spacing_m);
  if (!(s.plane.boundary_m >= 0 && std::isfinite(s.plane.boundary_m)))
    return fail(ErrorCode::bad_setting, "--boundary {} is not a width; give metres >= 0, as 0.5",
                s.plane.boundary_m);
  if (s.samples < 2 * kEstimates || s.samples > 1 << 20)
    return fail(ErrorCode::bad_setting, "--samples {} is outside {} to {}", s.samples,
                2 * kEstimates, 1 << 20);
  for (const double floor_m : s.plane.floors)
    if (!std::isfinite(floor_m))
      return fail(ErrorCode::bad_setting, "--floor {} is not a height; give metres", floor_m);
  for (const std::filesystem::path& output : s.outputs)
    if (output.extension() != ".csv" && output.extension() != ".png")
      return fail(ErrorCode::bad_setting, "-o {}: name it .csv for the points, or .png for plans",
                  output.string());
  for (const std::filesystem::path& output : s.outputs) {
    LUXEL_TRY_STATUS(check_output_file(output));
  }
  return {};
}

RoomLight light_of(const LitFloor& lit, std::optional<uint32_t> room) {
  RoomLight out;
  out.minimum = INFINITY;
  double squares = 0;
  for (size_t i = 0; i < lit.floor.points.size(); ++i) {
    const PlanePoint& point = lit.floor.points[i];
    if (room && point.room != *room) continue;
    const double e = double(lit.illuminance[i]), error = double(lit.standard_error[i]);
    ++out.points, out.mean += e, squares += error * error;
    out.largest_error = std::max(out.largest_error, error);
    if (e < out.minimum) out.minimum = e, out.minimum_at = point.position;
    if (out.points == 1 || e > out.maximum) out.maximum = e, out.maximum_at = point.position;
  }
  const double n = double(std::max<size_t>(out.points, 1));
  out.mean /= n, out.standard_error = std::sqrt(squares) / n;
  out.area_m2 = double(out.points) * lit.floor.cell_x() * lit.floor.cell_z();
  return out;
}

Result<LitFloor> light_floor(const LitBake& bake, const LuxSettings& s, Floor floor, uint64_t seed,
                             LuxReport& report, Progress& progress) {
  LitFloor out{std::move(floor), {}, {}, {}, {}};
  std::vector<Vec3> positions;
  for (const PlanePoint& point : out.floor.points) positions.push_back(point.position);
  const std::vector<Vec3> normals(positions.size(), Vec3{0, 1, 0});
  const int per_estimate = s.samples / kEstimates;
  const PlacesParams params{kEstimates, per_estimate, std::max(1, per_estimate / kRaysPerShadowRay),
                            seed};
  LUXEL_TRY(const PlacesLight light, light_at_places(bake, positions, normals, params, progress));
  report.rays += light.rays;
  for (const Rgb& e : light.irradiance) out.illuminance.push_back(luminance(e));
  out.standard_error = light.luminance_error;
  for (uint32_t room = 0; room < out.floor.room_count; ++room)
    out.rooms.push_back(light_of(out, room));
  out.all = light_of(out, std::nullopt);
  return out;
}

}  // namespace

std::string lux_csv(const LuxReport& report) {
  std::string csv = "x,y,z,E,standard_error,floor,room\n";
  for (size_t f = 0; f < report.floors.size(); ++f) {
    const LitFloor& lit = report.floors[f];
    for (size_t i = 0; i < lit.floor.points.size(); ++i) {
      const Vec3 p = lit.floor.points[i].position;
      const DVec3 o = report.origin;
      using scene::short_number;
      csv += fmt::format("{},{},{},{:.6g},{:.3g},{},{}\n", short_number(p.x, o.x),
                         short_number(p.y, o.y), short_number(p.z, o.z), lit.illuminance[i],
                         lit.standard_error[i], f + 1, lit.floor.points[i].room + 1);
    }
  }
  return csv;
}

Result<LuxReport> lux(const LuxSettings& s, Progress& progress) {
  LUXEL_TRY_STATUS(check_lux(s));
  const ThreadLimit threads(s.threads);
  progress.begin("import", 0);
  LUXEL_TRY(const std::unique_ptr<LitBake> bake,
            read_lit_bake(s.scene, s.reading, s.from, s.outside));
  LuxReport report;
  report.warnings = bake->warnings, report.unit = bake->unit;
  report.origin = bake->baked.origin;
  // The bake's scene: surfaces with two sides have both of them there.
  LUXEL_TRY(std::vector<Floor> floors,
            find_work_planes(bake->baked, *bake->baked_tracer, s.plane, progress));
  for (size_t f = 0; f < floors.size(); ++f) {
    if (floors[f].points.empty()) continue;
    LUXEL_TRY(LitFloor lit,
              light_floor(*bake, s, std::move(floors[f]), hash64(s.seed, f), report, progress));
    report.floors.push_back(std::move(lit));
  }
  if (report.floors.empty())
    return fail(
        ErrorCode::bad_input,
        "no point of the work plane is left: all lie inside solids or in the boundary; give "
        "a smaller --boundary or --spacing");
  progress.begin(kWriteStage, 0);
  std::vector<OutputFile> files;
  for (const std::filesystem::path& output : s.outputs)
    files.push_back(output.extension() == ".csv"
                        ? text_file(output, lux_csv(report))
                        : OutputFile{output, image::encode_png(lux_plan(bake->baked, s, report))});
  LUXEL_TRY_STATUS(write_files_atomically(files));
  return report;
}

}  // namespace luxel::pipeline
