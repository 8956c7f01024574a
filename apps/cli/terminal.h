// Abilities of the terminal behind stderr.
#pragma once

#include <string>
#include <string_view>

namespace luxel::cli {

/// True where a line can be written over: stderr is a terminal, and not a dumb one.
bool rewrites_lines();
/// True where such a terminal is to show colours: NO_COLOR (no-color.org) is not set.
bool has_colours();

enum class Colour : int { red = 31, yellow = 33 };
/// The text in bold letters of a colour, where there are colours.
std::string painted(std::string_view text, Colour colour);

}  // namespace luxel::cli
