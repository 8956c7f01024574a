#include "luxel/trace/vulkan/device_ray_tracer.h"

#include <algorithm>
#include <cstring>

#include "luxel/base/check.h"
#include "luxel/base/parallel.h"
#include "luxel/scene/drawn_triangle.h"
#include "luxel/scene/sides.h"
#include "luxel/trace/vulkan/faster_hierarchy.h"
#include "luxel/trace/vulkan/shaders/closest.comp.h"
#include "luxel/trace/vulkan/shaders/occluded.comp.h"
#include "luxel/trace/vulkan/trace_push_shared.h"

namespace luxel::trace {
namespace {

constexpr size_t kGroup = 64;  // as the shaders have it
/// Beyond it, products of lengths are no floats.
constexpr float kLargestScene_m = 1e15f;
constexpr std::string_view kTriangles = "the buffer of triangles";

using on_device::TracePush;

}  // namespace

DeviceRayTracer::DeviceRayTracer(const gpu::Device& device, const scene::Scene& scene,
                                 gpu::Commands commands)
    : device_(&device),
      scene_(&scene),
      commands_(std::move(commands)),
      first_triangle_(scene::first_triangles(scene)) {}

Status DeviceRayTracer::upload_hierarchy(HierarchyKind kind, size_t max_flat_triangles) {
  kind_ = kind;
  if (!(scene::world_bounds(*scene_).diagonal() < kLargestScene_m))
    return fail(ErrorCode::unsupported, "the device cannot trace rays in a scene of more than {} m",
                kLargestScene_m);
  if (kind == HierarchyKind::driver) return upload_driver_hierarchy(max_flat_triangles);
  LUXEL_TRY(const DeviceHierarchy hierarchy, device_hierarchy(*scene_, kind, max_flat_triangles));
  triangle_count_ = hierarchy.triangles.size(), has_instances_ = hierarchy.has_instances;
  LUXEL_TRY_STATUS(upload_see_through(hierarchy.see_through));
  constexpr std::string_view kBoxes = "the buffer of boxes around triangles";
  LUXEL_TRY(nodes_, kind == HierarchyKind::wide
                        ? gpu::uploaded_or_one(commands_, hierarchy.wide, kBoxes)
                        : gpu::uploaded_or_one(commands_, hierarchy.binary, kBoxes));
  LUXEL_TRY(triangles_, gpu::uploaded_or_one(commands_, hierarchy.triangles, kTriangles));
  return {};
}

Status DeviceRayTracer::upload_driver_hierarchy(size_t max_flat_triangles) {
  LUXEL_CHECK(device_->has_ray_queries);
  LUXEL_TRY(const DriverHierarchy hierarchy, driver_hierarchy(*scene_, max_flat_triangles));
  triangle_count_ = hierarchy.triangles.size(), has_instances_ = hierarchy.has_instances;
  LUXEL_TRY_STATUS(upload_see_through(hierarchy.see_through));
  LUXEL_TRY(triangles_, gpu::uploaded_or_one(commands_, hierarchy.triangles, kTriangles));
  LUXEL_TRY(driver_, accelerate(commands_, hierarchy, triangles_));
  return {};
}

Status DeviceRayTracer::upload_see_through(const SeeThrough& open) {
  constexpr std::string_view kOpen = "the buffer of surfaces that let light through";
  lets_light_through_ = !open.triangles.empty();
  LUXEL_TRY(open_materials_, gpu::uploaded_or_one(commands_, open.materials, kOpen));
  LUXEL_TRY(open_triangles_, gpu::uploaded_or_one(commands_, open.triangles, kOpen));
  LUXEL_TRY(open_texels_, gpu::uploaded_or_one(commands_, open.texels, kOpen));
  return {};
}

Status DeviceRayTracer::make_pipelines() {
  const auto make = [&](gpu::Spirv shader) {
    return gpu::make_compute_pipeline(*device_, shader, {sizeof(TracePush), {}},
                                      {shader_constant()});
  };
  LUXEL_TRY(closest_, make(closest_comp(kind_)));
  LUXEL_TRY(occluded_, make(occluded_comp(kind_)));
  return {};
}

Result<DeviceRayTracer> DeviceRayTracer::build(const gpu::Device& device, const scene::Scene& scene,
                                               HierarchyKind kind, size_t max_flat_triangles) {
  LUXEL_TRY(gpu::Commands commands, gpu::Commands::make(device));
  DeviceRayTracer out(device, scene, std::move(commands));
  LUXEL_TRY_STATUS(out.upload_hierarchy(kind, max_flat_triangles));
  LUXEL_TRY_STATUS(out.make_pipelines());
  return out;
}

Result<DeviceRayTracer> DeviceRayTracer::build(const gpu::Device& device,
                                               const scene::Scene& scene) {
  const HierarchyKind kind = faster_hierarchy(device);
  auto built = build(device, scene, kind);
  if (built || kind != HierarchyKind::driver) return built;
  // luxel's own hierarchy may hold a scene that the driver's cannot.
  return build(device, scene, own_hierarchy(device));
}

on_device::World DeviceRayTracer::world() const {
  return {kind_ == HierarchyKind::driver ? driver_.world.address : nodes_.address,
          triangles_.address,
          {open_materials_.address, open_triangles_.address, open_texels_.address}};
}

Result<double> DeviceRayTracer::dispatch(const gpu::Pipeline& pipeline, VkDeviceAddress rays,
                                         VkDeviceAddress out, size_t count) {
  const size_t most = kGroup * device_->limits.maxComputeWorkGroupCount[0];
  return gpu::run_in_pieces(
      commands_, count, most, piece_, [&](VkCommandBuffer c, size_t first, size_t some) {
        const TracePush push{world(), rays, out, uint32_t(first), uint32_t(first + some)};
        gpu::bind(*device_, c, pipeline, push);
        device_->vk.vkCmdDispatch(c, uint32_t((some + kGroup - 1) / kGroup), 1, 1);
      });
}

Status DeviceRayTracer::make_room(size_t count) {
  if (room_.count >= count) return {};
  room_ = {}, sent_ = {}, answered_ = {};
  constexpr std::string_view kWhat = "the buffer of rays";
  LUXEL_TRY(sent_, gpu::make_buffer(*device_, count * sizeof(Ray), gpu::Access::from_host, kWhat));
  LUXEL_TRY(answered_, gpu::make_buffer(*device_, count * sizeof(on_device::Hit),
                                        gpu::Access::to_host, kWhat));
  LUXEL_TRY(room_.rays,
            gpu::make_buffer(*device_, count * sizeof(Ray), gpu::Access::device, kWhat));
  LUXEL_TRY(room_.hits,
            gpu::make_buffer(*device_, count * sizeof(on_device::Hit), gpu::Access::device, kWhat));
  room_.count = count;
  return {};
}

Hit DeviceRayTracer::hit_of(const on_device::Hit& met) const {
  if (met.number == on_device::kNoTriangle) return {};
  const auto drawn = scene::drawn_triangle(first_triangle_, met.number & ~on_device::kBackFace);
  Hit out{met.t,
          drawn.instance,
          drawn.triangle,
          {met.u, met.v},
          (met.number & on_device::kBackFace) != 0};
  if (!out.back_face) return out;
  if (const auto other = scene::other_side_of(*scene_, out.point()))
    out.triangle = other->triangle, out.at = other->at, out.back_face = false;
  return out;
}

Status DeviceRayTracer::trace_parts(const gpu::Pipeline& pipeline, size_t bytes_per_answer,
                                    std::span<const Ray> rays, const AtPart& at_part) {
  for (size_t first = 0; first < rays.size(); first += kRaysAtATime) {
    const size_t count = std::min(kRaysAtATime, rays.size() - first);
    LUXEL_TRY_STATUS(make_room(count));
    std::memcpy(sent_.mapped, rays.data() + first, count * sizeof(Ray));
    LUXEL_TRY_STATUS(gpu::copy_bytes(commands_, sent_, room_.rays, count * sizeof(Ray)));
    LUXEL_TRY([[maybe_unused]] const double seconds,
              dispatch(pipeline, room_.rays.address, room_.hits.address, count));
    LUXEL_TRY_STATUS(gpu::copy_bytes(commands_, room_.hits, answered_, count * bytes_per_answer));
    at_part(first, count);
  }
  return {};
}

Status DeviceRayTracer::closest_hits(std::span<const Ray> rays, std::span<Hit> hits) {
  LUXEL_CHECK(rays.size() == hits.size());
  return trace_parts(closest_, sizeof(on_device::Hit), rays, [&](size_t first, size_t count) {
    const auto* met = reinterpret_cast<const on_device::Hit*>(answered_.mapped);
    parallel_for(count, 4096, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) hits[first + i] = hit_of(met[i]);
    });
  });
}

