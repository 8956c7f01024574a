// Exact solutions by every solver of the pipeline's table.
#include <fmt/format.h>

#include "bench/validation.h"
#include "luxel/base/file.h"
#include "luxel/validate/exact_measure.h"

namespace luxel::bench {
namespace {

std::string signed_percent(double v) { return fmt::format("{:+.3f} %", 100 * v); }

constexpr validate::MeasureEffort kEffort;

Status add_case(const validate::ExactCase& c, std::string_view solver,
                std::vector<std::vector<std::string>>& rows, nlohmann::json& json,
                Progress& progress) {
  LUXEL_TRY(const auto p, validate::prepare(c.scene, c.resolution, progress));
  LUXEL_TRY(const std::vector<validate::Measured> measured,
            validate::measure(*p, c, solver, kEffort, progress));
  for (size_t k = 0; k < c.parts.size(); ++k) {
    const validate::ExactPart& part = c.parts[k];
    const validate::Measured& m = measured[k];
    const double error = m.mean / m.exact - 1;
    rows.push_back(
        {c.section, c.name, part.name, std::string(solver), fmt::format("{:.6g}", m.exact),
         fmt::format("{:.6g}", m.mean), signed_percent(error),
         m.standard_error > 0 ? fmt::format("{:.3f} %", 100 * m.standard_error / m.exact) : "",
         part.pointwise ? fmt::format("{:.2f} %", 100 * m.texel_rms) : "",
         c.slack > 0 ? fmt::format("{:.1e}", c.slack) : ""});
    json.push_back({{"case", c.name},
                    {"part", part.name},
                    {"solver", solver},
                    {"exact", m.exact},
                    {"mean", m.mean},
                    {"standard_error", m.standard_error},
                    {"rms", m.texel_rms}});
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
  // Every case by every solver that can do it.
  LUXEL_TRY(const std::vector<validate::ExactCase> cases, validate::exact_cases(text));
  for (const validate::ExactCase& c : cases)
    for (const pipeline::Solver& solver : pipeline::solvers())
      if (validate::is_ready_for(solver.name, c))
        LUXEL_TRY_STATUS(add_case(c, solver.name, rows, section.json, progress));
  section.markdown = fmt::format(
      "## Solvers against exact solutions\n\n"
      "The table has E [W/m^2] of scenes whose light is known in closed form. Its first column is "
      "the section of `exact-solutions.md`.\n\n"
      "- *mean*: the mean of E over the part's surface, read from the lightmap at {} places.\n"
      "- *error of a texel*: the root mean square of the relative error at the texels, where E is "
      "known pointwise. Where E is below a tenth of its mean, the error is relative to that "
      "tenth.\n"
      "- *model*: the difference between the scene and the scene of the formula (facets of a "
      "sphere).\n\n"
      "gather takes {} rays and {} shadow rays per texel. hemicube takes {} vertices at most (more "
      "where the scene has more) and {} pixels (16 in scenes of many facets). matrix takes about "
      "{} patches. The path tracer (reference) takes {} paths without any other help, so its "
      "texels are noisy. Its mean is that of {} paths from each of {} places over the scene, "
      "without a lightmap. The mean must lie within 4 of the *standard errors* that the path "
      "tracer itself prints. (One of 370 rows exceeds 3 by chance, and there are more than 20.)\n\n"
      "Section 8 and the values of section 6 for one element per face have no rows: they are for "
      "solvers whose form factors are means over areas, and hemicube looks from points. "
      "hierarchical has no rows for spheres yet.\n\n"
      "{}",
      kEffort.lightmap_points, kEffort.rays, kEffort.shadow_rays, kEffort.elements,
      kEffort.hemicube, kEffort.patches, kEffort.paths, kEffort.paths_per_point,
      kEffort.path_points,
      markdown_table({"", "scene", "part", "solver", "exact E", "mean", "error of the mean",
                      "standard error", "error of a texel", "model"},
                     rows));
  return section;
}

}  // namespace luxel::bench
