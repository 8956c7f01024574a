// Processes that mpirun or srun has started together.
#pragma once

#include <memory>
#include <string>

#include "luxel/base/result.h"
#include "luxel/base/team.h"

namespace luxel::cluster {

/// "Open MPI 4.1.4"; empty: luxel was built without MPI.
std::string mpi_version();

/// Number of processes that mpirun or srun has started, by the environment; 1 where there is
/// neither.
int processes_started();

/// A process's part in the common work.
struct Joined {
  std::unique_ptr<Team> team;  ///< null: it works alone, or it only lends its cores
  bool works = true;
  int processes = 1, nodes = 1;
};

/// Joins all processes that were started together. `program` must be the same text for all. Of each
/// node's processes `per_node` work, and the others lend them the cores that they may run on: the
/// scene and its hierarchy are there once for each that works. Once per process, before any other
/// thread is started; stop_signals() are blocked in the threads that this starts. Errors: luxel
/// was built without MPI or with another one, another process has another `program`, MPI's own.
Result<Joined> join_processes(const std::string& program, int per_node);

/// Waits until all have come here, without using a core; then the team and MPI end. `failed`: the
/// others may never come, and MPI ends the job when this process does.
void leave_processes(Joined joined, bool failed);

}  // namespace luxel::cluster
