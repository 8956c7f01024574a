// Commands whose work processes share that mpirun or srun has started together.
#pragma once

#include <functional>

#include "apps/cli/cli.h"
#include "luxel/base/team.h"

namespace luxel::cli {

/// --processes-per-node.
void add_processes_per_node(CLI::App& command, int& processes_per_node);

/// Calls run(common, team): `team` is null where a process was started alone, or works alone. Of
/// several that were started together, those that only lend their cores do not call it, and only
/// the first one's `common` lets it print. Returns the exit code.
int run_together(const Common& common, int processes_per_node,
                 const std::function<int(const Common& common, Team* team)>& run);

/// The command's options have `common` and `processes_per_node`; run(options, team) gets them with
/// the `common` above.
template <class Options, class Run>
int run_together(const Options& options, const Run& run) {
  return run_together(options.common, options.processes_per_node,
                      [&](const Common& common, Team* team) {
                        Options own = options;
                        own.common = common;
                        return run(own, team);
                      });
}

}  // namespace luxel::cli
