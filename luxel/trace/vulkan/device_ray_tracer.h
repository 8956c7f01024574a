// Finds the surfaces that rays meet, on a graphics device.
#pragma once

#include <functional>
#include <span>

#include "luxel/gpu/buffer.h"
#include "luxel/gpu/commands.h"
#include "luxel/gpu/pieces.h"
#include "luxel/gpu/pipeline.h"
#include "luxel/trace/ray_tracer.h"
#include "luxel/trace/vulkan/device_hierarchy.h"
#include "luxel/trace/vulkan/driver_hierarchy.h"

namespace luxel::trace {

/// Rays in a device's memory, and room for what they meet.
struct DeviceRays {
  size_t count = 0;
  gpu::Buffer rays;  ///< trace::Ray, as on the processor
  gpu::Buffer hits;  ///< on_device::Hit of each, once closest_hits() has run
};

static_assert(sizeof(Ray) == 32);  // as shaders/ray.glsl reads it

/// Rays and triangles in a device's memory; meshes with several instances are stored once, as
/// RayTracer stores them. It answers as RayTracer does, up to rounding: rays that
/// graze an edge may meet its other side, and of surfaces that coincide either may be met. Surfaces
/// let light through by chance as they do there: the same ray has the same luck. It knows no tints.
/// `device` and `scene` are kept by reference and must outlive it. One thread at a time uses it.
class DeviceRayTracer {
 public:
  /// `kind`: HierarchyKind::driver only where Device::has_ray_queries. Errors: those of
  /// stored_triangles() and driver_hierarchy(), a scene of 10^15 m (ErrorCode::unsupported), no
  /// memory, the device is lost.
  static Result<DeviceRayTracer> build(const gpu::Device& device, const scene::Scene& scene,
                                       HierarchyKind kind,
                                       size_t max_flat_triangles = kMaxFlatTriangles);
  /// By faster_hierarchy().
  static Result<DeviceRayTracer> build(const gpu::Device& device, const scene::Scene& scene);

  /// hits[i] is what rays[i] meets first. Sizes are equal. They go to the device and back in parts
  /// of at most kRaysAtATime. Errors: no memory, the device is lost.
  Status closest_hits(std::span<const Ray> rays, std::span<Hit> hits);
  /// blocked[i] is 1 when anything lies on rays[i] within [t_min, t_max]. Errors: as above.
  Status occluded(std::span<const Ray> rays, std::span<uint8_t> blocked);

  /// Puts some rays into the device's memory, kMostRays at most. Errors: no memory, the device is
  /// lost.
  Result<DeviceRays> upload(std::span<const Ray> rays);
  /// Fills rays.hits; returns the seconds until the device was done, as the processor sees them.
  /// Errors: the device is lost.
  Result<double> closest_hits(DeviceRays& rays);

  /// A device's hit as those of RayTracer: what has two sides is met on the side that the ray comes
  /// from.
  Hit hit_of(const on_device::Hit& met) const;

  /// For shaders that trace rays themselves: they include shaders/hierarchy.glsl, are compiled for
  /// kind() (luxel_ray_shaders() in CMake), and get shader_constant() as their constant 0.
  on_device::World world() const;
  HierarchyKind kind() const { return kind_; }
  uint32_t shader_constant() const {
    return uint32_t(lets_light_through_) | uint32_t(has_instances_) << 1;
  }
  const gpu::Device& device() const { return *device_; }
  /// That are stored, places of instances among them.
  size_t triangles() const { return triangle_count_; }

  static constexpr size_t kRaysAtATime = 1u << 20;
  static constexpr size_t kMostRays = 1u << 29;  ///< whose numbers shaders can double

 private:
  DeviceRayTracer(const gpu::Device& device, const scene::Scene& scene, gpu::Commands commands);
  Status upload_hierarchy(HierarchyKind kind, size_t max_flat_triangles);
  Status upload_driver_hierarchy(size_t max_flat_triangles);
  Status upload_see_through(const SeeThrough& open);
  Status make_pipelines();
  Result<double> dispatch(const gpu::Pipeline& pipeline, VkDeviceAddress rays, VkDeviceAddress out,
                          size_t count);
  /// Sends rays there part by part; the answers of [first, first + count) then lie in answered_.
  using AtPart = std::function<void(size_t first, size_t count)>;
  Status trace_parts(const gpu::Pipeline& pipeline, size_t bytes_per_answer,
                     std::span<const Ray> rays, const AtPart& at_part);
  Status make_room(size_t count);

  const gpu::Device* device_;
  const scene::Scene* scene_;
  gpu::Commands commands_;
  std::vector<uint32_t> first_triangle_;
  size_t triangle_count_ = 0;
  HierarchyKind kind_ = HierarchyKind::binary;
  // Some triangle lets light through; meshes are shared. Shaders without either are faster.
  bool lets_light_through_ = false, has_instances_ = false;
  gpu::Buffer nodes_, triangles_;
  DriverAcceleration driver_;  ///< instead of nodes_; ends before triangles_
  gpu::Buffer open_materials_, open_triangles_, open_texels_;  ///< SeeThrough
  gpu::Pipeline closest_, occluded_;
  gpu::PieceSize piece_;
  // Where rays from the processor and their answers stop on their way.
  gpu::Buffer sent_, answered_;
  DeviceRays room_;
};

}  // namespace luxel::trace
