// RayTracer over Embree 3. [Wald14]
#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "base/check.h"
#include "trace/ray_tracer.h"

namespace luxel::trace {
namespace {

constexpr unsigned kPacket = 16;

/// Packets take Embree's hybrid traversal. The one for packets declared coherent is up to twice as
/// fast where the rays of a packet stay together, but loops for ever now and then in Embree 3.13.5
/// with instances (seen in rtcOccluded16), so it is only used for closest hits without them.
RTCIntersectContext packet_context(bool coherent = false) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags =
      coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  return context;
}

/// What a filter function needs to find the hole in a mask.
struct SceneTag {
  const scene::Scene* scene = nullptr;
};

/// Geometries of the top level are attached under their instance's number, so that a hit's instance
/// is its geometry where it lies in the top level itself, and its innermost instance id elsewhere.
inline uint32_t instance_of(uint32_t instance_id, uint32_t geometry_id) {
  return instance_id != RTC_INVALID_GEOMETRY_ID ? instance_id : geometry_id;
}

/// Rejects hits in the holes of alpha masks, for packets of any size.
void reject_holes(const RTCFilterFunctionNArguments* args) {
  const scene::Scene& scene = *static_cast<const SceneTag*>(args->geometryUserPtr)->scene;
  for (unsigned i = 0; i < args->N; ++i) {
    if (args->valid[i] != -1) continue;
    const scene::SurfacePoint p{
        instance_of(RTCHitN_instID(args->hit, args->N, i, 0),
                    RTCHitN_geomID(args->hit, args->N, i)),
        RTCHitN_primID(args->hit, args->N, i),
        {RTCHitN_u(args->hit, args->N, i), RTCHitN_v(args->hit, args->N, i)}};
    if (!scene::is_solid_at(scene, p)) args->valid[i] = 0;
  }
}

bool has_mask(const scene::Scene& scene, const scene::Mesh& mesh) {
  for (const uint32_t material : mesh.triangle_material)
    if (scene.materials[material].alpha_mode == scene::AlphaMode::mask) return true;
  return false;
}

void* new_buffer(RTCGeometry geometry, RTCBufferType type, RTCFormat format, size_t stride,
                 size_t count) {
  return rtcSetNewGeometryBuffer(geometry, type, 0, format, stride, count);
}

}  // namespace

struct RayTracer::Impl {
  RTCDevice device = nullptr;
  RTCScene top = nullptr;
  std::vector<RTCScene> meshes;  ///< per mesh; null unless several instances share it
  bool has_shared_meshes = false;
  SceneTag tag;
  /// Per instance, the map of object normals to world normals of the front side.
  std::vector<std::array<Vec3, 3>> normal_columns;

  ~Impl() {
    for (RTCScene mesh : meshes)
      if (mesh) rtcReleaseScene(mesh);
    if (top) rtcReleaseScene(top);
    if (device) rtcReleaseDevice(device);
  }

  RTCGeometry new_triangles(const scene::Scene& scene, const scene::Mesh& mesh, const Mat34& map);
  bool add_shared_mesh(const scene::Scene& scene, const scene::Mesh& mesh);
  bool add_instance(const scene::Scene& scene, uint32_t instance);
  bool from_behind(uint32_t instance, Vec3 object_normal, Vec3 direction) const {
    const auto& m = normal_columns[instance];
    const Vec3 n = m[0] * object_normal.x + m[1] * object_normal.y + m[2] * object_normal.z;
    return dot(n, direction) > 0;
  }
};

