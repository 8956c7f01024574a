// RayTracer over Embree 3. [Wald14]
#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <string>
#include <vector>

#include "luxel/base/check.h"
#include "luxel/base/random.h"
#include "luxel/scene/sides.h"
#include "luxel/trace/ray_tracer.h"

namespace luxel::trace {
namespace {

constexpr unsigned kPacket = 16;

/// Up to so many triangles packets of rays that are only alike run faster as coherent ones. At
/// 6,000 both are as fast, and in larger scenes coherent ones are up to a sixth slower.
constexpr size_t kFewTriangles = 4096;

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

/// Geometries of the top level are attached under their instance's number, so that a hit's instance
/// is its geometry where it lies in the top level itself, and its innermost instance id elsewhere.
inline uint32_t instance_of(uint32_t instance_id, uint32_t geometry_id) {
  return instance_id != RTC_INVALID_GEOMETRY_ID ? instance_id : geometry_id;
}

/// What a query does with the light of a packet's rays that goes straight through surfaces.
enum class Through : uint8_t {
  chance,  ///< let the ray through or not
  tint,    ///< let it through, and multiply its light by the tint
  share    ///< the same with (1 - coverage) tint; where nothing is left, it is blocked
};

/// Embree hands the context of a query to filter functions: ours has more behind it. It tells them
/// the scene, too: geometries are shared between tracers, each of which has a scene of its own.
struct Query {
  Query(const scene::Scene& in, const RTCIntersectContext& rays, Through which = Through::chance)
      : context(rays), scene(in), through(which) {}

  RTCIntersectContext context;
  const scene::Scene& scene;
  Through through;
  Rgb* light = nullptr;  ///< one for each ray of the packet
  unsigned count = 0;    ///< of rays in the packet, where light is asked for
  /// Places that a ray has passed: Embree may ask about one several times, because spatial splits
  /// put a triangle into several boxes. So many are remembered.
  static constexpr size_t kRemembered = 16;
  std::array<std::array<uint64_t, kRemembered>, kPacket> passed;
  std::array<uint32_t, kPacket> passed_count{};

  bool is_new(unsigned lane, uint64_t place) {
    const size_t known = std::min<size_t>(passed_count[lane], kRemembered);
    const auto end = passed[lane].begin() + std::ptrdiff_t(known);
    if (std::find(passed[lane].begin(), end, place) != end) return false;
    passed[lane][passed_count[lane]++ % kRemembered] = place;
    return true;
  }
};

/// A number in [0, 1) that follows from the bits of a ray and of what it meets.
float chance_of(const RTCFilterFunctionNArguments* args, unsigned i, uint64_t place) {
  const auto bits = [](float x) { return uint64_t(std::bit_cast<uint32_t>(x)); };
  RTCRayN* ray = args->ray;
  const uint64_t direction =
      hash64(bits(RTCRayN_dir_x(ray, args->N, i)) << 32 | bits(RTCRayN_dir_y(ray, args->N, i)),
             bits(RTCRayN_dir_z(ray, args->N, i)));
  const uint64_t origin =
      hash64(bits(RTCRayN_org_x(ray, args->N, i)) << 32 | bits(RTCRayN_org_y(ray, args->N, i)),
             bits(RTCRayN_org_z(ray, args->N, i)));
  return unit_float(uint32_t(hash64(hash64(direction, origin), place) >> 32));
}

/// Lets rays through the holes of masks and through what is not opaque, for packets of any size.
void let_through(const RTCFilterFunctionNArguments* args) {
  Query& query = *reinterpret_cast<Query*>(args->context);
  const scene::Scene& scene = query.scene;
  for (unsigned i = 0; i < args->N; ++i) {
    if (args->valid[i] != -1) continue;
    const scene::SurfacePoint p{
        instance_of(RTCHitN_instID(args->hit, args->N, i, 0),
                    RTCHitN_geomID(args->hit, args->N, i)),
        RTCHitN_primID(args->hit, args->N, i),
        {RTCHitN_u(args->hit, args->N, i), RTCHitN_v(args->hit, args->N, i)}};
    const scene::Passage passage = scene::passage_at(scene, p);
    if (passage.coverage >= 1) continue;
    const uint64_t place = uint64_t(p.instance) << 32 | p.triangle;
    if (query.through == Through::chance) {
      if (chance_of(args, i, place) >= passage.coverage) args->valid[i] = 0;
      continue;
    }
    const unsigned lane = RTCRayN_id(args->ray, args->N, i);
    // Where packets are taken apart Embree may ask for lanes that no ray is in.
    if (lane >= query.count) continue;
    Rgb& light = query.light[lane];
    if (query.is_new(lane, place)) {
      const float open = query.through == Through::share ? 1 - passage.coverage : 1.0f;
      light = light * passage.tint * open;
    }
    if (max_component(light) > 0) args->valid[i] = 0;
  }
}

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

struct RayTracer::Impl {
  const scene::Scene* scene = nullptr;
  RTCDevice device = nullptr;
  RTCScene top = nullptr;
  std::vector<RTCScene> meshes;  ///< per mesh; null: its instances lie in the top level themselves
  bool has_shared_meshes = false;
  bool has_tints = false;
  size_t sorted_triangles = 0;

