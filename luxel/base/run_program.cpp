#include "luxel/base/run_program.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <thread>

#include "luxel/base/clock.h"
#include "luxel/base/stop_signals.h"
#include "luxel/base/transfer.h"

namespace luxel {
inline namespace base {
namespace {

/// A file in memory, for what a program writes. With a pipe it would have to be read meanwhile.
class MemoryFile {
 public:
  MemoryFile() : file_(::memfd_create("luxel-output", MFD_CLOEXEC)) {}
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  ~MemoryFile() {
    if (file_ >= 0) ::close(file_);
  }
  int number() const { return file_; }
  uint64_t size() const {
    struct stat about {};
    return ::fstat(file_, &about) == 0 ? uint64_t(about.st_size) : 0;
  }
  /// False when it cannot be read.
  template <class Bytes>
  bool read(Bytes& to) const {
    return transfer_all(::pread, file_, reinterpret_cast<char*>(to.data()), to.size(), 0) == 0;
  }

 private:
  int file_;
};

/// Files and signals with which a new program begins, for one call of posix_spawn().
struct SpawnSettings {
  posix_spawn_file_actions_t files;
  posix_spawnattr_t attributes;

  SpawnSettings(int out, int err) {
    ::posix_spawn_file_actions_init(&files);
    ::posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    ::posix_spawn_file_actions_adddup2(&files, out, STDOUT_FILENO);
    ::posix_spawn_file_actions_adddup2(&files, err, STDERR_FILENO);
    ::posix_spawn_file_actions_addclosefrom_np(&files, STDERR_FILENO + 1);
    // Threads of a bake block the signals that ask it to stop.
    sigset_t none, usual = stop_signals();
    ::sigemptyset(&none);
    for (const int signal : {SIGPIPE, SIGCHLD}) ::sigaddset(&usual, signal);
    ::posix_spawnattr_init(&attributes);
    ::posix_spawnattr_setsigmask(&attributes, &none);
    ::posix_spawnattr_setsigdefault(&attributes, &usual);
    ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
  }
  SpawnSettings(const SpawnSettings&) = delete;
  SpawnSettings& operator=(const SpawnSettings&) = delete;
  ~SpawnSettings() {
    ::posix_spawn_file_actions_destroy(&files);
    ::posix_spawnattr_destroy(&attributes);
  }
};

Result<pid_t> start(const std::vector<std::string>& words, int out, int err) {
  const SpawnSettings settings(out, err);
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  pid_t process = 0;
  const int error = ::posix_spawn(&process, words[0].c_str(), &settings.files, &settings.attributes,
                                  arguments.data(), ::environ);
  if (error == 0) return process;
  return fail(ErrorCode::io, "cannot start {}: {}", words[0], std::strerror(error));
}

}  // namespace

Result<ProgramEnd> run_program(const std::vector<std::string>& words, double seconds,
                               uint64_t most_bytes) {
  const MemoryFile out, err;
  if (out.number() < 0 || err.number() < 0)
    return fail(ErrorCode::io, "cannot keep what {} writes: {}", words[0], std::strerror(errno));
  LUXEL_TRY(const pid_t process, start(words, out.number(), err.number()));
  ProgramEnd end;
  const Clock::time_point began = Clock::now();
  for (pid_t ended = 0; ended != process;) {
    ended = ::waitpid(process, &end.status, end.was_killed ? 0 : WNOHANG);
    if (ended < 0 && errno != EINTR)
      return fail(ErrorCode::io, "cannot wait for {}: {}", words[0], std::strerror(errno));
    if (ended != 0) continue;
    end.was_killed = seconds_since(began) > seconds;
    if (end.was_killed) ::kill(process, SIGKILL);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  if (out.size() + err.size() > most_bytes)
    return fail(ErrorCode::out_of_memory, "{} has written more than {} bytes", words[0],
                most_bytes);
  end.out.resize(out.size()), end.err.resize(err.size());
  if (!out.read(end.out) || !err.read(end.err))
    return fail(ErrorCode::io, "cannot read what {} has written", words[0]);
  return end;
}

}  // namespace base
}  // namespace luxel