/// A mesh's triangles with `map` applied; nullptr when memory ran out.
RTCGeometry RayTracer::Impl::new_triangles(const scene::Scene& scene, const scene::Mesh& mesh,
                                           const Mat34& map) {
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
  std::copy(mesh.triangles.begin(), mesh.triangles.end(),
            static_cast<std::array<uint32_t, 3>*>(indices));
  if (has_mask(scene, mesh)) {
    rtcSetGeometryUserData(geometry, &tag);
    rtcSetGeometryIntersectFilterFunction(geometry, reject_holes);
    rtcSetGeometryOccludedFilterFunction(geometry, reject_holes);
  }
  rtcCommitGeometry(geometry);
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

bool RayTracer::Impl::add_shared_mesh(const scene::Scene& scene, const scene::Mesh& mesh) {
  RTCGeometry geometry = new_triangles(scene, mesh, {});
  if (!geometry) return false;
  RTCScene bottom = rtcNewScene(device);
  meshes.back() = bottom;
  rtcAttachGeometry(bottom, geometry);
  rtcReleaseGeometry(geometry);
  commit_scene(bottom);
  return rtcGetDeviceError(device) == RTC_ERROR_NONE;
}

bool RayTracer::Impl::add_instance(const scene::Scene& scene, uint32_t index) {
  const scene::Instance& instance = scene.instances[index];
  const Mat34& m = instance.world_from_object;
  RTCScene shared = meshes[instance.mesh];
  RTCGeometry geometry = shared ? rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE)
                                : new_triangles(scene, scene.meshes[instance.mesh], m);
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

namespace {

/// Which meshes are stored once for all their instances.
std::vector<bool> shared_meshes(const scene::Scene& scene, size_t max_flat_triangles) {
  std::vector<uint32_t> uses(scene.meshes.size());
  for (const scene::Instance& instance : scene.instances) ++uses[instance.mesh];
  const bool large = scene::first_triangles(scene).back() > max_flat_triangles;
  std::vector<bool> shared;
  for (const uint32_t n : uses) shared.push_back(large && n > 1);
  return shared;
}

}  // namespace

RayTracer::RayTracer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
RayTracer::RayTracer(RayTracer&&) noexcept = default;
RayTracer& RayTracer::operator=(RayTracer&&) noexcept = default;
RayTracer::~RayTracer() = default;

Result<RayTracer> RayTracer::build(const scene::Scene& scene, size_t max_flat_triangles) {
  auto impl = std::make_unique<Impl>();
  impl->device = rtcNewDevice(nullptr);
  if (!impl->device) return fail(ErrorCode::unsupported, "Embree does not run on this processor");
  impl->tag.scene = &scene;
  bool good = true;
  const std::vector<bool> shared = shared_meshes(scene, max_flat_triangles);
  for (size_t i = 0; i < scene.meshes.size(); ++i) {
    impl->meshes.push_back(nullptr);
    impl->has_shared_meshes = impl->has_shared_meshes || shared[i];
    if (shared[i]) good = good && impl->add_shared_mesh(scene, scene.meshes[i]);
  }
  impl->top = rtcNewScene(impl->device);
  for (uint32_t i = 0; i < scene.instances.size(); ++i) good = good && impl->add_instance(scene, i);
  commit_scene(impl->top);
  if (!good || rtcGetDeviceError(impl->device) != RTC_ERROR_NONE)
    return fail(ErrorCode::out_of_memory,
                "no memory for the ray tracing structure of {} meshes; close other programs or "
                "simplify the scene",
                scene.meshes.size());
  return RayTracer(std::move(impl));
}

namespace {

/// Loads up to 16 rays. Lanes beyond the last are invalid; they hold copies of the first ray, so
/// that no garbage reaches Embree.
unsigned load_packet(std::span<const Ray> rays, int* valid, RTCRay16& out) {
  const unsigned count = unsigned(std::min<size_t>(kPacket, rays.size()));
  for (unsigned i = 0; i < kPacket; ++i) {
    valid[i] = i < count ? -1 : 0;
    const Ray& ray = rays[i < count ? i : 0];
    out.org_x[i] = ray.origin.x, out.org_y[i] = ray.origin.y, out.org_z[i] = ray.origin.z;
    out.dir_x[i] = ray.direction.x, out.dir_y[i] = ray.direction.y, out.dir_z[i] = ray.direction.z;
    out.tnear[i] = ray.t_min, out.tfar[i] = ray.t_max;
    out.time[i] = 0, out.mask[i] = ~0u, out.id[i] = i, out.flags[i] = 0;
  }
  return count;
}

}  // namespace

void RayTracer::closest_hits(std::span<const Ray> rays, std::span<Hit> hits,
                             Packets packets) const {
  LUXEL_CHECK(rays.size() == hits.size());
  RTCIntersectContext context =
      packet_context(packets == Packets::bundles && !impl_->has_shared_meshes);
  for (size_t first = 0; first < rays.size(); first += kPacket) {
    alignas(64) int valid[kPacket];
    RTCRayHit16 packet;
    const unsigned count = load_packet(rays.subspan(first), valid, packet.ray);
    for (unsigned i = 0; i < kPacket; ++i)
      packet.hit.geomID[i] = packet.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect16(valid, impl_->top, &context, &packet);
    for (unsigned i = 0; i < count; ++i) {
      Hit& hit = hits[first + i];
      if (packet.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) {
        hit = Hit{};
        continue;
      }
      const uint32_t instance = instance_of(packet.hit.instID[0][i], packet.hit.geomID[i]);
      const Vec3 normal{packet.hit.Ng_x[i], packet.hit.Ng_y[i], packet.hit.Ng_z[i]};
      hit = {packet.ray.tfar[i],
             instance,
             packet.hit.primID[i],
             {packet.hit.u[i], packet.hit.v[i]},
             impl_->from_behind(instance, normal, rays[first + i].direction)};
    }
  }
}

Hit RayTracer::closest_hit(const Ray& ray) const {
  Hit hit;
  closest_hits({&ray, 1}, {&hit, 1});
  return hit;
}

void RayTracer::occluded(std::span<const Ray> rays, std::span<uint8_t> blocked) const {
  LUXEL_CHECK(rays.size() == blocked.size());
  RTCIntersectContext context = packet_context();
  for (size_t first = 0; first < rays.size(); first += kPacket) {
    alignas(64) int valid[kPacket];
    RTCRay16 packet;
    const unsigned count = load_packet(rays.subspan(first), valid, packet);
    rtcOccluded16(valid, impl_->top, &context, &packet);
    for (unsigned i = 0; i < count; ++i) blocked[first + i] = packet.tfar[i] < 0 ? 1 : 0;
  }
}

Vec3 offset_origin(Vec3 position, Vec3 normal, float scene_diagonal_m) {
  // Interpolating three corners, moving them into the world and intersecting them errs by some ten
  // roundings (2^-24) of the largest number involved; 2^-18 of it is safe and stays under a
  // hundredth of a millimetre per metre. [Waechter19]
  const Vec3 size{std::abs(position.x), std::abs(position.y), std::abs(position.z)};
  return position + normal * (0x1p-18f * std::max(max_component(size), scene_diagonal_m));
}

}  // namespace luxel::trace
