// The table of solvers.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "luxel/pipeline/solver/solver.h"

namespace luxel::pipeline {

/// All of them; the first is the default.
std::span<const Solver> solvers();
/// nullptr when there is no such solver.
const Solver* find_solver(std::string_view name);
/// "gather, ..."
std::string solver_names();

}  // namespace luxel::pipeline
