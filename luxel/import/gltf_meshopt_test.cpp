// EXT_ and KHR_meshopt_compression: what the encoders made of a torus is the torus.
#include <gmock/gmock.h>

#include "luxel/base/process_memory.h"
#include "luxel/import/compressed_test_support.h"
#include "tests/support.h"

namespace luxel::import {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// Octahedra of 8 bits: x and y are half a unit of 1 / 127 off, z as much as both, so the point by
/// sqrt(6) / 2 units and its direction, where |p| >= 1 / sqrt(3), by sqrt(3) times that. Then each
/// component is rounded to a byte once more: sqrt(3) / 2 units.
constexpr float kOctahedron8 = (1.7321f * 2.4495f + 1.7321f) / 2 / 127;

TEST(GltfMeshopt, FloatsAreExactAndOctahedraNearly) {
  const Surface surface = torus(12);
  for (const char* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"})
    for (const bool marked : {true, false}) {
      const std::string glb = meshopt_gltf(surface, name).glb(marked);
      const scene::Scene scene = scene_of(import_text("a.glb", glb));
      ASSERT_EQ(scene.meshes.size(), 1u);
      expect_surface(scene.meshes[0], surface, {0, kOctahedron8, 0});
    }
}

// Old files become new ones by their names alone; new streams are none of the old extension.
TEST(GltfMeshopt, TheNewerExtensionReadsBothFormats) {
  const Surface surface = torus(6);
  const auto with_name = [&](const char* made_for, const char* name) {
    MeshoptGltf m = meshopt_gltf(surface, made_for);
    for (nlohmann::json& view : m.gltf.json["bufferViews"])
      view["extensions"] = {{name, view["extensions"][made_for]}};
    m.name = name;
    return import_text("a.glb", m.glb());
  };
  expect_surface(
      scene_of(with_name("EXT_meshopt_compression", "KHR_meshopt_compression")).meshes[0], surface,
      {0, kOctahedron8, 0});
  EXPECT_THAT(error_of(with_name("KHR_meshopt_compression", "EXT_meshopt_compression")),
              HasSubstr("are damaged or are not 49 elements of 12 bytes"));
}

// White, then a colour of 8 bits whose luma is (200 + 2 * 50 + 100) / 4; alpha lacks its lowest
// bit.
TEST(GltfMeshopt, ColorFilter) {
  MeshoptGltf m = meshopt_gltf(torus(3), "KHR_meshopt_compression");
  std::string colors;
  for (int i = 0; i < 16; ++i)
    colors += i < 8 ? std::string{'\xff', 0, 0, '\xff'} : std::string{100, 50, -50, '\xff'};
  const int c =
      m.accessor(m.attributes(std::vector<char>(colors.begin(), colors.end()), 4, "COLOR"), 5121,
                 16, "VEC4", true);
  m.gltf.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = c;
  const scene::Scene scene = scene_of(import_text("a.glb", m.glb()));
  ASSERT_EQ(scene.meshes.at(0).colors.size(), 16u);
  for (size_t i = 0; i < 16; ++i)
    expect_near(scene.meshes[0].colors[i],
                i < 8 ? Vec3{1, 1, 1} : Vec3{200 / 255.0f, 50 / 255.0f, 100 / 255.0f}, 1e-6f);
}

// A control byte without deltas is 1 kB: what may become 100 MB is no more than is left.
TEST(GltfMeshopt, DecodedBytesAreCountedFirst) {
  MeshoptGltf m = meshopt_gltf(torus(3), "KHR_meshopt_compression");
  constexpr size_t kControls = 100'000;
  m.view("\xa1" + std::string(kControls, '\xaa') + std::string(24, '\0'), 4, 256 * kControls,
         "ATTRIBUTES");
  const TemporaryFolder folder;
  const uint64_t before = resident_bytes();
  const auto imported = import_scene(folder.write("a.glb", m.glb()), {}, before + 32 * 1024 * 1024);
  ASSERT_FALSE(imported);
  EXPECT_EQ(imported.error().code, ErrorCode::out_of_memory);
  EXPECT_THAT(imported.error().message, HasSubstr("a.glb: buffer view 4 needs 97.7 MiB"));
  EXPECT_LT(resident_bytes(), before + 32 * 1024 * 1024);
}

TEST(GltfMeshopt, TextFilesNameTheirCompressedBuffer) {
  const Surface surface = torus(6);
  const MeshoptGltf m = meshopt_gltf(surface);
  const TemporaryFolder folder;
  folder.write("data.bin", m.gltf.buffer);
  nlohmann::json document = m.gltf.json;
  document["buffers"] = m.buffers(true);
  document["buffers"][0] = {{"byteLength", m.gltf.buffer.size()}, {"uri", "data.bin"}};
  document["extensionsRequired"] = {"EXT_meshopt_compression"};
  // The placeholder may name a file that is not there: nobody needs it.
  document["buffers"][1]["uri"] = "nowhere.bin";
  expect_surface(scene_of(import_scene(folder.write("a.gltf", document.dump()))).meshes[0], surface,
                 {0, kOctahedron8, 0});
}

TEST(GltfMeshopt, PicturesBesideCompressedViewsAreRead) {
  MeshoptGltf m = meshopt_gltf(torus(6));
  const int picture = m.gltf.view(png_of(3, 2, {10, 20, 30, 255}));
  m.gltf.json["images"] = {{{"bufferView", picture}, {"mimeType", "image/png"}}};
  m.gltf.json["textures"] = {{{"source", 0}}};
  m.gltf.json["materials"] = {
      {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}, {"metallicFactor", 0}}}}};
  m.gltf.json["meshes"][0]["primitives"][0]["material"] = 0;
  const scene::Scene scene = scene_of(import_text("a.glb", m.glb()));
  ASSERT_EQ(scene.textures.size(), 1u);
  EXPECT_EQ(scene.textures[0].width, 3);
}

