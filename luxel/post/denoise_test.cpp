#include "luxel/post/denoise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "luxel/base/parallel.h"
#include "luxel/base/random.h"
#include "luxel/post/neighbours.h"

namespace luxel::post {
namespace {

constexpr int kSide = 64;

/// A flat square of kSide x kSide texels of 1 cm, or two: the second one beyond the edge x = kSide
/// of the first, turned about it by an angle, as a chart of its own farther right in the atlas.
struct Sheet {
  scene::Scene scene;
  atlas::Atlas atlas;
  atlas::TexelMap map;
  std::vector<Vec3> position, normal;
  std::vector<uint8_t> hidden;
  std::vector<Rgb> values;
  std::vector<float> variance;
  Progress::Snapshot done;  ///< after filter()

  explicit Sheet(int charts = 1, float angle = 0) {
    constexpr float kTexel = 0.01f, kSize = kTexel * kSide;
    const int stride = kSide + 24;  // farther apart than windows are wide
    atlas.resolution = map.resolution = charts * stride;
    map.texel_at.assign(size_t(map.resolution) * size_t(map.resolution), atlas::kNone);
    atlas.chart_count = uint32_t(charts);
    scene.materials.resize(1);
    scene::Mesh mesh;
    for (int c = 0; c < charts; ++c) {
      const Vec3 along = c == 0 ? Vec3{1, 0, 0} : Vec3{std::cos(angle), 0, std::sin(angle)};
      const Vec3 corner = c == 0 ? Vec3{} : Vec3{kSize, 0, 0};
      const Vec3 n = cross(along, Vec3{0, 1, 0});
      const float x0 = 2 + float(c * stride), s = float(kSide);
      const uint32_t v = uint32_t(mesh.positions.size());
      for (const Vec2 p : {Vec2{0, 0}, Vec2{1, 0}, Vec2{1, 1}, Vec2{0, 1}})
        mesh.positions.push_back(corner + along * (p.x * kSize) + Vec3{0, p.y * kSize, 0});
      mesh.triangles.push_back({v, v + 1, v + 2}), mesh.triangles.push_back({v, v + 2, v + 3});
      atlas.corners.push_back({Vec2{x0, 2}, {x0 + s, 2}, {x0 + s, 2 + s}});
      atlas.corners.push_back({Vec2{x0, 2}, {x0 + s, 2 + s}, {x0, 2 + s}});
      for (int k = 0; k < 2; ++k) {
        atlas.chart.push_back(uint32_t(c));
        mesh.triangle_material.push_back(0);
      }
      for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x) {
          const uint32_t ax = uint32_t(int(x0) + x), ay = uint32_t(2 + y);
          map.texel_at[ay * size_t(map.resolution) + ax] = uint32_t(map.texels.size());
          map.texels.push_back(
              {uint16_t(ax), uint16_t(ay), {0, uint32_t(2 * c), {}}, uint32_t(2 * c), true});
          position.push_back(corner + along * (kTexel * (float(x) + 0.5f)) +
                             Vec3{0, kTexel * (float(y) + 0.5f), 0});
          normal.push_back(n);
        }
    }
    atlas.first_triangle = {0, uint32_t(2 * charts)};
    scene.meshes.push_back(mesh), scene.instances.push_back({"sheet", 0, {}});
    hidden.assign(position.size(), 0);
  }

  size_t size() const { return position.size(); }
  static int x_of(size_t i) { return int(i % (kSide * kSide)) % kSide; }
  static int y_of(size_t i) { return int(i % (kSide * kSide)) / kSide; }

