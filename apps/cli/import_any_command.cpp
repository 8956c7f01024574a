// `luxel import-any FILE`: what another luxel starts to read a file whose reader may end its
// process, never end, or fill the memory (luxel/import/other_process.h). It is not in --help.
#include <malloc.h>
#include <sys/prctl.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>

#include "apps/cli/cli.h"
#include "apps/cli/print.h"
#include "luxel/base/parallel.h"
#include "luxel/base/process_memory.h"
#include "luxel/export/baked_glb.h"
#include "luxel/import/other_process.h"
#include "luxel/import/reading_memory.h"

namespace luxel::cli {
namespace {

struct ImportAnyOptions {
  Common common;
  std::string file, up;
  import::ImportParams reading;
  import::ProcessLimits limits;
};

bool limit(__rlimit_resource what, uint64_t most, uint64_t hard_more = 0) {
  const rlimit both{most, most + hard_more};
  return ::setrlimit(what, &both) == 0;
}

/// Limits what is below by what this process has already, and may have.
bool limit_this_process(const import::ProcessLimits& limits) {
  // Each arena of the allocator would take addresses that count.
  ::mallopt(M_ARENA_MAX, 1);
  // At a hard limit of time the kernel sends SIGKILL, which does not say why.
  const auto seconds = uint64_t(std::ceil(limits.seconds));
  const uint64_t most = import::ReadingMemory(limits.memory_bytes).left_bytes();
  // The process that waits for the scene may be killed: then this one is, too.
  return ::prctl(PR_SET_PDEATHSIG, SIGKILL) == 0 && limit(RLIMIT_CORE, 0) &&
         limit(RLIMIT_CPU, seconds, 1) && limit(RLIMIT_FSIZE, most) &&
         limit(RLIMIT_AS, virtual_bytes() + most);
}

int run_import_any(const ImportAnyOptions& options) {
  const ThreadLimit one(1);
  if (!limit_this_process(options.limits))
    return report({ErrorCode::io, "cannot limit what the process that reads it may use"},
                  options.common);
  import::ImportParams reading = options.reading;
  if (!options.up.empty()) reading.up = options.up == "z" ? import::Up::z : import::Up::y;
  auto imported =
      import::import_in_this_process(options.file, reading, options.limits.memory_bytes);
  if (!imported) return report(imported.error(), options.common);
  print_warnings(imported->warnings, options.common);
  const auto glb = export_::scene_glb(imported->scene);
  if (!glb) return report(glb.error(), options.common);
  print_bytes(stdout, std::as_bytes(std::span(*glb)));
  return kDone;
}

}  // namespace

void register_import_any(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("import-any", "Hand a scene over to another luxel");
  command->group("");
  auto options = std::make_shared<ImportAnyOptions>();
  import::ImportParams& reading = options->reading;
  command->add_option("FILE", options->file)->required();
  command->add_option("--seconds", options->limits.seconds)->required();
  command->add_option("--bytes", options->limits.memory_bytes)->required();
  command->add_option("--crease-deg", reading.smooth_normals_deg);
  command->add_option("--unit-m", reading.unit_m);
  command->add_option("--up", options->up)->check(CLI::IsMember({"y", "z"}));
  command->add_option("--search-path", reading.search_paths);
  command->add_flag("--trust-paths", reading.trust_paths);
  add_common(*command, options->common);
  command->callback(
      [options, &action] { action = [options] { return run_import_any(*options); }; });
}

}  // namespace luxel::cli
