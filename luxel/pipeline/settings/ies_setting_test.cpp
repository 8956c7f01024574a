#include "luxel/pipeline/settings/ies_setting.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "luxel/base/file.h"

namespace luxel::pipeline {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr const char* kFile =
    "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 3 1 1 2 0 0 0\n1 1 60\n0 45 90\n0\n100 70 0\n";

/// kFile in a folder of this test's own, removed with the object.
struct FileOnDisk {
  std::filesystem::path folder, path;
  FileOnDisk() {
    std::string name = (std::filesystem::temp_directory_path() / "luxel-ies-XXXXXX").string();
    folder = ::mkdtemp(name.data()), path = folder / "a.ies";
    EXPECT_TRUE(write_file_atomically(path, text_file(path, kFile).bytes));
  }
  FileOnDisk(const FileOnDisk&) = delete;
  FileOnDisk& operator=(const FileOnDisk&) = delete;
  ~FileOnDisk() {
    std::error_code ignored;
    std::filesystem::remove_all(folder, ignored);
  }
};

TEST(IesSetting, NameFileAndScale) {
  const auto plain = parse_ies_setting("desk lamp=a/b.ies");
  ASSERT_TRUE(plain);
  EXPECT_EQ(plain->light, "desk lamp");
  EXPECT_EQ(plain->file, "a/b.ies");
  EXPECT_EQ(plain->scale, 1);
  EXPECT_EQ(parse_ies_setting("x=a=b,c.ies")->file, "a=b,c.ies");
  EXPECT_EQ(parse_ies_setting("x=a,b.ies,0.5")->file, "a,b.ies");
  EXPECT_EQ(parse_ies_setting("x=a,b.ies,0.5")->scale, 0.5f);
  for (const char* text : {"", "x", "=a.ies", "x=", "x=,2", "x=a.ies,-1", "x=a.ies,1e10"}) {
    const auto setting = parse_ies_setting(text);
    ASSERT_FALSE(setting) << text;
    EXPECT_THAT(setting.error().message, HasSubstr("--ies '" + std::string(text) + "'"));
  }
}

TEST(IesSetting, GoesToAllLampsOfTheName) {
  const FileOnDisk disk;
  const auto file = disk.path;
  scene::Scene scene;
  scene.lights.resize(4);
  scene.lights[0].name = scene.lights[2].name = scene.lights[3].name = "spot";
  scene.lights[1].name = "other";
  scene.lights[3].kind = scene::PunctualLight::Kind::directional;
  const auto added = add_profiles(std::array{IesSetting{"spot", file, 2}}, scene);
  ASSERT_TRUE(added) << added.error().message;
  EXPECT_TRUE(added->empty());
  ASSERT_EQ(scene.profiles.size(), 2u);
  EXPECT_EQ(scene.lights[0].profile, 0u);
  EXPECT_EQ(scene.lights[1].profile, scene::kNone);
  EXPECT_EQ(scene.lights[2].profile, 1u);
  EXPECT_EQ(scene.lights[3].profile, scene::kNone) << "a sun has no distribution";
  EXPECT_EQ(scene.lights[0].intensity, (Rgb{2, 2, 2}));
}

TEST(IesSetting, UnknownNamesAreSaid) {
  const FileOnDisk disk;
  const auto file = disk.path;
  scene::Scene scene;
  const auto error = [&](std::vector<IesSetting> settings) {
    const auto added = add_profiles(settings, scene);
    return added ? "no error" : added.error().message;
  };
  EXPECT_THAT(error({{"x", file}}), AllOf(HasSubstr("--ies x="), HasSubstr("no such lights")));
  scene.lights.resize(2);
  scene.lights[0].name = "left", scene.lights[1].name = "right";
  EXPECT_THAT(error({{"x", file}}), HasSubstr("choose from: 'left', 'right'"));
  EXPECT_THAT(error({{"left", file}, {"left", file}}), HasSubstr("already has another file"));
  EXPECT_THAT(error({{"left", disk.folder / "b.ies"}}), HasSubstr("b.ies"));
}

}  // namespace
}  // namespace luxel::pipeline