// The exponents are shared by the three numbers of a row. With 15 bits of mantissa and numbers
// below 2 the step is 2^(1 - 14); half of it is lost.
TEST(GltfMeshopt, ExponentialFilter) {
  const Surface surface = torus(12);
  MeshoptGltf m = meshopt_gltf(surface);
  std::vector<uint32_t> words(surface.positions.size());
  meshopt_encodeFilterExp(words.data(), surface.vertices(), 12, 15, surface.positions.data());
  const int p =
      m.accessor(m.attributes(words, 12, "EXPONENTIAL"), 5126, surface.vertices(), "VEC3");
  m.gltf.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = p;
  expect_surface(scene_of(import_text("a.glb", m.glb())).meshes[0], surface,
                 {1.7321f * std::ldexp(1.0f, 1 - 15) + 1e-6f, kOctahedron8, 0});
}

// The largest of four components is left out, the others lie within 1 / sqrt(2) and take 12 bits:
// off by d = sqrt(1/2) / 2 / 2047 each, the largest by at most 3 d, since it is no less than 1/2;
// then 16 bits each. A vector turns by twice the quaternion's error.
TEST(GltfMeshopt, QuaternionFilterTurnsInstances) {
  MeshoptGltf m = meshopt_gltf(torus(6));
  std::vector<float> turns;
  std::vector<Vec3> images_of_x;
  for (int i = 0; i < 40; ++i) {  // about y: x goes to (cos a, 0, -sin a)
    const double a = 0.15 * i;
    for (const double q : {0.0, std::sin(a / 2), 0.0, std::cos(a / 2)}) turns.push_back(float(q));
    images_of_x.push_back({float(std::cos(a)), 0, float(-std::sin(a))});
  }
  std::vector<int16_t> words(turns.size());
  meshopt_encodeFilterQuat(words.data(), 40, 8, 12, turns.data());
  const int r = m.accessor(m.attributes(words, 8, "QUATERNION"), 5122, 40, "VEC4", true);
  m.gltf.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["ROTATION"] = r;
  const scene::Scene scene = scene_of(import_text("a.glb", m.glb()));
  ASSERT_EQ(scene.instances.size(), 40u);
  const float d = 0.7072f / 2 / 2047, error = 2 * (std::sqrt(12.0f) * d + 1.0f / 32767) + 1e-6f;
  for (size_t i = 0; i < 40; ++i)
    expect_near(column(scene.instances[i].world_from_object, 0), images_of_x[i], error);
}

TEST(GltfMeshopt, IndexSequencesAndShortIndices) {
  const Surface surface = torus(6);
  for (const bool triangles : {true, false}) {
    MeshoptGltf m = meshopt_gltf(surface);
    const int i = m.accessor(m.indices(surface.indices, 2, triangles), 5123, surface.indices.size(),
                             "SCALAR");
    m.gltf.json["meshes"][0]["primitives"][0]["indices"] = i;
    expect_surface(scene_of(import_text("a.glb", m.glb())).meshes[0], surface,
                   {0, kOctahedron8, 0});
  }
}

