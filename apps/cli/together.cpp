#include "apps/cli/together.h"

#include <chrono>
#include <thread>

#include "apps/cli/print.h"
#include "luxel/cluster/mpi.h"
#include "luxel/pipeline/settings/version.h"

namespace luxel::cli {
namespace {

/// "8 processes on 2 nodes: 2 work, the others lend their cores".
std::string about_processes(const cluster::Joined& joined) {
  const int working = joined.team ? int(joined.team->size()) : 1;
  const std::string all = fmt::format("{} processes on {} node{}", joined.processes, joined.nodes,
                                      joined.nodes == 1 ? "" : "s");
  if (working == joined.processes) return all + " work together";
  return fmt::format("{}: {} work{}, the others lend their cores (--processes-per-node)", all,
                     working, working == 1 ? "s" : "");
}

/// The first process says what went wrong, and mpirun ends the others then. Where it does not in
/// time, since it is at work on something else, this one does.
void say_when_nobody_does(const cluster::Joined& joined, const std::string& unsaid) {
  std::this_thread::sleep_for(std::chrono::seconds(10));
  print_line(stderr, fmt::format("luxel: process {} of {}: {}",
                                 joined.team ? joined.team->rank() : 0, joined.processes, unsaid));
}

}  // namespace

void add_processes_per_node(CLI::App& command, int& processes_per_node) {
  command
      .add_option("--processes-per-node", processes_per_node,
                  "Under mpirun or srun: number of processes per node that work, each with its own "
                  "copy of the scene; the others lend them their cores")
      ->check(CLI::Range(1, 1024).description(""))
      ->type_name("COUNT")
      ->capture_default_str();
}

int run_together(const Common& common, int processes_per_node,
                 const std::function<int(const Common&, Team*)>& run) {
  if (cluster::processes_started() <= 1) return run(common, nullptr);
  auto joined =
      cluster::join_processes(std::string("luxel ") + pipeline::kVersion, processes_per_node);
  if (!joined) return report(joined.error(), common);
  const bool is_first = joined->works && (!joined->team || joined->team->rank() == 0);
  if (is_first) print_note(about_processes(*joined), common);
  Common own = common;
  own.in_team = true;
  std::string unsaid;
  if (!is_first)
    own.quiet = own.silent = true, own.json = own.progress_json = false, own.unsaid = &unsaid;
  const int code = joined->works ? run(own, joined->team.get()) : kDone;
  // Others do not know yet of an error before or after the work, unlike one within it.
  if (code != kDone && joined->team) joined->team->give_up({ErrorCode::io, unsaid});
  if (!is_first && code != kDone) say_when_nobody_does(*joined, unsaid);
  cluster::leave_processes(std::move(*joined), code != kDone);
  return code;
}

}  // namespace luxel::cli