  /// values = light(i) + independent normal noise, `stated` times its variance given along.
  template <class Light>
  void fill(const Light& light, float sigma, float stated = 1, uint64_t seed = 3) {
    RandomStream random{seed};
    values.clear(), variance.clear();
    for (size_t i = 0; i < size(); ++i) {
      const float r = std::sqrt(-2 * std::log(1 - random.next()));
      const float noise = sigma * r * std::cos(2 * kPi * random.next());
      values.push_back(max(light(i) + Rgb{1, 1, 1} * noise, Rgb{}));
      variance.push_back(stated * sigma * sigma);
    }
  }
  void filter(bool is_direct = false, const LookAgain& look_again = {}) {
    Progress progress;
    const TexelGeometry places{scene, atlas, map, position, normal, hidden, {}};
    const std::vector<NoisyLight> parts{{values, variance, is_direct, look_again}};
    ASSERT_TRUE(denoise(places, parts, {}, progress));
    done = progress.snapshot();
  }
  template <class Light>
  double rms(const Light& light) const {
    double sum = 0;
    for (size_t i = 0; i < size(); ++i) {
      const Rgb d = values[i] - light(i);
      sum += double(dot(d, d)) / 3;
    }
    return std::sqrt(sum / double(size()));
  }
};

Rgb flat(size_t) { return {1, 2, 0.5f}; }
Rgb slope(size_t i) {
  return Rgb{1, 1, 1} * (1 + 0.02f * float(Sheet::x_of(i)) + 0.01f * float(Sheet::y_of(i)));
}
Rgb step(size_t i) { return Rgb{1, 1, 1} * (Sheet::x_of(i) < kSide / 2 ? 1.0f : 3.0f); }

TEST(Denoise, ALightWithoutNoiseStaysBitForBit) {
  for (const auto& light : {flat, slope, step}) {
    Sheet sheet;
    sheet.fill(light, 0);
    const std::vector<Rgb> before = sheet.values;
    sheet.filter();
    EXPECT_EQ(sheet.values, before);
  }
}

// Variances that are stated where there is no noise: the constant and the plane are in the space of
// the fits. What is left is the rounding of floats, some 1e-6 of the largest value, and, for the
// slope, the ridge: 0.02 / 0.4 of a slope in the smallest window, which the centre of a window does
// not feel, and a border texel only in the first rounds.
TEST(Denoise, ConstantsAndSlopesStayThoughNoiseIsStated) {
  for (const auto& light : {flat, slope}) {
    Sheet sheet;
    sheet.fill(light, 0);
    sheet.variance.assign(sheet.size(), 1e-4f);
    sheet.filter();
    for (size_t i = 0; i < sheet.size(); ++i)
      EXPECT_NEAR(sheet.values[i].x, light(i).x, 1e-3f * light(i).x) << i;
  }
}

// All steps of the filter count, each as often as it was said to.
TEST(Denoise, TellsHowMuchIsDone) {
  Sheet sheet;
  sheet.fill(flat, 0.1f);
  sheet.filter();
  EXPECT_GT(sheet.done.total, 0u);
  EXPECT_EQ(sheet.done.done, sheet.done.total);
}

/// Standard deviation after the last window, of 9 texels, over that before, when all agree: the
/// weights w = 1 - d^2 / 81 of a full window, whose planes have the mean as their middle.
double predicted_factor() {
  double sum = 0, squares = 0;
  for (int y = -9; y <= 9; ++y)
    for (int x = -9; x <= 9; ++x) {
      const double w = std::max(0.0, 1 - double(x * x + y * y) / 81);
      sum += w, squares += w * w;
    }
  return sum / std::sqrt(squares);
}

// A full window reduces noise by 12.4. Planes at the border of the sheet are less certain (up to
// four times in variance at an edge, and 45 % of the texels lie within a window of one), and one
// texel in a hundred disagrees by chance: half of it must be reached, and more than it cannot be.
TEST(Denoise, NoiseFallsAsTheWindowsPredict) {
  ASSERT_NEAR(predicted_factor(), 13.8, 0.3);
  for (const float stated : {1.0f, 8.0f}) {
    for (const auto& light : {flat, slope}) {
      Sheet sheet;
      sheet.fill(light, 0.1f, stated);
      const double before = sheet.rms(light);
      sheet.filter();
      EXPECT_GT(before / sheet.rms(light), 0.5 * predicted_factor()) << stated;
      EXPECT_LT(before / sheet.rms(light), predicted_factor()) << stated;
    }
  }
}

// The step is 20 times the noise. Away from it by a texel nothing of the other side is left: the
// largest of 4096 errors of a mean over half a window, 0.1 / (0.5 * 12.4) times 4, is 0.07; 10 % of
// the step that is mixed in would be 0.2. On the texels beside it the same holds, for the second
// round takes them apart again.
TEST(Denoise, AnEdgeAboveTheNoiseStays) {
  Sheet sheet;
  sheet.fill(step, 0.1f);
  sheet.filter();
  for (size_t i = 0; i < sheet.size(); ++i) EXPECT_NEAR(sheet.values[i].x, step(i).x, 0.13f) << i;
  EXPECT_LT(sheet.rms(step), 0.1 / 5);
}

// Noise that is small beside the edge is of the size that is stated; the edge itself does not
// count.
TEST(Denoise, AnEdgeInConvergedLightMovesByLessThanItsNoise) {
  Sheet sheet;
  sheet.fill(step, 1e-4f, 16);
  sheet.filter();
  EXPECT_LT(sheet.rms(step), 1e-4);
  for (size_t i = 0; i < sheet.size(); ++i) EXPECT_NEAR(sheet.values[i].x, step(i).x, 6e-4f) << i;
}

/// Places of fireflies, farther apart than they are shared out.
bool is_firefly(size_t i) { return Sheet::x_of(i) % 11 == 4 && Sheet::y_of(i) % 13 == 6; }

// Each firefly is thirty times as bright as the field; together they have a sixth of the light. It
// stays in the map: shared out among texels within 6, and the filter spreads it farther. The
// brightest texel is a few deviations of what windows leave of the noise above the mean.
TEST(Denoise, FirefliesAreSharedOut) {
  Sheet sheet;
  sheet.fill(flat, 0.1f);
  double before = 0, after = 0;
  for (size_t i = 0; i < sheet.size(); ++i) {
    if (is_firefly(i)) sheet.values[i] = flat(i) * 30;
    // Its own square counts in the mean of 37 that is stated around it.
    const bool near =
        std::abs(Sheet::x_of(i) % 11 - 4) <= 3 && std::abs(Sheet::y_of(i) % 13 - 6) <= 3;
    if (near) sheet.variance[i] = 2 * 29 * 29 / 37.0f;
    before += double(sheet.values[i].y);
  }
  sheet.filter();
  float brightest = 0;
  for (const Rgb& v : sheet.values) after += double(v.y), brightest = std::max(brightest, v.y);
  // The filter leans towards medians (docs/method/denoise.md).
  EXPECT_NEAR(after, before, 0.02 * before);
  EXPECT_LT(brightest, 1.5 * before / double(sheet.size()));
}

// Fireflies of seven deviations, far below twice the light around: the filter alone holds them for
// light. Both halves of their samples have one, so that their own variance is that of all others.
TEST(Denoise, FaintFirefliesAreSharedOut) {
  Sheet sheet;
  sheet.fill(flat, 0.1f);
  const auto bright = [](size_t i) { return flat(i) * 1.4f; };
  for (size_t i = 0; i < sheet.size(); ++i)
    if (is_firefly(i)) sheet.values[i] = bright(i);
  sheet.filter();
  // Windows leave a noise of 0.1 / 13, 0.03 at borders; each firefly has 0.8 to share.
  for (size_t i = 0; i < sheet.size(); ++i) EXPECT_NEAR(sheet.values[i].y, 2, 0.15) << i;
}

// In direct light a texel that states as much noise as it stands out is looked at again. It is a
// firefly if it is seen to be dark, and light if it is not. Who states no more noise than the
// others is not looked at (a few of plain noise are), nor is anybody without a way to look.
TEST(Denoise, DirectFirefliesAreLookedAtAgain) {
  for (const bool stated : {true, false})
    for (const float seen : {2.0f, 7.9f}) {
      Sheet sheet;
      sheet.fill(flat, 0.1f);
      for (size_t i = 0; i < sheet.size(); ++i)
        if (is_firefly(i)) sheet.values[i] = flat(i) * 4, sheet.variance[i] = stated ? 9.0f : 0.01f;
      size_t looked = 0;
      const LookAgain look = [&](std::span<const uint32_t> texels) {
        looked += size_t(std::ranges::count_if(texels, is_firefly));
        return std::vector<Rgb>(texels.size(), flat(0) * (seen / 2));
      };
      Sheet blind = sheet;
      sheet.filter(true, look), blind.filter(true);
      const auto brightest = [](const Sheet& s) {
        float most = 0;
        for (const Rgb& v : s.values) most = std::max(most, v.y);
        return most;
      };
      EXPECT_EQ(looked > 0, stated);
      EXPECT_GT(brightest(blind), 7.5f);
      if (stated && seen == 2)
        EXPECT_LT(brightest(sheet), 2.4f);
      else
        EXPECT_GT(brightest(sheet), 7.5f);
    }
}

// Light that is known for sure stays, however bright and small: halves of rays that agree differ by
// rounding alone, a millionth of the light.
TEST(Denoise, ABrightTexelWithoutVarianceStays) {
  for (const float deviation : {0.0f, 60e-6f}) {
    Sheet sheet;
    sheet.fill(flat, 0.1f);
    for (size_t i = 0; i < sheet.size(); ++i)
      if (is_firefly(i)) sheet.values[i] = flat(i) * 30, sheet.variance[i] = deviation * deviation;
    sheet.filter();
    for (size_t i = 0; i < sheet.size(); ++i)
      if (is_firefly(i)) {
        EXPECT_NEAR(sheet.values[i].y, 60, 0.01) << i;
      } else {
        EXPECT_NEAR(sheet.values[i].y, 2, 0.2) << i;
      }
  }
}

// A spot of 2 x 2 texels and a line of one that are bright on purpose, though noisy: at least three
// texels of their kind are near. They are not shared out.
TEST(Denoise, SmallBrightThingsOfSeveralTexelsStay) {
  const auto light = [](size_t i) {
    const int x = Sheet::x_of(i), y = Sheet::y_of(i);
    const bool spot = (x == 20 || x == 21) && (y == 20 || y == 21);
    return Rgb{1, 1, 1} * (spot || x == 40 ? 10.0f : 1.0f);
  };
  Sheet sheet;
  sheet.fill(light, 0.1f);
  sheet.filter();
  for (size_t i = 0; i < sheet.size(); ++i) EXPECT_NEAR(sheet.values[i].x, light(i).x, 0.5) << i;
}

// The sum of both is kept, which the filter changes by some 1e-4 of the light; a window that takes
// in the other chart is a third of it there, some 1e-2.
TEST(Denoise, ChartsThatFaceDifferentWaysDoNotMix) {
  constexpr float kKept = 3e-4f;
  for (const float angle : {0.4f, kPi / 2, kPi}) {
    Sheet sheet(2, angle);
    // Differences far below the noise: only the directions tell the charts apart.
    const auto two = [](size_t i) { return Rgb{1, 1, 1} * (i < kSide * kSide ? 1.0f : 1.05f); };
    Sheet only_first(1);
    sheet.fill(two, 0.1f), only_first.fill(two, 0.1f);
    sheet.filter(), only_first.filter();
    for (size_t i = 0; i < only_first.size(); ++i)
      ASSERT_NEAR(sheet.values[i].x, only_first.values[i].x, kKept) << angle << " " << i;
  }
}

// A chart's border texels see half a window. Where the surface goes on in another chart the other
// half is found: they are as quiet as those in the middle, to within the statistics of 2 x 64
// correlated values (about 6 independent ones each: 40 %), where alone they are twice as noisy
// (the variance of a line's end is four times that of its mean).
TEST(Denoise, ASurfaceThatGoesOnInAnotherChartIsOne) {
  const auto border_rms = [](const Sheet& sheet) {
    double sum = 0;
    for (size_t i = 0; i < kSide * kSide; ++i)
      if (Sheet::x_of(i) == kSide - 1) sum += std::pow(double(sheet.values[i].x) - 1, 2);
    return std::sqrt(sum / kSide);
  };
  double joined = 0, apart = 0;
  for (uint64_t seed = 1; seed <= 8; ++seed) {
    Sheet one(2, 0), two(2, kPi / 2);
    one.fill([](size_t) { return Rgb{1, 1, 1}; }, 0.1f, 1, seed), two.values = one.values;
    two.variance = one.variance;
    one.filter(), two.filter();
    joined += border_rms(one) / 8, apart += border_rms(two) / 8;
  }
  EXPECT_LT(joined, 0.75 * apart);
}

TEST(Denoise, HiddenTexelsAreNeitherReadNorChanged) {
  Sheet sheet;
  sheet.fill(flat, 0.01f);
  const size_t dark = kSide * kSide / 2 + kSide / 2;
  sheet.values[dark] = {1.03f, 1.03f, 1.03f};
  sheet.hidden[dark] = 1;
  Sheet other = sheet;
  other.values[dark] = {1, 1, 1};
  sheet.filter(), other.filter();
  EXPECT_EQ(sheet.values[dark], (Rgb{1.03f, 1.03f, 1.03f}));
  sheet.values[dark] = other.values[dark];
  EXPECT_EQ(sheet.values, other.values);
}

// The mean over all texels is known before to sigma / 64; weights that are not symmetric add a
// little at the borders: three such deviations.
TEST(Denoise, KeepsTheMean) {
  for (const auto& light : {flat, slope, step}) {
    Sheet sheet;
    sheet.fill(light, 0.1f);
    double before = 0, after = 0;
    for (const Rgb& v : sheet.values) before += double(v.x) / double(sheet.size());
    sheet.filter();
    for (const Rgb& v : sheet.values) after += double(v.x) / double(sheet.size());
    EXPECT_NEAR(after, before, 3 * 0.1 / 64);
  }
}

// Noise of few samples is skewed: here -log of a uniform number, whose median is 0.69 of its mean.
// The sum stays to the rounding of floats.
TEST(Denoise, KeepsTheSumOfSkewedNoise) {
  Sheet sheet;
  sheet.fill(flat, 1);
  RandomStream random{5};
  double before = 0, after = 0;
  for (size_t i = 0; i < sheet.size(); ++i) {
    sheet.values[i] = flat(i) * (0.8f - 0.2f * std::log(1 - random.next()));
    sheet.variance[i] = 0.16f * luminance(flat(i)) * luminance(flat(i));
    before += double(sheet.values[i].x);
  }
  sheet.filter();
  for (const Rgb& v : sheet.values) after += double(v.x);
  EXPECT_NEAR(after, before, 1e-5 * before);
}

TEST(Denoise, StaysNonNegativeAndFiniteOverAHugeRange) {
  Sheet sheet;
  sheet.fill(flat, 0.1f);
  RandomStream random{11};
  for (size_t i = 0; i < sheet.size(); ++i) {
    const float e = std::pow(10.0f, 16 * random.next() - 8);
    sheet.values[i] = random.next() < 0.3f ? Rgb{} : Rgb{e, 0, 2 * e};
    sheet.variance[i] = e * e;
  }
  sheet.filter();
  for (const Rgb& v : sheet.values) {
    EXPECT_TRUE(is_finite(v));
    EXPECT_GE(min_component(v), 0);
  }
}

TEST(Denoise, SameBitsForAnyThreadCount) {
  Sheet one(2, 0);
  one.fill(step, 0.3f);
  Sheet seven = one;
  {
    const ThreadLimit limit(1);
    one.filter();
  }
  {
    const ThreadLimit limit(7);
    seven.filter();
  }
  EXPECT_EQ(one.values, seven.values);
}

TEST(Denoise, StopsWhenCancelled) {
  Sheet sheet;
  sheet.fill(flat, 0.1f);
  Progress progress;
  progress.request_cancel();
  const std::vector<NoisyLight> parts{{sheet.values, sheet.variance}};
  const Status status =
      denoise({sheet.scene, sheet.atlas, sheet.map, sheet.position, sheet.normal, sheet.hidden},
              parts, {}, progress);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, ErrorCode::cancelled);
}

}  // namespace
}  // namespace luxel::post