// As gltfpack writes files: integers that the node and the texture transform put in their place.
TEST(GltfMeshopt, QuantizedNumbersAreScaledByNodeAndTexture) {
  const Surface surface = torus(12);
  constexpr float kStep = 2.8f / 16383, kUvSteps = 4095;
  std::vector<uint16_t> positions, uv;
  for (size_t i = 0; i < surface.vertices(); ++i) {
    for (size_t k = 0; k < 3; ++k)
      positions.push_back(uint16_t(std::lround((surface.positions[3 * i + k] + 1.4f) / kStep)));
    positions.push_back(0);  // rows of a multiple of 4 bytes
    for (size_t k = 0; k < 2; ++k)
      uv.push_back(uint16_t(std::lround(surface.uv[2 * i + k] * kUvSteps)));
  }
  MeshoptGltf m = meshopt_gltf(surface);
  auto& attributes = m.gltf.json["meshes"][0]["primitives"][0]["attributes"];
  attributes["POSITION"] = m.accessor(m.attributes(positions, 8), 5123, surface.vertices(), "VEC3");
  attributes["TEXCOORD_0"] = m.accessor(m.attributes(uv, 4), 5123, surface.vertices(), "VEC2");
  m.gltf.json["nodes"][0]["scale"] = {kStep, kStep, kStep};
  m.gltf.json["nodes"][0]["translation"] = {-1.4, -1.4, -1.4};
  scene::Scene scene = scene_of(import_text("a.glb", m.glb()));
  scene::Mesh& mesh = scene.meshes[0];
  for (Vec3& p : mesh.positions) p = transform_point(scene.instances[0].world_from_object, p);
  for (Vec2& t : mesh.uv0) t = t * (1 / kUvSteps);
  expect_surface(mesh, surface,
                 {1.7321f * kStep / 2 + 1e-6f, kOctahedron8, 0.5f / kUvSteps + 1e-6f});
}

class GltfMeshoptDamage : public ::testing::Test {
 protected:
  MeshoptGltf m = meshopt_gltf(torus(6));
  nlohmann::json& views = m.gltf.json["bufferViews"];
  nlohmann::json& extension(size_t view) {
    return views[view]["extensions"]["EXT_meshopt_compression"];
  }
  std::string error() const {
    const auto imported = import_text("a.glb", m.glb());
    EXPECT_FALSE(imported);
    return imported ? "" : imported.error().message;
  }
  auto names_view(int view, const std::string& words) const {
    return AllOf(HasSubstr(fmt::format("a.glb: buffer view {}", view)), HasSubstr(words));
  }
};

TEST_F(GltfMeshoptDamage, NumbersThatContradictEachOther) {
  extension(0)["count"] = 48;
  EXPECT_THAT(error(), names_view(0, "count 48 times byteStride 12 is not the byteLength 588"));
  extension(0)["count"] = 1e15;
  EXPECT_THAT(error(), names_view(0, "count 1000000000000000 times"));
  extension(0)["count"] = 49;
  views[0]["byteStride"] = 24;
  EXPECT_THAT(error(), HasSubstr("accessor 0"));
  views[0]["byteStride"] = 8;
  EXPECT_THAT(error(), HasSubstr("a.glb: "));
  views[0].erase("byteStride");
  extension(0)["byteLength"] = 1e6;
  EXPECT_THAT(error(), names_view(0, "reach past"));
  extension(0)["byteLength"] = 9;
  EXPECT_THAT(error(),
              names_view(0, "its 9 compressed bytes cannot become 588 bytes, at most 576"));
  extension(0)["byteLength"] = 100;
  EXPECT_THAT(error(), names_view(0, "the 100 compressed bytes"));
  extension(0)["buffer"] = 2;
  EXPECT_THAT(error(), names_view(0, "buffer 2 is out of range"));
}

TEST_F(GltfMeshoptDamage, ALieAboutTheSizeAllocatesNothing) {
  extension(0)["count"] = 4e9;
  views[0]["byteLength"] = 4.8e10;
  m.decoded_bytes += size_t(4.8e10);
  EXPECT_THAT(error(), names_view(0, "cannot become 48000000000 bytes"));
}

