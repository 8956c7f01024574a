// Solvers whose elements are larger than the gap between two surfaces, against the path tracer, in
// a room with a rug and a picture 5 mm off floor and wall. What covered places got beyond their due
// was lost by those around.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "luxel/pipeline/solver/hemicube.h"
#include "luxel/pipeline/solver/hierarchical.h"
#include "luxel/pipeline/solver/matrix.h"
#include "luxel/solve/matrix/relight.h"
#include "luxel/solve/matrix/relighter.h"
#include "luxel/validate/agreement.h"
#include "tests/contact_room.h"

namespace luxel::validate {
namespace {

constexpr int kResolution = 64;
/// From 1.3 gaps inwards of the border a tenth of the light is left (luxel/transport/covers.h).
constexpr float kInside_m = 0.01f;
/// Distance around things within which light is lost: somewhat more than the side of a patch.
constexpr float kNear_m = 0.15f;

/// Errors of some texels' luminance. The square is of the solver alone: (g - a)(g - b).
struct Part {
  double truth = 0, solved = 0, square = 0, count = 0;
  double bias() const { return solved / truth - 1; }
  double rms_over(double mean) const { return std::sqrt(std::max(0.0, square / count)) / mean; }
};

struct Parts {
  Part covered, near, open;  ///< near is part of open
  double mean = 0;           ///< light of open texels
};

/// The room with its path-traced light.
struct JudgedRoom {
  test::ContactRoom room;
  std::unique_ptr<Prepared> p;
  Judged judged;

  explicit JudgedRoom(test::Thin thin) : room(test::contact_room_with(thin)) {
    Progress progress;
    auto prepared = prepare(room.scene, kResolution, progress);
    EXPECT_TRUE(prepared);
    p = std::move(*prepared);
    auto answer = judge(*p, 128, 1, progress);
    EXPECT_TRUE(answer);
    judged = std::move(*answer);
  }

  /// `hidden` may be empty.
  Parts parts_of(std::span<const Rgb> light, std::span<const uint8_t> hidden) const {
    Parts out;
    const auto add = [&](Part& part, size_t i) {
      const double a = double(luminance(judged.first[i])), b = double(luminance(judged.second[i]));
      const auto g = double(luminance(light[i]));
      part.truth += (a + b) / 2, part.solved += g, part.square += (g - a) * (g - b);
      part.count += 1;
    };
    for (size_t i = 0; i < light.size(); ++i) {
      const Vec3 at = p->elements.position[i], normal = p->elements.geometric_normal[i];
      if (room.is_covered(at, normal, kInside_m)) add(out.covered, i);
      if (judged.hidden[i] || (!hidden.empty() && hidden[i]) || room.is_covered(at, normal, 0))
        continue;
      add(out.open, i);
      if (room.is_near(at, normal, kNear_m)) add(out.near, i);
    }
    out.mean = out.open.truth / out.open.count;
    return out;
  }
};

/// Allowed error of light at covered places, over the mean: a texel is 0.1 m wide here, and the
/// truth of those next to the border is 0.02.
constexpr double kCovered = 0.03;

void expect_right(const Parts& parts, double near_bias, double open_rms) {
  EXPECT_GT(parts.covered.count, 100);
  EXPECT_GT(parts.near.count, 200);
  EXPECT_LT(parts.covered.rms_over(parts.mean), kCovered);
  EXPECT_LT(std::abs(parts.near.bias()), near_bias);
  EXPECT_LT(parts.open.rms_over(parts.mean), open_rms);
}

/// The stated error holds, as far as the judge can tell: its noise of 256 paths, some 0.03 of the
/// mean per texel, leaves an uncertainty of 0.03 / 2500^(1/4) = 0.004 in a root mean square.
void expect_true(double stated, const Parts& parts) {
  EXPECT_GT(stated + 0.004, parts.open.rms_over(parts.mean));
  EXPECT_LT(stated, 0.12) << "a statement that says nothing";
}

std::string name_of(const testing::TestParamInfo<test::Thin>& thin) {
  constexpr std::array kNames{"Sheet", "DoubleSidedSheet", "Box"};
  return kNames[size_t(thin.param)];
}
/// One-sided sheets are left out: they show the same as double-sided ones.
constexpr std::array kThin{test::Thin::double_sided_sheet, test::Thin::box};

class SlowNearContacts : public testing::TestWithParam<test::Thin> {};
INSTANTIATE_TEST_SUITE_P(Rooms, SlowNearContacts, testing::ValuesIn(kThin), name_of);

TEST_P(SlowNearContacts, SolversLoseNoLightAndLightNoGap) {
  const JudgedRoom room(GetParam());
  pipeline::BakeSettings settings;
  settings.own.of<matrix::MatrixParams>().patches.count = 2048;
  settings.own.of<hemicube::HemicubeParams>().max_elements = 5000;
  settings.own.of<hemicube::HemicubeParams>().resolution = 32;
  auto& hierarchical = settings.own.of<pipeline::HierarchicalSettings>();
  hierarchical.solve.eps = 0.1, hierarchical.mesh.discontinuities = false;
  // Measured 0.006, 0.010 to 0.013 (matrix, hemicube) and 0.014, 0.023 (hierarchical, whose eps is
  // a fourteenth of the mean).
  struct Row {
    std::string_view solver;
    double near_bias, open_rms;
  };
  for (const Row& row :
       {Row{"matrix", 0.012, 0.02}, {"hemicube", 0.01, 0.02}, {"hierarchical", 0.03, 0.04}}) {
    SCOPED_TRACE(row.solver);
    Progress progress;
    const auto solved = solve(*room.p, row.solver, settings, progress);
    ASSERT_TRUE(solved) << solved.error().message;
    const Parts parts = room.parts_of(solved->light.irradiance, solved->light.hidden);
    expect_right(parts, row.near_bias, row.open_rms);
    expect_true(solved->light.relative_error, parts);
  }
}

TEST_P(SlowNearContacts, TheRelighterDoesAsWell) {
  const JudgedRoom room(GetParam());
  const transport::Elements& texels = room.p->elements;
  matrix::Target target{.kind = matrix::Target::Kind::texels,
                        .width = kResolution,
                        .height = kResolution,
                        .texel = {},
                        .position = copied(texels.position),
                        .normal = copied(texels.normal),
                        .geometric_normal = copied(texels.geometric_normal),
                        .transfer = {}};
  for (const atlas::Texel& t : room.p->map.texels)
    target.texel.push_back({uint16_t(t.x), uint16_t(t.y)});
  Progress progress;
  auto data = matrix::make_relight_data(
      room.p->scene, *room.p->tracer, std::move(target),
      {.patches = {.count = 2048}, .factors = {.rays_per_patch = 4096}}, progress);
  ASSERT_TRUE(data) << data.error().message;
  auto relighter = matrix::Relighter::make(std::move(*data), {});
  ASSERT_TRUE(relighter) << relighter.error().message;
  relighter->update({});  // materials glow as baked
  // The lamp is a few patches, and its light as sharp as patches: measured 0.023 and 0.037.
  expect_right(room.parts_of(relighter->latest().indirect_at_points, {}), 0.035, 0.06);
}

}  // namespace
}  // namespace luxel::validate
