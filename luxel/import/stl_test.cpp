// .stl files, as text and binary; units and axes of files that state neither.
#include <gmock/gmock.h>

#include "luxel/import/import_test_support.h"

namespace luxel::import {
namespace {

using ::testing::HasSubstr;

using Facet = std::array<Vec3, 3>;

/// A prism of 32 sides, radius 1, from z = 0 to 2: nearly a cylinder.
std::vector<Facet> cylinder() {
  std::vector<Facet> out;
  const auto at = [](int side, float z) {
    const float angle = 2 * kPi * float(side % 32) / 32;
    return Vec3{std::cos(angle), std::sin(angle), z};
  };
  for (int s = 0; s < 32; ++s) {
    const Vec3 a = at(s, 0), b = at(s + 1, 0), c = at(s + 1, 2), d = at(s, 2);
    for (const Facet& facet :
         {Facet{a, b, c}, Facet{a, c, d}, Facet{Vec3{0, 0, 2}, d, c}, Facet{Vec3{0, 0, 0}, b, a}})
      out.push_back(facet);
  }
  return out;
}

std::string stl_text(const std::vector<Facet>& triangles) {
  std::string out = "solid thing\n";
  for (const Facet& t : triangles) {
    out += "facet normal 0 0 0\nouter loop\n";
    for (const Vec3 p : t) out += fmt::format("vertex {:.9g} {:.9g} {:.9g}\n", p.x, p.y, p.z);
    out += "endloop\nendfacet\n";
  }
  return out + "endsolid thing\n";
}

/// 80 bytes of anything, a count, then 12 floats and two bytes each.
std::string stl_binary(const std::vector<Facet>& triangles, std::string head = "") {
  head.resize(80, ' ');
  const auto append = [&](const auto& value) {
    head.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  append(uint32_t(triangles.size()));
  for (const Facet& t : triangles) append(Vec3{}), append(t), append(uint16_t(0));
  return head;
}

// Facets have no normals of their own: a round thing is round, and its rim is sharp.
TEST(Stl, TextAndBinaryAreSmoothAroundAndSharpAtTheRim) {
  const double side = 2 * 32 * 2 * std::sin(kPi / 32), ends = 32 * std::sin(2 * kPi / 32);
  for (const std::string& file :
       {stl_text(cylinder()), stl_binary(cylinder()), stl_binary(cylinder(), "solid by a CAD")}) {
    const scene::Scene scene = scene_of(import_text("a.stl", file));
    ASSERT_EQ(scene.meshes.size(), 1u);
    const scene::Mesh& mesh = scene.meshes[0];
    EXPECT_EQ(mesh.triangles.size(), 128u);
    EXPECT_NEAR(drawn_area(scene), side + ends, 1e-4);
    ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
    for (size_t v = 0; v < mesh.positions.size(); ++v) {
      const Vec3 n = mesh.normals[v], p = mesh.positions[v];
      const bool at_an_end = std::abs(n.z) > 0.5f;
      expect_near(n, at_an_end ? Vec3{0, 0, p.z > 1 ? 1.0f : -1.0f} : Vec3{p.x, p.y, 0}, 0.06f);
    }
  }
}

TEST(Stl, DamageIsAnErrorOrAWarning) {
  std::string binary = stl_binary(cylinder());
  for (const size_t length : {size_t(83), size_t(100), binary.size() - 1})
    EXPECT_FALSE(import_text("a.stl", binary.substr(0, length))) << length;
  binary[80] = char(0xff), binary[83] = char(0xff);
  EXPECT_FALSE(import_text("a.stl", binary)) << "it states four billion triangles";
  std::vector<Facet> triangles = cylinder();
  triangles[0][1].x = std::numeric_limits<float>::quiet_NaN();
  const auto nan = import_text("a.stl", stl_binary(triangles));
  EXPECT_FALSE(nan);
}

TEST(UnitsAndAxes, OfFilesThatStateNeither) {
  const std::vector<std::pair<const char*, std::string>> files{
      {"a.obj", "v 0 0 0\nv 100 0 0\nv 100 100 0\nv 0 100 0\nf 1 2 3 4\n"},
      {"a.ply",
       "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
       "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
       "0 0 0\n100 0 0\n100 100 0\n0 100 0\n4 0 1 2 3\n"},
      {"a.stl", stl_text({{{{0, 0, 0}, {100, 0, 0}, {100, 100, 0}}},
                          {{{0, 0, 0}, {100, 100, 0}, {0, 100, 0}}}})}};
  for (const auto& [name, text] : files) {
    const TemporaryFolder folder;
    const std::filesystem::path file = folder.write(name, text);
    ImportParams params;
    EXPECT_NEAR(drawn_area(scene_of(import_scene(file, params))), 1e4, 1) << name;
    params.unit_m = 0.01f, params.up = Up::z;
    const scene::Scene scene = scene_of(import_scene(file, params));
    EXPECT_NEAR(drawn_area(scene), 1, 1e-5) << name;
    // Normals along z point up now, and +y has become -z, behind.
    expect_near(scene::front_normal(scene, 0, 0), {0, 1, 0}, 1e-6f);
    const Box3 box = scene::world_bounds(scene);
    expect_near(box.lower, {0, 0, -1}, 1e-6f);
    expect_near(box.upper, {1, 0, 0}, 1e-6f);
  }
}

TEST(UnitsAndAxes, OfFilesThatStateThemAreRefused) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.write("a.glb", square_gltf().glb());
  ImportParams params;
  params.unit_m = 0.01f;
  const auto refused = import_scene(file, params);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::bad_setting);
  EXPECT_THAT(refused.error().message,
              HasSubstr(".glb files state their unit and the axis that points up; leave --unit "
                        "and --up out"));
}

}  // namespace
}  // namespace luxel::import
