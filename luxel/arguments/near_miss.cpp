#include "luxel/arguments/near_miss.h"

#include <fmt/format.h>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <array>
#include <vector>

namespace luxel::arguments {
namespace {

/// Longer words are no misspelt names, and would take long to look at.
constexpr size_t kLongest = 64;

/// "--samples" of "--samples=64".
std::string name_in(const std::string& argument) { return argument.substr(0, argument.find('=')); }

bool looks_like_an_option(const std::string& argument) {
  if (argument.size() < 2 || argument[0] != '-' || argument == "--") return false;
  const char second = argument[1];
  return second == '-' || (second >= 'a' && second <= 'z') || (second >= 'A' && second <= 'Z');
}

/// "-o" of "-oFOLDER".
bool is_known(const CLI::App& command, const std::string& argument) {
  if (command.get_option_no_throw(name_in(argument))) return true;
  return argument[1] != '-' && command.get_option_no_throw(argument.substr(0, 2));
}

std::vector<std::string> long_names_of(const CLI::App& command) {
  std::vector<std::string> out;
  for (const CLI::Option* option : command.get_options())
    for (const std::string& name : option->get_lnames()) out.push_back("--" + name);
  return out;
}

}  // namespace

size_t edits_between(std::string_view a, std::string_view b) {
  // Rows of the table of distances between beginnings: of two letters ago, of one ago, of now.
  std::array<std::vector<size_t>, 3> rows;
  for (std::vector<size_t>& row : rows) row.resize(b.size() + 1);
  for (size_t j = 0; j <= b.size(); ++j) rows[0][j] = j;
  for (size_t i = 1; i <= a.size(); ++i) {
    std::vector<size_t>& now = rows[i % 3];
    const std::vector<size_t>&before = rows[(i + 2) % 3], &earlier = rows[(i + 1) % 3];
    now[0] = i;
    for (size_t j = 1; j <= b.size(); ++j) {
      const size_t replaced = before[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      now[j] = std::min({before[j] + 1, now[j - 1] + 1, replaced});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        now[j] = std::min(now[j], earlier[j - 2] + 1);
    }
  }
  return rows[a.size() % 3][b.size()];
}

std::string near_miss(std::string_view word, std::span<const std::string> names) {
  const auto letters = [](std::string_view text) {
    return text.substr(std::min(text.find_first_not_of('-'), text.size()));
  };
  const std::string_view meant = letters(word);
  if (meant.size() < 2 || meant.size() > kLongest) return {};
  size_t fewest = std::max<size_t>(1, meant.size() / 3) + 1;
  std::string out;
  for (const std::string& name : names) {
    const std::string_view there = letters(name);
    const bool begins = meant.size() > 2 && there.starts_with(meant);
    const size_t edits = begins ? 1 : edits_between(meant, there);
    if (edits < fewest) fewest = edits, out = name;
  }
  return out;
}

std::string did_you_mean(std::string_view word, std::span<const std::string> names) {
  const std::string meant = near_miss(word, names);
  return meant.empty() ? "" : fmt::format("; did you mean '{}'?", meant);
}

std::string about_unknown_option(const CLI::App& command, std::string_view program,
                                 std::span<const std::string> arguments) {
  for (const std::string& argument : arguments) {
    if (argument == "--") return {};
    if (!looks_like_an_option(argument) || is_known(command, argument)) continue;
    const std::string name = name_in(argument);
    return fmt::format("{} has no option '{}'{}", program, name,
                       did_you_mean(name, long_names_of(command)));
  }
  return {};
}

}  // namespace luxel::arguments
