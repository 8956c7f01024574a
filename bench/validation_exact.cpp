// Exact solutions by every solver of the pipeline's table.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/file.h"
#include "base/random.h"
#include "base/warp.h"
#include "bench/exact_cases.h"
#include "bench/prepared.h"
#include "bench/validation.h"
#include "transport/irradiance_field.h"

namespace luxel::bench {
namespace {

struct Measured {
  double exact = 0, mean = 0;  ///< over random points of the part, uniform in area
  double rms = 0;  ///< of the relative error at the texels' samples; pointwise parts only
};

/// Random points of a scene, uniform in area.
std::vector<scene::SurfacePoint> random_points(const scene::Scene& scene, size_t count) {
  std::vector<scene::SurfacePoint> triangles;
  std::vector<double> area_below{0};
  for (uint32_t i = 0; i < scene.instances.size(); ++i)
    for (uint32_t t = 0; t < scene.meshes[scene.instances[i].mesh].triangles.size(); ++t) {
      triangles.push_back({i, t, {}});
      area_below.push_back(area_below.back() +
                           double(scene::area_m2(scene::world_triangle(scene, i, t))));
    }
  RandomStream random{hash64(uint64_t(1))};
  std::vector<scene::SurfacePoint> points;
  for (size_t k = 0; k < count; ++k) {
    // Strata of equal area keep the points' own noise out of the means.
    const double area = (double(k) + double(random.next())) / double(count) * area_below.back();
    const auto found = std::upper_bound(area_below.begin() + 1, area_below.end() - 1, area);
    scene::SurfacePoint p = triangles[size_t(found - area_below.begin()) - 1];
    p.at = triangle_sample(random.next2());
    points.push_back(p);
  }
  return points;
}

Measured measure(const Prepared& p, const ExactPart& part, const pipeline::TexelLight& light,
                 std::span<const scene::SurfacePoint> points) {
  Measured out;
  const transport::TexelField field{&p.atlas, &p.map, light.irradiance};
  double count = 0;
  for (const scene::SurfacePoint& at : points) {
    if (!part.contains(p.scene, at)) continue;
    out.exact += part.irradiance(scene::world_position(p.scene, at));
    out.mean += double(transport::irradiance_at(field, at).x);
    ++count;
  }
  out.exact /= count, out.mean /= count;
  if (!part.pointwise) return out;
  double sum = 0;
  count = 0;
  for (size_t i = 0; i < p.map.texels.size(); ++i) {
    if (!part.contains(p.scene, p.map.texels[i].sample)) continue;
    // Against the mean where the exact value is nearly 0: in an umbra.
    const double exact = part.irradiance(p.elements.position[i]);
    const double d = (double(light.irradiance[i].x) - exact) / std::max(exact, 0.1 * out.exact);
    sum += d * d, ++count;
  }
  out.rms = std::sqrt(sum / count);
  return out;
}

std::string percent(double v) { return fmt::format("{:+.3f} %", 100 * v); }

constexpr int kRays = 1024, kShadowRays = 256, kPaths = 128;
constexpr size_t kPoints = 400000;  ///< their own noise in a mean: 0.1 % near a point light

Status add_case(const ExactCase& c, std::string_view solver,
                std::vector<std::vector<std::string>>& rows, nlohmann::json& json,
                Progress& progress) {
  LUXEL_TRY(const auto p, prepare(c.scene, c.resolution, progress));
  pipeline::BakeSettings settings;
  settings.samples = solver == "reference" ? kPaths : kRays;
  settings.direct_samples = kShadowRays;
  LUXEL_TRY(const Timed solved, solve(*p, solver, settings, progress));
  const auto points = random_points(p->scene, kPoints);
  for (const ExactPart& part : c.parts) {
    const Measured m = measure(*p, part, solved.light, points);
    const double error = m.mean / m.exact - 1;
    rows.push_back({c.section, c.name, part.name, std::string(solver),
                    fmt::format("{:.6g}", m.exact), fmt::format("{:.6g}", m.mean), percent(error),
                    part.pointwise ? fmt::format("{:.2f} %", 100 * m.rms) : "",
                    c.slack > 0 ? fmt::format("{:.1e}", c.slack) : ""});
    json.push_back({{"case", c.name},
                    {"part", part.name},
                    {"solver", solver},
                    {"exact", m.exact},
                    {"mean", m.mean},
                    {"rms", m.rms}});
  }
  return {};
}

}  // namespace

Result<Section> validate_exact_solutions(const std::filesystem::path& shared, Progress& progress) {
  Section section;
  LUXEL_TRY(const std::vector<std::byte> bytes,
            read_file(shared / "reference" / "exact-solutions.md"));
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  std::vector<std::vector<std::string>> rows;
  section.json = nlohmann::json::array();
  for (const ExactCase& c : exact_cases(text))
    for (const pipeline::Solver& solver : pipeline::solvers())
      LUXEL_TRY_STATUS(add_case(c, solver.name, rows, section.json, progress));
  section.markdown = fmt::format(
      "## Solvers against exact solutions\n\n"
      "E [W/m^2] of scenes whose light is known in closed form (`exact-solutions.md`; the number "
      "is "
      "its section). *mean*: of E over the part's surface, read from the lightmap\nat {} places; "
      "*error of a texel*: root mean square of the relative error at the texels themselves, where "
      "E is "
      "known pointwise (where E is below a tenth of its mean,\nrelative to that tenth). *model*: "
      "how "
      "far the scene itself is from the formula's (facets of a sphere). gather takes {} rays and "
      "{} "
      "shadow rays per texel, the path\ntracer (reference) {} paths, without any other help: its "
      "texels are noisy, its means are not. Sections 6 (one element per face) and 8 are about "
      "solvers "
      "with constant\nelements, of which there is none yet.\n\n{}",
      kPoints, kRays, kShadowRays, kPaths,
      markdown_table({"", "scene", "part", "solver", "exact E", "mean", "error of the mean",
                      "error of a texel", "model"},
                     rows));
  return section;
}

}  // namespace luxel::bench
