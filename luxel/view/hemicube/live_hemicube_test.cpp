// Light that grows from vertex to vertex, and ends as that of a bake.
#include "luxel/view/hemicube/live_hemicube.h"

#include <gtest/gtest.h>

#include <chrono>
#include <mutex>
#include <thread>

#include "luxel/pipeline/bake/bake_scene.h"
#include "luxel/pipeline/solver/vertex_lit.h"
#include "luxel/scene/procedural.h"
#include "luxel/view/hemicube/growing_light.h"
#include "luxel/view/hemicube/mesh_test_support.h"
#include "luxel/view/hemicube/vertex_report.h"

namespace luxel::view {
namespace {

std::filesystem::path of_tree(const std::string& scene) {
  return std::filesystem::path(LUXEL_SOURCE_DIR) / "scenes" / scene;
}

pipeline::BakeSettings small_settings() {
  pipeline::BakeSettings out;
  out.scene = of_tree("cornell-box.glb");
  out.solver = "hemicube";
  out.output = std::filesystem::temp_directory_path() / "no-such-bake";
  out.resolution = 32;
  out.own.of<hemicube::HemicubeParams>().resolution = 8;
  out.own.of<hemicube::HemicubeParams>().max_elements = 900;
  out.direct_samples = 8;
  return out;
}

/// All that has come until the solver is at rest.
HemicubeNews come_to_rest(LiveHemicube& live) {
  HemicubeNews all;
  for (bool is_at_rest = false;;) {
    merge(live.take(), all);
    if (is_at_rest) return all;
    is_at_rest = live.state() != HemicubeState::solving;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}

TEST(LiveHemicube, EndsWithTheBitsOfABake) {
  pipeline::BakeSettings settings = small_settings();
  const auto live = std::make_unique<LiveHemicube>(std::vector{settings.scene}, settings);
  const HemicubeNews news = come_to_rest(*live);
  ASSERT_EQ(live->state(), HemicubeState::solved) << news.said.value_or("");
  EXPECT_GT(news.exposure, 0);
  settings.vertex_colors = true;
  Progress progress;
  const auto bake = pipeline::bake_scene(settings, progress);
  ASSERT_TRUE(bake) << bake.error().message;
  const pipeline::VertexLit wanted = *bake->light.vertex_lit;
  const pipeline::VertexLit found = pipeline::vertex_lit(
      news.read->scene, {news.mesh->mesh, news.mesh->receivers, news.irradiance});
  EXPECT_EQ(found.intensity, wanted.intensity);
  ASSERT_EQ(found.scene.meshes.size(), wanted.scene.meshes.size());
  for (size_t m = 0; m < wanted.scene.meshes.size(); ++m) {
    EXPECT_EQ(found.scene.meshes[m].positions, wanted.scene.meshes[m].positions);
    EXPECT_EQ(found.scene.meshes[m].colors, wanted.scene.meshes[m].colors);
  }
}

TEST(LiveHemicube, StopsInTheMiddleAndGoesOn) {
  pipeline::BakeSettings settings = small_settings();
  settings.own.of<hemicube::HemicubeParams>().max_error = 0;
  const auto live = std::make_unique<LiveHemicube>(std::vector{settings.scene}, settings);
  live->pause_at(0.5);
  HemicubeNews news = come_to_rest(*live);
  ASSERT_EQ(live->state(), HemicubeState::paused);
  const auto mesh = news.mesh;
  const size_t half = size_t(live->snapshot().done);
  EXPECT_GE(half, mesh->receivers.size() / 2);
  EXPECT_LT(half, mesh->receivers.size()) << "vertex by vertex";
  const std::vector<Rgb> partly = news.irradiance;
  live->pause(false);
  news = come_to_rest(*live);
  ASSERT_EQ(live->state(), HemicubeState::solved);
  EXPECT_FALSE(news.mesh) << "the mesh stays";
  // All bounces are more than one; what has not looked has direct light alone.
  double sum_partly = 0, sum = 0;
  for (size_t i = 0; i < partly.size(); ++i)
    sum_partly += double(partly[i].x), sum += double(news.irradiance[i].x);
  EXPECT_GT(sum, sum_partly * 1.05);
}

TEST(LiveHemicube, SeveralModelsAreOneScene) {
  pipeline::BakeSettings settings = small_settings();
  settings.own.of<hemicube::HemicubeParams>().max_elements = 2000;
  settings.own.of<hemicube::HemicubeParams>().max_error = 0;
  const std::filesystem::path box = of_tree("radiosity-box.glb");
  const auto one =
      come_to_rest(*std::make_unique<LiveHemicube>(std::vector{settings.scene}, settings));
  const auto two =
      come_to_rest(*std::make_unique<LiveHemicube>(std::vector{settings.scene, box}, settings));
  ASSERT_TRUE(one.read && two.read) << two.said.value_or("");
  EXPECT_GT(two.read->scene.instances.size(), one.read->scene.instances.size());
  const auto none = come_to_rest(*std::make_unique<LiveHemicube>(
      std::vector<std::filesystem::path>{settings.scene, "absent.glb"}, settings));
  EXPECT_NE(none.said.value_or("").find("absent.glb"), std::string::npos);
}

// In a furnace of emission e and reflectance 1/2 elements that have looked around have e + e / 2,
// the others e, until a bounce more is known.
TEST(GrowingLight, GrowsVertexByVertex) {
  const scene::Scene box = scene::furnace_box({0.5f, 0.5f, 0.5f}, {1, 1, 1});
  const auto tracer = trace::RayTracer::build(box);
  hemicube::HemicubeParams params;
  params.resolution = 16, params.element_size_m = 0.5f, params.max_error = 0, params.bounces = 1;
  GrowingLight light;
  std::vector<uint8_t> has_looked;
  std::mutex mutex;
  hemicube::Observer observer;
  observer.on_mesh = [&](const hemicube::Field& field) {
    light = begin_growing(field.receivers.elements.reflectance, field.irradiance);
    has_looked.assign(field.receivers.size(), 0);
  };
  observer.on_direct = [&](std::span<const Rgb> direct) { begin_pass(direct, light); };
  observer.on_view = [&](size_t i, Rgb source, const hemicube::View& view) {
    const std::scoped_lock lock(mutex);
    reach(i, source, view, light);
    has_looked[i] = 1;
    for (size_t k = 0; k < has_looked.size(); ++k)
      ASSERT_NEAR(light.irradiance[k].x, kPi * (has_looked[k] ? 1.5f : 1), 0.01f);
  };
  observer.on_bounce = [&](std::span<const Rgb> e) {
    for (size_t k = 0; k < e.size(); ++k) EXPECT_NEAR(light.irradiance[k].x, e[k].x, 1e-3f);
  };
  Progress progress;
  ASSERT_TRUE(
      hemicube::solve(box, light::collect_lights(box), *tracer, params, progress, observer));
}

TEST(ReportWorker, AnswersTheLastQuestionAndEndsAtOnce) {
  const auto mesh = testing::mesh_in(scene::cornell_box(), 0.1f);
  const std::vector<Rgb> light(mesh->receivers.size(), Rgb{1, 1, 1});
  auto worker = begin_reports();
  for (const int size : {512, 256, 16}) worker->ask({mesh, light, 7, size});
  worker->wait();
  const auto come = worker->take();
  ASSERT_EQ(come.size(), 1u);
  ASSERT_TRUE(come[0]) << come[0].error().message;
  EXPECT_EQ(come[0]->report.resolution, 16);
  EXPECT_EQ(come[0]->report.element, 7u);
  worker->ask({mesh, light, 7, 1024});
  const auto begin = std::chrono::steady_clock::now();
  worker.reset();
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
  EXPECT_LT(taken.count(), 1);
}

}  // namespace
}  // namespace luxel::view
