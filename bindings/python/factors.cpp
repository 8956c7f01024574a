// View factors between the surfaces of a scene.
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "bindings/python/arrays.h"
#include "luxel/base/parallel.h"
#include "luxel/pipeline/command/factors.h"

namespace luxel::python {
namespace {

/// Arguments of `luxel factors`.
struct Wanted {
  std::string method;
  std::optional<double> tolerance;
  std::optional<int64_t> samples;
  std::optional<int> hemicube;
  bool smooth = false;
  uint64_t seed = 1;
  int threads = 0;
};

pipeline::FactorSettings settings_of(const Wanted& wanted) {
  pipeline::FactorSettings out;
  out.method = wanted.method, out.tolerance = wanted.tolerance, out.samples = wanted.samples;
  out.hemicube = wanted.hemicube, out.smooth = wanted.smooth, out.seed = wanted.seed;
  return out;
}

/// Names, areas, factors (n, n), errors (n, n), whether they close a room.
py::tuple view_factors(const py::object& scene, const Wanted& wanted, const py::object& callback) {
  pipeline::FactorSettings settings = settings_of(wanted);
  std::optional<scene::Scene> copy;
  if (py::isinstance<scene::Scene>(scene))
    copy = scene.cast<const scene::Scene&>();
  else
    settings.scene = path_of(scene);
  Progress progress;
  const pipeline::FactorReport found = value_of(run(progress, callback, [&](Progress& p) {
    const ThreadLimit limit(wanted.threads);
    return copy ? pipeline::view_factors(std::move(*copy), settings, p)
                : pipeline::view_factors(settings, p);
  }));
  warn(found.warnings);
  const viewfactor::FactorMatrix& matrix = found.matrix;
  const auto n = py::ssize_t(matrix.size());
  return py::make_tuple(matrix.names, py::array_t<double>(n, matrix.area_m2.data()),
                        py::array_t<double>({n, n}, matrix.factor.data()),
                        py::array_t<double>({n, n}, matrix.error.data()), found.closed);
}

}  // namespace

void add_factors(py::module_& module) {
  module.def("_view_factors",
             [](const py::object& scene, const std::string& method, std::optional<double> tolerance,
                std::optional<int64_t> samples, std::optional<int> hemicube, bool smooth,
                uint64_t seed, int threads, const py::object& progress) {
               if (threads < 0 || threads > 1024)
                 throw py::value_error("threads must be from 0 to 1024");
               return view_factors(
                   scene, {method, tolerance, samples, hemicube, smooth, seed, threads}, progress);
             });
}

}  // namespace luxel::python
