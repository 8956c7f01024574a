// A solver as the rest of luxel sees it: a row of the table in solvers.cpp, written in the solver's
// own file in this folder.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/light/texel_scene.h"
#include "luxel/pipeline/settings/option.h"
#include "luxel/pipeline/settings/settings.h"
#include "luxel/pipeline/solver/plan.h"
#include "luxel/pipeline/texels/solve_input.h"

namespace luxel::pipeline {

/// Works out E at the scene's texels. Memory is bounded by settings.max_memory_bytes (memory.h).
/// Errors: cancelled, out of memory or disk, and what the method says.
using SolveFunction = Result<TexelLight> (*)(const light::TexelScene& in,
                                             const BakeSettings& settings,
                                             const SolveStores& stores,
                                             const SolveObserver& observer, Progress& progress);

/// Plans the light by trials of a few texels. Errors: cancelled, memory is too small.
using PlanFunction = Result<Plan> (*)(const light::TexelScene& in, const BakeSettings& settings,
                                      Progress& progress);

/// A note on a shared option that this solver reads in a way of its own.
struct OptionNote {
  std::string_view flag, text;
};

/// The stages of light with what they take of one core in most scenes [s], for as long as no trial
/// tells; none where nobody knows.
using UsualFunction = std::vector<Stage> (*)(const BakeSettings& settings, double texels);

struct Solver {
  std::string_view name;
  Capabilities can{};
  SolveFunction solve = nullptr;
  PlanFunction plan = nullptr;      ///< null: it cannot say what it will take
  UsualFunction usual = nullptr;    ///< null: nobody knows
  Options<BakeSettings> options{};  ///< that no other solver has; options_of_solver() makes them
  std::vector<OptionNote> notes{};
  /// Checks that its options do not contradict each other; null: they cannot. Errors (bad_setting).
  Status (*check)(const BakeSettings& settings) = nullptr;
};

/// The options of a solver whose settings are a T in BakeSettings::own, under a heading of --help.
template <class T>
Options<BakeSettings> options_of_solver(std::string_view solver, std::string_view heading,
                                        const Options<T>& options) {
  Options<BakeSettings> out = options_of_part<BakeSettings, T>(
      options, [](BakeSettings& s) -> T& { return s.own.of<T>(); });
  for (Option<BakeSettings>& option : out) option.solver = solver, option.group = heading;
  return out;
}

}  // namespace luxel::pipeline
