// numpy's arrays as luxel's values, and the other way round.
#pragma once

#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "bindings/python/work.h"
#include "luxel/base/vec.h"

namespace luxel::python {

/// An array, or what numpy makes one of: lists and tuples.
template <class T>
using Array = py::array_t<T, py::array::c_style | py::array::forcecast>;

/// Rows of an (n, width) array as values of as many numbers. Raises ValueError for another shape,
/// and for numbers that are not finite.
template <class Row, class T>
std::vector<Row> rows_of(const Array<T>& array, const std::string& name) {
  constexpr py::ssize_t kWidth = sizeof(Row) / sizeof(T);
  static_assert(sizeof(Row) == size_t(kWidth) * sizeof(T));
  if (array.ndim() != 2 || array.shape(1) != kWidth)
    throw py::value_error(name + " must have the shape (n, " + std::to_string(kWidth) + ")");
  for (py::ssize_t i = 0; i < array.size(); ++i)
    if (!std::isfinite(double(array.data()[i])))
      throw py::value_error(name + "[" + std::to_string(i / kWidth) + "] is not finite");
  std::vector<Row> out(size_t(array.shape(0)));
  std::memcpy(static_cast<void*>(out.data()), array.data(), out.size() * sizeof(Row));
  return out;
}
/// rows_of(), or nothing for None.
template <class Row, class T>
std::vector<Row> rows_or_none(const py::object& array, const std::string& name) {
  if (array.is_none()) return {};
  return rows_of<Row, T>(array.cast<Array<T>>(), name);
}

/// An array of whole numbers, of any number of dimensions. Raises TypeError for others: numpy would
/// cut them.
inline Array<int64_t> whole_numbers_of(const py::object& object, const std::string& name) {
  const py::array array = py::module_::import("numpy").attr("asarray")(object);
  const char kind = array.dtype().kind();
  if (kind != 'i' && kind != 'u' && array.size() != 0)
    throw py::type_error(name + " must be whole numbers");
  return array.cast<Array<int64_t>>();
}

/// A scene's file. Raises TypeError for what is no path, and for what no path can be.
inline std::filesystem::path path_of(const py::object& object) {
  try {
    const auto text = py::str(py::module_::import("os").attr("fspath")(object)).cast<std::string>();
    if (text.find('\0') == text.npos) return text;
  } catch (const std::exception&) {  // said below
  }
  throw py::type_error("scene must be a luxel.Scene or a path");
}

/// Three finite numbers.
inline Vec3 vec3_of(const Array<float>& array, const std::string& name) {
  if (array.ndim() != 1 || array.shape(0) != 3)
    throw py::value_error(name + " must have three numbers");
  const Vec3 out{array.data()[0], array.data()[1], array.data()[2]};
  if (!is_finite(out)) throw py::value_error(name + " is not finite");
  return out;
}
/// A colour: three finite numbers that are not negative, or one for all three.
inline Rgb color_of(const Array<float>& array, const std::string& name) {
  const bool is_gray = array.size() == 1;
  const Rgb out =
      is_gray ? Rgb{array.data()[0], array.data()[0], array.data()[0]} : vec3_of(array, name);
  if (!is_finite(out) || min_component(out) < 0)
    throw py::value_error(name + " must be finite, and not negative");
  return out;
}

/// An array over memory of `owner`, which lives as long as the array does. It is read only.
template <class T>
py::array_t<T> view(const T* data, std::vector<py::ssize_t> shape, const py::object& owner) {
  py::array_t<T> out(std::move(shape), data, owner);
  out.attr("setflags")(py::arg("write") = false);
  return out;
}
/// Vectors of three numbers of `owner` as an array (n, 3).
inline py::array_t<float> view_of_vectors(const Vec3* data, size_t count, const py::object& owner) {
  static_assert(sizeof(Vec3) == 3 * sizeof(float));
  return view(reinterpret_cast<const float*>(data), {py::ssize_t(count), 3}, owner);
}
/// A copy of them.
inline py::array_t<float> array_of_vectors(const std::vector<Vec3>& values) {
  py::array_t<float> out({py::ssize_t(values.size()), py::ssize_t(3)});
  std::memcpy(out.mutable_data(), values.data(), values.size() * sizeof(Vec3));
  return out;
}

}  // namespace luxel::python
