#include "luxel/trace/embree/embree_scene.h"

#include <algorithm>
#include <cmath>

#include "luxel/base/check.h"
#include "luxel/trace/embree/embree_query.h"
#include "luxel/trace/shared_meshes.h"

namespace luxel::trace {
namespace {

template <class Is>
bool has_material(const scene::Scene& scene, const scene::Mesh& mesh, const Is& is) {
  return std::any_of(mesh.triangle_material.begin(), mesh.triangle_material.end(),
                     [&](uint32_t material) { return is(scene.materials[material]); });
}

void* new_buffer(RTCGeometry geometry, RTCBufferType type, RTCFormat format, size_t stride,
                 size_t count) {
  return rtcSetNewGeometryBuffer(geometry, type, 0, format, stride, count);
}

}  // namespace

/// A mesh's triangles with `map` applied; nullptr when memory ran out.
RTCGeometry RayTracer::Impl::new_triangles(const scene::Mesh& mesh, const Mat34& map) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  void* vertices = new_buffer(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, sizeof(Vec3),
                              std::max<size_t>(1, mesh.positions.size()));
  void* indices = new_buffer(geometry, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3,
                             sizeof(mesh.triangles[0]), std::max<size_t>(1, mesh.triangles.size()));
  if (!vertices || !indices) {
    rtcReleaseGeometry(geometry);
    return nullptr;
  }
  std::transform(mesh.positions.begin(), mesh.positions.end(), static_cast<Vec3*>(vertices),
                 [&](Vec3 p) { return transform_point(map, p); });
  auto* corners = static_cast<std::array<uint32_t, 3>*>(indices);
  std::copy(mesh.triangles.begin(), mesh.triangles.end(), corners);
  // Rays meet the first of two sides of one sheet, which stands for both: Embree leaves out
  // triangles of vertices that there are not.
  for (uint32_t t = 0; t < mesh.other_side.size(); ++t)
    if (mesh.other_side[t] < t) corners[t] = {UINT32_MAX, UINT32_MAX, UINT32_MAX};
  if (has_material(*scene, mesh, scene::lets_light_through)) {
    rtcSetGeometryIntersectFilterFunction(geometry, let_through);
    rtcSetGeometryOccludedFilterFunction(geometry, let_through);
  }
  rtcCommitGeometry(geometry);
  sorted_triangles += mesh.triangles.size();
  return geometry;
}

namespace {

/// Robust: no ray slips through between two triangles that share an edge (a light leak).
void commit_scene(RTCScene scene) {
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_HIGH);
  rtcCommitScene(scene);
}

}  // namespace

bool RayTracer::Impl::add_shared_mesh(const scene::Mesh& mesh) {
  RTCGeometry geometry = new_triangles(mesh, {});
  if (!geometry) return false;
  RTCScene bottom = rtcNewScene(device);
  meshes.back() = bottom;
  rtcAttachGeometry(bottom, geometry);
  rtcReleaseGeometry(geometry);
  commit_scene(bottom);
  return rtcGetDeviceError(device) == RTC_ERROR_NONE;
}

bool RayTracer::Impl::add_instance(uint32_t index) {
  const scene::Instance& instance = scene->instances[index];
  const Mat34& m = instance.world_from_object;
  RTCScene shared = can_be_undone(m) ? meshes[instance.mesh] : nullptr;
  RTCGeometry geometry = shared ? rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE)
                                : new_triangles(scene->meshes[instance.mesh], m);
  if (!geometry) return false;
  if (shared) {
    rtcSetGeometryInstancedScene(geometry, shared);
    rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_ROW_MAJOR, m.row.data());
    rtcCommitGeometry(geometry);
    // Embree's normal is that of the mesh's own space, here and below: of the triangle as traced.
    normal_columns.push_back({transform_normal(m, {1, 0, 0}), transform_normal(m, {0, 1, 0}),
                              transform_normal(m, {0, 0, 1})});
  } else {
    const float side = determinant(m) < 0 ? -1.0f : 1.0f;
    normal_columns.push_back({Vec3{side, 0, 0}, Vec3{0, side, 0}, Vec3{0, 0, side}});
  }
  rtcAttachGeometryByID(top, geometry, index);
  rtcReleaseGeometry(geometry);
  return rtcGetDeviceError(device) == RTC_ERROR_NONE;
}

/// Everything but the meshes that are shared.
bool RayTracer::Impl::add_top() {
  for (const scene::Instance& i : scene->instances)
    has_tints = has_tints || has_material(*scene, scene->meshes[i.mesh], scene::tints_light);
  top = rtcNewScene(device);
  for (uint32_t i = 0; i < scene->instances.size(); ++i)
    if (!add_instance(i)) return false;
  commit_scene(top);
  return rtcGetDeviceError(device) == RTC_ERROR_NONE;
}

namespace {

Failure no_memory(const scene::Scene& scene) {
  return fail(ErrorCode::out_of_memory,
              "no memory for the ray tracing structure of {} meshes; close other programs or "
              "simplify the scene",
              scene.meshes.size());
}

}  // namespace

RayTracer::RayTracer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
RayTracer::RayTracer(RayTracer&&) noexcept = default;
RayTracer& RayTracer::operator=(RayTracer&&) noexcept = default;
RayTracer::~RayTracer() = default;

Result<RayTracer> RayTracer::build(const scene::Scene& scene, size_t max_flat_triangles) {
  return build_with(scene, shared_meshes(scene, max_flat_triangles));
}

Result<RayTracer> RayTracer::build_apart(const scene::Scene& scene) {
  return build_with(scene, std::vector<bool>(scene.meshes.size(), true));
}

Result<RayTracer> RayTracer::build_with(const scene::Scene& scene,
                                        const std::vector<bool>& shared) {
  auto impl = std::make_unique<Impl>();
  impl->device = rtcNewDevice(nullptr);
  if (!impl->device && rtcGetDeviceError(nullptr) == RTC_ERROR_UNSUPPORTED_CPU)
    return fail(ErrorCode::unsupported, "Embree does not run on this processor");
  if (!impl->device) return fail(ErrorCode::out_of_memory, "no memory for the ray tracer");
  impl->scene = &scene;
  impl->has_wide_vectors =
      rtcGetDeviceProperty(impl->device, RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED) != 0;
  bool good = true;
  for (size_t i = 0; i < scene.meshes.size(); ++i) {
    impl->meshes.push_back(nullptr);
    impl->has_shared_meshes = impl->has_shared_meshes || shared[i];
    if (shared[i]) good = good && impl->add_shared_mesh(scene.meshes[i]);
  }
  if (!good || !impl->add_top()) return no_memory(scene);
  return RayTracer(std::move(impl));
}

Result<RayTracer> RayTracer::moved(const scene::Scene& scene) const {
  LUXEL_CHECK(scene.meshes.size() == impl_->meshes.size());
  auto impl = std::make_unique<Impl>();
  rtcRetainDevice(impl_->device);
  impl->device = impl_->device;
  impl->scene = &scene;
  impl->has_wide_vectors = impl_->has_wide_vectors;
  impl->has_shared_meshes = impl_->has_shared_meshes;
  for (RTCScene mesh : impl_->meshes) {
    if (mesh) rtcRetainScene(mesh);
    impl->meshes.push_back(mesh);
  }
  if (!impl->add_top()) return no_memory(scene);
  return RayTracer(std::move(impl));
}

size_t RayTracer::sorted_triangles() const { return impl_->sorted_triangles; }

}  // namespace luxel::trace
