// Small files that ask for much: refused before it is used, and pictures are decoded once.
#include "luxel/import/reading_memory.h"

#include <gmock/gmock.h>

#include "luxel/base/process_memory.h"
#include "luxel/import/test_files.h"

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

}  // namespace
}  // namespace luxel::import
