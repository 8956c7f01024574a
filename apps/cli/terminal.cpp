#include "apps/cli/terminal.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>

namespace luxel::cli {
namespace {

std::string_view from_environment(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

}  // namespace

bool rewrites_lines() { return ::isatty(STDERR_FILENO) != 0 && from_environment("TERM") != "dumb"; }

bool has_colours() { return rewrites_lines() && from_environment("NO_COLOR").empty(); }

std::string painted(std::string_view text, Colour colour) {
  return has_colours() ? fmt::format("\033[1;{}m{}\033[0m", int(colour), text) : std::string(text);
}

}  // namespace luxel::cli
