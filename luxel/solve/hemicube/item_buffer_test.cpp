// The item buffer counts what look() counts, and who watches a solver changes nothing.
#include "luxel/solve/hemicube/item_buffer.h"

#include <gtest/gtest.h>

#include <atomic>

#include "luxel/solve/hemicube/hemicube_test_support.h"

namespace luxel::hemicube {
namespace {

using testing::mesh_of;

/// A closed box, a square over an open plane, and a square seen from behind.
std::vector<scene::Scene> scenes() {
  scene::Mesh squares = testing::unit_square();
  scene::add_quad(squares, {Vec3{0, 1, 0}, {1, 1, 0}, {1, 1, 1}, {0, 1, 1}}, 0);
  scene::Mesh backs = testing::unit_square();
  scene::add_quad(backs, {Vec3{0, 1, 0}, {0, 1, 1}, {1, 1, 1}, {1, 1, 0}}, 0);
  return {scene::cornell_box(), testing::scene_of(squares), testing::scene_of(backs)};
}

TEST(ItemBuffer, ItsPixelsAddUpToTheRow) {
  for (const scene::Scene& scene : scenes())
    for (const ElementKind kind : {ElementKind::vertex, ElementKind::triangle}) {
      const Mesh mesh = mesh_of(scene, 0.3f);
      const Receivers receivers = make_receivers(scene, mesh, kind);
      const auto tracer = trace::RayTracer::build(scene);
      const light::Lights lights = light::collect_lights(scene);
      const Senders senders{scene, *tracer, mesh, receivers, lights.around};
      const std::vector<Viewpoint> from{viewpoints(receivers.elements)[receivers.size() / 2]};
      std::vector<double> wanted(receivers.size()), found(receivers.size());
      double back = 0, seen_back = 0, whole = 0;
      Progress progress;
      const auto keep = [&](size_t, const View& view) -> Status {
        for (size_t k = 0; k < view.element.size(); ++k)
          wanted[view.element[k]] = double(view.share[k]);
        back = double(view.back);
        return {};
      };
      ASSERT_TRUE(look(senders, from, {32}, keep, progress));
      const auto items = item_buffer(senders, from[0], 32, progress);
      ASSERT_TRUE(items);
      for (size_t i = 0; i < items->items.size(); ++i) {
        const Item& item = items->items[i];
        whole += items->factor[i];
        if (item.kind == SeenKind::back) seen_back += items->factor[i];
        if (item.kind != SeenKind::surface) continue;
        if (kind == ElementKind::triangle) {
          found[receivers.leaf_of_node[item.at.node]] += items->factor[i];
          continue;
        }
        const auto& v = mesh.nodes[item.at.node].vertex;
        found[v[0]] += items->factor[i] * double(1 - item.at.at.u - item.at.at.v);
        found[v[1]] += items->factor[i] * double(item.at.at.u);
        found[v[2]] += items->factor[i] * double(item.at.at.v);
      }
      for (size_t e = 0; e < wanted.size(); ++e) EXPECT_NEAR(found[e], wanted[e], 1e-6);
      EXPECT_NEAR(seen_back, back, 1e-6);
      EXPECT_NEAR(whole, 1, 1e-12);
    }
}

// In a furnace E_0 is the same e everywhere, and an element that has looked around gathers e rho
// besides.
TEST(HemicubeObserver, HearsOfEachElementOnceAndChangesNothing) {
  const scene::Scene box = scene::furnace_box({0.5f, 0.5f, 0.5f}, {1, 1, 1});
  HemicubeParams params;
  params.resolution = 16, params.element_size_m = 0.25f, params.max_error = 0;
  const Solution alone = testing::solved(box, params);
  std::vector<std::atomic<int>> heard(alone.field.receivers.size());
  int meshes = 0, passes = 0, bounces = 0;
  std::vector<Rgb> last;
  Observer observer;
  observer.on_mesh = [&](const Field& field) {
    ++meshes;
    EXPECT_EQ(field.receivers.size(), heard.size());
  };
  observer.on_direct = [&](std::span<const Rgb> direct) {
    ++passes;
    EXPECT_EQ(direct.size(), heard.size());
  };
  observer.on_view = [&](size_t i, Rgb source, const View& view) {
    ++heard[i];
    EXPECT_NEAR(source.x, kPi, 1e-3f);
    float sum = 0;
    for (const float share : view.share) sum += share;
    EXPECT_NEAR(sum, 1, 1e-4f);
  };
  observer.on_bounce = [&](std::span<const Rgb> e) {
    ++bounces;
    last.assign(e.begin(), e.end());
  };
  bool is_solved = false;
  observer.on_solved = [&](const Solution& s) { is_solved = s.field.irradiance == last; };
  const auto tracer = trace::RayTracer::build(box);
  Progress progress;
  const auto watched = solve(box, light::collect_lights(box), *tracer, params, progress, observer);
  ASSERT_TRUE(watched);
  EXPECT_EQ(watched->field.irradiance, alone.field.irradiance);
  EXPECT_EQ(meshes, 1);
  EXPECT_EQ(passes, 1);
  EXPECT_EQ(bounces, alone.sweeps);
  EXPECT_TRUE(is_solved);
  for (const auto& times : heard) EXPECT_EQ(times, 1);
}

}  // namespace
}  // namespace luxel::hemicube
