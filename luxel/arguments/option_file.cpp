#include "luxel/arguments/option_file.h"

#include <toml++/toml.h>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <array>

#include "luxel/arguments/near_miss.h"
#include "luxel/base/file.h"
#include "luxel/base/real_path.h"
#include "luxel/pipeline/settings/outside_light.h"
#include "luxel/pipeline/solver/bake_options.h"
#include "luxel/pipeline/solver/solvers.h"

namespace luxel::arguments {
namespace {

namespace fs = std::filesystem;

/// The command line alone says which results there are, where they go and what they start from.
constexpr std::array<std::string_view, 14> kNotForFiles{
    "help", "output", "settings", "json", "progress-json", "quiet",  "from",
    "play", "script", "report",   "plan", "part",          "resume", "devices"};
/// Options that a stranger's file may not set: trust, and use of this machine.
constexpr std::array<std::string_view, 6> kOnlyWhenNamed{
    "trust-paths", "any-format", "max-memory", "threads", "processes-per-node", "device"};
/// If the command line gives the first, the file's second is left out.
struct Rival {
  std::string_view given, left_out;
};
constexpr auto kRivals = std::to_array<Rival>({
    {"--resolution", "--texels-per-metre"},
    {"--texels-per-metre", "--resolution"},
    {"--quality", "--samples"},
    {"--quality", "--direct-samples"},
    {"--quality", "--supersample"},
    {"--quality", "--denoise"},
    {"--quality", "--no-denoise"},
    {"--resume", "--keep"},
    {"--time-budget", "--keep"},
    {"--part", "--keep"},
    {"--keep", "--time-budget"},
    {"--part", "--time-budget"},
    {"--vertex-colors", "--attach"},
    {"--layers", "--light"},
    {"--light", "--layers"},
    {"--view", "--look-at"},
    {"--view", "--fov-deg"},
    {"--camera", "--look-at"},
    {"--camera", "--fov-deg"},
});
/// A file of options has some lines.
constexpr uintmax_t kMostBytes = 1 << 20;

template <class Names>
bool is_among(const Names& names, std::string_view name) {
  return std::ranges::find(names, name) != names.end();
}

struct Reader {
  const OptionFile& file;
  const CLI::App& command;
  std::string_view table;

