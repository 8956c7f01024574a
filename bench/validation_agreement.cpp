// Small scenes by every solver, against the path tracer.
#include <fmt/format.h>

#include "bench/validation.h"
#include "luxel/pipeline/solver/hemicube.h"
#include "luxel/validate/agreement.h"

namespace luxel::bench {

Result<Section> validate_agreement(Progress& progress) {
  Section section;
  section.json = nlohmann::json::array();
  std::vector<std::vector<std::string>> rows;
  constexpr int kPaths = 384, kSamples = 1024, kDirect = 256, kElements = 10000;
  for (validate::AgreementScene& s : validate::agreement_scenes()) {
    // One judge per scene, one row per solver.
    LUXEL_TRY(const auto p, validate::prepare(std::move(s.scene), s.resolution, progress));
    LUXEL_TRY(const validate::Judged judged, validate::judge(*p, kPaths, 1, progress));
    for (const pipeline::Solver& solver : pipeline::solvers()) {
      pipeline::BakeSettings settings;
      settings.samples = solver.name == "reference" ? kPaths : kSamples;
      settings.direct_samples = kDirect;
      settings.seed = 7;
      settings.own.of<hemicube::HemicubeParams>().max_elements = kElements;
      LUXEL_TRY(const validate::Timed solved, validate::solve(*p, solver.name, settings, progress));
      const validate::Agreement a =
          validate::agreement(solved.light.irradiance, solved.light.hidden, judged);
      rows.push_back({s.name, s.shows, std::string(solver.name), std::to_string(a.texels),
                      validate::relative_rmse_text(a),
                      fmt::format("{:+.3f} %", 100 * a.bias_over_mean),
                      fmt::format("{:.1f}", solved.processor_seconds)});
      section.json.push_back({{"scene", s.name},
                              {"solver", solver.name},
                              {"relative_rmse", a.relative_rmse},
                              {"bias_over_mean", a.bias_over_mean},
                              {"processor_seconds", solved.processor_seconds}});
    }
  }
  section.markdown = fmt::format(
      "## Solvers against the path tracer\n\n"
      "The table has small scenes and one row per solver; a new solver gets its rows "
      "automatically. The judge is two independent runs of {} paths per texel, a and b. For the "
      "light g of a solver, the mean of (g - a)(g - b) keeps the solver's own error and drops the "
      "judge's noise. gather: {} rays, {} shadow rays; hemicube: up to {} vertices. The path "
      "tracer's own row is a third run of {} paths; its error is its noise. hemicube, matrix and "
      "hierarchical leave out the colour that glass gives to indirect light (lights.md). This is "
      "their error under \"coloured glass\".\n\n"
      "{}",
      kPaths, kSamples, kDirect, kElements, kPaths,
      markdown_table({"scene", "shows", "solver", "texels", "relative RMSE", "bias", "processor s"},
                     rows));
  return section;
}

}  // namespace luxel::bench
