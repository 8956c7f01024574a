// Options from a file: luxel.toml beside a scene, or what --settings names.
#pragma once

#include <CLI/App.hpp>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "luxel/base/result.h"

namespace luxel::arguments {

inline constexpr std::string_view kOptionFileName = "luxel.toml";
/// The value of --settings for which no file is read, not even luxel.toml.
inline constexpr std::string_view kNoOptionFile = "none";

struct OptionFile {
  std::filesystem::path path;
  /// By --settings. A file that merely lies beside a scene may come from a stranger: it cannot name
  /// files outside of its folder, nor allow the scene to, and sets nothing about this machine.
  bool is_named = false;
};

/// True: --settings names a file of options, or none, rather than a bake.json.
bool is_option_file(const std::filesystem::path& settings);

/// The file of options of a command that was parsed: that of its --settings; without --settings the
/// luxel.toml in the folder of its SCENE, where there is one.
std::optional<OptionFile> option_file_of(const CLI::App& command);

/// The arguments ("--samples=64") that the file has for a command which was parsed without them.
/// `table`: the command's table in the file. In it a key is an option's name, and a table named as
/// a solver has what only counts with that solver. Left out is what the command was given, what
/// contradicts that, and what a solver of the command line does not look at. Paths are from the
/// file's folder on. Errors: the file cannot be read, is too large or no TOML, has a key that is no
/// option or none for files, a value of a wrong type, a path that is not there or lies outside;
/// they name file and line.
Result<std::vector<std::string>> options_in(const OptionFile& file, const CLI::App& command,
                                            std::string_view table);

}  // namespace luxel::arguments
