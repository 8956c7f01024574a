#include "luxel/validate/exact_cases.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "luxel/base/text_tables.h"
#include "luxel/base/vec_double.h"
#include "luxel/scene/procedural.h"
#include "luxel/scene/shapes.h"
#include "luxel/viewfactor/rectangle_factor.h"

namespace luxel::validate {
namespace {

/// Sphere facets: 5 levels are 20,480 triangles, 1 degree across; their edges change E by less.
constexpr int kSphereLevels = 5;
constexpr double kFacets = 1e-3;

constexpr Rgb gray(double v) { return {float(v), float(v), float(v)}; }
/// Radiance that makes self-emitted radiosity e.
constexpr Rgb exitance(double e) { return gray(e / kPiDouble); }

using scene::everywhere, scene::of_material;
using Contains = scene::Chosen;

ExactPart part(std::string name, Contains contains, double irradiance, bool pointwise = true) {
  return {std::move(name), std::move(contains), [irradiance](Vec3) { return irradiance; },
          pointwise};
}

double area_of(const scene::Scene& scene, const Contains& contains) {
  double area = 0;
  for (uint32_t i = 0; i < scene.instances.size(); ++i)
    for (uint32_t t = 0; t < scene.meshes[scene.instances[i].mesh].triangles.size(); ++t)
      if (contains(scene, {i, t, {}}))
        area += double(scene::area_m2(scene::world_triangle(scene, i, t)));
  return area;
}

// Section 1.
ExactCase furnace(double rho, double e) {
  return {fmt::format("furnace, rho {}, e {}", rho, e),
          "1",
          scene::furnace_box(gray(rho), exitance(e)),
          48,
          {part("all", everywhere, e / (1 - rho))}};
}

// Section 2: flux Phi of a lamp in a closed room: mean E is Phi / (A (1 - rho)).
ExactCase room_with_point_light(double rho) {
  ExactCase c{fmt::format("room with a point light, rho {}", rho),
              "2",
              scene::furnace_box(gray(rho), {}),
              192,
              {part("mean of all", everywhere, 10000 / 96.0 / (1 - rho), false)}};
  c.scene.instances[0].world_from_object = scaling({4, 4, 4});
  scene::PunctualLight lamp;
  lamp.position = scene::world_bounds(c.scene).lower + Vec3{1, 3, 1.5f};
  lamp.intensity = gray(10000 / (4 * kPiDouble));
  c.scene.lights.push_back(lamp);
  return c;
}

// Section 2 with emission on three triangles of the walls and a block in the room.
ExactCase room_with_block() {
  constexpr double kRho = 0.7;
  ExactCase c{"room with a block, rho 0.7", "2", scene::furnace_box(gray(kRho), {}), 128, {}};
  scene::Scene& s = c.scene;
  scene::add_material(s, "lamp", gray(kRho), exitance(1));
  for (size_t t = 0; t < 3; ++t) s.meshes[0].triangle_material[t] = 1;
  scene::Mesh block;
  const Vec3 centre = scene::world_bounds(s).centre();
  scene::add_box(block, centre - Vec3{0.2f, 0.1f, 0.3f}, centre + Vec3{0.1f, 0.3f, 0.2f}, 0);
  scene::place(s, std::move(block));
  const double mean_e = area_of(s, of_material(1)) / area_of(s, everywhere);
  // mean B = mean e / (1 - rho), and B = e + rho E.
  c.parts = {part("mean of all", everywhere, mean_e / (1 - kRho), false)};
  return c;
}

/// Gives the facets of a sphere materials 0, 1, 2, ... from the top downwards, by shares of the
/// area.
void paint_zones(scene::Scene& scene, const std::vector<double>& shares) {
  scene::Mesh& mesh = scene.meshes[0];
  std::vector<uint32_t> order(mesh.triangles.size());
  std::iota(order.begin(), order.end(), 0u);
  std::vector<float> height(order.size());
  std::vector<double> area(order.size());
  for (const uint32_t t : order) {
    const scene::Triangle3 w = scene::world_triangle(scene, 0, t);
    height[t] = w.a.y + w.b.y + w.c.y;
    area[t] = double(scene::area_m2(w));
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](uint32_t a, uint32_t b) { return height[a] > height[b]; });
  const double total = std::accumulate(area.begin(), area.end(), 0.0);
  double done = 0, limit = shares[0] * total;
  uint32_t zone = 0;
  for (const uint32_t t : order) {
    if (done >= limit && zone + 1 < shares.size()) limit += shares[++zone] * total;
    mesh.triangle_material[t] = zone;
    done += area[t];
  }
}

// Section 3: what is reflected arrives evenly, so E = mean(e) / (1 - mean(rho)) everywhere.
ExactCase sphere_zones() {
  const std::array<double, 3> rho{0.8, 0.5, 0.2};
  ExactCase c{"sphere in three zones",
              "3",
              scene::inward_sphere(1, kSphereLevels, gray(rho[0]), exitance(1)),
              160,
              {},
              kFacets};
  for (const size_t z : {1u, 2u}) scene::add_material(c.scene, "zone", gray(rho[z]));
  paint_zones(c.scene, {0.2, 0.3, 0.5});
  double mean_rho = 0;
  const double total = area_of(c.scene, everywhere);
  for (uint32_t z = 0; z < 3; ++z) mean_rho += rho[z] * area_of(c.scene, of_material(z)) / total;
  const double h = area_of(c.scene, of_material(0)) / total / (1 - mean_rho);
  c.parts = {part("zone that shines", of_material(0), h), part("zone 2", of_material(1), h),
             part("zone 3", of_material(2), h)};
  return c;
}

// Section 3: a beam of 1000 lm strikes the wall of a sphere with a black port.
ExactCase integrating_sphere() {
  constexpr double kRho = 0.9;
  ExactCase c{
      "integrating sphere", "3", scene::inward_sphere(2, kSphereLevels, gray(kRho), {}), 160, {},
      2 * kFacets};
  scene::add_material(c.scene, "port", {});
  paint_zones(c.scene, {0.95, 0.05});
  scene::PunctualLight beam;
  beam.kind = scene::PunctualLight::Kind::spot;
  beam.direction = {1, 0, 0};
  beam.inner_cone_rad = 0.1f, beam.outer_cone_rad = 0.3f;
  // A squared ramp in the cosine between the cones: Phi = 2 pi I (1 - ci + (ci - co) / 3).
  const double co = std::cos(0.3), ci = std::cos(0.1);
  beam.intensity = gray(1000 / (2 * kPiDouble * (1 - ci + (ci - co) / 3)));
  c.scene.lights.push_back(beam);
  const double area = area_of(c.scene, everywhere), f = area_of(c.scene, of_material(1)) / area;
  const Contains away = [](const scene::Scene& s, const scene::SurfacePoint& p) {
    return scene::world_position(s, p).x < 0;
  };
  c.parts = {part("away from the beam", away, 1000 * kRho / (area * (1 - kRho * (1 - f))))};
  return c;
}

// Section 4: plates a thousand times as wide as their distance; within 200 of the middle the
// missing rest is below (1/300)^2.
ExactCase plates() {
  ExactCase c{"parallel plates", "4", {}, 128, {}, 2e-5};
  scene::add_material(c.scene, "lower", gray(0.5), exitance(1));
  scene::add_material(c.scene, "upper", gray(0.8), exitance(0.25));
  scene::add_rectangle(c.scene, {-500, 500, -500, 500}, 0, true, 0);
  scene::add_rectangle(c.scene, {-500, 500, -500, 500}, 1, false, 1);
  const auto middle = [](uint32_t plate) -> Contains {
    return [plate](const scene::Scene& s, const scene::SurfacePoint& p) {
      const Vec3 at = scene::world_position(s, p);
      return p.instance == plate && std::max(std::abs(at.x), std::abs(at.z)) < 200;
    };
  };
  const double b1 = (1 + 0.5 * 0.25) / (1 - 0.4), b2 = (0.25 + 0.8 * 1) / (1 - 0.4);
  c.parts = {part("lower", middle(0), b2), part("upper", middle(1), b1)};
  return c;
}

// Section 5: E = (B - e) / rho.
ExactCase concentric_spheres(bool inner_shines) {
  const double e1 = inner_shines, e2 = !inner_shines, rho1 = 0.3, rho2 = 0.7, q = 0.25;
  const double d = 1 - rho2 * (1 - q) - rho1 * rho2 * q;
  const double b1 = (e1 * (1 - rho2 * (1 - q)) + rho1 * e2) / d, b2 = (e2 + rho2 * q * e1) / d;
  ExactCase c{inner_shines ? "concentric spheres, the inner shines"
                           : "concentric spheres, the outer shines",
              "5",
              scene::inward_sphere(2, kSphereLevels - 1, gray(rho2), exitance(e2)),
              160,
              {part("inner", of_material(1), (b1 - e1) / rho1, false),
               part("outer", of_material(0), (b2 - e2) / rho2, false)},
              4 * kFacets};
  scene::Scene inner = scene::inward_sphere(1, kSphereLevels - 1, gray(rho1), exitance(e1));
  for (auto& t : inner.meshes[0].triangles) std::swap(t[1], t[2]);
  inner.meshes[0].triangle_material.assign(inner.meshes[0].triangles.size(), 1);
  c.scene.materials.push_back(inner.materials[0]);
  scene::place(c.scene, inner.meshes[0]);
  return c;
}

/// A wall of the unit box, or none of two: by the triangle's corners.
Contains on_height(float y) {
  return [y](const scene::Scene& s, const scene::SurfacePoint& p) {
    const scene::Triangle3 t = scene::world_triangle(s, p.instance, p.triangle);
    return t.a.y == y && t.b.y == y && t.c.y == y;
  };
}

/// The limit of a geometric sequence from three of its members (Aitken).
double limit_of(double a, double b, double c) { return c - (c - b) * (c - b) / (c - 2 * b + a); }

// Section 6: rho = 0.5, the floor has e = 1. Means over the walls, to which the table of exact
// Galerkin solutions with 4, 8 and 16 elements to a side tends. `rows` is that table.
Result<ExactCase> cube(const std::vector<TextRow>& rows) {
  ExactCase c{"cube, one wall shines", "6", scene::furnace_box(gray(0.5), {}), 128, {}, 1e-4};
  scene::add_material(c.scene, "lamp", gray(0.5), exitance(1));
  // The floor shines.
  const Box3 box = scene::world_bounds(c.scene);
  const Contains floor = on_height(box.lower.y), ceiling = on_height(box.upper.y);
  for (uint32_t t = 0; t < c.scene.meshes[0].triangles.size(); ++t)
    if (floor(c.scene, {0, t, {}})) c.scene.meshes[0].triangle_material[t] = 1;
  const Contains side = [=](const scene::Scene& s, const scene::SurfacePoint& p) {
    return !floor(s, p) && !ceiling(s, p);
  };
  // The limit of the table's three sizes, for the floor, the ceiling and the sides.
  std::array<double, 3> limit{};
  for (size_t k = 0; k < 3; ++k) {
    std::array<double, 3> of_size{};
    for (size_t size = 0; size < 3; ++size) {
      const TextRow& row = rows[2 + size];
      if (row.size() < 4)
        return fail(ErrorCode::bad_input, "exact-solutions.md, section 6: row '{}' is too short",
                    row[0]);
      LUXEL_TRY(of_size[size], parse_number(row[k + 1]));
    }
    limit[k] = limit_of(of_size[0], of_size[1], of_size[2]);
  }
  // The table holds B = e + rho E.
  c.parts = {part("the wall that shines", floor, (limit[0] - 1) / 0.5, false),
             part("opposite", ceiling, limit[1] / 0.5, false),
             part("sides", side, limit[2] / 0.5, false)};
  return c;
}

// Section 7. Pointwise light in it has no closed form; its mean follows from section 2.
ExactCase tetrahedron() {
  ExactCase c{"regular tetrahedron, one face shines", "7", {}, 96, {}};
  scene::add_material(c.scene, "wall", gray(0.5));
  scene::add_material(c.scene, "lamp", gray(0.5), exitance(1));
  const std::array<Vec3, 4> v{Vec3{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  scene::Mesh mesh;
  for (const auto& [a, b, d] : {std::array{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}}) {
    // Fronts look inwards, to the origin.
    const Vec3 n = cross(v[size_t(b)] - v[size_t(a)], v[size_t(d)] - v[size_t(a)]);
    const bool inward = dot(n, v[size_t(a)]) < 0;
    scene::add_triangle(mesh, v[size_t(a)], v[size_t(inward ? b : d)], v[size_t(inward ? d : b)],
                        mesh.triangles.empty() ? 1 : 0);
  }
  scene::place(c.scene, std::move(mesh));
  c.parts = {part("mean of all", everywhere, 0.25 / 0.5, false)};
  return c;
}

// Section 9: emission e = 1 - rho F makes B = 1 everywhere, so E = F. Constant on each of 24 x 24
// cells, at its mean: at distance 1 that changes E by less than 1e-5.
ExactCase manufactured() {
  constexpr int kCells = 24;
  const auto factor = [](double x, double z) {
    return viewfactor::rectangle_factor(-x, 1 - x, -z, 1 - z, 1);
  };
  ExactCase c{"manufactured solution", "9", {}, 256, {}, 2e-5};
  std::array<scene::Mesh, 2> plates;
  for (int j = 0; j < kCells; ++j)
    for (int i = 0; i < kCells; ++i) {
      double mean = 0;
      for (int k = 0; k < 64; ++k)
        mean += factor((i + (k % 8 + 0.5) / 8) / kCells, (j + (k / 8 + 0.5) / 8) / kCells) / 64;
      const uint32_t m = scene::add_material(c.scene, "cell", gray(0.5), exitance(1 - 0.5 * mean));
      const auto at = [&](int k) { return float(k) / kCells; };
      const float x0 = at(i), x1 = at(i + 1), z0 = at(j), z1 = at(j + 1);
      scene::add_quad(plates[0], {Vec3{x0, 0, z0}, {x0, 0, z1}, {x1, 0, z1}, {x1, 0, z0}}, m);
      scene::add_quad(plates[1], {Vec3{x0, 1, z0}, {x1, 1, z0}, {x1, 1, z1}, {x0, 1, z1}}, m);
    }
  for (scene::Mesh& plate : plates) scene::place(c.scene, std::move(plate));
  c.parts = {{"all", everywhere, [=](Vec3 p) { return factor(double(p.x), double(p.z)); }}};
  return c;
}

// Section 10: the part of the emitter beyond max(0, 0.8 - x) is seen.
ExactCase penumbra() {
  ExactCase c{"penumbra of a straight edge", "10", {}, 256, {}};
  scene::add_material(c.scene, "black", {});
  scene::add_material(c.scene, "lamp", {}, exitance(1));
  scene::add_rectangle(c.scene, {-0.3f, 1.2f, 0.25f, 0.75f}, 0, true, 0);
  scene::add_rectangle(c.scene, {0, 1, 0, 1}, 2, false, 1);
  scene::add_rectangle(c.scene, {-2, 0.4f, -2, 2}, 1, false, 0);
  const Contains receiver = [](const scene::Scene&, const scene::SurfacePoint& p) {
    return p.instance == 0;
  };
  c.parts = {{"receiver", receiver, [](Vec3 p) {
                const double x = double(p.x), z = double(p.z);
                return viewfactor::rectangle_factor(std::clamp(0.8 - x, 0.0, 1.0) - x, 1 - x, -z,
                                                    1 - z, 2);
              }}};
  return c;
}

}  // namespace

Result<std::vector<ExactCase>> exact_cases(std::string_view exact_solutions_md) {
  std::vector<ExactCase> cases;
  cases.push_back(furnace(0.5, 1));
  cases.push_back(furnace(0.9, 0.3));
  cases.push_back(room_with_point_light(0.3));
  cases.push_back(room_with_point_light(0.9));
  cases.push_back(room_with_block());
  cases.push_back(sphere_zones());
  cases.push_back(integrating_sphere());
  cases.push_back(plates());
  cases.push_back(concentric_spheres(true));
  cases.push_back(concentric_spheres(false));
  const auto rows = markdown_rows(exact_solutions_md, "6 Cube", "n");
  if (rows.size() >= 5) {
    LUXEL_TRY(ExactCase shining, cube(rows));
    cases.push_back(std::move(shining));
  }
  cases.push_back(tetrahedron());
  cases.push_back(manufactured());
  cases.push_back(penumbra());
  return cases;
}

}  // namespace luxel::validate
