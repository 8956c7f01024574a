// Rays through a scene.
#include <pybind11/stl.h>

#include "bindings/python/arrays.h"
#include "luxel/scene/scene.h"
#include "luxel/trace/ray_tracer.h"

namespace luxel::python {
namespace {

/// A copy of a scene, which does not change, and its tracer.
struct Tracer {
  scene::Scene scene;
  std::optional<trace::RayTracer> rays;
};

std::unique_ptr<Tracer> make_tracer(const scene::Scene& scene) {
  auto out = std::make_unique<Tracer>();
  out->scene = scene;
  std::optional<Result<trace::RayTracer>> built;
  {
    const py::gil_scoped_release without_lock;
    built.emplace(trace::RayTracer::build(out->scene));
  }
  out->rays.emplace(value_of(std::move(*built)));
  return out;
}

/// Embree squares these numbers in single precision. Raises ValueError.
void check_size(const std::vector<Vec3>& rows, const std::string& name) {
  constexpr float kMost = 1e18f;
  for (size_t i = 0; i < rows.size(); ++i)
    if (std::max(max_component(rows[i]), -min_component(rows[i])) > kMost)
      throw py::value_error(name + "[" + std::to_string(i) + "] is too large; rays go up to 1e18");
}

std::vector<trace::Ray> rays_of(const Array<float>& origins, const Array<float>& directions,
                                float t_min, float t_max) {
  const std::vector<Vec3> from = rows_of<Vec3>(origins, "origins");
  const std::vector<Vec3> to = rows_of<Vec3>(directions, "directions");
  if (from.size() != to.size())
    throw py::value_error("origins and directions must have the same number of rows");
  if (!(t_min >= 0 && t_max >= t_min)) throw py::value_error("0 <= t_min <= t_max must hold");
  check_size(from, "origins"), check_size(to, "directions");
  std::vector<trace::Ray> rays(from.size());
  for (size_t i = 0; i < rays.size(); ++i) rays[i] = {from[i], t_min, to[i], t_max};
  return rays;
}

/// Fields of luxel.Hits, in their order.
py::tuple closest_hits(const Tracer& self, const Array<float>& origins,
                       const Array<float>& directions, float t_min, float t_max) {
  const std::vector<trace::Ray> rays = rays_of(origins, directions, t_min, t_max);
  std::vector<trace::Hit> hits(rays.size());
  {
    const py::gil_scoped_release without_lock;
    self.rays->closest_hits(rays, hits);
  }
  const auto n = py::ssize_t(hits.size());
  py::array_t<float> t(n), at({n, py::ssize_t(2)});
  py::array_t<int64_t> instance(n), triangle(n);
  py::array_t<bool> back_face(n);
  for (py::ssize_t i = 0; i < n; ++i) {
    const trace::Hit& hit = hits[size_t(i)];
    t.mutable_at(i) = hit.found() ? hit.t : INFINITY;
    instance.mutable_at(i) = hit.found() ? int64_t(hit.instance) : -1;
    triangle.mutable_at(i) = hit.found() ? int64_t(hit.triangle) : -1;
    at.mutable_at(i, 0) = hit.at.u, at.mutable_at(i, 1) = hit.at.v;
    back_face.mutable_at(i) = hit.back_face;
  }
  return py::make_tuple(t, instance, triangle, at, back_face);
}

py::array_t<bool> occluded(const Tracer& self, const Array<float>& origins,
                           const Array<float>& directions, float t_min, float t_max) {
  const std::vector<trace::Ray> rays = rays_of(origins, directions, t_min, t_max);
  std::vector<uint8_t> blocked(rays.size());
  {
    const py::gil_scoped_release without_lock;
    self.rays->occluded(rays, blocked);
  }
  py::array_t<bool> out{py::ssize_t(blocked.size())};
  for (size_t i = 0; i < blocked.size(); ++i) out.mutable_at(py::ssize_t(i)) = blocked[i] != 0;
  return out;
}

}  // namespace

void add_trace(py::module_& module) {
  py::class_<Tracer>(
      module, "Tracer", py::is_final(),
      "A snapshot of a scene, prepared for many calls of luxel.trace() and luxel.occluded().")
      .def(py::init(&make_tracer), py::arg("scene"))
      .def("_closest_hits", &closest_hits)
      .def("_occluded", &occluded);
}

}  // namespace luxel::python
