// Options of a command that come from a table (luxel/pipeline/settings/option.h).
#pragma once

#include <CLI/App.hpp>
#include <string>
#include <utility>
#include <vector>

#include "luxel/pipeline/settings/option.h"

namespace luxel::arguments {

/// Options of a table that the user gave, as text, in any order. They are read when the command
/// runs.
struct Given {
  std::vector<std::pair<std::string, std::string>> values;  ///< flag and text; switches have ""

  bool empty() const { return values.empty(); }
  bool has(std::string_view flag) const;
};

/// Adds one option, and writes to `given` what the user says; `given` outlives the command. `help`
/// is its whole text. A text that is not of the option's kind is wrong usage.
CLI::Option* add_option(CLI::App& command, const pipeline::OptionText& row, const std::string& help,
                        const std::string& default_text, Given& given);

/// "Help (1 to 1024; for gather, matrix)".
std::string help_with(const pipeline::OptionText& row, const std::string& users);

/// All of a table, whose flags are different ones.
template <class S>
std::vector<CLI::Option*> add_options(CLI::App& command, const pipeline::Options<S>& table,
                                      const S& defaults, Given& given,
                                      std::string_view heading = {}) {
  std::vector<CLI::Option*> out;
  for (const pipeline::Option<S>& row : table) {
    out.push_back(add_option(command, row, help_with(row, ""), row.default_text(defaults), given));
    if (!heading.empty()) out.back()->group(std::string(heading));
  }
  return out;
}

/// Reads what was given into settings. Errors (bad_setting): what the rows say.
template <class S>
Status read_given(const Given& given, const pipeline::Options<S>& table, S& settings) {
  for (const auto& [flag, text] : given.values)
    for (const pipeline::Option<S>& row : table)
      if (row.flag == flag) LUXEL_TRY_STATUS(row.read_text(settings, text));
  return {};
}

/// Lets a row's option exclude those of its `not_with`, which the command must have by now.
void exclude_each_other(CLI::App& command, const pipeline::OptionText& row);

}  // namespace luxel::arguments
