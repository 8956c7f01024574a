#include "luxel/display/fit_camera.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "luxel/scene/shapes.h"
#include "luxel/trace/camera_rays.h"

namespace luxel::display {
namespace {

using scene::Scene;

scene::Camera fitted(const Scene& scene, float aspect, Viewpoint from = Viewpoint::automatic) {
  const auto tracer = trace::RayTracer::build(scene);
  EXPECT_TRUE(tracer);
  return fit_camera(scene, *tracer, aspect, from);
}

/// True where the usual camera stands within the scene's bounds.
bool from_inside(const Scene& scene) {
  const Vec3 eye = column(fitted(scene, 1.5f).world_from_camera, 3);
  const Box3 box = world_bounds(scene);
  return min_component(eye - box.lower) > 0 && min_component(box.upper - eye) > 0;
}

uint32_t gray(Scene& scene, bool double_sided) {
  const uint32_t material = scene::add_material(scene, "gray", {0.5f, 0.5f, 0.5f});
  scene.materials[material].double_sided = double_sided;
  return material;
}

/// A room of one-sided walls that can be seen only from inside, open towards +z.
Scene open_room(float scale = 1) {
  Scene scene;
  const uint32_t m = gray(scene, false);
  scene::Mesh mesh;
  scene::add_quad(mesh, {Vec3{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}}, m);
  scene::add_quad(mesh, {Vec3{-1, -1, 1}, {1, -1, 1}, {1, -1, -1}, {-1, -1, -1}}, m);
  scene::add_quad(mesh, {Vec3{-1, 1, -1}, {1, 1, -1}, {1, 1, 1}, {-1, 1, 1}}, m);
  scene::add_quad(mesh, {Vec3{-1, -1, 1}, {-1, -1, -1}, {-1, 1, -1}, {-1, 1, 1}}, m);
  scene::add_quad(mesh, {Vec3{1, -1, -1}, {1, -1, 1}, {1, 1, 1}, {1, 1, -1}}, m);
  scene::place(scene, std::move(mesh));
  scene.instances[0].world_from_object = scaling({scale, scale, scale});
  return scene;
}

/// A block that is seen, and lit, from both sides: a closed room of 4 x 3 x 4 m, or an object. A
/// window of 1 x 1 m is missing in its wall at +z.
Scene shell(bool window) {
  Scene scene;
  const uint32_t m = gray(scene, true);
  scene::Mesh mesh;
  scene::add_box(mesh, {-2, 0, -2}, {2, 3, 2}, m);
  if (window) {
    std::vector<std::array<uint32_t, 3>> kept;
    for (const auto& t : mesh.triangles)
      if (std::ranges::any_of(t, [&](uint32_t v) { return mesh.positions[v].z < 0; }))
        kept.push_back(t);
    mesh.triangles = kept, mesh.triangle_material.assign(kept.size(), m);
    scene::add_quad_with_hole(mesh, {Vec3{-2, 0, 2}, {2, 0, 2}, {2, 3, 2}, {-2, 3, 2}},
                              {Vec3{-0.5f, 1, 2}, {0.5f, 1, 2}, {0.5f, 2, 2}, {-0.5f, 2, 2}}, m);
  }
  scene::place(scene, std::move(mesh));
  return scene;
}

void add_day(Scene& scene, Vec3 towards_sun) {
  scene.background = {1, 1, 1};
  scene::PunctualLight sun;
  sun.kind = scene::PunctualLight::Kind::directional;
  sun.direction = -normalize(towards_sun), sun.intensity = {5, 5, 5};
  scene.lights.push_back(sun);
}

// The light decides what a closed block is: a room, or a thing.
TEST(FitCamera, LooksFromInsideWhereThereIsLightInside) {
  Scene with_lamp = shell(false), under_sky = shell(false), with_window = shell(true);
  scene::PunctualLight lamp;
  lamp.position = {0, 2.5f, 0};
  with_lamp.lights.push_back(lamp);
  add_day(under_sky, {1, 1, 1});
  add_day(with_window, {1, 1, 1});
  EXPECT_TRUE(from_inside(with_lamp));
  EXPECT_FALSE(from_inside(under_sky));
  EXPECT_TRUE(from_inside(with_window));
}

// A lit room before a wall three times as high and wide: most places in the air are out of the
// room, but all that is to be seen is within.
TEST(FitCamera, LooksFromInsideWhereOutsideIsDark) {
  Scene scene = shell(false);
  scene::add_quad(scene.meshes[0], {Vec3{-9, 0, -4}, {9, 0, -4}, {9, 12, -4}, {-9, 12, -4}}, 0);
  scene::PunctualLight lamp;
  lamp.position = {0, 2.5f, 0};
  scene.lights.push_back(lamp);
  const Vec3 eye = column(fitted(scene, 1.5f).world_from_camera, 3);
  EXPECT_LT(std::max({std::abs(eye.x), std::abs(eye.y - 1.5f), std::abs(eye.z)}), 2);
}

// One-sided walls are invisible from outside: what there is of this closed room is seen from there.
TEST(FitCamera, LooksIntoADollsHouseFromOutside) {
  Scene room = open_room();
  scene::add_quad(room.meshes[0], {Vec3{1, -1, 1}, {-1, -1, 1}, {-1, 1, 1}, {1, 1, 1}}, 0);
  scene::PunctualLight lamp;
  lamp.position = {0, 0.8f, 0};
  room.lights.push_back(lamp);
  EXPECT_FALSE(from_inside(room));
}

/// Houses of 6 x 6 x 6 m on a square of 60 x 60 m, each a lit room.
Scene town_of(std::span<const Vec3> places) {
  Scene town;
  const uint32_t m = gray(town, true);
  scene::Mesh mesh;
  scene::add_quad(mesh, {Vec3{-30, 0, 30}, {30, 0, 30}, {30, 0, -30}, {-30, 0, -30}}, m);
  for (const Vec3 at : places) {
    scene::add_box(mesh, at - Vec3{3, 0, 3}, at + Vec3{3, 6, 3}, m);
    scene::PunctualLight lamp;
    lamp.position = at + Vec3{0, 3, 0};
    town.lights.push_back(lamp);
  }
  scene::place(town, std::move(mesh));
  add_day(town, {1, 1, 1});
  return town;
}

// There is light in each house, but the town is what there is to see, as its people see it.
TEST(FitCamera, LooksAtATownFromAStreet) {
  std::vector<Vec3> houses;
  for (int i = -2; i <= 2; ++i)
    for (int j = -2; j <= 2; ++j) houses.push_back({12.0f * float(i), 0, 12.0f * float(j)});
  const Vec3 eye = column(fitted(town_of(houses), 1.5f).world_from_camera, 3);
  EXPECT_GT(eye.y, 0.5f);
  EXPECT_LT(eye.y, 1.7f);
  EXPECT_LT(std::max(std::abs(eye.x), std::abs(eye.z)), 30);
  for (const Vec3 at : houses)
    EXPECT_GT(std::max(std::abs(eye.x - at.x), std::abs(eye.z - at.z)), 3.4f) << "near a wall";
}

// Three houses are things on a plate.
TEST(FitCamera, LooksAtAFewHousesFromOutside) {
  const std::vector<Vec3> houses{{-12, 0, 0}, {12, 0, 0}, {0, 0, 12}};
  EXPECT_FALSE(from_inside(town_of(houses)));
}

TEST(FitCamera, DoesAsItIsTold) {
  Scene room = shell(true);
  add_day(room, {1, 1, 1});
  const Box3 box = world_bounds(room);
  const auto eye = [&](Viewpoint from) {
    return column(fitted(room, 1.5f, from).world_from_camera, 3);
  };
  const Vec3 in = eye(Viewpoint::interior), out = eye(Viewpoint::exterior);
  EXPECT_TRUE(min_component(in - box.lower) > 0 && min_component(box.upper - in) > 0);
  EXPECT_TRUE(min_component(out - box.lower) < 0 || min_component(box.upper - out) < 0);
}

// A ball has no other side to tell: the sun's side it is, for suns all around.
TEST(FitCamera, ShowsThingsFromTheirLitSide) {
  for (int i = 0; i < 4; ++i) {
    Scene scene;
    const uint32_t m = gray(scene, false);
    scene::place(scene, scene::sphere("ball", 1, 32, 16, m));
    const float azimuth = 1.57f * float(i) + 0.3f;
    const Vec3 towards_sun{std::cos(azimuth), 0.8f, std::sin(azimuth)};
    add_day(scene, towards_sun);
    const Vec3 back = column(fitted(scene, 1.5f).world_from_camera, 2);
    EXPECT_GT(dot(back, normalize(towards_sun)), 0.3f) << i;
  }
}

// A cube with an edge towards the sun: with the sun straight behind the eye all that is seen would
// be as bright, and no shadow seen.
TEST(FitCamera, DoesNotLookAlongTheSunsRays) {
  Scene scene;
  const uint32_t m = gray(scene, false);
  scene::Mesh cube;
  scene::add_box(cube, {-1, -1, -1}, {1, 1, 1}, m);
  scene::place(scene, std::move(cube));
  const Vec3 towards_sun{1, 1, 1};
  add_day(scene, towards_sun);
  const Vec3 back = column(fitted(scene, 1.5f).world_from_camera, 2);
  EXPECT_GT(dot(back, normalize(towards_sun)), 0.3f);
  EXPECT_LT(dot(back, normalize(towards_sun)), 0.9f);
}

/// Where a point is in a camera's picture: from -1 to 1 across and upwards, for parallel rays.
Vec2 seen_at(const scene::Camera& camera, float aspect, Vec3 p) {
  const Vec3 d = p - column(camera.world_from_camera, 3);
  const float half = 0.5f * camera.orthographic_height_m;
  EXPECT_LT(dot(d, column(camera.world_from_camera, 2)), 0) << "before the camera";
  return {dot(d, column(camera.world_from_camera, 0)) / (half * aspect),
          dot(d, column(camera.world_from_camera, 1)) / half};
}

// A block of 6 x 2 x 4 m in a picture of 3:2. From the front it is 6 wide and 2 high: its width
// fills the picture, but for the margin. From the top it is 6 x 4: both do.
TEST(FitCamera, FrontAndTopShowAllOfTheSceneSquarely) {
  constexpr float kAspect = 1.5f, kEdge = 1 / 1.04f;
  Scene scene;
  scene::Mesh mesh;
  scene::add_box(mesh, {1, 0, -2}, {7, 2, 2}, gray(scene, false));
  scene::place(scene, std::move(mesh));
  const scene::Camera front = fitted(scene, kAspect, Viewpoint::front);
  const scene::Camera top = fitted(scene, kAspect, Viewpoint::top);
  const auto expect_at = [&](const scene::Camera& camera, Vec3 p, Vec2 expected) {
    const Vec2 seen = seen_at(camera, kAspect, p);
    EXPECT_NEAR(seen.x, expected.x, 1e-5f);
    EXPECT_NEAR(seen.y, expected.y, 1e-5f);
  };
  for (const float z : {-2.0f, 2.0f}) {
    expect_at(front, {1, 0, z}, {-kEdge, -kEdge / 2});
    expect_at(front, {7, 2, z}, {kEdge, kEdge / 2});
  }
  for (const float y : {0.0f, 2.0f}) {
    expect_at(top, {1, y, -2}, {-kEdge, kEdge});
    expect_at(top, {7, y, 2}, {kEdge, -kEdge});
  }
}

TEST(FitCamera, SeesMostOfAnOpenRoom) {
  const Scene scene = open_room();
  const auto tracer = trace::RayTracer::build(scene);
  const scene::Camera camera = fit_camera(scene, *tracer, 4.0f / 3.0f);
  const trace::CameraRays rays_of(camera, 80, 60);
  std::vector<trace::Ray> rays;
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 80; ++x) rays.push_back(rays_of.through(float(x) + 0.5f, float(y) + 0.5f));
  int found = 0;
  for (const trace::Hit& hit : trace::visible_hits(scene, *tracer, rays)) found += hit.found();
  EXPECT_GT(found, 80 * 60 * 4 / 10);
  // The camera stands upright.
  EXPECT_GT(camera.world_from_camera.row[1][1], 0.5f);
  EXPECT_NEAR(camera.world_from_camera.row[1][0], 0, 1e-6f);
}

TEST(FitCamera, DoesNotDependOnTheUnitOfLength) {
  const scene::Camera metres = fitted(open_room(), 1.5f), other = fitted(open_room(64), 1.5f);
  for (int i = 0; i < 3; ++i)
    EXPECT_NEAR(other.world_from_camera.row[i][3] / 64, metres.world_from_camera.row[i][3], 1e-3f);
}

/// A sheet of 2 x 2 m on the ground: one of both sides, or two that lie on each other.
Scene sheet(bool two_quads) {
  Scene scene;
  const uint32_t m = gray(scene, !two_quads);
  scene::Mesh mesh;
  scene::add_quad(mesh, {Vec3{-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}}, m);
  if (two_quads) scene::add_quad(mesh, {Vec3{-1, 0, -1}, {1, 0, -1}, {1, 0, 1}, {-1, 0, 1}}, m);
  scene::place(scene, std::move(mesh));
  return scene;
}

// From both places of a sheet itself, its floor is its ceiling.
TEST(FitCamera, NeverStandsInASheet) {
  for (const bool two_quads : {false, true})
    for (const Viewpoint from : {Viewpoint::automatic, Viewpoint::interior})
      for (const float thickness : {0.0f, 1e-3f}) {
        Scene scene = sheet(two_quads);
        if (thickness > 0) {
          scene.instances.push_back(scene.instances[0]);
          scene.instances[1].world_from_object = translation({0, thickness, 0});
        }
        add_day(scene, {1, 2, 1});
        const Vec3 eye = column(fitted(scene, 1.5f, from).world_from_camera, 3);
        EXPECT_GT(std::abs(eye.y), 0.05f) << two_quads << int(from) << thickness;
      }
}

// From inside, a lamp is one bright colour.
TEST(FitCamera, NeverStandsInALamp) {
  Scene scene;
  const uint32_t m = scene::add_material(scene, "glow", {0.5f, 0.5f, 0.5f}, {9, 9, 9});
  scene.materials[m].double_sided = true;
  scene::place(scene, scene::sphere("lamp", 1, 32, 16, m));
  EXPECT_FALSE(from_inside(scene));
}

// The front of a floor that was wound upside down is not seen: the picture is of its back, from
// where all of it is seen.
TEST(FitCamera, LooksAtBacksWhereThereAreNoFronts) {
  Scene scene;
  scene::add_rectangle(scene, {-1, 1, -1, 1}, 0, false, gray(scene, false));
  const auto tracer = trace::RayTracer::build(scene);
  const trace::CameraRays rays(fit_camera(scene, *tracer, 1), 16, 16);
  int found = 0;
  for (int i = 0; i < 256; ++i)
    found += tracer->closest_hit(rays.through(float(i % 16) + 0.5f, float(i / 16) + 0.5f)).found();
  EXPECT_GT(found, 256 / 4);
}

}  // namespace
}  // namespace luxel::display
