// The table of solvers: the only place that names one by string.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/pipeline/settings/settings.h"
#include "luxel/pipeline/texels/solve_input.h"
#include "luxel/solve/hemicube/hemicube.h"
#include "luxel/solve/matrix/matrix.h"

namespace luxel::pipeline {

using SolveFunction = Result<TexelLight> (*)(const SolveInput&, const BakeSettings&, Progress&);

struct Solver {
  std::string_view name;
  SolveFunction solve;
  /// What it looks at of the settings.
  bool samples = false, direct_samples = false, supersample = false, hemicube = false,
       matrix = false, hierarchical = false;
  bool max_error = false;  ///< can be asked for an error, of its mesh or of texels
  bool errors = false;     ///< knows how sure each texel is: --error-map, --time-budget, --plan
  bool noise = false;      ///< knows the variance of its light: --denoise
  bool layers = false;     ///< can tell the light of each lamp apart: --layers
  bool scatters = false;   ///< follows light that surfaces scatter through
  bool parts = false;      ///< keeps its finished parts: --checkpoint, --resume
  bool keeps = false;      ///< leaves what later bakes can build on: --keep
};

/// What a bake's settings ask of the hemicube solver. Shadow rays are four times direct_samples.
hemicube::HemicubeParams hemicube_params(const BakeSettings& settings);

/// What they ask of the matrix solver.
matrix::MatrixParams matrix_params(const BakeSettings& settings);

/// All of them; the first is the default.
std::span<const Solver> solvers();
/// nullptr when there is no such solver.
const Solver* find_solver(std::string_view name);
/// "gather, ..."
std::string solver_names();

}  // namespace luxel::pipeline
