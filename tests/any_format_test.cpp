// Files that only Assimp reads: refused, or read in a process whose end is a sentence.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "luxel/import/other_process.h"
#include "luxel/scene/digest.h"
#include "tests/command.h"

namespace luxel::testing_support {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr const char* kRectangle = "OFF\n4 2 0\n0 0 0\n2 0 0\n2 0 1\n0 0 1\n3 0 1 2\n3 0 2 3\n";

TEST(AnyFormat, IsReadWhereItIsAskedFor) {
  const ScratchFolder s;
  const std::string file = s.write("-a b.off", kRectangle).string();
  const CommandResult refused = luxel("info '" + file + "'");
  EXPECT_EQ(refused.code, 1);
  EXPECT_THAT(refused.err, AllOf(HasSubstr(".off files (OFF)"), HasSubstr("--any-format")));
  const auto area = [&](const std::string& options) {
    const CommandResult r =
        shell("cd " + s.path.string() + " && " LUXEL_BINARY " info --any-format --json " + options +
              " -- '-a b.off'");
    EXPECT_EQ(r.code, 0) << r.err;
    return nlohmann::json::parse(r.out);
  };
  EXPECT_NEAR(area("")["area_m2"], 2, 1e-6);
  const nlohmann::json in_cm = area("--unit cm --up z --smooth-normals 30 --trust-paths");
  EXPECT_NEAR(in_cm["area_m2"], 2e-4, 1e-10);
  EXPECT_NEAR(in_cm["bounds"][1][1], 0.01, 1e-8) << "z of the file is up";
}

/// A square with a picture.
constexpr const char* kTextured = R"(AC3Db
MATERIAL "red" rgb 0.8 0.1 0.1 amb 0 0 0 emis 0 0 0 spec 0 0 0 shi 1 trans 0
OBJECT world
kids 1
OBJECT poly
name "floor"
texture "PICTURE"
numvert 4
0 0 0
1 0 0
1 0 -1
0 0 -1
numsurf 1
SURF 0x10
mat 0
refs 4
0 0 0
1 1 0
2 1 1
3 0 1
kids 0
)";

// Files that a scene names are opened as anywhere else, and warnings arrive.
TEST(AnyFormat, PicturesAndWarningsComeAlong) {
  const ScratchFolder s;
  std::filesystem::create_directory(s.path / "in");
  for (const char* place : {"in/near.png", "far.png"})
    std::filesystem::copy(
        std::filesystem::path(LUXEL_SOURCE_DIR) / "tests/fuzz/corpus/png/small.png",
        s.path / place);
  const auto info = [&](const std::string& picture) {
    std::string text = kTextured;
    text.replace(text.find("PICTURE"), 7, picture);
    const CommandResult r = luxel("info --any-format --json " + s.write("in/a.ac", text).string());
    EXPECT_EQ(r.code, 0) << r.err;
    return nlohmann::json::parse(r.out);
  };
  EXPECT_EQ(info("near.png")["textures"], 1);
  const nlohmann::json far = info("../far.png");
  EXPECT_EQ(far["textures"], 0);
  EXPECT_THAT(far["warnings"].dump(), HasSubstr("outside of the scene's folder"));
}

// A face of vertices that the file does not have. StackOverflow.IsASentence ends another one.
TEST(AnyFormat, AReaderThatEndsItsProcessIsASentence) {
  const ScratchFolder s;
  const auto file =
      s.write("a.ase",
              "*3DSMAX_ASCIIEXPORT 200\n*MATERIAL_LIST {\n*MATERIAL_COUNT 1\n*MATERIAL 0 {\n}\n}\n"
              "*GEOMOBJECT {\n*MESH {\n*MESH_NUMFACES 1\n*MESH_FACE_LIST {\n"
              "*MESH_FACE 0: A: 0 B: 1 C: 2 AB: 1 BC: 1 CA: 1 *MESH_SMOOTHING 0 *MESH_MTLID 0\n"
              "}\n}\n*MATERIAL_REF 0\n}\n");
  const CommandResult r = luxel("info --any-format --json " + file.string());
  EXPECT_EQ(r.code, 1) << r.err;
  EXPECT_THAT(r.err, AllOf(HasSubstr("a.ase: the process that read it"),
                           HasSubstr("convert it to glTF (.glb)")));
  EXPECT_EQ(nlohmann::json::parse(r.out)["error"]["code"], "bad_input");
}

// `tess` says how finely the sphere is divided: each step has four times the triangles.
TEST(AnyFormat, AReaderThatTakesTooLongIsASentence) {
  const ScratchFolder s;
  const auto file = s.write("a.nff",
                            "v\nfrom 0 0 5\nat 0 0 0\nup 0 1 0\nangle 45\nhither 1\n"
                            "resolution 1 1\ntess 12\nf 1 1 1 1 0 0 0 0\ns 0 0 0 1\n");
  const auto imported = import::import_in_other_process(file, {}, {1, 0});
  ASSERT_FALSE(imported);
  EXPECT_EQ(imported.error().code, ErrorCode::bad_input);
  EXPECT_THAT(imported.error().message,
              AllOf(HasSubstr("a.nff"), HasSubstr("reading it took longer than 1 s")));
}

// Four hundred million vertices by the file's first line take 5 GB.
TEST(AnyFormat, AReaderThatTakesTooMuchMemoryIsASentence) {
  const ScratchFolder s;
  const auto file = s.write("a.off", "OFF\n400000000 1 0\n0 0 0\n");
  const CommandResult r = luxel("bake --any-format --max-memory 300M " + file.string() + " -o " +
                                (s.path / "out").string());
  EXPECT_EQ(r.code, 3) << r.err;
  EXPECT_THAT(r.err, AllOf(HasSubstr("a.off"), HasSubstr("left of --max-memory")));
  EXPECT_FALSE(std::filesystem::exists(s.path / "out"));
}

// The other process hands over the scene as this one would read it.
TEST(AnyFormat, NothingIsLostBetweenTheProcesses) {
  const ScratchFolder s;
  std::filesystem::copy(std::filesystem::path(LUXEL_SOURCE_DIR) / "tests/fuzz/corpus/png/small.png",
                        s.path / "PICTURE");
  for (const auto& file : {s.write("a.off", kRectangle), s.write("a.ac", kTextured)}) {
    const import::ImportParams params{.smooth_normals_deg = 60, .up = import::Up::z};
    const auto here = import::import_in_this_process(file, params, 0);
    auto there = import::import_in_other_process(file, params, {20, 0});
    ASSERT_TRUE(here && there);
    for (size_t m = 0; m < here->scene.materials.size(); ++m) {  // glTF has no such highlights
      there->scene.materials.at(m).specular = here->scene.materials[m].specular;
      there->scene.materials.at(m).sharpness = here->scene.materials[m].sharpness;
    }
    EXPECT_EQ(here->scene.name, there->scene.name);
    EXPECT_EQ(scene::difference(scene::digests_of(here->scene), scene::digests_of(there->scene)),
              "");
    EXPECT_TRUE(there->node_of_instance.empty()) << "nobody sees the nodes of that file";
  }
}

}  // namespace
}  // namespace luxel::testing_support