Status DeviceRayTracer::occluded(std::span<const Ray> rays, std::span<uint8_t> blocked) {
  LUXEL_CHECK(rays.size() == blocked.size());
  return trace_parts(occluded_, sizeof(uint32_t), rays, [&](size_t first, size_t count) {
    const auto* is_blocked = reinterpret_cast<const uint32_t*>(answered_.mapped);
    for (size_t i = 0; i < count; ++i) blocked[first + i] = is_blocked[i] != 0;
  });
}

Result<DeviceRays> DeviceRayTracer::upload(std::span<const Ray> rays) {
  LUXEL_CHECK(!rays.empty() && rays.size() <= kMostRays);
  DeviceRays out;
  out.count = rays.size();
  constexpr std::string_view kWhat = "the buffer of rays";
  LUXEL_TRY(out.rays, gpu::uploaded(commands_, std::as_bytes(rays), kWhat));
  LUXEL_TRY(out.hits, gpu::make_buffer(*device_, rays.size() * sizeof(on_device::Hit),
                                       gpu::Access::device, kWhat));
  return out;
}

Result<double> DeviceRayTracer::closest_hits(DeviceRays& rays) {
  return dispatch(closest_, rays.rays.address, rays.hits.address, rays.count);
}

}  // namespace luxel::trace
