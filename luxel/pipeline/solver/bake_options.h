// All options of a bake, and what can be done by them.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "luxel/base/result.h"
#include "luxel/pipeline/settings/option.h"
#include "luxel/pipeline/settings/settings.h"
#include "luxel/pipeline/solver/solver.h"

namespace luxel::pipeline {

/// Those that solvers share, then those of each solver. A flag may stand in several rows, of which
/// a solver looks at one.
const Options<BakeSettings>& bake_options();

/// The solver looks at the option.
bool looks_at(const Solver& solver, const Option<BakeSettings>& option);
/// "gather, matrix": the solvers that look at an option, or at any row of a flag; those that can
/// plan with "--plan".
std::string solvers_with(const Option<BakeSettings>& option);
std::string solvers_with(std::string_view flag);
/// The solver's row of this flag. Error (bad_setting): it has none; says who has.
Result<const Option<BakeSettings>*> option_of(const Solver& solver, std::string_view flag);

/// Checks that there is such a solver, that it can do what is asked, and every value. Errors
/// (bad_setting) name the option, the value, and what works.
Status check(const BakeSettings& settings);

/// By each option's key; those of one solver in an object of its name, for that solver only.
nlohmann::json to_json(const BakeSettings& settings);
/// Reads the JSON that to_json() made, or the bake.json that holds it. Keys that are not there keep
/// their value. Errors (bad_setting): a key or value that no option has.
Status read_json(const nlohmann::json& json, BakeSettings& settings);
/// Reads bake.json, or what it holds as settings, from a file. Errors: no such file, no JSON, a
/// key or value that no option has.
Status read_settings(const std::filesystem::path& file, BakeSettings& settings);

/// The settings on which the light of a bake depends besides its scene: those that change any bit
/// of the results, and, for a bake that builds on a kept one, those that change the light.
nlohmann::json settings_of_checkpoint(const BakeSettings& settings);
nlohmann::json settings_of_kept_bake(const BakeSettings& settings);

}  // namespace luxel::pipeline
