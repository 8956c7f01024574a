// luxel bench gpu-growth: rays of a graphics device as scenes grow, up to tens of millions of
// triangles, of which each is stored, or of copies of one mesh.
#include "bench/bench.h"
#include "luxel/base/clock.h"
#include "luxel/base/parallel.h"
#include "luxel/base/random.h"
#include "luxel/base/warp.h"
#include "luxel/scene/procedural.h"
#include "luxel/trace/vulkan/device_ray_tracer.h"

namespace luxel::bench {
namespace {

constexpr size_t kRays = size_t(1) << 22;
constexpr int kGrowthRounds = 5;

/// `copies` spheres of 20 * 4^levels triangles each, in a cube of the side 10.
scene::Scene spheres(int levels, int copies) {
  scene::Scene out = scene::inward_sphere(1, levels, {0.5f, 0.5f, 0.5f}, {});
  const scene::Instance one = out.instances.front();
  out.instances.clear();
  RandomStream random{5};
  for (int k = 0; k < copies; ++k) {
    scene::Instance instance = one;
    instance.world_from_object =
        translation({8 * random.next() + 1, 8 * random.next() + 1, 8 * random.next() + 1});
    out.instances.push_back(instance);
  }
  return out;
}

/// From all over the scene in all directions.
std::vector<trace::Ray> rays_in(const scene::Scene& scene) {
  const Box3 box = scene::world_bounds(scene);
  const Vec3 size = box.upper - box.lower;
  std::vector<trace::Ray> out(kRays);
  parallel_for(kRays, 4096, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      RandomStream random{hash64(7, i)};
      const Vec3 from{box.lower.x + size.x * random.next(), box.lower.y + size.y * random.next(),
                      box.lower.z + size.z * random.next()};
      out[i] = {from, 0, uniform_sphere_sample(random.next2()), INFINITY};
    }
  });
  return out;
}

Status add_scene(const scene::Scene& scene, const gpu::Device& device, Table& table) {
  const std::vector<trace::Ray> rays = rays_in(scene);
  auto start = Clock::now();
  LUXEL_TRY(trace::DeviceRayTracer tracer, trace::DeviceRayTracer::build(device, scene));
  const double built_s = seconds_since(start);
  LUXEL_TRY(trace::DeviceRays there, tracer.upload(rays));
  double device_s = INFINITY, processor_s = INFINITY;
  LUXEL_TRY(const trace::RayTracer on_processor, trace::RayTracer::build(scene));
  std::vector<trace::Hit> hits(rays.size());
  for (int k = 0; k < kGrowthRounds; ++k) {
    LUXEL_TRY(const double seconds, tracer.closest_hits(there));
    device_s = std::min(device_s, seconds);
    start = Clock::now();
    parallel_for(rays.size(), 4096, [&](size_t begin, size_t end) {
      on_processor.closest_hits(std::span(rays).subspan(begin, end - begin),
                                std::span(hits).subspan(begin, end - begin));
    });
    processor_s = std::min(processor_s, seconds_since(start));
  }
  const uint32_t drawn = scene::first_triangles(scene).back();
  const double rate = double(rays.size()) * 1e-6;
  table.rows.push_back({std::to_string(drawn), std::to_string(tracer.triangles()),
                        fmt::format("{:.2f}", built_s), fmt::format("{:.1f}", rate / device_s),
                        fmt::format("{:.1f}", rate / processor_s)});
  table.json.push_back({{"drawn", drawn},
                        {"stored", tracer.triangles()},
                        {"built_s", built_s},
                        {"device_mrays_per_s", rate / device_s},
                        {"processor_mrays_per_s", rate / processor_s}});
  return {};
}

}  // namespace

Result<Table> measure_gpu_growth(const std::filesystem::path&, int threads) {
  const ThreadLimit limit(threads);
  Table table = new_table("gpu-growth", {"triangles drawn", "stored", "built in [s]",
                                         "device [Mrays/s]", "processor [Mrays/s]"});
  LUXEL_TRY(const auto device, gpu::Device::open({}));
  table.notes.push_back("device: " + device->name);
  // Less of it where a processor plays the device.
  const bool is_card = device->type != VK_PHYSICAL_DEVICE_TYPE_CPU;
  for (const int levels : {6, 8, 10})
    if (is_card || levels == 6) LUXEL_TRY_STATUS(add_scene(spheres(levels, 1), *device, table));
  LUXEL_TRY_STATUS(add_scene(spheres(is_card ? 8 : 6, 16), *device, table));
  return table;
}

}  // namespace luxel::bench
