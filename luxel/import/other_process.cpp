#include "luxel/import/other_process.h"

#include <dlfcn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <nlohmann/json.hpp>

#include "luxel/base/run_program.h"
#include "luxel/base/shown_text.h"
#include "luxel/import/readers.h"

namespace luxel::import {
namespace {

namespace fs = std::filesystem;

/// The folders in which the program may lie: this program's, this library's, and those of PATH. One
/// that is no absolute path would depend on where this process happens to be.
std::vector<fs::path> folders_of_programs() {
  std::error_code ignored;
  std::vector<fs::path> folders{fs::read_symlink("/proc/self/exe", ignored).parent_path()};
  Dl_info library{};
  if (::dladdr(reinterpret_cast<const void*>(&usual_limits), &library) != 0)
    folders.push_back(fs::path(library.dli_fname).parent_path());
  const char* path = std::getenv("PATH");
  for (std::string_view rest = path ? path : ""; !rest.empty();) {
    const size_t end = std::min(rest.find(':'), rest.size());
    folders.emplace_back(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  std::erase_if(folders, [](const fs::path& folder) { return !folder.is_absolute(); });
  return folders;
}

Result<fs::path> find_luxel(const std::string& file) {
  std::error_code ignored;
  for (const fs::path& folder : folders_of_programs())
    if (const fs::path program = folder / "luxel";
        fs::is_regular_file(program, ignored) && ::access(program.c_str(), X_OK) == 0)
      return program;
  return fail(ErrorCode::unsupported,
              "{}: --any-format needs the program luxel to read it, which is in no folder of PATH; "
              "install it, or convert the file to glTF (.glb)",
              file);
}

std::vector<std::string> command_of(const fs::path& program, const fs::path& file,
                                    const ImportParams& params, const ProcessLimits& limits) {
  std::vector<std::string> words{program.string(), "import-any", "--progress-json"};
  const auto add = [&](const char* flag, std::string value) {
    words.insert(words.end(), {flag, std::move(value)});
  };
  add("--seconds", fmt::format("{}", limits.seconds));
  add("--bytes", fmt::format("{}", limits.memory_bytes));
  if (params.smooth_normals_deg) add("--crease-deg", fmt::format("{}", *params.smooth_normals_deg));
  if (params.unit_m) add("--unit-m", fmt::format("{}", *params.unit_m));
  if (params.up) add("--up", *params.up == Up::z ? "z" : "y");
  if (params.trust_paths) words.push_back("--trust-paths");
  for (const fs::path& folder : params.search_paths)
    add("--search-path", fs::absolute(folder).string());
  words.push_back((file.string().starts_with('-') ? "." / file : file).string());
  return words;
}

/// Output of the process: its warnings, and the sentence of its error, empty without one. Each line
/// is an event of --progress-json.
struct Said {
  std::vector<std::string> warnings;
  std::string error;
};
Said said_in(std::string_view text) {
  Said said;
  while (!text.empty()) {
    const size_t end = std::min(text.find('\n'), text.size());
    const auto event = nlohmann::json::parse(text.substr(0, end), nullptr, false);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (!event.is_object()) continue;
    const auto text_in = [&](const char* key) {
      const auto found = event.find(key);
      return found == event.end() || !found->is_string() ? "" : found->get<std::string>();
    };
    if (text_in("event") == "warning") said.warnings.push_back(text_in("message"));
    if (text_in("event") == "error") said.error = text_in("message");
  }
  return said;
}

/// The error of a process that has not handed over a scene.
Failure failure_of(const ProgramEnd& end, const Said& said, const std::string& file,
                   const ProcessLimits& limits) {
  constexpr int kOutOfResource = 3;  // an exit code of luxel
  const int signal = WIFSIGNALED(end.status) ? WTERMSIG(end.status) : 0;
  if (end.was_killed || signal == SIGXCPU)
    return fail(ErrorCode::bad_input,
                "{}: reading it took longer than {:g} s; convert it to glTF (.glb)", file,
                limits.seconds);
  if (signal == SIGINT || signal == SIGTERM || signal == SIGHUP)
    return fail(ErrorCode::cancelled, "{}: the process that read it was stopped", file);
  const char* const name = ::sigdescr_np(signal);
  if (signal != 0)
    return fail(ErrorCode::bad_input,
                "{}: the process that read it was ended by signal {} ({}); convert it to glTF "
                "(.glb)",
                file, signal, name ? name : "unknown");
  if (said.error.empty())
    return fail(ErrorCode::bad_input,
                "{}: the process that read it ended with code {}; convert it to glTF (.glb)", file,
                WEXITSTATUS(end.status));
  return fail(
      WEXITSTATUS(end.status) == kOutOfResource ? ErrorCode::out_of_memory : ErrorCode::bad_input,
      "{}{}", said.error.starts_with(file) ? "" : file + ": ", said.error);
}

}  // namespace

ProcessLimits usual_limits(uint64_t file_bytes, uint64_t max_memory_bytes) {
  return {double(20 + file_bytes / 1000000), max_memory_bytes};
}

Result<Imported> import_in_other_process(const fs::path& path, const ImportParams& params,
                                         const ProcessLimits& limits) {
  const std::string file = shown_text(path.string());
  LUXEL_TRY(const fs::path program, find_luxel(file));
  ReadingMemory memory(limits.memory_bytes);
  // It sets its own limit of processor time. This one is for a process that waits for nothing.
  constexpr double kWaiting = 10;
  LUXEL_TRY(ProgramEnd end, run_program(command_of(program, path, params, limits),
                                        kWaiting * limits.seconds, memory.left_bytes()));
  Said said = said_in(end.err);
  if (end.status != 0) return failure_of(end, said, file, limits);
  LUXEL_TRY_STATUS(memory.take(end.out.size(), file));
  LUXEL_TRY(Imported imported,
            import_glb(std::move(end.out), path.string(), {.origin = params.origin}, memory));
  imported.warnings.insert(imported.warnings.begin(), said.warnings.begin(), said.warnings.end());
  // Nodes of a file that nobody sees.
  imported.node_of_instance.clear(), imported.node_of_light.clear();
  return imported;
}

}  // namespace luxel::import
