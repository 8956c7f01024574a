// Rays that a device makes are those of the processor. Skipped without a device.
#include "luxel/solve/device/first_hits.h"

#include <gmock/gmock.h>

#include "luxel/base/random.h"
#include "luxel/base/warp.h"
#include "luxel/gpu/device_test_support.h"
#include "luxel/scene/procedural.h"

namespace luxel::device {
namespace {

/// Elements on the unit sphere, some of whose normals are bent.
transport::Elements elements_on_sphere(size_t count) {
  RandomStream random{17};
  transport::Elements out;
  for (size_t i = 0; i < count; ++i) {
    const Vec3 flat = uniform_sphere_sample(random.next2());
    const Vec3 bent = normalize(flat + 0.8f * uniform_sphere_sample(random.next2()));
    out.position.push_back(flat), out.geometric_normal.push_back(flat);
    out.normal.push_back(i % 2 ? bent : flat);
  }
  out.normal[0] = out.geometric_normal[0] = {0, 0, 1};
  out.normal[1] = out.geometric_normal[1] = {0, 0, -1};
  return out;
}

/// Directions as they come back from a large sphere around: where they meet it.
std::vector<Vec3> met_places(const scene::Scene& scene, const FirstHits& hits,
                             std::span<const on_device::Hit> values, size_t element) {
  std::vector<Vec3> out;
  for (size_t k = 0; k < hits.params.samples; ++k) {
    const on_device::Hit& hit = values[hits.index_of(element, k)];
    EXPECT_NE(hit.number, on_device::kNoTriangle);
    out.push_back(
        scene::world_position(scene, {0, hit.number & ~on_device::kBackFace, {hit.u, hit.v}}));
  }
  return out;
}

using FirstHitsOnDevice = gpu::testing::OnDevice;

// 10^5 rays from a small sphere to a large one around it. The number of samples is that of cells, a
// multiple, less, and no multiple. Directions agree to some roundings of the square root that tells
// how far they lean, which are largest near the pole: 10^-4 of the way.
TEST_F(FirstHitsOnDevice, AreThoseOfTheProcessorsRays) {
  const scene::Scene scene = scene::inward_sphere(10, 4, {0.5f, 0.5f, 0.5f}, {});
  const transport::Elements elements = elements_on_sphere(350);  // no multiple of 64
  const auto embree = trace::RayTracer::build(scene);
  using trace::HierarchyKind;
  for (const HierarchyKind kind :
       {HierarchyKind::binary, HierarchyKind::wide, HierarchyKind::driver}) {
    if (kind == HierarchyKind::driver && !device_->has_ray_queries) continue;
    const auto tracer = trace::DeviceRayTracer::build(*device_, scene, kind);
    ASSERT_TRUE(tracer);
    for (const uint32_t samples : {32u, 64u, 100u, 128u}) {
      const uint64_t seed = 5;
      auto hits = prepare_first_hits(*tracer, *commands_, elements, {samples, seed});
      ASSERT_TRUE(hits) << hits.error().message;
      ASSERT_TRUE(trace_first_hits(*tracer, *commands_, *hits));
      const auto values = gpu::downloaded<on_device::Hit>(
          *commands_, hits->hits, hits->hits.size / sizeof(on_device::Hit), "hits");
      ASSERT_TRUE(values) << values.error().message;
      for (size_t i = 0; i < elements.size(); ++i) {
        std::vector<trace::Ray> rays(samples);
        gather::element_rays(elements.position[i], elements.normal[i], elements.geometric_normal[i],
                             gather::seed_of_rays(seed, i), rays);
        const std::vector<Vec3> places = met_places(scene, *hits, *values, i);
        for (size_t k = 0; k < samples; ++k) {
          const trace::Hit expected = embree->closest_hit(rays[k]);
          ASSERT_LT(length(places[k] - scene::world_position(scene, expected.point())), 1e-3f)
              << "samples " << samples << ", element " << i << ", ray " << k;
        }
      }
    }
  }
}

}  // namespace
}  // namespace luxel::device
