// KHR_draco_mesh_compression: what Draco's encoder made of a torus is the torus.
#include <gmock/gmock.h>

#include "luxel/import/compressed_test_support.h"

namespace luxel::import {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// A range r in b bits has the step r / (2^b - 1), and each number is at most half a step off. The
/// range is the longest side of the box; rounding of floats adds less than 1e-6.
float half_step(float range, int bits) { return 0.5f * range / float((1 << bits) - 1) + 1e-6f; }

/// The octahedron |x| + |y| + |z| = 1 has x and y in units of 1 / c, c = 2^(b-1) - 1. x is half a
/// unit off; y another whole unit, where rounding up both leaves the octahedron. So z is off by at
/// most 2, the point by sqrt(0.25 + 2.25 + 4) = 2.55 units, and where |p| >= 1 / sqrt(3) its
/// direction by sqrt(3) times that.
float normal_error(int bits) { return 1.7321f * 2.55f / float((1 << (bits - 1)) - 1); }

Bounds bounds_of(const DracoOptions& o) {
  return {1.7321f * half_step(2.8f, o.position_bits), normal_error(o.normal_bits),
          half_step(1, o.uv_bits)};
}

TEST(GltfDraco, EveryWayOfEncodingIsTheTorus) {
  const Surface surface = torus(12);
  std::vector<DracoOptions> ways{{}, {}, {}, {}, {}};
  ways[1].sequential = true;
  ways[2].speed = 0;   // valence codes, most kinds of prediction
  ways[3].speed = 10;  // the plainest
  ways[4] = {16, 14, 15, false, 5};
  for (const DracoOptions& options : ways) {
    const scene::Scene scene = scene_of(import_glb(draco_gltf(draco_bytes(surface, options))));
    ASSERT_EQ(scene.meshes.size(), 1u);
    expect_surface(scene.meshes[0], surface, bounds_of(options));
  }
}

TEST(GltfDraco, AnAttributeOfAnotherIdIsAnotherAttribute) {
  Gltf gltf = draco_gltf(draco_bytes(torus(6)));
  auto& ids = gltf.json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"]
                       ["attributes"];
  ids["POSITION"] = 1;
  const scene::Scene scene = scene_of(import_glb(gltf));
  for (const Vec3 p : scene.meshes[0].positions)
    EXPECT_NEAR(length(p), 1, 1e-5f) << "the normals stand in for the positions";
}

TEST(GltfDraco, AnOptionalExtensionIsReadBeforeItsFallback) {
  Gltf gltf = draco_gltf(draco_bytes(torus(6)));
  gltf.json.erase("extensionsRequired");
  gltf.json["accessors"][0]["bufferView"] =
      gltf.view(std::string(12 * gltf.json["accessors"][0]["count"].get<size_t>(), '\0'));
  EXPECT_NEAR(scene::world_bounds(scene_of(import_glb(gltf))).upper.x, 1.4f, 1e-3f)
      << "the fallback is all zeros";
}

TEST(GltfDraco, PrimitivesThatSayTheSameShareTheirVertices) {
  Gltf gltf = draco_gltf(draco_bytes(torus(6)));
  auto& primitives = gltf.json["meshes"][0]["primitives"];
  primitives.push_back(primitives[0]);
  const scene::Scene scene = scene_of(import_glb(gltf));
  EXPECT_EQ(scene.meshes[0].triangles.size(), 2u * 2 * 6 * 6);
  EXPECT_EQ(scene.meshes[0].positions.size(), gltf.json["accessors"][0]["count"].get<size_t>());
}

/// Draco holds a list of triangles whatever the mode says.
TEST(GltfDraco, AStripHasTheSameTriangles) {
  Gltf gltf = draco_gltf(draco_bytes(torus(12)));
  gltf.json["meshes"][0]["primitives"][0]["mode"] = 5;
  const scene::Scene scene = scene_of(import_glb(gltf));
  ASSERT_EQ(scene.meshes.size(), 1u);
  expect_surface(scene.meshes[0], torus(12), bounds_of({}));
}

class GltfDracoDamage : public ::testing::Test {
 protected:
  Gltf gltf = draco_gltf(draco_bytes(torus(6)));
  nlohmann::json& primitive = gltf.json["meshes"][0]["primitives"][0];
  nlohmann::json& extension = primitive["extensions"]["KHR_draco_mesh_compression"];

