#include "solve/hemicube/hemicube.h"

#include <gtest/gtest.h>

#include "scene/procedural.h"
#include "scene/shapes.h"
#include "tests/support.h"

namespace luxel::hemicube {
namespace {

Solution solved(const scene::Scene& scene, const HemicubeParams& params) {
  auto tracer = trace::RayTracer::build(scene);
  EXPECT_TRUE(tracer);
  Progress progress;
  auto out = solve(scene, transport::collect_lights(scene), *tracer, params, progress);
  EXPECT_TRUE(out) << out.error().message;
  return out ? std::move(*out) : Solution{};
}

// E = e / (1 - rho) - e, the same at every element: what a wall receives is what the others send.
// Shares of each hemisphere sum to 1 and light is the same everywhere, so only the exact direct
// light errs, by rounding, and the passes left out: 1e-4.
TEST(Hemicube, FurnaceIsExactAtEveryElement) {
  for (const float rho : {0.0f, 0.5f, 0.9f})
    for (const ElementKind kind : {ElementKind::vertex, ElementKind::triangle}) {
      const float e = kPi * 2;
      const scene::Scene box = scene::furnace_box({rho, rho, rho}, {2, 2, 2});
      HemicubeParams params;
      params.elements = kind, params.resolution = 16, params.element_size_m = 0.25f;
      const Solution s = solved(box, params);
      const float expected = e / (1 - rho);
      ASSERT_GT(s.field.irradiance.size(), 100u);
      float worst = 0;
      for (const Rgb& irradiance : s.field.irradiance)
        worst = std::max(worst, std::abs(irradiance.x / expected - 1));
      EXPECT_LT(worst, 0.01f) << rho << " " << int(kind);
      std::printf("rho %g kind %d elements %zu worst %g sweeps %d\n", double(rho), int(kind),
                  s.field.irradiance.size(), double(worst), s.sweeps);
    }
}

TEST(Hemicube, Cornell) {
  const scene::Scene box = scene::cornell_box();
  HemicubeParams params;
  params.max_elements = 10000;
  const auto t = std::chrono::steady_clock::now();
  const Solution s = solved(box, params);
  std::printf(
      "elements %zu sending %zu triangles %zu rays %zu sweeps %d bytes %zu err %g vis %g sum %g "
      "wall %g\n",
      s.field.irradiance.size(), s.sending_elements, s.field.mesh.triangle_count, size_t(s.rays),
      s.sweeps, size_t(s.row_bytes), s.relative_error, s.seconds.visibility, s.seconds.summation,
      std::chrono::duration<double>(std::chrono::steady_clock::now() - t).count());
}

}  // namespace
}  // namespace luxel::hemicube
