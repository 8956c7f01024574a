#include "luxel/arguments/table_options.h"

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>

namespace luxel::arguments {

bool Given::has(std::string_view flag) const {
  return std::any_of(values.begin(), values.end(),
                     [&](const auto& value) { return value.first == flag; });
}

CLI::Option* add_option(CLI::App& command, const pipeline::OptionText& row, const std::string& help,
                        const std::string& default_text, Given& given) {
  const std::string flag = row.flag;
  CLI::Option* option = nullptr;
  if (row.value.empty()) {
    option = command.add_flag_callback(
        flag, [&given, flag] { given.values.emplace_back(flag, ""); }, help);
  } else {
    const auto take = [&given, flag,
                       is_of_kind = row.is_of_kind](const std::vector<std::string>& texts) {
      for (const std::string& text : texts) {
        if (!is_of_kind(text)) throw CLI::ValidationError(flag, text + " is not a number");
        given.values.emplace_back(flag, text);
      }
    };
    option = command.add_option_function<std::vector<std::string>>(flag, take, help)
                 ->type_name(row.value)
                 ->type_size(1)
                 ->allow_extra_args(false);
    if (!row.repeats) option->expected(1);
    if (!default_text.empty()) option->default_str(default_text);
  }
  if (!row.group.empty()) option->group(row.group);
  return option;
}

std::string help_with(const pipeline::OptionText& row, const std::string& users) {
  std::string note = row.range;
  if (!users.empty()) note += (note.empty() ? "for " : "; for ") + users;
  return note.empty() ? row.help : row.help + " (" + note + ")";
}

void exclude_each_other(CLI::App& command, const pipeline::OptionText& row) {
  for (const std::string& other : row.not_with)
    command.get_option(row.flag)->excludes(command.get_option(other));
}

}  // namespace luxel::arguments
