// Options and arguments that commands share.
#include <charconv>
#include <cstdio>

#include "apps/cli/cli.h"
#include "luxel/arguments/option_file.h"
#include "luxel/pipeline/settings/bake_settings_options.h"
#include "luxel/pipeline/settings/import_options.h"
#include "luxel/scene/held_range.h"

namespace luxel::cli {
namespace {

/// As the option of `luxel bake` has it, which is a row of a table.
constexpr uint64_t kMostThreads = 1024;

/// main() reads what the file has.
void add_option_file(CLI::App& command, Common& common) {
  const auto check = [](const std::string& text) {
    return is_option_file(text) ? std::string() : text + " is neither a .toml file nor none";
  };
  command
      .add_option("--settings", common.settings,
                  fmt::format("Read options from this file instead of {} beside the scene; none: "
                              "read no file; the command line overrides the file",
                              kOptionFileName))
      ->check(CLI::Validator(check, ""))
      ->type_name("FILE.toml|none");
}

}  // namespace

void add_common(CLI::App& command, Common& common) {
  if (!command.get_option_no_throw("--threads"))
    command.add_option("--threads", common.threads, "Number of threads; 0: all cores")
        ->check(whole_number(kMostThreads))
        ->capture_default_str();
  if (command.get_option_no_throw("SCENE") && !command.get_option_no_throw("--settings"))
    add_option_file(command, common);
  command.add_flag("--quiet", common.quiet, "Print no progress and no warnings");
  command.add_flag("--json", common.json,
                   "Print one JSON object to stdout, and everything else to stderr");
  command.add_flag_callback(
      "--progress-json", [&common] { common.progress_json = common.quiet = true; },
      "Print only progress, warnings and errors to stderr, as JSON with one object per line");
}

CLI::Validator whole_number(uint64_t most) {
  return {[most](const std::string& text) {
            uint64_t value = 0;
            const char* end = text.data() + text.size();
            const auto [stop, error] = std::from_chars(text.data(), end, value);
            if (error == std::errc() && stop == end && value <= most) return std::string();
            return fmt::format("{} is not a whole number from 0 to {}", text, most);
          },
          ""};
}

Result<DVec3> parse_point(const char* option, const std::string& text) {
  DVec3 p;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%lf,%lf,%lf%c", &p.x, &p.y, &p.z, &rest) != 3)
    return fail(ErrorCode::bad_setting, "{} '{}' is not a point; give x,y,z in metres", option,
                text);
  if (scene::is_held(to_float(p))) return p;
  return fail(ErrorCode::bad_setting, "{} '{}' is too far away: coordinates go up to {:g} m",
              option, text, scene::kFarthest_m);
}

std::vector<CLI::Option*> add_import(CLI::App& command, Given& given) {
  return add_options(command, pipeline::import_options(), import::ImportParams{}, given);
}

std::vector<CLI::Option*> add_outside_light(CLI::App& command, Given& given) {
  const auto table = pipeline::outside_light_options();
  const std::vector<CLI::Option*> options =
      add_options(command, table, pipeline::OutsideLight{}, given);
  for (const auto& row : table) exclude_each_other(command, row);
  return options;
}

}  // namespace luxel::cli
