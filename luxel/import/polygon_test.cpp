// Polygons as triangles: areas against the shoelace formula, in any plane and far from the origin.
#include "luxel/import/polygon.h"

#include <gmock/gmock.h>

#include <cmath>
#include <map>
#include <string>

#include "luxel/import/import_test_support.h"

namespace luxel::import {
namespace {

using ::testing::HasSubstr;

using Corners = std::vector<DVec3>;
using Triangles = std::vector<std::array<uint32_t, 3>>;

Corners flat(std::initializer_list<std::array<int, 2>> corners) {
  Corners out;
  for (const auto& [x, y] : corners) out.push_back({double(x), double(y), 0});
  return out;
}

/// Teeth along the edge of a floor: 12 m by 2 m without `notches` squares of 1 m.
Corners floor_with_notches(int notches) {
  Corners out = flat({{0, 0}, {12, 0}, {12, 2}});
  for (int k = notches; k-- > 0;)
    for (const auto& [x, y] : {std::array{2, 2}, {2, 1}, {1, 1}, {1, 2}})
      out.push_back({2.0 * k + x, double(y), 0});
  out.push_back({0, 2, 0});
  return out;
}

/// Two arms of width 1 that wind around each other's gap.
Corners spiral(int corners_of_each_side) {
  Corners outer, inner;
  for (int k = 0; k < corners_of_each_side; ++k) {
    const double angle = 0.05 * k, radius = 2 + 0.2 * angle;
    outer.push_back({radius * std::cos(angle), radius * std::sin(angle), 0});
    inner.push_back({(radius - 0.5) * std::cos(angle), (radius - 0.5) * std::sin(angle), 0});
  }
  outer.insert(outer.end(), inner.rbegin(), inner.rend());
  return outer;
}

/// A star of random radii: each of its corners may be a notch.
Corners star(uint32_t seed) {
  Corners out;
  uint32_t state = seed * 747796405u + 2891336453u;
  for (int k = 0; k < 23; ++k) {
    state = state * 1664525u + 1013904223u;
    const double angle = 2 * kPiDouble * k / 23, radius = 1 + double(state >> 8) / (1 << 24) * 9;
    out.push_back({radius * std::cos(angle), radius * std::sin(angle), 0});
  }
  return out;
}

/// Simple outlines, and those whose holes are joined by a doubled edge.
std::map<std::string, Corners> outlines() {
  std::map<std::string, Corners> out{
      {"square", flat({{0, 0}, {2, 0}, {2, 2}, {0, 2}})},
      {"corner on an edge", flat({{0, 0}, {1, 0}, {2, 0}, {2, 2}, {0, 2}})},
      {"arrow head", flat({{0, 0}, {4, 2}, {0, 4}, {1, 2}})},
      {"arrow head from its notch", flat({{1, 2}, {0, 0}, {4, 2}, {0, 4}})},
      {"L", flat({{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 3}, {0, 3}})},
      {"T", flat({{0, 2}, {1, 2}, {1, 0}, {2, 0}, {2, 2}, {3, 2}, {3, 3}, {0, 3}})},
      {"U", flat({{0, 0}, {3, 0}, {3, 3}, {2, 3}, {2, 1}, {1, 1}, {1, 3}, {0, 3}})},
      {"five notches", floor_with_notches(5)},
      {"wall with a window",
       flat({{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 0}, {1, 1}, {1, 3}, {3, 3}, {3, 1}, {1, 1}})},
      {"wall with two windows", flat({{0, 0},
                                      {7, 0},
                                      {7, 4},
                                      {0, 4},
                                      {0, 0},
                                      {1, 1},
                                      {1, 3},
                                      {3, 3},
                                      {3, 1},
                                      {4, 1},
                                      {4, 3},
                                      {6, 3},
                                      {6, 1},
                                      {4, 1},
                                      {3, 1},
                                      {1, 1}})},
      {"a corner that touches an edge", flat({{0, 0}, {6, 0}, {6, 4}, {3, 0}, {0, 4}})},
      {"spike", flat({{0, 0}, {2, 0}, {2, 2}, {2, 5}, {2, 2}, {0, 2}})},
      {"doubled corners", flat({{0, 0}, {0, 0}, {2, 0}, {2, 2}, {2, 2}, {2, 2}, {0, 2}})},
      {"spiral", spiral(200)}};
  for (uint32_t seed = 1; seed <= 100; ++seed) out["star " + std::to_string(seed)] = star(seed);
  return out;
}

double shoelace(const Corners& corners) {
  double twice = 0;
  for (size_t k = 0; k < corners.size(); ++k) {
    const DVec3 a = corners[k], b = corners[(k + 1) % corners.size()];
    twice += a.x * b.y - a.y * b.x;
  }
  return std::abs(twice) / 2;
}

/// The sum of the areas of triangles, each without sign.
double area_of(const Corners& corners, const Triangles& triangles) {
  double sum = 0;
  for (const auto& [a, b, c] : triangles)
    sum += length(cross(corners[b] - corners[a], corners[c] - corners[a])) / 2;
  return sum;
}

Corners mapped(const Corners& corners, const auto& map) {
  Corners out;
  for (const DVec3& c : corners) out.push_back(map(c));
  return out;
}

void expect_area(const Corners& corners, double area, const std::string& what) {
  Triangles triangles;
  EXPECT_TRUE(triangulate(corners, triangles)) << what;
  EXPECT_NEAR(area_of(corners, triangles), area, 1e-6 * area) << what;
  DVec3 normal;
  for (const auto& [a, b, c] : triangles)
    normal += cross(corners[b] - corners[a], corners[c] - corners[a]);
  for (const auto& [a, b, c] : triangles)
    EXPECT_GT(dot(cross(corners[b] - corners[a], corners[c] - corners[a]), normal), 0) << what;
}

TEST(Triangulate, TheAreaIsThatOfTheShoelaceFormula) {
  for (const auto& [name, corners] : outlines()) {
    const double area = shoelace(corners);
    expect_area(corners, area, name);
    expect_area(Corners(corners.rbegin(), corners.rend()), area, name + ", other winding");
    expect_area(mapped(corners, [](DVec3 c) { return DVec3{c.z, c.x, c.y}; }), area, name + ", yz");
    expect_area(mapped(corners, [](DVec3 c) { return DVec3{c.y, c.z, c.x}; }), area, name + ", zx");
    expect_area(mapped(corners,
                       [](DVec3 c) {
                         return c + DVec3{1e6, -2e6, 3e6};
                       }),
                area, name + ", far away");
    const double s = std::sqrt(0.5);
    expect_area(mapped(corners,
                       [s](DVec3 c) {
                         return DVec3{s * c.x, c.y, s * c.x};
                       }),
                area, name + ", oblique");
  }
}

TEST(Triangulate, NearlyPlanarOnesAreSplitAsFlatOnesAre) {
  for (const auto& [name, corners] : outlines()) {
    Triangles triangles;
    const auto bent = [](DVec3 c) { return DVec3{c.x, c.y, 1e-3 * std::sin(c.x + 2 * c.y)}; };
    EXPECT_TRUE(triangulate(mapped(corners, bent), triangles)) << name;
    EXPECT_NEAR(area_of(corners, triangles), shoelace(corners), 1e-6 * shoelace(corners)) << name;
  }
}

TEST(Triangulate, AConvexPolygonIsTheFanFromItsFirstCorner) {
  Corners corners;
  for (int k = 0; k < 6; ++k)
    corners.push_back({std::cos(k * kPiDouble / 3), 0, std::sin(k * kPiDouble / 3)});
  Triangles triangles;
  EXPECT_TRUE(triangulate(corners, triangles));
  EXPECT_EQ(triangles, (Triangles{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}}));
}

TEST(Triangulate, ACornerOnAStraightEdgeStaysOne) {
  const Corners corners = flat({{0, 0}, {1, 0}, {2, 0}, {2, 2}, {0, 2}});
  Triangles triangles;
  EXPECT_TRUE(triangulate(corners, triangles));
  ASSERT_EQ(triangles.size(), 3u);
  for (uint32_t k = 0; k < 5; ++k) {  // each edge of the outline is one of a triangle
    size_t found = 0;
    for (const auto& t : triangles)
      for (size_t i = 0; i < 3; ++i) found += t[i] == k && t[(i + 1) % 3] == (k + 1) % 5;
    EXPECT_EQ(found, 1u) << k;
  }
}

TEST(Triangulate, AnOutlineThatCrossesItselfIsSaidAndSplitFromItsFirstCorner) {
  Triangles triangles;
  EXPECT_FALSE(triangulate(flat({{0, 0}, {4, 3}, {4, 0}, {0, 2}}), triangles));
  EXPECT_EQ(triangles, (Triangles{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_FALSE(triangulate(flat({{0, 0}, {1, 1}, {1, 0}, {0, 1}}), triangles)) << "no area in sum";
}

TEST(Triangulate, WithoutAreaOrNotFiniteIsAFanForTheSceneToCheck) {
  for (const Corners& corners :
       {flat({{0, 0}, {1, 0}, {2, 0}, {3, 0}}), Corners(4),
        Corners{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, NAN, 0}},
        Corners{{0, 0, 0}, {1e300, 0, 0}, {1e300, 1e300, 0}, {0, INFINITY, 0}}}) {
    Triangles triangles;
    EXPECT_TRUE(triangulate(corners, triangles));
    EXPECT_EQ(triangles, (Triangles{{0, 1, 2}, {0, 2, 3}}));
  }
}

TEST(Triangulate, TenThousandCorners) {
  const Corners corners = spiral(5000);
  expect_area(corners, shoelace(corners), "spiral");
}

const std::string kPlyOfT =
    "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\n"
    "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0\n4 0 0\n4 1 0\n3 1 0\n3 3 0\n2 3 0\n2 1 0\n0 1 0\n8 0 1 2 3 4 5 6 7\n";
const std::string kObjOfT =
    "v 0 0 0\nv 4 0 0\nv 4 1 0\nv 3 1 0\nv 3 3 0\nv 2 3 0\nv 2 1 0\nv 0 1 0\n"
    "f 1 2 3 4 5 6 7 8\n";
const std::string kColladaOfT = R"(<COLLADA version="1.4.1"><asset><unit meter="1"/></asset>
<library_geometries><geometry id="g"><mesh><source id="p">
<float_array id="a" count="24">0 0 0 4 0 0 4 1 0 3 1 0 3 3 0 2 3 0 2 1 0 0 1 0</float_array>
<technique_common><accessor source="#a" count="8" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<polylist count="1"><input semantic="VERTEX" source="#v" offset="0"/><vcount>8</vcount>
<p>0 1 2 3 4 5 6 7</p></polylist></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n"><instance_geometry url="#g"/></node>
</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
const std::string kFbxOfT = R"(; FBX 7.4.0 project file
FBXHeaderExtension: {
FBXHeaderVersion: 1003
FBXVersion: 7400
}
GlobalSettings: {
Version: 1000
Properties70: {
P: "UnitScaleFactor", "double", "Number", "",100
}
}
Objects: {
Geometry: 10, "Geometry::t", "Mesh" {
Vertices: *24 {
a: 0,0,0,4,0,0,4,1,0,3,1,0,3,3,0,2,3,0,2,1,0,0,1,0
}
PolygonVertexIndex: *8 {
a: 0,1,2,3,4,5,6,-8
}
}
Model: 20, "Model::t", "Mesh" {
Version: 232
}
}
Connections: {
C: "OO",20,0
C: "OO",10,20
}
)";

TEST(Triangulate, APolygonHasItsAreaInEveryFormat) {
  for (const auto& [name, text] : {std::pair{"t.obj", kObjOfT},
                                   {"t.ply", kPlyOfT},
                                   {"t.dae", kColladaOfT},
                                   {"t.fbx", kFbxOfT}}) {
    const Result<Imported> imported = import_text(name, text);
    const scene::Scene scene = scene_of(imported);
    EXPECT_NEAR(drawn_area(scene), 6, 1e-5) << name;
    ASSERT_EQ(scene.meshes.size(), 1u) << name;
    EXPECT_EQ(scene.meshes[0].triangles.size(), 6u) << name;
    EXPECT_EQ(all_of(imported->warnings), "") << name;
  }
}

TEST(Triangulate, AFileIsToldOfPolygonsThatCrossThemselves) {
  const auto imported = import_text(
      "a.ply",
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
      "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0\n4 3 0\n4 0 0\n0 2 0\n4 0 1 2 3\n");
  ASSERT_TRUE(imported) << imported.error().message;
  EXPECT_THAT(
      all_of(imported->warnings),
      HasSubstr("a.ply: polygons whose outline crosses itself: 1; their area is not right"));
}

}  // namespace
}  // namespace luxel::import