  /// Whether packets are traced as coherent ones.
  bool is_coherent(Packets packets) const {
    if (has_shared_meshes) return false;
    return packets == Packets::bundles ||
           (packets == Packets::alike && sorted_triangles <= kFewTriangles);
  }
  /// Per instance, the map of object normals to world normals of the front side.
  std::vector<std::array<Vec3, 3>> normal_columns;

  ~Impl() {
    for (RTCScene mesh : meshes)
      if (mesh) rtcReleaseScene(mesh);
    if (top) rtcReleaseScene(top);
    if (device) rtcReleaseDevice(device);
  }

  RTCGeometry new_triangles(const scene::Mesh& mesh, const Mat34& map);
  bool add_shared_mesh(const scene::Mesh& mesh);
  bool add_instance(uint32_t instance);
  bool add_top();
  bool from_behind(uint32_t instance, Vec3 object_normal, Vec3 direction) const {
    const auto& m = normal_columns[instance];
    const Vec3 n = m[0] * object_normal.x + m[1] * object_normal.y + m[2] * object_normal.z;
    return dot(n, direction) > 0;
  }
  /// What has two sides is met on the side that the ray comes from.
  void turn_to_ray(Hit& hit) const {
    if (!hit.back_face) return;
    if (const auto other = scene::other_side_of(*scene, hit.point()))
      hit.triangle = other->triangle, hit.at = other->at, hit.back_face = false;
  }
};

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

namespace {

/// Whether rays can be taken into the space of a mesh that stands so: not into that of one which is
/// pressed flat.
bool can_be_undone(const Mat34& m) {
  const float size = length(column(m, 0)) * length(column(m, 1)) * length(column(m, 2));
  return std::abs(determinant(m)) > 1e-6f * size;
}

}  // namespace

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

/// Per mesh: whether it is stored once for all its instances.
std::vector<bool> shared_meshes(const scene::Scene& scene, size_t max_flat_triangles) {
  std::vector<uint32_t> uses(scene.meshes.size());
  for (const scene::Instance& instance : scene.instances) ++uses[instance.mesh];
  const bool large = scene::first_triangles(scene).back() > max_flat_triangles;
  std::vector<bool> shared;
  for (const uint32_t n : uses) shared.push_back(large && n > 1);
  return shared;
}

tl::unexpected<Error> no_memory(const scene::Scene& scene) {
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
  impl->has_shared_meshes = impl_->has_shared_meshes;
  for (RTCScene mesh : impl_->meshes) {
    if (mesh) rtcRetainScene(mesh);
    impl->meshes.push_back(mesh);
  }
  if (!impl->add_top()) return no_memory(scene);
  return RayTracer(std::move(impl));
}

size_t RayTracer::sorted_triangles() const { return impl_->sorted_triangles; }

namespace {

/// What all rays have alike, packet after packet.
void begin_packets(RTCRay16& out) {
  for (unsigned i = 0; i < kPacket; ++i)
    out.time[i] = 0, out.mask[i] = ~0u, out.id[i] = i, out.flags[i] = 0;
}

/// Compilers make vector code of it.
void load_rays(const Ray* from, RTCRay16& out) {
  for (unsigned i = 0; i < kPacket; ++i) {
    out.org_x[i] = from[i].origin.x, out.org_y[i] = from[i].origin.y;
    out.org_z[i] = from[i].origin.z, out.tnear[i] = from[i].t_min;
    out.dir_x[i] = from[i].direction.x, out.dir_y[i] = from[i].direction.y;
    out.dir_z[i] = from[i].direction.z, out.tfar[i] = from[i].t_max;
  }
}

/// Loads up to 16 rays. Lanes beyond the last are invalid; they hold copies of the first ray, so
/// that no garbage reaches Embree.
unsigned load_packet(std::span<const Ray> rays, int* valid, RTCRay16& out) {
  const unsigned count = unsigned(std::min<size_t>(kPacket, rays.size()));
  for (unsigned i = 0; i < kPacket; ++i) valid[i] = i < count ? -1 : 0;
  if (count == kPacket) {
    load_rays(rays.data(), out);
  } else {
    std::array<Ray, kPacket> padded;
    padded.fill(rays[0]);
    std::copy_n(rays.begin(), count, padded.begin());
    load_rays(padded.data(), out);
  }
  return count;
}

}  // namespace

void RayTracer::closest_hits(std::span<const Ray> rays, std::span<Hit> hits,
                             Packets packets) const {
  LUXEL_CHECK(rays.size() == hits.size());
  Query query{*impl_->scene, packet_context(impl_->is_coherent(packets))};
  RTCRayHit16 packet;
  begin_packets(packet.ray);
  for (size_t first = 0; first < rays.size(); first += kPacket) {
    // 16 rays at a time.
    alignas(64) int valid[kPacket];
    const unsigned count = load_packet(rays.subspan(first), valid, packet.ray);
    for (unsigned i = 0; i < kPacket; ++i)
      packet.hit.geomID[i] = packet.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect16(valid, impl_->top, &query.context, &packet);
    // What they hit, and whether it shows its front.
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
      impl_->turn_to_ray(hit);
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
  Query query{*impl_->scene, packet_context()};
  RTCRay16 packet;
  begin_packets(packet);
  for (size_t first = 0; first < rays.size(); first += kPacket) {
    alignas(64) int valid[kPacket];
    const unsigned count = load_packet(rays.subspan(first), valid, packet);
    rtcOccluded16(valid, impl_->top, &query.context, &packet);
    for (unsigned i = 0; i < count; ++i) blocked[first + i] = packet.tfar[i] < 0 ? 1 : 0;
  }
}

namespace {

/// What is_empty() hands to Embree's callback.
struct BoxQuestion {
  const scene::Scene& scene;
  const TurnedBox& box;
  const std::function<bool(uint32_t, uint32_t)>& counts;
  bool is_empty = true;
};

/// Whether a triangle lies beyond one of the box's sides.
bool is_outside(const scene::Triangle3& t, const TurnedBox& box) {
  const std::array<float, 3> half{box.half_m.x, box.half_m.y, box.half_m.z};
  for (size_t k = 0; k < 3; ++k) {
    const float a = dot(t.a - box.middle, box.axes[k]), b = dot(t.b - box.middle, box.axes[k]),
                c = dot(t.c - box.middle, box.axes[k]);
    if (std::min({a, b, c}) > half[k] || std::max({a, b, c}) < -half[k]) return true;
  }
  return false;
}

/// Returns whether the radius has changed: nothing more is looked at once something is found.
bool look_at_triangle(RTCPointQueryFunctionArguments* args) {
  BoxQuestion& question = *static_cast<BoxQuestion*>(args->userPtr);
  if (!question.counts(args->geomID, args->primID)) return false;
  if (is_outside(scene::world_triangle(question.scene, args->geomID, args->primID), question.box))
    return false;
  question.is_empty = false;
  args->query->radius = 0;
  return true;
}

}  // namespace

bool RayTracer::is_empty(const TurnedBox& box,
                         const std::function<bool(uint32_t, uint32_t)>& counts) const {
  if (impl_->has_shared_meshes) return false;
  BoxQuestion question{*impl_->scene, box, counts};
  RTCPointQuery query;
  query.x = box.middle.x, query.y = box.middle.y, query.z = box.middle.z;
  query.time = 0, query.radius = length(box.half_m);
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(impl_->top, &query, &context, look_at_triangle, &question);
  return question.is_empty;
}

bool RayTracer::has_tints() const { return impl_->has_tints; }

void RayTracer::tint(std::span<const Ray> rays, std::span<const Hit> hits,
                     std::span<Rgb> light) const {
  LUXEL_CHECK(rays.size() == hits.size() && rays.size() == light.size());
  Query query{*impl_->scene, packet_context(), Through::tint};
  RTCRay16 packet;
  begin_packets(packet);
  for (size_t first = 0; first < rays.size(); first += kPacket) {
    alignas(64) int valid[kPacket];
    const unsigned count = load_packet(rays.subspan(first), valid, packet);
    // Up to just before the hit: what stands there has stopped the ray, not tinted it.
    for (unsigned i = 0; i < count; ++i)
      if (hits[first + i].found()) packet.tfar[i] = hits[first + i].t * (1 - 1e-6f);
    query.light = light.data() + first, query.count = count;
    query.passed_count.fill(0);
    rtcOccluded16(valid, impl_->top, &query.context, &packet);
  }
}

void RayTracer::transmitted(std::span<const Ray> rays, std::span<Rgb> share) const {
  LUXEL_CHECK(rays.size() == share.size());
  // Without tints, only holes let light through: all of it.
  Query query{*impl_->scene, packet_context(), has_tints() ? Through::share : Through::chance};
  RTCRay16 packet;
  begin_packets(packet);
  for (size_t first = 0; first < rays.size(); first += kPacket) {
    alignas(64) int valid[kPacket];
    const unsigned count = load_packet(rays.subspan(first), valid, packet);
    for (unsigned i = 0; i < count; ++i) share[first + i] = {1, 1, 1};
    query.light = share.data() + first, query.count = count;
    query.passed_count.fill(0);
    rtcOccluded16(valid, impl_->top, &query.context, &packet);
    for (unsigned i = 0; i < count; ++i)
      if (packet.tfar[i] < 0) share[first + i] = {};
  }
}

float rounding_m(Vec3 position, float scene_diagonal_m) {
  // Interpolating three corners, moving them into the world and intersecting them errs by some ten
  // roundings (2^-24) of the largest number involved; 2^-18 of it is safe and stays under a
  // hundredth of a millimetre per metre. [Waechter19]
  const Vec3 size{std::abs(position.x), std::abs(position.y), std::abs(position.z)};
  return 0x1p-18f * std::max(max_component(size), scene_diagonal_m);
}

Vec3 offset_origin(Vec3 position, Vec3 normal, float scene_diagonal_m) {
  return position + normal * rounding_m(position, scene_diagonal_m);
}

}  // namespace luxel::trace
