// Bounces: the terms of the Neumann series, whatever the memory and the threads.
#include "luxel/solve/hemicube/exchange.h"

#include <gtest/gtest.h>

#include <thread>

#include "luxel/base/parallel.h"
#include "luxel/solve/hemicube/hemicube_test_support.h"

namespace luxel::hemicube {
namespace {

using testing::solved;
using testing::try_to_solve;

// In a furnace all walls emit e and reflect rho: after n reflections E is e (1 + rho + ... +
// rho^n), everywhere; e / (1 - rho) after all.
TEST(Exchange, BouncesAreTheTermsOfTheNeumannSeries) {
  const Rgb rho{0.5f, 0.25f, 0.9f};
  const scene::Scene box = scene::furnace_box(rho, {2, 2, 2});
  for (const ElementKind kind : {ElementKind::vertex, ElementKind::triangle})
    for (const int bounces : {0, 1, 2, 7, -1}) {
      HemicubeParams params;
      params.elements = kind, params.resolution = 16, params.element_size_m = 0.25f;
      params.bounces = bounces;
      const Solution s = solved(box, params);
      ASSERT_GE(s.field.irradiance.size(), 6u * 25);
      if (bounces >= 0) {
        EXPECT_EQ(s.sweeps, bounces);
      }
      for (const auto channel : {&Rgb::x, &Rgb::y, &Rgb::z}) {
        const double r = double(rho.*channel), e = 2 * M_PI;
        const double expected =
            bounces < 0 ? e / (1 - r) : e * (1 - std::pow(r, bounces + 1)) / (1 - r);
        for (const Rgb& irradiance : s.field.irradiance)
          EXPECT_NEAR(double(irradiance.*channel), expected, 5e-4 * expected) << bounces;
      }
    }
}

// Cut meshes, too: new elements take part in as many bounces as the first ones.
TEST(Exchange, BouncesOfACutMeshAreNested) {
  HemicubeParams params;
  params.resolution = 16, params.max_elements = 1500, params.element_size_m = 0.12f;
  const scene::Scene box = scene::cornell_box();
  const size_t uncut = testing::mesh_of(box, params.element_size_m).vertices.size();
  double before = 0;
  for (const int bounces : {0, 1, 2, 20, -1}) {
    params.bounces = bounces;
    const Solution s = solved(box, params);
    EXPECT_GT(s.field.irradiance.size(), uncut);
    double sum = 0, area = 0;
    for (size_t i = 0; i < s.field.irradiance.size(); ++i) {
      const double a = double(s.field.receivers.area_m2[i]);
      sum += a * double(s.field.irradiance[i].x), area += a;
    }
    const double mean = sum / area;
    if (bounces < 0) {
      EXPECT_NEAR(mean, before, 2e-3 * before);  // after 20 nothing is left
    } else {
      EXPECT_GT(mean, before * 1.001);
    }
    before = mean;
  }
}

HemicubeParams small_cornell() {
  HemicubeParams params;
  params.resolution = 16, params.max_elements = 1200;
  params.scratch_folder = std::filesystem::temp_directory_path();
  return params;
}

TEST(Exchange, RowsInAFileGiveTheSameBits) {
  const scene::Scene box = scene::cornell_box();
  for (const ElementKind kind : {ElementKind::vertex, ElementKind::triangle}) {
    HemicubeParams params = small_cornell();
    params.elements = kind;
    const Solution in_memory = solved(box, params);
    EXPECT_EQ(in_memory.row_bytes_in_file, 0u);
    // No tile in memory; a third of them.
    for (const uint64_t limit : {uint64_t(1), in_memory.row_bytes / 3}) {
      params.row_memory_bytes = limit;
      const Solution in_file = solved(box, params);
      EXPECT_EQ(in_file.field.irradiance, in_memory.field.irradiance);
      EXPECT_EQ(in_file.row_bytes, in_memory.row_bytes);
      EXPECT_LE(in_file.row_bytes - in_file.row_bytes_in_file, limit);
    }
  }
}

TEST(Exchange, AFolderThatIsNotThereIsAnError) {
  HemicubeParams params = small_cornell();
  params.row_memory_bytes = 1, params.scratch_folder = "/nonexistent/folder";
  Progress progress;
  const auto s = try_to_solve(scene::cornell_box(), params, progress);
  ASSERT_FALSE(s);
  EXPECT_EQ(s.error().code, ErrorCode::io);
}

TEST(Exchange, AnyNumberOfThreadsGivesTheSameBits) {
  const scene::Scene box = scene::cornell_box();
  for (const ElementKind kind : {ElementKind::vertex, ElementKind::triangle}) {
    HemicubeParams params = small_cornell();
    params.elements = kind, params.smooth = true;
    std::vector<Rgb> first;
    for (const int threads : {1, 2, 7}) {
      const ThreadLimit limit(threads);
      const Solution s = solved(box, params);
      if (first.empty()) first = s.field.irradiance;
      EXPECT_EQ(s.field.irradiance, first) << threads;
    }
  }
}

TEST(Cancel, BeforeAndWithinLongStagesIsAnError) {
  scene::Scene box = scene::furnace_box({0.99f, 0.99f, 0.99f}, {1, 1, 1});
  HemicubeParams params = small_cornell();
  for (const char* stage : {"", "hemicubes", "bounces"}) {
    Progress progress;
    if (!*stage) progress.request_cancel();
    std::thread watcher([&] {
      while (!progress.cancelled()) {
        if (progress.snapshot().stage == stage) progress.request_cancel();
        std::this_thread::yield();
      }
    });
    const auto s = try_to_solve(box, params, progress);
    progress.request_cancel();
    watcher.join();
    ASSERT_FALSE(s) << stage;
    EXPECT_EQ(s.error().code, ErrorCode::cancelled);
  }
}

}  // namespace
}  // namespace luxel::hemicube
