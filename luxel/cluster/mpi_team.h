// A team whose members are processes that MPI has started. Only where luxel is built with MPI.
#pragma once

#include <mpi.h>

#include <memory>
#include <string>

#include "luxel/base/team.h"

namespace luxel::cluster {

/// The processes of `members`, which goes with the team. `node`: where this one runs, for messages.
/// Called by all of them.
std::unique_ptr<Team> make_mpi_team(MPI_Comm members, std::string node);

}  // namespace luxel::cluster