  template <class... Args>
  Failure wrong(const toml::node& node, fmt::format_string<Args...> text, Args&&... args) const {
    return fail(ErrorCode::bad_setting, "{}, line {}: {}", file.path.string(),
                node.source().begin.line, fmt::format(text, std::forward<Args>(args)...));
  }
};

std::string flag_of(std::string_view key) {
  std::string out = "--" + std::string(key);
  std::ranges::replace(out, '_', '-');
  return out;
}

std::vector<std::string> keys_of(const CLI::App& command) {
  std::vector<std::string> out;
  for (const CLI::Option* option : command.get_options())
    for (const std::string& name : option->get_lnames())
      if (!is_among(kNotForFiles, name)) out.push_back(name);
  return out;
}

bool is_given(const CLI::App& command, std::string_view flag) {
  const CLI::Option* option = command.get_option_no_throw(std::string(flag));
  return option && option->count() > 0;
}

/// The command was given this option, or one that contradicts it.
bool gives_way(const CLI::App& command, const CLI::Option& option) {
  if (option.count() > 0) return true;
  for (const CLI::Option* other : option.get_excludes())
    if (other->count() > 0) return true;
  return std::ranges::any_of(kRivals, [&](const Rival& rival) {
    return option.check_name(std::string(rival.left_out)) && is_given(command, rival.given);
  });
}

/// False: the command line names a solver that does not look at this option of bakes.
bool is_looked_at(const CLI::App& command, std::string_view flag) {
  if (!is_given(command, "--solver")) return true;
  const pipeline::Solver* solver =
      pipeline::find_solver(command.get_option("--solver")->results().back());
  const bool is_of_bakes = std::ranges::any_of(pipeline::bake_options(),
                                               [&](const auto& row) { return row.flag == flag; });
  return !solver || !is_of_bakes || pipeline::option_of(*solver, flag);
}

/// A path of the file as the command gets it: what was looked at here is what is opened then.
Result<std::string> located(const Reader& in, const toml::node& node, const fs::path& stated) {
  const fs::path folder = in.file.path.parent_path();
  if (in.file.is_named) return (folder / stated).string();
  const fs::path real = real_path(folder / stated);
  if (real.empty()) return in.wrong(node, "{} does not exist", (folder / stated).string());
  if (real != real_path(folder) && !lies_below(real, folder))
    return in.wrong(node,
                    "{} lies outside this file's folder; copy it there, or give --settings {}",
                    stated.string(), in.file.path.string());
  return real.string();
}

/// The text of an option with its path from the file's folder on.
Result<std::string> with_located_path(const Reader& in, const toml::node& node,
                                      std::string_view flag, std::string text) {
  if (flag == "--search-path") return located(in, node, text);
  if (flag == "--environment") {
    LUXEL_TRY(const auto environment, pipeline::parse_environment(text));
    LUXEL_TRY(const std::string path, located(in, node, environment.file));
    return path + text.substr(environment.file.string().size());
  }
  if (flag == "--ies") {
    LUXEL_TRY(const auto ies, pipeline::parse_ies_setting(text));
    LUXEL_TRY(const std::string path, located(in, node, ies.file));
    return ies.light + "=" + path + text.substr(ies.light.size() + 1 + ies.file.string().size());
  }
  return text;
}

/// Strings, numbers and lists of those as the command line has them.
Result<std::string> text_of(const Reader& in, std::string_view key, const toml::node& node) {
  if (const auto* text = node.as_string()) {
    if (text->get().empty()) return in.wrong(node, "{} is empty", key);
    return text->get();
  }
  if (const auto* number = node.as_integer()) return fmt::format("{}", number->get());
  if (const auto* number = node.as_floating_point()) return fmt::format("{}", number->get());
  if (const auto* list = node.as_array(); list && !list->empty()) {
    std::string out;
    for (const toml::node& one : *list) {
      if (one.is_array()) return in.wrong(one, "{} has a list within a list", key);
      LUXEL_TRY(const std::string text, text_of(in, key, one));
      out += (out.empty() ? "" : ",") + text;
    }
    return out;
  }
  return in.wrong(node, "{} must be a text in quotes, a number, or a list of those", key);
}

/// A switch that is on, or off by the option that turns it off; nothing where it is as it is.
Result<std::vector<std::string>> read_switch(const Reader& in, std::string_view key,
                                             const toml::node& node, const CLI::Option* option) {
  const auto* is_on = node.as_boolean();
  if (!is_on) return in.wrong(node, "{} must be true or false", key);
  if (option && is_on->get()) return std::vector<std::string>{flag_of(key)};
  const std::string off = flag_of("no-" + std::string(key));
  if (is_on->get() || !in.command.get_option_no_throw(off)) return std::vector<std::string>{};
  return std::vector<std::string>{off};
}

Result<std::vector<std::string>> read_option(const Reader& in, std::string_view key,
                                             const toml::node& node) {
  const std::string flag = flag_of(key), name = flag.substr(2);
  const CLI::Option* option = in.command.get_option_no_throw(flag);
  const CLI::Option* off = in.command.get_option_no_throw("--no-" + name);
  if (!in.file.is_named && is_among(kOnlyWhenNamed, name))
    return in.wrong(node, "{} belongs on the command line, or in a file given by --settings", key);
  if (is_among(kNotForFiles, name)) return in.wrong(node, "{} belongs on the command line", key);
  if (!option && !off)
    return in.wrong(node, "luxel {} has no option '{}'{}", in.table, key,
                    did_you_mean(name, keys_of(in.command)));
  if (gives_way(in.command, option ? *option : *off) ||
      !is_looked_at(in.command, option ? flag : "--no-" + name))
    return std::vector<std::string>{};
  // A switch, by itself or by the one that turns it off.
  if (!option || option->get_items_expected_max() == 0) return read_switch(in, key, node, option);
  std::vector<std::string> out;
  const toml::array* list = node.as_array();
  const bool repeats = list && option->get_items_expected_max() > 1;
  for (size_t k = 0; k < (repeats ? list->size() : 1); ++k) {
    const toml::node& one = repeats ? *list->get(k) : node;
    LUXEL_TRY(std::string text, text_of(in, key, one));
    LUXEL_TRY(text, with_located_path(in, one, flag, std::move(text)));
    out.push_back(flag + "=" + text);
  }
  return out;
}

/// The solver by the command line, by the file, or by default.
std::string solver_of(const CLI::App& command, const toml::table& options) {
  const CLI::Option* given = command.get_option_no_throw("--solver");
  if (given && given->count() > 0) return given->results().back();
  return options["solver"].value_or(given ? given->get_default_str() : std::string());
}

Status read_table(const Reader& in, const toml::table& options, const std::string& solver,
                  std::vector<std::string>& out) {
  for (const auto& [key, node] : options) {
    const toml::table* inner = node.as_table();
    const bool of_solver = inner && pipeline::find_solver(key.str());
    if (of_solver && !in.command.get_option_no_throw("--solver"))
      return in.wrong(node, "luxel {} has no --solver; put its options below [{}]", in.table,
                      in.table);
    if (of_solver) {
      if (key.str() == solver) LUXEL_TRY_STATUS(read_table(in, *inner, solver, out));
      continue;
    }
    LUXEL_TRY(const std::vector<std::string> arguments, read_option(in, key.str(), node));
    out.insert(out.end(), arguments.begin(), arguments.end());
  }
  return {};
}

Result<toml::table> read_toml(const OptionFile& file) {
  std::error_code failed;
  const fs::path real = real_path(file.path);
  if (!file.is_named && real.parent_path() != real_path(file.path.parent_path()))
    return fail(ErrorCode::bad_input, "{} is a link to another folder; give --settings {}",
                file.path.string(), file.path.string());
  if (fs::file_size(file.path, failed) > kMostBytes && !failed)
    return fail(ErrorCode::bad_input, "{} is not a file of options: it has over {} bytes",
                file.path.string(), kMostBytes);
  LUXEL_TRY(const std::vector<std::byte> bytes, read_file(file.path));
  try {
    return toml::parse(std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  } catch (const toml::parse_error& error) {
    return fail(ErrorCode::bad_input, "{}, line {}: {}", file.path.string(),
                error.source().begin.line, error.description());
  }
}

/// The commands that read files of options.
std::vector<std::string> commands_beside(const CLI::App& command, std::string_view table) {
  std::vector<std::string> out{std::string(table)};
  if (const CLI::App* program = command.get_parent())
    for (const CLI::App* one : program->get_subcommands([](const CLI::App*) { return true; }))
      if (one->get_option_no_throw("SCENE")) out.push_back(one->get_name());
  return out;
}

/// Errors: what is no table, or no command's.
Status check_tables(const Reader& in, const toml::table& all) {
  const std::vector<std::string> commands = commands_beside(in.command, in.table);
  for (const auto& [key, node] : all) {
    if (!node.is_table())
      return in.wrong(node, "'{}' is outside any table; options of luxel bake belong in [bake]",
                      key.str());
    if (!is_among(commands, key.str()))
      return in.wrong(node, "no command '{}' reads this file{}", key.str(),
                      did_you_mean(key.str(), commands));
  }
  return {};
}

}  // namespace

bool is_option_file(const fs::path& settings) {
  return settings == kNoOptionFile || settings.extension() == ".toml";
}

std::optional<OptionFile> option_file_of(const CLI::App& command) {
  const CLI::Option* named = command.get_option_no_throw("--settings");
  if (named && named->count() > 0) {
    const fs::path path = named->results().back();
    if (!is_option_file(path) || path == kNoOptionFile) return std::nullopt;
    return OptionFile{path, true};
  }
  const CLI::Option* scene = command.get_option_no_throw("SCENE");
  if (!scene || scene->count() == 0) return std::nullopt;
  const fs::path path = fs::path(scene->results().back()).parent_path() / kOptionFileName;
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored)) return std::nullopt;
  return OptionFile{path, false};
}

Result<std::vector<std::string>> options_in(const OptionFile& file, const CLI::App& command,
                                            std::string_view table) {
  const Reader in{file, command, table};
  LUXEL_TRY(const toml::table all, read_toml(file));
  LUXEL_TRY_STATUS(check_tables(in, all));
  std::vector<std::string> out;
  if (const toml::table* options = all[table].as_table())
    LUXEL_TRY_STATUS(read_table(in, *options, solver_of(command, *options), out));
  return out;
}

}  // namespace luxel::arguments
