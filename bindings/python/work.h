// Long work of luxel under Python: without the interpreter's lock, with progress, and stopped by
// Ctrl-C. Errors become exceptions.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <atomic>
#include <chrono>
#include <exception>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "luxel/base/progress.h"
#include "luxel/base/result.h"

namespace luxel::python {

namespace py = pybind11;

/// Throws what Python raises for an error: MemoryError, OSError for files and disks, ValueError for
/// settings, luxel.Error for everything else.
[[noreturn]] void raise(const Error& error);

/// The value, or raise().
template <class T>
T value_of(Result<T> result) {
  if (!result) raise(result.error());
  return std::move(*result);
}

/// Makes luxel.Error, which raise() throws.
void add_error(py::module_& module);

/// Warns of each sentence, as Python's warnings.warn() does. Throws where the user has made errors
/// of them.
void warn(const std::vector<std::string>& sentences);

/// Calls a Python function with the stage, the share of it that is done, and the seconds left of
/// all; the latter two are None where they are not known.
void report(const py::object& callback, const Progress& progress);

/// Work that runs while this lives. Python's end waits for it, because a thread that asks for the
/// interpreter's lock after that is ended in the middle of what it does.
class RunningWork {
 public:
  /// Raises RuntimeError when Python ends.
  explicit RunningWork(Progress& progress);
  ~RunningWork();
  RunningWork(const RunningWork&) = delete;
  RunningWork& operator=(const RunningWork&) = delete;

 private:
  Progress* progress_;
};
/// Makes a function for Python's atexit, which stops all work and waits for it.
void add_stop_at_exit(py::module_& module);

/// Runs work(Progress&) on a thread of its own, and looks ten times a second whether Python wants
/// it to stop. `callback` is None, or what report() calls; what it raises stops the work.
template <class Work>
auto run(Progress& progress, const py::object& callback, Work&& work) {
  using Out = decltype(work(progress));
  const RunningWork running(progress);
  std::optional<Out> out;
  std::exception_ptr failed;
  std::atomic<bool> is_over{false};
  std::thread worker([&] {
    try {
      out.emplace(work(progress));
    } catch (...) {
      failed = std::current_exception();
    }
    is_over = true;
  });
  std::optional<py::error_already_set> raised;
  while (!is_over) {
    {
      const py::gil_scoped_release without_lock;
      const auto until = std::chrono::steady_clock::now() + std::chrono::milliseconds(100);
      while (!is_over && std::chrono::steady_clock::now() < until)
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    if (raised) continue;  // the work is about to stop
    try {
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      if (!callback.is_none()) report(callback, progress);
    } catch (py::error_already_set& error) {
      raised.emplace(error);
      progress.request_cancel();
    }
  }
  {
    const py::gil_scoped_release without_lock;
    worker.join();
  }
  if (raised) throw std::move(*raised);
  if (failed) std::rethrow_exception(failed);
  return std::move(*out);
}

void add_scene(py::module_& module);
void add_bake(py::module_& module);
void add_trace(py::module_& module);
void add_factors(py::module_& module);
void add_relighter(py::module_& module);
void add_compare(py::module_& module);

}  // namespace luxel::python
