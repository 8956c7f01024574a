// luxel bake --device: the real program on the software device of this machine. Skipped where there
// is none.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "luxel/base/file.h"
#include "luxel/export/baked_glb.h"
#include "luxel/gpu/device.h"
#include "luxel/scene/procedural.h"
#include "tests/command.h"

namespace luxel::testing_support {
namespace {

using ::testing::HasSubstr;

const std::string kBoxToBake = scene_file("cornell-box.glb");

/// The name of the software device.
std::string software_device() {
  const auto devices = gpu::list_devices();
  if (!devices) return {};
  for (const gpu::DeviceInfo& d : *devices)
    if (d.type == VK_PHYSICAL_DEVICE_TYPE_CPU && d.lacks.empty()) return d.name;
  return {};
}

class BakeOnDevice : public ::testing::Test {
 protected:
  void SetUp() override {
    const std::string name = software_device();
    if (name.empty()) GTEST_SKIP() << "no software device";
    // "llvmpipe (LLVM 15.0.6, 256 bits)"
    name_ = name, option_ = "--device gpu:" + name.substr(0, name.find(' '));
  }
  CommandResult bake(const std::string& folder, const std::string& options) const {
    return luxel("bake " + kBoxToBake + " --resolution 64 --samples 64 --no-denoise -o " +
                 (scratch_.path / folder).string() + " " + options);
  }
  nlohmann::json report(const std::string& folder) const {
    return nlohmann::json::parse(slurp(scratch_.path / folder / "bake.json"));
  }

