// Guesses at the name that a user meant by one that is not there.
#pragma once

#include <CLI/App.hpp>
#include <span>
#include <string>
#include <string_view>

namespace luxel::arguments {

/// Fewest letters to insert, leave out, replace, or exchange with the next one to make one text of
/// the other: the optimal string alignment distance [Damerau64].
size_t edits_between(std::string_view a, std::string_view b);

/// The name that differs from `word` by the fewest letters, or begins with all of it; the first of
/// several. Empty: none differs by at most a third of the word's letters (at least one), or the
/// word has one letter only.
std::string near_miss(std::string_view word, std::span<const std::string> names);

/// "; did you mean '--output'?" where one of the names is a near miss, or nothing.
std::string did_you_mean(std::string_view word, std::span<const std::string> names);

/// "luxel bake has no option '--ouput'; did you mean '--output'?" of the first argument that looks
/// like an option and is none of `command`; empty: there is no such argument. `program`: how the
/// command is called. Arguments after "--" are no options, and neither are numbers below 0.
std::string about_unknown_option(const CLI::App& command, std::string_view program,
                                 std::span<const std::string> arguments);

}  // namespace luxel::arguments
