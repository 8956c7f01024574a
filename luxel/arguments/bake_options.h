// The options of a bake on a command line, for every program that bakes.
#pragma once

#include <CLI/App.hpp>
#include <filesystem>
#include <string>

#include "luxel/arguments/table_options.h"
#include "luxel/base/result.h"
#include "luxel/pipeline/settings/settings.h"

namespace luxel::arguments {

/// The user's choices for a bake.
struct BakeChoice {
  std::filesystem::path scene, output, settings;
  std::string solver;
  bool plan = false;
  Given given;
};

/// --settings and --solver. Returns the first. `choice` outlives the command, here and below.
CLI::Option* add_bake_settings(CLI::App& command, BakeChoice& choice);

/// Every flag of the table once, under its first row's heading.
void add_bake_table(CLI::App& command, Given& given);

/// From the file of --settings, if there is one, and then from the command line. What a solver
/// would not look at must not be given: its user expects something of it. Errors (bad_setting).
Result<pipeline::BakeSettings> settings_of(const BakeChoice& choice);

}  // namespace luxel::arguments
