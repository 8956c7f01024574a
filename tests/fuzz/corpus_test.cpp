// The fuzzers' corpus through their targets, in any build: what was found once stays found. Each
// file is named by what it was found for.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "luxel/import/import.h"
#include "tests/fuzz/compressed_gltf.h"
#include "tests/fuzz/fbx_binary.h"
#include "tests/fuzz/targets.h"

namespace luxel::fuzz {
namespace {

std::string seed_bytes(const std::filesystem::path& file) {
  std::ifstream in(std::filesystem::path(LUXEL_SOURCE_DIR) / "tests/fuzz/corpus" / file,
                   std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

class Corpus : public ::testing::TestWithParam<Target> {};

TEST_P(Corpus, EndsNothing) {
  const std::filesystem::path folder =
      std::filesystem::path(LUXEL_SOURCE_DIR) / "tests/fuzz/corpus" / GetParam().name;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    files.push_back(entry.path());
  std::ranges::sort(files);
  ASSERT_FALSE(files.empty()) << "a target without seeds finds little";
  for (const std::filesystem::path& file : files) {
    SCOPED_TRACE(file.string());
    const std::string bytes = seed_bytes(file);
    GetParam().run(std::as_bytes(std::span(bytes)));
  }
}

size_t triangles_in(std::vector<std::byte> file, const std::string& name) {
  const auto imported = import::import_bytes(std::move(file), name);
  if (!imported) ADD_FAILURE() << imported.error().message;
  return imported ? scene::first_triangles(imported->scene).back() : 0;
}

/// Wrappers that targets put around their inputs are right: else decoders would never be reached.
TEST(Wrapped, SeedsAreRead) {
  EXPECT_EQ(triangles_in(binary_fbx(seed_bytes("fbx_binary/square.fbx")), "a.fbx"), 2u);
  for (const char* seed : {"edgebreaker-0", "edgebreaker-7", "sequential-0", "sequential-7"}) {
    const std::string bytes = seed_bytes(std::filesystem::path("draco") / seed);
    EXPECT_EQ(triangles_in(draco_glb(std::as_bytes(std::span(bytes))), "a.glb"), 18u) << seed;
  }
  for (const char* seed : {"sequence", "triangles", "format-1", "colors"}) {
    const std::string bytes = seed_bytes(std::filesystem::path("meshopt") / seed);
    EXPECT_EQ(triangles_in(meshopt_glb(std::as_bytes(std::span(bytes))), "a.glb"), 18u) << seed;
  }
}

INSTANTIATE_TEST_SUITE_P(Targets, Corpus, ::testing::ValuesIn(targets().begin(), targets().end()),
                         [](const auto& tested) { return std::string(tested.param.name); });

}  // namespace
}  // namespace luxel::fuzz
