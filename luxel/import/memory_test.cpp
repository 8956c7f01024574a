// A binary glTF file that lies in memory, as in an .lxr file.
#include <gmock/gmock.h>

#include "luxel/import/import_test_support.h"

namespace luxel::import {
namespace {

using ::testing::HasSubstr;

std::vector<std::byte> in_memory(const std::string& text) {
  const auto* first = reinterpret_cast<const std::byte*>(text.data());
  return {first, first + text.size()};
}

TEST(ImportGlb, IsWhatTheFileWouldBe) {
  const std::string glb = square_gltf().glb();
  const scene::Scene of_file = scene_of(import_text("a.glb", glb));
  const scene::Scene of_memory = scene_of(import_glb(in_memory(glb), "box.lxr"));
  ASSERT_EQ(of_memory.meshes.size(), 1u);
  EXPECT_EQ(of_memory.meshes[0].positions.size(), 4u);
  EXPECT_EQ(of_memory.meshes[0].positions, of_file.meshes[0].positions);
  EXPECT_EQ(of_memory.meshes[0].triangles, of_file.meshes[0].triangles);
  EXPECT_EQ(of_memory.instances.size(), of_file.instances.size());
  EXPECT_EQ(of_memory.materials[0].base_color, of_file.materials[0].base_color);
}

TEST(ImportGlb, ErrorsNameWhatItIsCalled) {
  const std::string glb = square_gltf().glb();
  for (const std::string& text : {std::string(), std::string("glTF"), glb.substr(0, 40),
                                  glb.substr(0, glb.size() - 8), std::string("{\"asset\": 1}")}) {
    const auto imported = import_glb(in_memory(text), "folder/box.lxr");
    ASSERT_FALSE(imported) << text.size();
    EXPECT_EQ(imported.error().code, ErrorCode::bad_input);
    EXPECT_THAT(imported.error().message, HasSubstr("box.lxr")) << text.size();
  }
}

}  // namespace
}  // namespace luxel::import
