#include "bindings/python/work.h"

#include <condition_variable>
#include <mutex>
#include <set>
#include <stdexcept>

#include "luxel/base/shown_text.h"

namespace luxel::python {
namespace {

/// luxel.Error. The interpreter keeps one for itself, as it does of its own exceptions.
PyObject*& error_class() {
  static PyObject* made = nullptr;
  return made;
}

/// All work that runs in any thread of this interpreter.
struct AllWork {
  std::mutex mutex;
  std::condition_variable is_less;
  std::set<Progress*> progresses;
  bool is_ending = false;
};
AllWork& all_work() {
  static AllWork all;
  return all;
}

void stop_all() {
  AllWork& all = all_work();
  const py::gil_scoped_release without_lock;  // the work needs it to end
  std::unique_lock lock(all.mutex);
  all.is_ending = true;
  for (Progress* progress : all.progresses) progress->request_cancel();
  all.is_less.wait(lock, [&] { return all.progresses.empty(); });
}

/// Python prints sentences as they are: what they quote is to do no harm there.
py::object text_of_sentence(const std::string& sentence) {
  return py::str(short_message(sentence));
}

PyObject* class_of(ErrorCode code) {
  switch (code) {
    case ErrorCode::out_of_memory:
      return PyExc_MemoryError;
    case ErrorCode::io:
    case ErrorCode::out_of_disk:
      return PyExc_OSError;
    case ErrorCode::bad_setting:
      return PyExc_ValueError;
    case ErrorCode::bad_input:
    case ErrorCode::unsupported:
    case ErrorCode::out_of_time:
    case ErrorCode::no_device:
    case ErrorCode::parts_missing:
    case ErrorCode::cancelled:
      break;
  }
  return error_class();
}

}  // namespace

void raise(const Error& error) {
  PyErr_SetObject(class_of(error.code), text_of_sentence(error.message).ptr());
  throw py::error_already_set();
}

void add_error(py::module_& module) {
  error_class() = PyErr_NewExceptionWithDoc(
      "luxel.Error", "An error of luxel for which Python has no exception of its own.",
      PyExc_RuntimeError, nullptr);
  if (!error_class()) throw py::error_already_set();
  module.attr("Error") = py::reinterpret_borrow<py::object>(error_class());
}

void warn(const std::vector<std::string>& sentences) {
  for (const std::string& sentence : sentences)
    if (PyErr_WarnFormat(PyExc_UserWarning, 1, "%U", text_of_sentence(sentence).ptr()) != 0)
      throw py::error_already_set();
}

RunningWork::RunningWork(Progress& progress) : progress_(&progress) {
  const std::lock_guard lock(all_work().mutex);
  if (all_work().is_ending) throw std::runtime_error("Python is about to end");
  all_work().progresses.insert(progress_);
}
RunningWork::~RunningWork() {
  const std::lock_guard lock(all_work().mutex);
  all_work().progresses.erase(progress_);
  all_work().is_less.notify_all();
}

void add_stop_at_exit(py::module_& module) {
  module.def("_stop_all", &stop_all);
  py::module_::import("atexit").attr("register")(module.attr("_stop_all"));
}

void report(const py::object& callback, const Progress& progress) {
  const Progress::Snapshot now = progress.snapshot();
  if (now.stage_index < 0) return;
  py::object share = py::none(), left = py::none();
  if (now.share >= 0) share = py::float_(now.share);
  if (now.seconds_left >= 0) left = py::float_(now.seconds_left);
  callback(now.stage, share, left);
}

}  // namespace luxel::python
