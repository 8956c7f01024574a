#include "bindings/python/work.h"

namespace luxel::python {
namespace {

/// luxel.Error. The interpreter keeps one for itself, as it does of its own exceptions.
PyObject*& error_class() {
  static PyObject* made = nullptr;
  return made;
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
  PyErr_SetString(class_of(error.code), error.message.c_str());
  throw py::error_already_set();
}

void add_error(py::module_& module) {
  error_class() = PyErr_NewExceptionWithDoc(
      "luxel.Error", "What luxel could not do, for which Python has no exception of its own.",
      PyExc_RuntimeError, nullptr);
  if (!error_class()) throw py::error_already_set();
  module.attr("Error") = py::reinterpret_borrow<py::object>(error_class());
}

void warn(const std::vector<std::string>& sentences) {
  for (const std::string& sentence : sentences)
    if (PyErr_WarnEx(PyExc_UserWarning, sentence.c_str(), 1) != 0) throw py::error_already_set();
}

void report(const py::object& callback, const Progress& progress) {
  const Progress::Snapshot now = progress.snapshot();
  if (now.stage_index < 0) return;
  py::object share = py::none(), left = py::none();
  if (now.total > 0) share = py::float_(double(now.done) / double(now.total));
  if (now.seconds_left >= 0) left = py::float_(now.seconds_left);
  callback(now.stage, share, left);
}

}  // namespace luxel::python
