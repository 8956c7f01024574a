// Every solver of the pipeline's table against the path tracer, on small scenes.
#include <gtest/gtest.h>

#include <algorithm>

#include "luxel/base/random.h"
#include "luxel/pipeline/solver/hemicube.h"
#include "luxel/pipeline/solver/matrix.h"
#include "luxel/validate/agreement.h"

namespace luxel::validate {
namespace {

/// Allowed difference of a solver, and the reason.
struct Tolerance {
  std::string_view solver, scene;
  double relative_rmse, bias;
  std::string_view reason;
};

/// A row for every scene.
constexpr std::string_view kEveryScene = "every scene";

/// A solver without a row here fails: whoever adds one says how good it is, and why not better. The
/// judge's mean over some 2,600 texels is known to 0.0007 (Cornell box) to 0.0013 (window), one
/// standard error: biases have four of them, and what is said beside them.
constexpr Tolerance kTolerances[] = {
    {"gather", "Cornell box", 0.025, 0.003,
     "a texel is 19 mm: bilinear light loses the dark of contacts and shadow edges"},
    {"gather", "point light in a room", 0.005, 0.002,
     "noise of 1024 rays; texels at the table's shadow"},
    {"gather", "spheres and cube", 0.007, 0.002, "noise of 1024 rays; facets of the spheres"},
    {"gather", "every kind of light", 0.03, 0.006,
     "a texel is half as wide as a hole of the mask, whose light bounces blurred"},
    {"gather", "window", 0.025, 0.005, "noise: the window is small, and the sun's patch bright"},
    {"gather", "sky map", 0.025, 0.005, "noise: the window is small, and the sun's patch bright"},
    {"gather", "sun through glass", 0.025, 0.005, "noise: the sun's patches are bright"},
    {"gather", "coloured glass", 0.05, 0.005,
     "noise of 1024 rays, of which few find the sky; 0.02 with 8192"},
    {"hemicube", "Cornell box", 0.015, 0.004,
     "4,000 elements: shadow edges inside triangles; 0.012"},
    {"hemicube", "point light in a room", 0.007, 0.004,
     "light falls off steeply beside the corners"},
    {"hemicube", "spheres and cube", 0.01, 0.005, "facets of the spheres; corners"},
    {"hemicube", "every kind of light", 0.07, 0.01,
     "sharp shadows of a mask whose holes are smaller than elements; 0.068"},
    {"hemicube", "window", 0.02, 0.006, "the sun's patch has an edge inside triangles"},
    {"hemicube", "sky map", 0.03, 0.006, "the sun's patch has an edge inside triangles"},
    {"hemicube", "sun through glass", 0.025, 0.005, "the sun's patches have edges in triangles"},
    {"matrix", "Cornell box", 0.025, 0.003,
     "2,048 patches of 34 mm, texels of 19 mm: the dark of contacts; 0.023"},
    {"matrix", "point light in a room", 0.006, 0.003,
     "indirect light bends within patches at corners"},
    {"matrix", "spheres and cube", 0.02, 0.003, "where spheres touch the floor"},
    {"matrix", "every kind of light", 0.016, 0.003,
     "indirect light bends within patches: 0.0125 with 2,048 of them"},
    {"matrix", "window", 0.018, 0.004, "the sky's light has a border inside patches"},
    {"matrix", "sky map", 0.03, 0.005, "the sky's light has a border inside patches"},
    {"matrix", "sun through glass", 0.04, 0.011,
     "form factors are made reciprocal, which those of glass that covers a fifth are not"},
    {"hierarchical", "Cornell box", 0.02, 0.003, "texels beside the feet of the blocks"},
    {"hierarchical", "point light in a room", 0.008, 0.004,
     "interpolants are off by 0.0025 of the mean"},
    {"hierarchical", "spheres and cube", 0.01, 0.003,
     "where spheres touch the floor; the sky by 1024 rays"},
    {"hierarchical", "every kind of light", 0.04, 0.005,
     "shadows of a mask's holes, along which no triangle's edge runs"},
    {"hierarchical", "window", 0.018, 0.004, "the sky's light by 1024 rays"},
    {"hierarchical", "sky map", 0.05, 0.006, "the sun's patch has an edge inside triangles"},
    {"hierarchical", "sun through glass", 0.045, 0.012,
     "between surfaces glass is opaque: no light of the room leaves by the panes"},
    {"reference", "Cornell box", 0.07, 0.005, "its own noise: 0.05 at 512 paths, mean 0.001"},
    {"reference", "point light in a room", 0.05, 0.004, "its own noise: 0.03"},
    {"reference", "spheres and cube", 0.05, 0.004, "its own noise: 0.03"},
    {"reference", "every kind of light", 0.06, 0.004, "its own noise: 0.04"},
    {"reference", "window", 0.13, 0.009, "its own noise: 0.09; most paths miss the window"},
    {"reference", "sky map", 0.13, 0.009, "its own noise; most paths miss the window"},
    {"reference", "sun through glass", 0.16, 0.009, "its own noise: 0.12"},
    {"reference", "coloured glass", 0.16, 0.009, "its own noise: 0.12; most paths miss the sky"},
};

/// A scene that a solver says it cannot do (docs/method/lights.md).
struct LeftOut {
  std::string_view solver, scene, reason;
};
constexpr LeftOut kLeftOut[] = {
    {"hemicube", "coloured glass", "sky and indirect light come through glass without its colour"},
    {"matrix", "coloured glass", "sky and indirect light come through glass without its colour"},
    {"hierarchical", "coloured glass", "glass stops the light of sky and surfaces"},
};

template <class Rows>
auto row_of(const Rows& rows, std::string_view solver, std::string_view scene) {
  const auto row = std::find_if(std::begin(rows), std::end(rows), [&](const auto& r) {
    return r.solver == solver && (r.scene == scene || r.scene == kEveryScene);
  });
  return row == std::end(rows) ? nullptr : &*row;
}

std::vector<std::string> scene_names() {
  std::vector<std::string> names;
  for (const AgreementScene& s : agreement_scenes()) names.push_back(s.name);
  return names;
}

/// gtest's names of tests have no spaces.
std::string in_one_word(const testing::TestParamInfo<std::string>& scene) {
  std::string word = scene.param;
  std::replace(word.begin(), word.end(), ' ', '_');
  return word;
}

class SlowAgreement : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Scenes, SlowAgreement, testing::ValuesIn(scene_names()), in_one_word);

TEST_P(SlowAgreement, EverySolverAgreesWithThePathTracer) {
  constexpr int kPaths = 512;
  std::vector<AgreementScene> scenes = agreement_scenes();
  const auto s = std::find_if(scenes.begin(), scenes.end(), [&](const AgreementScene& scene) {
    return scene.name == GetParam();
  });
  Progress progress;
  const auto p = prepare(std::move(s->scene), 64, progress);
  ASSERT_TRUE(p) << p.error().message;
  const auto judged = judge(**p, kPaths, 1, progress);
  ASSERT_TRUE(judged);
  for (const pipeline::Solver& solver : pipeline::solvers()) {
    SCOPED_TRACE(solver.name);
    if (const LeftOut* left_out = row_of(kLeftOut, solver.name, s->name)) {
      std::printf("%-18s %-10s left out: %s\n", s->name.c_str(), std::string(solver.name).c_str(),
                  std::string(left_out->reason).c_str());
      continue;
    }
    const Tolerance* tolerance = row_of(kTolerances, solver.name, s->name);
    ASSERT_NE(tolerance, nullptr) << "say above how well it agrees, and why";
    pipeline::BakeSettings settings;
    settings.samples = solver.name == "reference" ? kPaths : 1024;
    settings.direct_samples = 256;
    settings.seed = 7;
    settings.own.of<hemicube::HemicubeParams>().max_elements = 4000;
    settings.own.of<matrix::MatrixParams>().patches.count = 2048;
    const auto solved = solve(**p, solver.name, settings, progress);
    ASSERT_TRUE(solved) << solved.error().message;
    const Agreement a = agreement(solved->light.irradiance, solved->light.hidden, *judged);
    EXPECT_GT(a.texels, 1000u);
    EXPECT_LE(a.relative_rmse, tolerance->relative_rmse) << tolerance->reason;
    EXPECT_LE(std::abs(a.bias_over_mean), tolerance->bias) << tolerance->reason;
    std::printf("%-18s %-10s relative RMSE %.4f  bias %+.4f  judge's noise %.4f\n", s->name.c_str(),
                std::string(solver.name).c_str(), a.relative_rmse, a.bias_over_mean, a.judge_noise);
  }
}

// The measure itself: a known error is found through noise that is much larger.
TEST(Agreement, FindsAKnownErrorBelowTheJudgesNoise) {
  constexpr size_t kTexels = 200000;
  RandomStream random{3};
  const auto noise = [&] { return 0.4f * (random.next() - 0.5f); };  // deviation 0.115
  Judged judged;
  std::vector<Rgb> solved;
  for (size_t i = 0; i < kTexels; ++i) {
    const float truth = 1, d = i % 2 ? 0.03f : -0.01f;  // root mean square 0.02236, mean 0.01
    judged.first.push_back(Rgb{1, 1, 1} * (truth + noise()));
    judged.second.push_back(Rgb{1, 1, 1} * (truth + noise()));
    judged.standard_error.push_back(Rgb{1, 1, 1} * 0.0816f);
    judged.hidden.push_back(0);
    solved.push_back(Rgb{1, 1, 1} * (truth + d));
  }
  const Agreement a = agreement(solved, {}, judged);
  EXPECT_EQ(a.texels, kTexels);
  // Noise of the mean of 600,000 products of deviation 0.0133: 1.7e-5 on 5e-4.
  EXPECT_NEAR(a.relative_rmse, 0.02236 / 1.02, 0.0015);
  EXPECT_NEAR(a.bias_over_mean, 0.01, 0.001);
  EXPECT_NEAR(a.judge_noise, 0.0816 / 1.01, 0.003);
}

TEST(Agreement, LeavesOutWhatIsHidden) {
  Judged judged;
  judged.first = judged.second = {{1, 1, 1}, {1, 1, 1}, {1, 1, 1}};
  judged.standard_error.resize(3);
  judged.hidden = {0, 1, 0};
  const std::vector<Rgb> solved{{1.1f, 1.1f, 1.1f}, {50, 50, 50}, {70, 70, 70}};
  const std::vector<uint8_t> hidden{0, 0, 1};
  const Agreement a = agreement(solved, hidden, judged);
  EXPECT_EQ(a.texels, 1u);
  EXPECT_NEAR(a.relative_rmse, 0.1 / 1.11, 1e-5);
  EXPECT_NEAR(a.bias_over_mean, 0.1, 1e-6);
}

}  // namespace
}  // namespace luxel::validate