TEST_F(GltfMeshoptDamage, LayoutsThatTheExtensionForbids) {
  extension(0)["byteStride"] = 6;
  EXPECT_THAT(error(), names_view(0, "byteStride is 6, must be a multiple of 4"));
  extension(0)["byteStride"] = 260;
  EXPECT_THAT(error(), names_view(0, "byteStride is 260"));
  extension(0)["byteStride"] = 12;
  extension(0)["filter"] = "OCTAHEDRAL";
  EXPECT_THAT(error(), names_view(0, "must be 4 or 8 for the filter OCTAHEDRAL"));
  extension(0)["filter"] = "QUATERNION";
  EXPECT_THAT(error(), names_view(0, "must be 8 for the filter QUATERNION"));
  extension(0)["filter"] = "COLOR";
  EXPECT_THAT(error(), names_view(0, "filter is \"COLOR\", must be one of NONE, OCTAHEDRAL"));
  extension(0).erase("filter");
  views[0]["extensions"]["KHR_meshopt_compression"] = extension(0);
  EXPECT_THAT(error(), names_view(0, "it has both EXT_meshopt_compression and KHR_meshopt"));
  views[0]["extensions"].erase("EXT_meshopt_compression");
  views[0]["extensions"]["KHR_meshopt_compression"]["filter"] = "COLOR";
  EXPECT_THAT(error(), names_view(0, "byteStride is 12, must be 4 or 8 for the filter COLOR"));
  views[0]["extensions"] = views[1]["extensions"];
  extension(0) = {{"buffer", 0},
                  {"byteLength", 100},
                  {"byteStride", 12},
                  {"count", 49},
                  {"mode", "ATTRIBUTES"}};
  extension(3)["count"] = 214;
  EXPECT_THAT(error(), names_view(3, "count is 214, must be a multiple of 3"));
  extension(3)["byteStride"] = 8;
  EXPECT_THAT(error(), names_view(3, "must be 2 or 4 for indices"));
  extension(3)["byteStride"] = 4;
  extension(3)["filter"] = "EXPONENTIAL";
  EXPECT_THAT(error(), names_view(3, "indices cannot have a filter"));
  extension(3)["mode"] = 0;
  EXPECT_THAT(error(), names_view(3, "mode is 0, must be one of ATTRIBUTES, TRIANGLES, INDICES"));
  views[3]["extensions"]["EXT_meshopt_compression"] = "yes";
  EXPECT_THAT(error(), names_view(3, "must be an object"));
}

TEST_F(GltfMeshoptDamage, IndicesOutOfRangeAfterDecoding) {
  std::vector<uint32_t> indices = torus(6).indices;
  indices[4] = 49;  // there are 49 vertices
  const int i = m.accessor(m.indices(indices, 4, true), 5125, indices.size(), "SCALAR");
  m.gltf.json["meshes"][0]["primitives"][0]["indices"] = i;
  EXPECT_THAT(error(), HasSubstr("mesh 0 (thing), primitive 0: vertex index 49 is out of range"));
}

TEST_F(GltfMeshoptDamage, FallbackBuffersThatSomebodyNeeds) {
  views[2].erase("extensions");
  EXPECT_THAT(error(), HasSubstr("buffer 1 is marked as fallback, but buffer view 2 needs"));
  m.gltf.json["images"] = {{{"bufferView", 0}, {"mimeType", "image/png"}}};
  EXPECT_THAT(error(), HasSubstr("image 0 lies in buffer view 0, which EXT_meshopt_compression"));
}

// One scene, exported with and without compression: not one bit of its numbers differs.
TEST(GltfMeshoptScene, TheGardenIsTheGarden) {
  LUXEL_NEEDS_SHARED("scenes/japanese_bridge_garden");
  const auto folder = testing_support::shared_folder() / "scenes/japanese_bridge_garden";
  const scene::Scene a = scene_of(import_scene(folder / "japanese_bridge_garden.glb"));
  const scene::Scene b = scene_of(import_scene(folder / "japanese_bridge_garden_meshopt.glb"));
  EXPECT_EQ(scene::first_triangles(a), scene::first_triangles(b));
  EXPECT_EQ(scene::first_triangles(b).back(), 21883u) << "by its README";
  EXPECT_EQ(scene::world_bounds(a).lower, scene::world_bounds(b).lower);
  EXPECT_EQ(scene::world_bounds(a).upper, scene::world_bounds(b).upper);
  EXPECT_FLOAT_EQ(drawn_area(a), drawn_area(b));
  ASSERT_GE(a.materials.size(), 13u);  // of the file; more are made for sheets with two sides
  ASSERT_EQ(b.materials.size(), a.materials.size());
  for (size_t i = 0; i < 13; ++i) {
    const scene::Material &m = a.materials[i], &n = b.materials[i];
    // Nine decimal digits in one file, the shortest that is the same float in the other.
    expect_near(m.base_color, n.base_color, 1e-6f);
    expect_near(m.emission, n.emission, 1e-5f);
    // One file writes an index of refraction of 1000 where the other means infinity: 0.996 for 1.
    expect_near(m.specular, n.specular, 0.004f * 1.7321f);
    EXPECT_NEAR(m.roughness, n.roughness, 1e-6f);
    EXPECT_EQ(m.metallic, n.metallic);
    EXPECT_EQ(m.double_sided, n.double_sided);
    EXPECT_EQ(m.alpha_mode, n.alpha_mode);
  }
}

}  // namespace
}  // namespace luxel::import
