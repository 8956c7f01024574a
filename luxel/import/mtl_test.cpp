// Material libraries: what they say, and what is wrong in them.
#include "luxel/import/mtl.h"

#include <gmock/gmock.h>

#include "luxel/import/import_test_support.h"

namespace luxel::import {
namespace {

using ::testing::IsEmpty;

MtlLibrary library_of(std::string_view text, std::vector<std::string>& warnings) {
  MtlLibrary out;
  add_library(text, "m.mtl", out, warnings);
  return out;
}

TEST(Mtl, SaysWhatItsLinesSay) {
  std::vector<std::string> warnings;
  const MtlLibrary library = library_of(
      "# made by hand\nnewmtl a b\nKd 0.5 0.6 0.7\n\tks .1 0 0\r\nNs 42\nillum 2\nd 0.4\nKe 1\n"
      "Ka 1 1 1\nNi 1.5\nbump b.png\nmap_Kd -s 2 3 1 -clamp on -o 0.5 my brick.png\n"
      "map_emissive -bm 2 \"glow.png\"\nnewmtl c\nTr 0.25\nPm \\\n0.5\n",
      warnings);
  EXPECT_THAT(warnings, IsEmpty());
  ASSERT_EQ(library.size(), 2u);
  const MtlMaterial& a = library.at("a b");
  EXPECT_EQ(a.color, (Rgb{0.5f, 0.6f, 0.7f}));
  EXPECT_EQ(a.specular, (Rgb{0.1f, 0, 0}));
  EXPECT_EQ(a.sharpness, 42);
  EXPECT_EQ(a.alpha, 0.4f);
  EXPECT_EQ(a.emission, (Rgb{1, 1, 1}));
  EXPECT_EQ(a.color_picture.name, "my brick.png");
  EXPECT_TRUE(a.color_picture.clamp);
  EXPECT_EQ(a.color_picture.scale.y, 3);
  EXPECT_EQ(a.color_picture.offset.x, 0.5f);
  EXPECT_EQ(a.emission_picture.name, "glow.png");
  const MtlMaterial& c = library.at("c");
  EXPECT_FALSE(c.color);
  EXPECT_EQ(c.alpha, 0.75f);
  EXPECT_EQ(c.metallic, 0.5f);
}

TEST(Mtl, LeavesOutWhatIsWrongAndSaysWhere) {
  std::vector<std::string> warnings;
  const MtlLibrary library = library_of(
      "\nmap_Kd brick.png\nKd 1 1 1\nnewmtl a\nKd x 1 1\nKd nan 0 0\nd\nNs 1e999\nKe 1 2\n"
      "map_Kd\nKs 0.1 0.1 0.1\n",
      warnings);
  EXPECT_FALSE(library.at("a").color);
  EXPECT_EQ(library.at("a").specular, (Rgb{0.1f, 0.1f, 0.1f}));
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0],
            "m.mtl: 8 lines are left out, the first in line 2: they have no material above or no "
            "usable value");
}

constexpr const char* kTriangle = "v 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nusemtl a\nf 1/1 2/1 3/1\n";

TEST(Mtl, NoLibraryEndsTheScene) {
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

TEST(Mtl, OneLineMayNameSeveralLibraries) {
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

// 20,000 lines that name files which are not there would be 3.5 MB of warnings.
TEST(Mtl, OfManyMissingLibrariesSomeAreNamed) {
  const TemporaryFolder folder;
  std::string text;
  for (int i = 0; i < 20000; ++i) text += "mtllib m" + std::to_string(i) + ".mtl\n";
  const auto imported = import_scene(folder.write("a.obj", text + kTriangle));
  ASSERT_TRUE(imported) << imported.error().message;
  ASSERT_EQ(imported->warnings.size(), 101u);
  EXPECT_THAT(imported->warnings.back(), testing::HasSubstr("more warnings are left out"));
}

}  // namespace
}  // namespace luxel::import
