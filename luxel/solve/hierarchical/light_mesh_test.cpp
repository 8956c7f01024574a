#include "luxel/solve/hierarchical/light_mesh.h"

#include <map>

#include "luxel/base/random.h"
#include "luxel/scene/surface_points.h"
#include "luxel/solve/hierarchical/hierarchical_test_support.h"
#include "luxel/solve/hierarchical/surface.h"

namespace luxel::hierarchical {
namespace {

using testing::solved;
using testing::Solved;

LightMesh mesh_of(const Solved& s, MeshParams params = {}) {
  Progress progress;
  auto mesh = make_light_mesh(s.solution, s.scene, *s.tracer, params, progress);
  EXPECT_TRUE(mesh);
  return std::move(*mesh);
}

TEST(Interpolant, IsEveryQuadraticFromItsSixSamples) {
  RandomStream random{4};
  for (int trial = 0; trial < 20; ++trial) {
    std::array<float, 6> c;
    for (float& v : c) v = 2 * random.next() - 1;
    const auto f = [&](float s, float t) {
      const float v = c[0] * s * s + c[1] * s * t + c[2] * s + c[3] * t * t + c[4] * t + c[5];
      return Rgb{v, 2 * v, -v};
    };
    const Interpolant r =
        interpolant_of({f(0, 0), f(0.5f, 0), f(1, 0), f(0.5f, 0.5f), f(0, 1), f(0, 0.5f)});
    for (int k = 0; k < 10; ++k) {
      const float s = random.next(), t = (1 - s) * random.next();
      EXPECT_NEAR(value_of(r, s, t).x, f(s, t).x, 1e-5);
      EXPECT_NEAR(value_of(r, s, t).y, f(s, t).y, 1e-5);
    }
  }
}

/// Triangles per edge, each edge by its ends' places.
using Edges = std::map<std::array<int64_t, 6>, int>;
Edges edges_of(const LightMesh& mesh, double grain_m) {
  Edges edges;
  const auto round = [&](double x) { return int64_t(std::llround(x / grain_m)); };
  for (const LightTriangle& t : mesh.triangles)
    for (size_t k = 0; k < 3; ++k) {
      DVec3 a = mesh.vertices[t.vertex[k]], b = mesh.vertices[t.vertex[(k + 1) % 3]];
      std::array<int64_t, 3> p{round(a.x), round(a.y), round(a.z)},
          q{round(b.x), round(b.y), round(b.z)};
      if (q < p) std::swap(p, q);
      ++edges[{p[0], p[1], p[2], q[0], q[1], q[2]}];
    }
  return edges;
}

// A closed room whose walls meet edge to edge: without T-vertices of any kind, within a face or
// where faces meet, each edge has two triangles.
TEST(LightMesh, EveryEdgeOfAClosedRoomHasTwoTriangles) {
  const auto s = solved(scene::radiosity_box(), {.eps = 0.03});
  for (const bool lines : {false, true}) {
    MeshParams params;
    params.discontinuities = lines;
    const LightMesh mesh = mesh_of(*s, params);
    size_t odd = 0;
    const Edges edges = edges_of(mesh, 2e-5);
    for (const auto& [edge, count] : edges) odd += count != 2;
    EXPECT_EQ(odd, 0u) << "of " << edges.size();
  }
}

TEST(LightMesh, FillsTheFaces) {
  const auto s = solved(scene::cornell_box(), {.eps = 0.02});
  const LightMesh mesh = mesh_of(*s);
  std::vector<double> area(s->solution.faces.size());
  for (const LightTriangle& t : mesh.triangles) {
    const DVec3 a = mesh.vertices[t.vertex[0]];
    const DVec3 n = cross(mesh.vertices[t.vertex[1]] - a, mesh.vertices[t.vertex[2]] - a);
    EXPECT_GT(dot(n, s->solution.faces.faces[t.face].plane.normal), 0);
    area[t.face] += length(n) / 2;
  }
  for (size_t f = 0; f < area.size(); ++f) {
    const double wanted = viewfactor::area_m2(s->solution.faces.faces[f].corners);
    EXPECT_NEAR(area[f], wanted, 1e-5 * wanted) << f;
  }
}

TEST(LightMesh, TheFurnaceGlowsEvenly) {
  const auto s =
      solved(scene::furnace_box({0.5f, 0.5f, 0.5f}, Rgb{1, 1, 1} * (1 / kPi)), {.eps = 0.02});
  const LightMesh mesh = mesh_of(*s);
  for (const scene::SurfacePoint& p : scene::points_uniform_in_area(s->scene, 500, 3))
    EXPECT_NEAR(irradiance_at(s->solution, mesh, s->scene, p).x, 2, 0.01);
}

// The shadow of the edge at x = 0.25 m, 1 m high, ends at 0.25 / (1 - 1/2.5) = 0.41667 m: its
// penumbra, from the lamp's both sides at -+5 mm, is 2 * 5 mm / 1.5 = 6.7 mm wide about it. Half of
// the light beside it is reached within a millimetre of its middle.
TEST(LightMesh, ShadowsEndWhereTheyDo) {
  const auto s = solved(testing::lamp_and_screen(0.005f, 5000), {.eps = 5});
  const LightMesh mesh = mesh_of(*s);
  const auto at = [&](double x) {
    const uint32_t floor = s->solution.faces.face_of_triangle[0];
    const MeshPoint place = *locate(s->solution, mesh, floor, {x, 0, 0.1});
    return double(value_of(mesh.interpolant[place.triangle], place.s, place.t).x);
  };
  const double edge = 0.25 / (1 - 1 / 2.5), bright = at(edge + 0.02), dark = at(edge - 0.02);
  EXPECT_LT(dark, 0.05 * bright);
  double half = -1;
  for (double x = edge - 0.01; x < edge + 0.01; x += 2e-5)
    if (at(x) < 0.5 * (bright + dark)) half = x;
  EXPECT_NEAR(half, edge, 1e-3);
}

}  // namespace
}  // namespace luxel::hierarchical
