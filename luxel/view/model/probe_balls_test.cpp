// Probes come back from the files that a bake writes.
#include "luxel/view/model/probe_balls.h"

#include <gmock/gmock.h>

#include <fstream>

#include "luxel/base/file.h"
#include "luxel/pipeline/bake/light_directions.h"

namespace luxel::view {
namespace {

using ::testing::HasSubstr;

std::filesystem::path folder_with_probes(size_t count, DVec3 origin = {}) {
  pipeline::ProbeGrid grid;
  grid.spacing_m = 0.25f;
  for (size_t i = 0; i < count; ++i) {
    light::Probe probe{.position = {float(i), 2, -0.1f}};
    for (size_t k = 0; k < kSh2; ++k) probe.irradiance[k] = {float(k) / 3, float(i), -1};
    grid.probes.push_back(probe), grid.row.push_back(int32_t(i));
  }
  const std::filesystem::path folder =
      std::filesystem::path(::testing::TempDir()) / ("probes" + std::to_string(count));
  std::filesystem::create_directories(folder);
  const auto files = pipeline::probe_files(grid, origin, folder);
  EXPECT_TRUE(files);
  for (const OutputFile& file : *files) EXPECT_TRUE(write_file_atomically(file.path, file.bytes));
  return folder;
}

TEST(ProbeBalls, ComeBackFromFiles) {
  EXPECT_TRUE(read_probes(folder_with_probes(0), {})->probes.empty());
  const auto read = read_probes(folder_with_probes(3), {});
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->spacing_m, 0.25f);
  ASSERT_EQ(read->probes.size(), 3u);
  EXPECT_EQ(read->probes[2].position, (Vec3{2, 2, -0.1f}));
  EXPECT_EQ(read->probes[2].irradiance[8], (Rgb{8.0f / 3, 2, -1}));
}

// In the file they stand in the world, 5,000 km away; whoever shows them has a scene near 0.
TEST(ProbeBalls, StandInTheSceneThatTheyAreOf) {
  const DVec3 origin{512344, 88, -5403208};
  const auto read = read_probes(folder_with_probes(3, origin), origin);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->probes[2].position, (Vec3{2, 2, -0.1f}));
  const auto unmoved = read_probes(folder_with_probes(3, origin), {});
  EXPECT_EQ(unmoved->probes[2].position, (Vec3{512346, 90, -5403208}));
}

TEST(ProbeBalls, SayWhatIsWrong) {
  const auto error = [](const std::filesystem::path& folder) {
    const auto read = read_probes(folder, {});
    return read ? "no error" : read.error().message;
  };
  EXPECT_THAT(error(std::filesystem::path(::testing::TempDir()) / "without_probes"),
              HasSubstr("`luxel bake` with --probes 0.5"));
  const std::filesystem::path folder = folder_with_probes(2);
  std::filesystem::copy_file(folder_with_probes(3) / "probes.json", folder / "probes.json",
                             std::filesystem::copy_options::overwrite_existing);
  EXPECT_THAT(error(folder), HasSubstr("9 x 2 pixels, and probes.json 3 probes"));
  std::ofstream(folder / "probes.json") << R"({"spacing": -1, "position": []})";
  EXPECT_THAT(error(folder), HasSubstr("its spacing, -1, is not above 0"));
  std::ofstream(folder / "probes.json") << "{";
  EXPECT_THAT(error(folder), HasSubstr("probes.json: "));
}

}  // namespace
}  // namespace luxel::view
