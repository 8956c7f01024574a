// View factors of a scene's surfaces: what `luxel factors` does.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/base/team.h"
#include "luxel/import/import.h"
#include "luxel/viewfactor/factor_matrix.h"

namespace luxel::pipeline {

/// Settings of `luxel factors`; unset values have the defaults named here.
struct FactorSettings {
  std::filesystem::path scene;
  std::filesystem::path output;     ///< a .csv; empty: nothing is written
  std::string method = "analytic";  ///< analytic, hemicube or rays
  std::optional<double> tolerance;  ///< analytic: relative error past blockers; 1e-4
  /// rays: per surface, 262144; hemicube: points per surface, 256
  std::optional<int64_t> samples;
  std::optional<int> hemicube;  ///< hemicube: pixels along an edge of its top, even; 64
  bool smooth = false;
  std::string from, to;  ///< names of surfaces; empty: all
  uint64_t seed = 1;
  uint64_t max_memory_bytes = 0;  ///< of the process; 0: what is free
  import::ImportParams reading;
};

/// The table of view factors, and how good it is.
struct FactorReport {
  viewfactor::FactorMatrix matrix;
  viewfactor::FactorSelection selection;
  viewfactor::FactorChecks
      checks;                ///< of the whole matrix; without meaning when `selection` is not
  double largest_error = 0;  ///< the largest estimated error of a factor
  bool closed = false;       ///< every row sums to 1 as well as the method can tell
  size_t polygons = 0;
  std::optional<double> smoothing;  ///< the largest change of a factor
  std::vector<std::string> warnings;
};

/// Reads, computes, and writes the table. Errors: settings out of range, surfaces that do not
/// exist, no surface with area, tables that do not fit into memory, an output that cannot be
/// written. Members of a team share the work out; all but the first get an empty report.
Result<FactorReport> view_factors(const FactorSettings& settings, Progress& progress,
                                  Team* team = nullptr);

/// view_factors() of a scene that a program has built: settings.scene is only a name for messages.
/// The scene is validated first (luxel/scene/validate.h).
Result<FactorReport> view_factors(scene::Scene scene, const FactorSettings& settings,
                                  Progress& progress);

/// The largest sum of tables that the work holds at once [bytes].
uint64_t factor_table_bytes(size_t surfaces, const FactorSettings& settings);

/// The rows and columns asked for: first row `surface,NAME,NAME,...`, then NAME and the factors to
/// each with 17 significant digits. Names with commas, quotes or line ends are quoted as RFC 4180
/// says.
std::string factors_csv(const viewfactor::FactorMatrix& matrix,
                        const viewfactor::FactorSelection& selection);

}  // namespace luxel::pipeline