  ScratchFolder scratch_;
  std::string name_, option_;
};

// Rays that graze an edge differ, and no others: 0.2 % of the mean, root mean square.
TEST_F(BakeOnDevice, IsThatOfTheProcessor) {
  ASSERT_EQ(bake("cpu", "--quiet").code, 0);
  const CommandResult r = bake("gpu", option_);
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_THAT(r.err, HasSubstr("with " + name_));
  EXPECT_EQ(report("cpu")["device"], "cpu");
  EXPECT_EQ(report("gpu")["device"], name_);
  EXPECT_EQ(report("gpu")["counts"]["texels"], report("cpu")["counts"]["texels"]);
  const CommandResult c =
      luxel("compare " + (scratch_.path / "cpu").string() + " " + (scratch_.path / "gpu").string() +
            " --max-rmse-over-mean 0.002 --json");
  EXPECT_EQ(c.code, 0) << c.out << c.err;
}

// Hemicubes are the device's, what they are summed up to is the processor's.
TEST_F(BakeOnDevice, ByHemicubesIsThatOfTheProcessor) {
  const std::string small =
      "--solver hemicube --hemicube 16 --max-elements 600 --resolution 64 --quiet -o ";
  const std::string cpu = (scratch_.path / "cpu").string(), gpu = (scratch_.path / "gpu").string();
  ASSERT_EQ(luxel("bake " + kBoxToBake + " " + small + cpu).code, 0);
  const CommandResult r = luxel("bake " + kBoxToBake + " " + small + gpu + " " + option_);
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_EQ(report("gpu")["device"], name_);
  const CommandResult c =
      luxel("compare " + (scratch_.path / "cpu").string() + " " + (scratch_.path / "gpu").string() +
            " --max-rmse-over-mean 0.002 --json");
  EXPECT_EQ(c.code, 0) << c.out << c.err;
}

// Paths with the same random numbers; a few differ from where rounding has them meet another
// surface.
TEST_F(BakeOnDevice, ByPathsIsThatOfTheProcessor) {
  const std::string few =
      "--solver reference --resolution 16 --samples 16 --no-denoise --quiet -o ";
  const std::string cpu = (scratch_.path / "cpu").string(), gpu = (scratch_.path / "gpu").string();
  ASSERT_EQ(luxel("bake " + kBoxToBake + " " + few + cpu).code, 0);
  const CommandResult r = luxel("bake " + kBoxToBake + " " + few + gpu + " " + option_);
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_EQ(report("gpu")["device"], name_);
  const CommandResult c = luxel("compare " + cpu + " " + gpu + " --max-rmse-over-mean 0.02 --json");
  EXPECT_EQ(c.code, 0) << c.out << c.err;
}

TEST_F(BakeOnDevice, PicturesAreThoseOfTheProcessor) {
  const std::string draw = "render " + kBoxToBake + " --technique path --size 24x18 --samples 4 ";
  const std::string cpu = (scratch_.path / "cpu.exr").string(),
                    gpu = (scratch_.path / "gpu.exr").string();
  ASSERT_EQ(luxel(draw + "--quiet -o " + cpu).code, 0);
  const CommandResult r = luxel(draw + "--json -o " + gpu + " " + option_);
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_EQ(nlohmann::json::parse(r.out)["device"], name_);
  const CommandResult c = luxel("compare " + cpu + " " + gpu + " --max-rmse-over-mean 0.05 --json");
  EXPECT_EQ(c.code, 0) << c.out << c.err;
  const CommandResult other =
      luxel("render " + kBoxToBake + " --technique normals -o " + gpu + " " + option_);
  EXPECT_EQ(other.code, 1) << other.err;
  EXPECT_THAT(other.err,
              HasSubstr("--device is for --technique path and radiosity, not for normals"));
}

TEST_F(BakeOnDevice, GivesTheSameBitsEachTime) {
  ASSERT_EQ(bake("once", option_ + " --quiet").code, 0);
  ASSERT_EQ(bake("again", option_ + " --quiet --threads 1").code, 0);
  EXPECT_EQ(slurp(scratch_.path / "once/lightmap.exr"),
            slurp(scratch_.path / "again/lightmap.exr"));
}

TEST_F(BakeOnDevice, LeavesNoCheckpointAndBuildsOnNone) {
  ASSERT_EQ(bake("gpu", option_ + " --quiet --checkpoint 0.001").code, 0);
  EXPECT_EQ(files_in(scratch_.path / "gpu"), kBakeFiles);
  for (const std::string option : {"--keep", "--resume", "--layers per-light", "--light direct"}) {
    const CommandResult r = bake("refused", option_ + " " + option);
    EXPECT_EQ(r.code, 1) << r.err;
    EXPECT_THAT(r.err, HasSubstr(option + " runs on the processor only")) << option;
    EXPECT_FALSE(std::filesystem::exists(scratch_.path / "refused"));
  }
}

TEST_F(BakeOnDevice, RefusesColouredGlass) {
  scene::Scene scene = scene::cornell_box();
  scene.materials[0].transmission = 1, scene.materials[0].base_color = {0.5f, 1, 1};
  const std::filesystem::path file = scratch_.path / "glass.glb";
  ASSERT_TRUE(write_file_atomically(file, *export_::scene_glb(scene)));
  const CommandResult r = luxel("bake " + file.string() + " --resolution 32 --samples 16 -o " +
                                (scratch_.path / "glass").string() + " " + option_);
  EXPECT_EQ(r.code, 1) << r.err;
  EXPECT_THAT(r.err, HasSubstr("coloured glass"));
  EXPECT_FALSE(std::filesystem::exists(scratch_.path / "glass"));
}

TEST(DeviceOption, WithoutADeviceIsASentence) {
  const ScratchFolder scratch;
  const std::string to_nowhere = "bake " + kBoxToBake + " -o " + (scratch.path / "out").string();
  // No driver is found there.
  const std::string no_driver = "env VK_DRIVER_FILES=/nowhere VK_ICD_FILENAMES=/nowhere";
  const CommandResult none = luxel(to_nowhere + " --device gpu", no_driver);
  EXPECT_EQ(none.code, 1) << none.err;
  const CommandResult wrong = luxel(to_nowhere + " --device cuda");
  EXPECT_EQ(wrong.code, 1) << wrong.err;
  EXPECT_THAT(wrong.err, HasSubstr("--device cuda is not known; give cpu, gpu, auto, or gpu:"));
  EXPECT_FALSE(std::filesystem::exists(scratch.path / "out"));
  const CommandResult any =
      luxel(to_nowhere + " --resolution 16 --samples 16 --quiet --device auto", no_driver);
  EXPECT_EQ(any.code, 0) << any.err;
  EXPECT_EQ(nlohmann::json::parse(slurp(scratch.path / "out/bake.json"))["device"], "cpu");
}

}  // namespace
}  // namespace luxel::testing_support
