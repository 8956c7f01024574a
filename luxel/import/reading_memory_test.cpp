// Small files that ask for much: refused before it is used, and pictures are decoded once.
#include "luxel/import/reading_memory.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <functional>

#include "luxel/base/process_memory.h"
#include "luxel/import/import_test_support.h"

namespace luxel::import {
namespace {

using ::testing::HasSubstr;

constexpr uint64_t kMiB = 1024 * 1024;

TEST(ReadingMemory, CountsDown) {
  ReadingMemory memory(resident_bytes() + 100 * kMiB);
  EXPECT_TRUE(memory.take(30 * kMiB, "a"));
  EXPECT_TRUE(memory.take(30 * kMiB, "b"));
  const Status taken = memory.take(60 * kMiB, "the picture c");
  ASSERT_FALSE(taken);
  EXPECT_EQ(taken.error().code, ErrorCode::out_of_memory);
  EXPECT_THAT(taken.error().message, HasSubstr("the picture c needs 60.0 MiB"));
  EXPECT_THAT(taken.error().message, HasSubstr("left of --max-memory"));
}

/// The square with `count` images, a texture and a material of each, all of one picture.
Gltf with_pictures(size_t count, const std::string& png) {
  Gltf gltf = square_gltf();
  const int view = gltf.view(png);
  for (size_t i = 0; i < count; ++i) {
    gltf.json["images"].push_back({{"bufferView", view}, {"mimeType", "image/png"}});
    gltf.json["textures"].push_back({{"source", i}});
    gltf.json["materials"].push_back(
        {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", i}}}}}});
  }
  gltf.json["meshes"][0]["primitives"][0]["material"] = 0;
  return gltf;
}

// 200 images of 2048 x 2048 pixels would be 3.2 GB; each with the one picture's bytes.
TEST(ReadingMemory, ImagesThatShareTheirBytesAreOneTexture) {
  const std::string glb = with_pictures(200, png_of(2048, 2048, {10, 20, 30, 255})).glb();
  const TemporaryFolder folder;
  const scene::Scene scene =
      scene_of(import_scene(folder.write("a.glb", glb), {}, resident_bytes() + 100 * kMiB));
  ASSERT_EQ(scene.textures.size(), 1u);
  EXPECT_EQ(scene.textures[0].width, 2048);
  EXPECT_EQ(scene.materials[199].base_color_texture.texture, 0u);
}

TEST(ReadingMemory, APictureTooLargeForItIsRefusedBeforeItIsDecoded) {
  const std::string glb = with_pictures(1, png_of(4096, 4096, {10, 20, 30, 255})).glb();
  const TemporaryFolder folder;
  const uint64_t before = resident_bytes();
  const auto imported = import_scene(folder.write("a.glb", glb), {}, before + 32 * kMiB);
  ASSERT_FALSE(imported);
  EXPECT_EQ(imported.error().code, ErrorCode::out_of_memory);
  EXPECT_THAT(imported.error().message, HasSubstr("a picture of 4096 x 4096 pixels"));
  EXPECT_LT(resident_bytes(), before + 32 * kMiB);
}

/// A file that becomes far more than 100 MiB.
struct GrowingFile {
  std::string name;
  std::function<std::string()> content;

  friend void PrintTo(const GrowingFile& f, std::ostream* out) { *out << f.name; }
};

/// The square, drawn 20 million times: 3 GB.
std::string glb_of_copies() {
  Gltf gltf = square_gltf();
  const int zeros = gltf.accessor({{"componentType", 5126}, {"count", 20000000}, {"type", "VEC3"}});
  gltf.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"] =
      zeros;
  return gltf.glb();
}

/// Vertices of which the file says only how many: zeros.
std::string glb_of_zeros() {
  Gltf gltf = square_gltf();
  const int zeros = gltf.accessor({{"componentType", 5126},
                                   {"count", 30000000},
                                   {"type", "VEC3"},
                                   {"min", {0, 0, 0}},
                                   {"max", {0, 0, 0}}});
  gltf.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = zeros;
  return gltf.glb();
}

/// Three bytes for each material, which takes some kilobytes in tinygltf.
std::string glb_of_materials() {
  Gltf gltf = square_gltf();
  gltf.json["materials"] = nlohmann::json::array();
  for (int i = 0; i < 200000; ++i) gltf.json["materials"].push_back(nlohmann::json::object());
  return gltf.glb();
}

/// A node that holds two of the next, and so on: 2^18 squares.
std::string dae_of_doubled_nodes() {
  std::string nodes;
  for (int i = 0; i < 18; ++i) {
    const std::string next = "<instance_node url=\"#n" + std::to_string(i + 1) + "\"/>";
    nodes += "<node id=\"n" + std::to_string(i) + "\">" + next + next + "</node>";
  }
  return "<?xml version=\"1.0\"?><COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" "
         "version=\"1.4.1\"><asset><unit meter=\"1\"/><up_axis>Y_UP</up_axis></asset>"
         "<library_geometries><geometry id=\"g\"><mesh><source id=\"p\"><float_array id=\"a\" "
         "count=\"9\">0 0 0 1 0 0 0 1 0</float_array><technique_common><accessor source=\"#a\" "
         "count=\"3\" stride=\"3\"><param name=\"X\" type=\"float\"/><param name=\"Y\" "
         "type=\"float\"/><param name=\"Z\" type=\"float\"/></accessor></technique_common></source>"
         "<vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices>"
         "<triangles count=\"1\"><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/>"
         "<p>0 1 2</p></triangles></mesh></geometry></library_geometries><library_nodes>" +
         nodes +
         "<node id=\"n18\"><instance_geometry url=\"#g\"/></node></library_nodes>"
         "<library_visual_scenes><visual_scene id=\"s\"><node><instance_node url=\"#n0\"/></node>"
         "</visual_scene></library_visual_scenes><scene><instance_visual_scene url=\"#s\"/></scene>"
         "</COLLADA>";
}

/// A line again and again, after a first part.
std::string repeated(std::string text, const std::string& line, int count) {
  for (int i = 0; i < count; ++i) text += line;
  return text;
}

std::string obj_of_fans() {
  return repeated("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n", "f 1 2 3 4\n", 2000000);
}
std::string ply_of_triangles() {
  return repeated(
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nelement face 2000000\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0\n1 0 0\n0 1 0\n",
      "3 0 1 2\n", 2000000);
}
std::string stl_of_triangles() {
  return repeated("solid a\n",
                  "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
                  "endloop\nendfacet\n",
                  400000) +
         "endsolid a\n";
}

/// A value of /proc/self/status, in bytes.
uint64_t status_of_process(const std::string& key) {
  std::ifstream status("/proc/self/status");
  uint64_t kilobytes = 0;
  for (std::string word; status >> word;)
    if (word == key) status >> kilobytes;
  return kilobytes * 1024;
}

class GrowingFiles : public ::testing::TestWithParam<GrowingFile> {};

// Nothing is asked of a file but a sentence: the process never has more than it may.
TEST_P(GrowingFiles, StayWithinTheCap) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.write(GetParam().name, GetParam().content());
  return_free_memory();
  std::ofstream("/proc/self/clear_refs") << "5";  // the peak is that from now on
  const uint64_t cap = resident_bytes() + 100 * kMiB;
  // Memory that earlier tests in this process have freed is taken first.
  const uint64_t freed = status_of_process("VmData:") - resident_bytes();
  const auto imported = import_scene(file, {}, cap);
  EXPECT_FALSE(imported);
  if (!imported) {
    EXPECT_EQ(imported.error().code, ErrorCode::out_of_memory);
    EXPECT_THAT(imported.error().message, HasSubstr("--max-memory"));
  }
  // Pages of the program itself count for nothing.
  const uint64_t peak = status_of_process("VmHWM:") - status_of_process("RssFile:");
  EXPECT_LT(double(peak), 1.1 * double(cap + freed));
}

INSTANTIATE_TEST_SUITE_P(Import, GrowingFiles,
                         ::testing::Values(GrowingFile{"copies.glb", glb_of_copies},
                                           GrowingFile{"zeros.glb", glb_of_zeros},
                                           GrowingFile{"materials.glb", glb_of_materials},
                                           GrowingFile{"doubled.dae", dae_of_doubled_nodes},
                                           GrowingFile{"fans.obj", obj_of_fans},
                                           GrowingFile{"triangles.ply", ply_of_triangles},
                                           GrowingFile{"triangles.stl", stl_of_triangles}),
                         [](const auto& test) {
                           std::string name = test.param.name;
                           std::ranges::replace(name, '.', '_');
                           return name;
                         });

}  // namespace
}  // namespace luxel::import