  std::string error() const {
    const auto imported = import_glb(gltf);
    EXPECT_FALSE(imported);
    return imported ? "" : imported.error().message;
  }
  auto names_primitive_and(const std::string& words) const {
    return AllOf(HasSubstr("a.glb: mesh 0 (thing), primitive 0"), HasSubstr(words));
  }
};

TEST_F(GltfDracoDamage, CountsThatTheAccessorDoesNotHave) {
  gltf.json["accessors"][0]["count"] = 48;
  EXPECT_THAT(error(), names_primitive_and("hold 49 vertices, the accessor states 48"));
  gltf.json["accessors"][0]["count"] = 49;
  gltf.json["accessors"][3]["count"] = 213;
  EXPECT_THAT(error(), names_primitive_and("hold 72 triangles, its accessor states 213 indices"));
}

TEST_F(GltfDracoDamage, TypesThatTheAccessorDoesNotHave) {
  gltf.json["accessors"][0]["type"] = "VEC4";
  EXPECT_THAT(error(), names_primitive_and("hold 3 numbers of type 5126 per vertex, the accessor "
                                           "states 4 of type 5126"));
  gltf.json["accessors"][0]["type"] = "VEC3";
  gltf.json["accessors"][0]["componentType"] = 5123;
  EXPECT_THAT(error(), names_primitive_and("states 3 of type 5123"));
}

TEST_F(GltfDracoDamage, WordsThatTheExtensionDoesNotHave) {
  extension["attributes"]["POSITION"] = 9;
  EXPECT_THAT(error(), names_primitive_and("POSITION: there is no attribute 9"));
  extension["attributes"]["POSITION"] = 5e9;
  EXPECT_THAT(error(), names_primitive_and("id 5000000000"));
  extension["attributes"] = {{"COLOR_0", 0}};
  EXPECT_THAT(error(), names_primitive_and("COLOR_0 is not among the primitive's attributes"));
  extension.erase("attributes");
  EXPECT_THAT(error(), names_primitive_and("it has no attributes"));
  extension["bufferView"] = 7;
  EXPECT_THAT(error(), names_primitive_and("bufferView 7 is out of range"));
  extension.erase("bufferView");
  EXPECT_THAT(error(), names_primitive_and("it has no bufferView"));
  primitive["extensions"]["KHR_draco_mesh_compression"] = 3;
  EXPECT_THAT(error(), names_primitive_and("is 3, must be an object"));
}

TEST_F(GltfDracoDamage, OnlyTriangles) {
  primitive["mode"] = 6;
  EXPECT_THAT(error(), names_primitive_and("mode is 6"));
}

TEST_F(GltfDracoDamage, BytesThatAreNoneOfDracos) {
  gltf.buffer[0] = 'X';
  EXPECT_THAT(error(), names_primitive_and("do not start as Draco data do"));
  gltf.buffer[0] = 'D';
  gltf.buffer[5] = 1;
  EXPECT_THAT(error(), names_primitive_and("version 1.2, must be 2.2"));
  gltf.buffer[5] = 2;
  gltf.buffer[7] = 0;
  EXPECT_THAT(error(), names_primitive_and("hold points"));
  gltf.buffer[7] = 1;
  gltf.json["bufferViews"][0]["byteLength"] = 11;
  EXPECT_THAT(error(), names_primitive_and("end in their header"));
  gltf.json["bufferViews"][0]["byteLength"] = 200;
  EXPECT_THAT(error(), names_primitive_and("200 bytes of Draco data are damaged"));
}

// After the 11 bytes of the header and the traversal's kind stand the numbers of vertices and of
// triangles, seven bits a byte, the last byte below 128. [Draco bitstream 2.2]
TEST_F(GltfDracoDamage, CountsThatNoMemoryHolds) {
  ASSERT_EQ(int(gltf.buffer[13]), 72) << "triangles";
  const std::string two_hundred_million = "\x80\x84\xaf\x5f";
  gltf.buffer.replace(13, 1, two_hundred_million);
  gltf.json["bufferViews"][0]["byteLength"] = gltf.buffer.size();
  EXPECT_THAT(error(), names_primitive_and("cannot hold 200000000 triangles"));
  gltf.buffer.replace(12, 5, two_hundred_million + "\x48");
  EXPECT_THAT(error(), names_primitive_and("state 200000000 vertices for 72 triangles"));
}

}  // namespace
}  // namespace luxel::import
