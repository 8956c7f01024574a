// Signals that ask a program to end.
#pragma once

#include <csignal>

namespace luxel {

/// Ctrl-C, SIGTERM, and SIGHUP, by which a terminal says that it goes. One that was ignored when
/// the program started, as SIGHUP under nohup, stays ignored: it is left out.
inline sigset_t stop_signals() {
  sigset_t out;
  sigemptyset(&out);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction now {};
    const bool is_ignored = ::sigaction(signal, nullptr, &now) == 0 && now.sa_handler == SIG_IGN;
    if (!is_ignored) sigaddset(&out, signal);
  }
  return out;
}

}  // namespace luxel
