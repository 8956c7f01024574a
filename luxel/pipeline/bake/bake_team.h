// Bakes that several processes share out among each other while they run: mpirun.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/base/team.h"
#include "luxel/pipeline/settings/settings.h"

namespace luxel::pipeline {

/// Errors (bad_setting): an option or a solver that knows no team. Null: there is none.
Status check_team(const Team* team, const BakeSettings& settings, bool has_device);

/// Errors: members were given other settings than the first one (bad_setting), of those that
/// `identity` has (bake_identity()); another member gives up.
Status check_same_settings(Team* team, const nlohmann::json& identity, Progress& progress);

/// Messages of other members that could not keep finished parts, each with the member's number;
/// `own` is this member's message, or empty. Errors: another member gives up.
Result<std::vector<std::string>> failures_of_others(Team* team, const std::string& own,
                                                    Progress& progress);

/// For bake.json: how many members there are, how often they have given each other something, and
/// how many bytes; null: there is no team.
nlohmann::json about_team(const Team* team);

}  // namespace luxel::pipeline
