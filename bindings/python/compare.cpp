// Differences between pictures or bakes: `luxel compare`.
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <nlohmann/json.hpp>

#include "bindings/python/arrays.h"
#include "luxel/base/parallel.h"
#include "luxel/base/shown_text.h"
#include "luxel/pipeline/command/compare.h"

namespace luxel::python {
namespace {

/// Linear light (height, width, 3 or 4); the fourth channel is coverage.
pipeline::Picture picture_of(const Array<float>& array, const std::string& name) {
  if (array.ndim() != 3 || (array.shape(2) != 3 && array.shape(2) != 4) || array.size() == 0 ||
      array.shape(0) > 1 << 15 || array.shape(1) > 1 << 15)
    throw py::value_error(name + " must have the shape (height, width, 3 or 4)");
  image::Image image(int(array.shape(1)), int(array.shape(0)), int(array.shape(2)));
  std::copy(array.data(), array.data() + array.size(), image.data.begin());
  return {name, std::move(image), {}};
}

/// The object of `luxel compare --json`, as text.
std::string compare_arrays(const Array<float>& a, const Array<float>& b,
                           std::optional<double> exposure, const py::object& callback) {
  if (exposure && !(*exposure >= 1e-20 && *exposure <= 1e20))
    throw py::value_error("exposure must be from 1e-20 to 1e20");
  const pipeline::Picture first = picture_of(a, "a"), second = picture_of(b, "b");
  Progress progress;
  const pipeline::Measured found = value_of(run(progress, callback, [&](Progress& p) {
    return pipeline::measure(first, second, exposure, p);
  }));
  return json_text(pipeline::to_json(found.numbers));
}

std::string compare_files(const std::filesystem::path& a, const std::filesystem::path& b,
                          const std::optional<std::filesystem::path>& report,
                          std::optional<double> exposure, const py::object& callback) {
  pipeline::CompareSettings settings;
  settings.a = a, settings.b = b, settings.report = report, settings.exposure = exposure;
  Progress progress;
  const pipeline::Compared found = value_of(
      run(progress, callback, [&](Progress& p) { return pipeline::compare(settings, p); }));
  return json_text(pipeline::to_json(found));
}

}  // namespace

void add_compare(py::module_& module) {
  module.def("_compare_arrays", &compare_arrays);
  module.def("_compare_files", &compare_files);
}

}  // namespace luxel::python
