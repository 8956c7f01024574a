// Runs the real program and looks at what it says and leaves.
#pragma once

#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>

#include "tests/scratch_folder.h"
#include "tests/support.h"

namespace luxel::testing_support {

struct CommandResult {
  int code = -1;
  std::string out, err;
};

inline std::string slurp(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

/// A command through the shell, and what it prints. A signal that ends it is 128 and its number.
inline CommandResult shell(const std::string& command) {
  const ScratchFolder scratch;
  const std::string out = (scratch.path / "out").string(), err = (scratch.path / "err").string();
  const int status = std::system((command + " >" + out + " 2>" + err).c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), slurp(out), slurp(err)};
}

/// `luxel ARGUMENTS` through the shell; `before` stands in front of it (timeout, ulimit).
inline CommandResult luxel(const std::string& arguments, const std::string& before = "") {
  return shell(before + " " LUXEL_BINARY " " + arguments);
}

/// Before a command that asks Vulkan for devices: Mesa's on the processor keeps memory.
inline constexpr const char* kNoLeakSearch = "ASAN_OPTIONS=detect_leaks=0";

inline std::set<std::string> files_in(const std::filesystem::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    names.insert(entry.path().filename().string());
  return names;
}
/// Names and bytes of all files but bake.json, which has times.
inline std::string results_in(const std::filesystem::path& folder) {
  std::string out;
  for (const std::string& name : files_in(folder))
    if (name != "bake.json") out += name + slurp(folder / name);
  return out;
}
inline const std::set<std::string> kBakeFiles{"lightmap.exr", "baked.glb", "preview.png",
                                              "bake.json"};

inline std::string scene_file(const std::string& name) {
  return (std::filesystem::path(LUXEL_SOURCE_DIR) / "scenes" / name).string();
}

}  // namespace luxel::testing_support
