// A luxel that runs beside the test, to be watched and ended.
#pragma once

#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include <sstream>
#include <string>
#include <vector>

#include "tests/command.h"

namespace luxel::testing_support {

/// `luxel ARGUMENTS`, words with spaces between them. Killed with this object, if it still runs.
class Running {
 public:
  explicit Running(const std::string& arguments) {
    std::vector<std::string> words{LUXEL_BINARY};
    std::istringstream in(arguments);
    for (std::string word; in >> word;) words.push_back(word);
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    const std::string err = (scratch_.path / "err").string();
    child_ = ::fork();
    if (child_ != 0) return;
    ::dup2(::open(err.c_str(), O_WRONLY | O_CREAT, 0600), STDERR_FILENO);
    ::execv(argv[0], argv.data());
    ::_exit(127);
  }
  Running(const Running&) = delete;
  Running& operator=(const Running&) = delete;
  ~Running() { end_with(SIGKILL); }

  bool ended() {
    ended_ = ended_ || ::waitpid(child_, &status_, WNOHANG) == child_;
    return ended_;
  }
  /// Sends the signal and waits for the end. False when it had ended before.
  bool end_with(int signal) {
    if (ended()) return false;
    ::kill(child_, signal);
    ::waitpid(child_, &status_, 0);
    ended_ = true;
    return signal != SIGKILL || WIFSIGNALED(status_);
  }
  int status() const { return status_; }  ///< as waitpid() gives it
  std::string err() const { return slurp(scratch_.path / "err"); }

 private:
  const ScratchFolder scratch_;
  pid_t child_ = -1;
  int status_ = 0;
  bool ended_ = false;
};

}  // namespace luxel::testing_support
