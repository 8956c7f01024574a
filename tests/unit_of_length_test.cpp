// E has no unit of length in it: a scene that is scaled, its lamps with it, has the light that it
// had.
#include <gtest/gtest.h>

#include "luxel/pipeline/solver/hemicube.h"
#include "luxel/pipeline/solver/matrix.h"
#include "luxel/validate/prepared.h"
#include "tests/extremes.h"

namespace luxel::testing_support {
namespace {

std::vector<Rgb> light_of(const scene::Scene& scene, const std::string& solver) {
  pipeline::BakeSettings settings;
  settings.samples = 4, settings.direct_samples = 4, settings.supersample = 4;
  settings.own.of<hemicube::HemicubeParams>().max_elements = 500;
  settings.own.of<matrix::MatrixParams>().patches.count = 256;
  Progress progress;
  const auto prepared = validate::prepare(scene, 32, progress);
  if (!prepared) return {};
  const auto solved = validate::solve(**prepared, solver, settings, progress);
  return solved ? solved->light.irradiance : std::vector<Rgb>{};
}

double relative_difference(const std::vector<Rgb>& a, const std::vector<Rgb>& b) {
  if (a.size() != b.size()) return INFINITY;
  double difference = 0, sum = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    difference += std::abs(double(luminance(a[i])) - double(luminance(b[i])));
    sum += double(luminance(b[i]));
  }
  return difference / sum;
}

class UnitOfLength : public ::testing::TestWithParam<const char*> {};

// Powers of two round as 1 does, so not a bit may differ, up to the ends of what is held
// (luxel/scene/held_range.h): these boxes are half a micrometre and 150,000 km wide. An overflow,
// or a length that somebody held for small, would show.
TEST_P(UnitOfLength, IsOfNoConsequence) {
  const std::string solver = GetParam();
  const std::vector<Rgb> light = light_of(box_with_lamps(), solver);
  ASSERT_GT(light.size(), 100u);
  for (const float factor : {0x1p-20f, 0x1p28f}) {
    const std::vector<Rgb> same = light_of(scaled(box_with_lamps(), factor), solver);
    // Hierarchical refines until a clock or an error of points chosen by rounding ends it.
    if (solver == "hierarchical")
      EXPECT_LT(relative_difference(same, light), 0.01) << factor;
    else
      EXPECT_TRUE(same == light) << factor << ": " << relative_difference(same, light);
  }
}
INSTANTIATE_TEST_SUITE_P(Solvers, UnitOfLength,
                         ::testing::Values("gather", "hemicube", "matrix", "hierarchical",
                                           "reference"));

}  // namespace
}  // namespace luxel::testing_support
