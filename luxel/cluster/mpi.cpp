#include "luxel/cluster/mpi.h"

#include <cstdlib>

#ifdef LUXEL_MPI
#include <mpi.h>
#include <pthread.h>
#include <sched.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "luxel/base/stop_signals.h"
#include "luxel/cluster/mpi_team.h"
#endif

namespace luxel::cluster {

int processes_started() {
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"})
    if (const char* text = std::getenv(name)) return std::max(std::atoi(text), 1);
  // srun --mpi=pmix says who each process is, and Slurm how many there are.
  const char* tasks = std::getenv("SLURM_STEP_NUM_TASKS");
  return std::getenv("PMIX_RANK") && tasks ? std::max(std::atoi(tasks), 1) : 1;
}

#ifdef LUXEL_MPI

std::string mpi_version() {
  return fmt::format("Open MPI {}.{}.{}", OMPI_MAJOR_VERSION, OMPI_MINOR_VERSION,
                     OMPI_RELEASE_VERSION);
}

namespace {

/// Blocks stop_signals() while it lives, so that threads that are started do not take them.
class BlockedSignals {
 public:
  BlockedSignals() {
    const sigset_t stop = stop_signals();
    pthread_sigmask(SIG_BLOCK, &stop, &before_);
  }
  BlockedSignals(const BlockedSignals&) = delete;
  BlockedSignals& operator=(const BlockedSignals&) = delete;
  ~BlockedSignals() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }

 private:
  sigset_t before_;
};

Status start_mpi() {
  int provided = 0;
  // Every call is under one mutex: not all ways that MPI knows to another node take more.
  if (MPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &provided) != MPI_SUCCESS)
    return fail(ErrorCode::unsupported, "MPI cannot be started");
  if (provided < MPI_THREAD_SERIALIZED)
    return fail(ErrorCode::unsupported, "this MPI does not support threads, which luxel needs");
  int size = 1;
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  if (size != processes_started())
    return fail(ErrorCode::unsupported,
                "{} processes were started together, but MPI sees {}: luxel was built with another "
                "MPI ({}) than the one that started it",
                processes_started(), size, mpi_version());
  return {};
}

/// The processes of one node, and what each does.
struct Node {
  MPI_Comm processes = MPI_COMM_NULL;
  int rank = 0, size = 1, works = 1;

  bool is_working() const { return rank < works; }
};

Node own_node(int per_node) {
  Node out;
  MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &out.processes);
  MPI_Comm_rank(out.processes, &out.rank), MPI_Comm_size(out.processes, &out.size);
  out.works = std::min(per_node, out.size);
  return out;
}

/// Those that work may run on the cores of all of their node, each `works`-th process's.
void take_lent_cores(const Node& node) {
  std::vector<cpu_set_t> all(size_t(node.size));
  cpu_set_t own;
  CPU_ZERO(&own);
  sched_getaffinity(0, sizeof own, &own);
  MPI_Allgather(&own, int(sizeof own), MPI_BYTE, all.data(), int(sizeof own), MPI_BYTE,
                node.processes);
  if (!node.is_working()) return;
  for (int rank = node.rank; rank < node.size; rank += node.works)
    CPU_OR(&own, &own, &all[size_t(rank)]);
  sched_setaffinity(0, sizeof own, &own);  // where it may not, it keeps its own
}

int count_of_nodes(const Node& node) {
  const int is_first = node.rank == 0;
  int nodes = 0;
  MPI_Allreduce(&is_first, &nodes, 1, MPI_INT, MPI_SUM, MPI_COMM_WORLD);
  return nodes;
}

std::string name_of_node() {
  char name[MPI_MAX_PROCESSOR_NAME];
  int length = 0;
  MPI_Get_processor_name(name, &length);
  return {name, size_t(length)};
}

/// Errors: some process has another `program`.
Status check_program(const std::string& program) {
  int size = 1;
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  constexpr size_t kLength = 256;
  const auto own = [&] {
    std::string text = fmt::format("{} ({})", program, name_of_node());
    text.resize(kLength);
    return text;
  }();
  std::string all(size_t(size) * kLength, '\0');
  MPI_Allgather(own.data(), int(kLength), MPI_BYTE, all.data(), int(kLength), MPI_BYTE,
                MPI_COMM_WORLD);
  const auto text_of = [&](int rank) { return std::string(all.c_str() + size_t(rank) * kLength); };
  const std::string first = text_of(0);
  for (int rank = 1; rank < size; ++rank) {
    const std::string other = text_of(rank);
    if (other.substr(0, other.rfind(" (")) == first.substr(0, first.rfind(" ("))) continue;
    return fail(ErrorCode::bad_setting,
                "process 0 is {}, process {} is {}; install one version on all nodes", first, rank,
                other);
  }
  return {};
}

}  // namespace

Result<Joined> join_processes(const std::string& program, int per_node) {
  const BlockedSignals blocked;
  LUXEL_TRY_STATUS(start_mpi());
  LUXEL_TRY_STATUS(check_program(program));
  const Node node = own_node(per_node);
  take_lent_cores(node);
  Joined out;
  out.works = node.is_working();
  out.nodes = count_of_nodes(node);
  MPI_Comm_size(MPI_COMM_WORLD, &out.processes);
  int rank = 0, working = 1;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm workers = MPI_COMM_NULL;
  MPI_Comm_split(MPI_COMM_WORLD, out.works ? 0 : MPI_UNDEFINED, rank, &workers);
  if (!out.works) return out;
  MPI_Comm_size(workers, &working);
  if (working > 1) out.team = make_mpi_team(workers, name_of_node());
  return out;
}

void leave_processes(Joined joined, bool failed) {
  if (failed) return;
  joined.team.reset();
  MPI_Request all = MPI_REQUEST_NULL;
  MPI_Ibarrier(MPI_COMM_WORLD, &all);
  for (int done = 0; !done;) {
    MPI_Test(&all, &done, MPI_STATUS_IGNORE);
    if (!done) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  MPI_Finalize();
}

#else

std::string mpi_version() { return {}; }

Result<Joined> join_processes(const std::string&, int) {
  return fail(ErrorCode::unsupported,
              "this luxel was built without MPI; install Open MPI's development files "
              "(libopenmpi-dev) and rebuild it, or use luxel bake --part");
}

void leave_processes(Joined, bool) {}

#endif

}  // namespace luxel::cluster
