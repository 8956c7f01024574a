// A room in a scene of four kilometres has the light that it has alone, by every solver: how far
// the scene reaches says nothing about where rays start. The room is closed, so that no light goes
// in or out.
#include <gtest/gtest.h>

#include "luxel/pipeline/solver/hemicube.h"
#include "luxel/pipeline/solver/hierarchical.h"
#include "luxel/pipeline/solver/matrix.h"
#include "luxel/scene/shapes.h"
#include "luxel/trace/surface_starts_test_support.h"
#include "luxel/validate/prepared.h"

namespace luxel::validate {
namespace {

constexpr float kRoad_m = 4000;

/// A room of 1 m with its floor at y = 0, a lamp under its ceiling and a shelf.
scene::Scene room() {
  scene::Scene out;
  const uint32_t grey = scene::add_material(out, "grey", {0.6f, 0.6f, 0.6f});
  const uint32_t lamp = scene::add_material(out, "lamp", {0, 0, 0}, {4, 4, 4});
  scene::Mesh mesh;
  scene::add_box(mesh, {-0.5f, 0, -0.5f}, {0.5f, 1, 0.5f}, grey);
  for (auto& t : mesh.triangles) std::swap(t[1], t[2]);  // seen from inside
  scene::add_box(mesh, {-0.3f, 0.3f, -0.2f}, {0.1f, 0.35f, 0.1f}, grey);
  const float y = 0.97f;
  scene::add_quad(
      mesh, {Vec3{-0.15f, y, -0.15f}, {0.15f, y, -0.15f}, {0.15f, y, 0.15f}, {-0.15f, y, 0.15f}},
      lamp);
  scene::place(out, std::move(mesh));
  return out;
}

/// Things that reach far: a small stone, or a road under the room that lies level or climbs by one
/// in twenty, as a mesh of its own or a part of the room's.
enum class Far : uint8_t { stone, road, road_of_one_mesh, climbing_road };

/// The middle of the scene is `away` from the room's.
scene::Scene with_far(scene::Scene scene, Far what, float away) {
  const float half = kRoad_m / 2, climb = what == Far::climbing_road ? 0.05f : 0.0f;
  const float from = what == Far::stone ? half - 0.1f : -half;
  const auto corner = [&](float x, float z) {
    return Vec3{x - away, (x - away) * climb - 0.5f, z};
  };
  const scene::Quad quad{corner(from, 4), corner(half, 4), corner(half, -4), corner(from, -4)};
  scene::Mesh own;
  scene::add_quad(what == Far::road_of_one_mesh ? scene.meshes[0] : own, quad, 0);
  if (!own.triangles.empty()) scene::place(scene, std::move(own));
  return scene;
}

scene::Scene moved(scene::Scene scene, const Mat34& by) {
  for (scene::Instance& instance : scene.instances)
    instance.world_from_object = by * instance.world_from_object;
  return scene;
}

/// A scene that begins with the room, whose texels are those of the room alone.
std::unique_ptr<Prepared> prepared_with_texels_of(const Prepared& alone, scene::Scene scene) {
  auto out = std::make_unique<Prepared>();
  out->scene = std::move(scene);
  out->atlas = alone.atlas;
  out->atlas.first_triangle = scene::first_triangles(out->scene);
  // Triangles that the room alone does not have lie on no texel.
  const size_t all = out->atlas.first_triangle.back();
  out->atlas.corners.resize(all, {Vec2{0, 0}, {0, 0}, {0, 0}});
  out->atlas.chart.resize(all, out->atlas.chart_count++);
  out->map = atlas::rasterise(alone.scene, alone.atlas);
  out->elements = transport::elements_from_texels(out->scene, out->atlas, out->map);
  out->lights = light::collect_lights(out->scene);
  auto tracer = trace::RayTracer::build(out->scene);
  EXPECT_TRUE(tracer);
  out->tracer.emplace(std::move(*tracer));
  return out;
}

struct Difference {
  double mean = 0, rms = 0;  ///< over the mean
};
Difference difference(std::span<const Rgb> light, std::span<const Rgb> alone) {
  double sum = 0, off = 0, off2 = 0;
  for (size_t i = 0; i < alone.size(); ++i) {
    const double d = double(luminance(light[i])) - double(luminance(alone[i]));
    sum += double(luminance(alone[i])), off += d, off2 += d * d;
  }
  return {off / sum, std::sqrt(off2 / double(alone.size())) / (sum / double(alone.size()))};
}

struct Case {
  std::string name;
  Far what;
  float away;  ///< of the scene's middle from the room
  Mat34 moved;
};
constexpr float kNearStone = kRoad_m / 2 - 3;
std::vector<Case> cases(bool roads) {
  const Mat34 turned = trace::testing::turn({0, 1, 0}, kPi / 6), far = translation({2000, 0, 0});
  if (!roads)
    return {{"stone", Far::stone, 0, {}}, {"stone, 2 km from the origin", Far::stone, 0, far}};
  return {{"middle", Far::road, 0, {}},
          {"end", Far::road, kRoad_m / 2 - 1, {}},
          {"one mesh", Far::road_of_one_mesh, 0, {}},
          {"climbing", Far::climbing_road, 0, {}},
          {"turned", Far::road_of_one_mesh, 0, turned},
          {"climbing and turned", Far::climbing_road, kRoad_m / 2 - 1, turned},
          {"2 km from the origin", Far::road, 0, far}};
}

class SlowLongScenes : public testing::TestWithParam<std::string_view> {};
INSTANTIATE_TEST_SUITE_P(Solvers, SlowLongScenes,
                         testing::Values("gather", "hemicube", "matrix", "hierarchical",
                                         "reference"));

// Solvers with elements share them out by area, of which a road has too much: for them a stone lies
// 2 km away instead of 3 m.
TEST_P(SlowLongScenes, ARoomHasTheLightThatItHasAlone) {
  pipeline::BakeSettings settings;
  settings.samples = 256, settings.seed = 7;
  settings.own.of<hemicube::HemicubeParams>().max_elements = 4000;
  settings.own.of<matrix::MatrixParams>().patches.count = 2048;
  const bool roads = GetParam() == "gather" || GetParam() == "reference";
  Progress progress;
  const auto alone = prepare(room(), 48, progress);
  ASSERT_TRUE(alone) << alone.error().message;
  const auto light_of = [&](scene::Scene scene) {
    const auto p = prepared_with_texels_of(**alone, std::move(scene));
    auto found = solve(*p, GetParam(), settings, progress);
    EXPECT_TRUE(found) << found.error().message;
    return std::move(found->light.irradiance);
  };
  const std::vector<Rgb> right =
      light_of(roads ? (*alone)->scene : with_far((*alone)->scene, Far::stone, kNearStone));
  for (const Case& c : cases(roads)) {
    const std::vector<Rgb> got =
        light_of(moved(with_far((*alone)->scene, c.what, c.away), c.moved));
    const Difference d = difference(got, right);
    std::printf("%-12s %-28s mean %+.5f  rms %.5f\n", std::string(GetParam()).c_str(),
                c.name.c_str(), d.mean, d.rms);
    EXPECT_LT(std::abs(d.mean), 0.004) << c.name;
  }
}

}  // namespace
}  // namespace luxel::validate
