#include "luxel/solve/hierarchical/feedback.h"

#include "luxel/base/random.h"
#include "luxel/solve/hierarchical/hierarchical_test_support.h"

namespace luxel::hierarchical {
namespace {

using testing::solved;

// Against sums over many places: the nearest linear function has the same mean, and the same
// moments along s and t.
TEST(LinearOf, KeepsMeanAndFirstMoments) {
  RandomStream random{9};
  for (int trial = 0; trial < 10; ++trial) {
    Interpolant r;
    for (Rgb& c : r) c = Rgb{1, 1, 1} * (2 * random.next() - 1);
    const std::array<Rgb, 3> linear = linear_of(r);
    constexpr int n = 200;
    double off = 0, off_s = 0, off_t = 0;
    for (int j = 0; j < n; ++j)
      for (int i = 0; i + j < n; ++i)
        for (const double part : {1 / 3.0, 2 / 3.0}) {  // of the square's two triangles
          if (part > 0.5 && i + j == n - 1) continue;
          const double s = (i + part) / n, t = (j + part) / n;
          const Rgb there =
              linear[0] * float(1 - s - t) + linear[1] * float(s) + linear[2] * float(t);
          const double d = double((value_of(r, float(s), float(t)) - there).x);
          off += d, off_s += d * s, off_t += d * t;
        }
    // The sums' own error falls like 1 / n^2; float's rounding is below.
    EXPECT_NEAR(off / (n * n), 0, 2e-5);
    EXPECT_NEAR(off_s / (n * n), 0, 2e-5);
    EXPECT_NEAR(off_t / (n * n), 0, 2e-5);
  }
}

// Links that bring a tenth less than they should: a closed room loses a good part of what its lamp
// emits, and has it back once exact light has been fed back some times.
TEST(FeedBack, CorrectsLinksThatAreWrong) {
  const auto s = solved(scene::radiosity_box(), {.eps = 0.1});
  Progress progress;
  for (auto& links : s->solution.links.of)
    for (Link& link : links) {
      link.factor *= 0.9f;
      for (float& to : link.to) to *= 0.9f;
    }
  ASSERT_TRUE(iterate(s->solution, *s->tracer, 1e-5, progress));
  EXPECT_LT(absorbed_over_emitted(s->solution), 0.87);
  double change = INFINITY;
  for (int k = 0; k < 4; ++k) {
    const auto mesh = make_light_mesh(s->solution, s->scene, *s->tracer, {}, progress);
    ASSERT_TRUE(mesh);
    const auto changed = feed_back(s->solution, *s->tracer, *mesh, progress);
    ASSERT_TRUE(changed);
    EXPECT_LT(*changed, 0.4 * change) << k;  // links err by 0.1, light of all bounces by 0.3
    change = *changed;
  }
  // Interpolants over these elements lose half a hundredth, which only dividing them would mend.
  EXPECT_NEAR(absorbed_over_emitted(s->solution), 1, 0.01);
}

}  // namespace
}  // namespace luxel::hierarchical
