// What Assimp gets of a material library, and libraries that ended the process or the scene.
#include "luxel/import/mtl_text.h"

#include <gmock/gmock.h>

#include "luxel/import/test_files.h"

namespace luxel::import {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::string text_for_assimp(std::string_view library, std::vector<std::string>* said = nullptr) {
  MtlText out;
  std::vector<std::string> warnings;
  add_library(library, "m.mtl", out, warnings);
  if (said != nullptr) *said = warnings;
  return out.text;
}

TEST(MtlText, KeepsWhatIsUsed) {
  EXPECT_EQ(text_for_assimp("# made by hand\nnewmtl a b\nKd 0.5 0.6 0.7\n\tks .1 0 0\r\nNs 42\n"
                            "illum 2\nd 0.4\nKe 1\nKa 1 1 1\nNi 1.5\nbump b.png\n"
                            "map_Kd -s 1 1 1 -clamp on -o 0.5 my brick.png\n"
                            "map_emissive -bm 2 glow.png\n"),
            "newmtl a b\nKd 0.5 0.6 0.7\nKs 0.1 0 0\nNs 42\nillum 2\nd 0.4\nKe 1 1 1\n"
            "map_Kd -clamp on my brick.png\nmap_Ke glow.png\n");
  MtlText out;
  std::vector<std::string> warnings;
  add_library("newmtl a\nKd 1 1 1\nnewmtl b\nKs 1 1 1\n", "m.mtl", out, warnings);
  EXPECT_THAT(out.with_color, ElementsAre("a"));
  EXPECT_THAT(warnings, IsEmpty());
}

TEST(MtlText, LeavesOutWhatIsWrongAndSaysWhere) {
  std::vector<std::string> said;
  EXPECT_EQ(text_for_assimp("\nmap_Kd brick.png\nKd 1 1 1\nnewmtl a\nKd x 1 1\nKd nan 0 0\nd\n"
                            "Ns 1e999\nKe 1 2\nillum -7\nmap_Kd\nKs 0.1 0.1 0.1\n",
                            &said),
            "newmtl a\nKs 0.1 0.1 0.1\n");
  ASSERT_EQ(said.size(), 1u);
  EXPECT_EQ(said[0],
            "m.mtl: 9 lines are left out, the first in line 2: they have no material above or no "
            "usable value");
}

constexpr const char* kTriangle = "v 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nusemtl a\nf 1/1 2/1 3/1\n";

// The first ended the process in Assimp, the others the scene.
TEST(MtlText, NoLibraryEndsTheScene) {
  const TemporaryFolder folder;
  const auto scene = folder.write("a.obj", std::string("mtllib m.mtl\n") + kTriangle);
  for (const std::string& text :
       {std::string("map_Kd a.png\nnewmtl a\n"), std::string(), std::string("n"), std::string("K"),
        std::string("newmtl"), std::string("newmtl a\nd -halo"), std::string("newmtl a\nNs\n"),
        std::string("newmtl a\nKd"), std::string("newmtl a\nmap_Kd -bm"),
        std::string("newmtl \0a\nKd 1 1 1\n", 20), std::string(100'000, 'K'),
        "newmtl a\nKd 1 1 1\nmap_Ks " + std::string(100'000, 'x'),
        "newmtl " + std::string(100'000, 'a')}) {
    folder.write("m.mtl", text);
    const auto imported = import_scene(scene);
    EXPECT_TRUE(imported) << text.substr(0, 40) << ": " << imported.error().message;
  }
}

TEST(MtlText, OneLineMayNameSeveralLibraries) {
  const TemporaryFolder folder;
  folder.write("a.mtl", "newmtl a\nKd 0.25 0.25 0.25\n");
  folder.write("b.mtl", "newmtl b\nKd 0.5 0.5 0.5\n");
  folder.write("a b.mtl", "newmtl a\nKd 0.125 0.125 0.125\n");
  const auto color = [&](const std::string& libraries) {
    const auto imported =
        import_scene(folder.write("a.obj", "mtllib " + libraries + "\n" + kTriangle));
    for (const scene::Material& material : scene_of(imported).materials)
      if (material.name == "a") return material.base_color.x;
    return -1.0f;
  };
  EXPECT_EQ(color("b.mtl a.mtl"), 0.25f);
  EXPECT_EQ(color("a b.mtl"), 0.125f) << "a name with a blank comes first";
}

}  // namespace
}  // namespace luxel::import
