// The boxes of [Rodriguez06]: a closed room cut into a regular grid, empty and with two shapes.
#include "luxel/scene/place_camera.h"
#include "luxel/scene/procedural.h"
#include "luxel/scene/shapes.h"

namespace luxel::scene {
namespace {

/// Quads along a wall; the lamp takes the one in the middle of 5 x 5, a fifth of the width.
constexpr int kQuads = 5;
constexpr float kBoxWidth_m = 2;

/// A flat rectangle of the box: corner, and the sides along which it is cut into quads. Seen from
/// the front, `v` is 90 degrees counter-clockwise from `u`.
struct Wall {
  std::array<int, 3> corner, u, v;  ///< in quads from the box's lower corner; u, v: unit steps
};

/// Where the grid's corners lie. All walls compute them so, and therefore meet exactly.
Vec3 grid_point(const Wall& wall, int i, int j) {
  std::array<float, 3> p{};
  for (size_t k = 0; k < 3; ++k)
    p[k] = float(wall.corner[k] + i * wall.u[k] + j * wall.v[k]) * kBoxWidth_m / float(kQuads);
  return {p[0] - kBoxWidth_m / 2, p[1], p[2] - kBoxWidth_m / 2};
}

/// The quads [i0, i1) x [j0, j1) of a wall as a mesh of their own.
void place_grid(Scene& scene, std::string name, const Wall& wall, const std::array<int, 4>& range,
                uint32_t material) {
  const auto [i0, i1, j0, j1] = range;
  Mesh mesh;
  mesh.name = std::move(name);
  for (int j = j0; j < j1; ++j)
    for (int i = i0; i < i1; ++i)
      add_quad(mesh,
               {grid_point(wall, i, j), grid_point(wall, i + 1, j), grid_point(wall, i + 1, j + 1),
                grid_point(wall, i, j + 1)},
               material);
  place(scene, std::move(mesh));
}

/// Nine grids around and with the lamp. Each is an instance, so that no vertex is shared: that
/// makes the paper's counts.
void place_ceiling(Scene& scene, uint32_t gray, uint32_t light) {
  const Wall wall{{0, kQuads, 0}, {1, 0, 0}, {0, 0, 1}};
  constexpr std::array<int, 4> kCuts{0, kQuads / 2, kQuads / 2 + 1, kQuads};
  for (size_t j = 0; j < 3; ++j)
    for (size_t i = 0; i < 3; ++i) {
      const bool lamp = i == 1 && j == 1;
      const std::string name = "ceiling " + std::to_string(1 + i + 3 * j);
      place_grid(scene, lamp ? "light" : name, wall,
                 {kCuts[i], kCuts[i + 1], kCuts[j], kCuts[j + 1]}, lamp ? light : gray);
    }
}

/// A ring around the y axis with smooth normals: `around` circles of `across` vertices.
Mesh torus(const char* name, float ring_radius_m, float tube_radius_m, int around, int across,
           uint32_t material) {
  Mesh mesh;
  mesh.name = name;
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < across; ++j) {
      const float phi = 2 * kPi * float(i) / float(around);
      const float theta = 2 * kPi * float(j) / float(across);
      const Vec3 outwards{std::cos(phi), 0, -std::sin(phi)};
      const Vec3 normal = normalize(outwards * std::cos(theta) + Vec3{0, std::sin(theta), 0});
      mesh.normals.push_back(normal);
      mesh.positions.push_back(outwards * ring_radius_m + normal * tube_radius_m);
    }
  const auto at = [&](int i, int j) { return uint32_t(i % around * across + j % across); };
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < across; ++j) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  mesh.triangle_material.assign(mesh.triangles.size(), material);
  return mesh;
}

}  // namespace

Scene radiosity_box() {
  Scene scene;
  scene.name = "radiosity-box";
  const uint32_t gray = add_material(scene, "gray", {0.7f, 0.7f, 0.7f});
  const uint32_t red = add_material(scene, "red", {0.63f, 0.06f, 0.05f});
  const uint32_t green = add_material(scene, "green", {0.14f, 0.45f, 0.09f});
  // [Rodriguez06, plate C.10] gives the lamp's colour, a radiosity: radiance is that over pi.
  const uint32_t light =
      add_material(scene, "light", {0, 0, 0}, Rgb{100.4f, 96.8f, 90.0f} * (1 / kPi));

  constexpr int n = kQuads;
  const std::array<int, 4> whole{0, n, 0, n};
  place_grid(scene, "floor", {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}}, whole, gray);
  place_grid(scene, "back wall", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, whole, gray);
  place_grid(scene, "front wall", {{n, 0, n}, {-1, 0, 0}, {0, 1, 0}}, whole, gray);
  place_grid(scene, "left wall", {{0, 0, n}, {0, 0, -1}, {0, 1, 0}}, whole, red);
  place_grid(scene, "right wall", {{n, 0, 0}, {0, 0, 1}, {0, 1, 0}}, whole, green);
  place_ceiling(scene, gray, light);

  // From outside, through the back of the front wall, which is invisible from there.
  place_camera(scene, "front", {0, 1, 4.4f}, {0, 1, 0}, 0.65f, 1);
  return scene;
}

Scene radiosity_box_with_shapes() {
  Scene scene = radiosity_box();
  scene.name = "radiosity-box-with-shapes";
  // 32 * 23 + 2 vertices and 40 * 30: 1938, which with the box's 774 are 2712.
  const uint32_t blue = add_material(scene, "blue", {0.2f, 0.35f, 0.7f});
  const uint32_t yellow = add_material(scene, "yellow", {0.75f, 0.6f, 0.15f});
  place(scene, sphere("sphere", 0.35f, 32, 24, blue), translation({0, 0.55f, 0}));
  place(scene, torus("torus", 0.42f, 0.13f, 40, 30, yellow), translation({0, 1.3f, 0}));
  return scene;
}

}  // namespace luxel::scene
