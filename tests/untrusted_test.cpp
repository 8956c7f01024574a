// docs/guide/untrusted.md as it is written: its sandbox runs, and what is outside stays outside.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/command.h"

namespace luxel::testing_support {
namespace {

using ::testing::HasSubstr;

/// The page's command, with a folder of this test's own in the place of its folders.
std::string command_of_page(const std::filesystem::path& folder) {
  std::istringstream page(
      slurp(std::filesystem::path(LUXEL_SOURCE_DIR) / "docs/guide/untrusted.md"));
  std::string command;
  for (std::string line; std::getline(page, line);) {
    const bool goes_on = !command.empty() && command.back() == '\\';
    if (goes_on) command.pop_back();
    if (goes_on || line.starts_with("    prlimit")) command += line;
    if (!command.empty() && command.back() != '\\') break;
  }
  const auto replace = [&](const std::string& word, const std::string& by) {
    const size_t at = command.find(word);
    EXPECT_NE(at, std::string::npos) << word;
    if (at != std::string::npos) command.replace(at, word.size(), by);
  };
  replace("build/release/bin/luxel", LUXEL_BINARY);
  replace("uploads", (folder / "uploads").string());
  replace("results", (folder / "results").string());
  return command;
}

TEST(Untrusted, TheSandboxOfThePageWorks) {
  const ScratchFolder s;
  if (const CommandResult none = shell("bwrap --unshare-all --ro-bind / / true"); none.code != 0)
    GTEST_SKIP() << "bwrap is not here, or may make no namespaces: " << none.err;
  for (const char* folder : {"uploads", "results"})
    std::filesystem::create_directory(s.path / folder);
  std::filesystem::copy(std::filesystem::path(LUXEL_SOURCE_DIR) / "scenes/cornell-box.glb",
                        s.path / "uploads/scene.glb");
  const std::string small = " --resolution 16 --samples 4 --direct-samples 2";
  const std::string command = command_of_page(s.path) + small;
  const CommandResult good = shell(command);
  ASSERT_EQ(good.code, 0) << good.err;
  EXPECT_EQ(nlohmann::json::parse(good.out)["settings"]["resolution"], 16);
  EXPECT_TRUE(std::filesystem::exists(s.path / "results/bake/lightmap.exr"));
  // A scene that names a file of the machine, with --trust-paths by mistake: it is not in sight.
  s.write("secret.bin", std::string(36, '\0'));
  s.write("uploads/scene.glb", "");
  const std::string gltf =
      R"({"asset": {"version": "2.0"}, "buffers": [{"byteLength": 36, "uri": ")" +
      (s.path / "secret.bin").string() + R"("}]})";
  s.write("uploads/scene.gltf", gltf);
  std::string other = command;
  other.replace(other.find("scene.glb"), 9, "scene.gltf");
  const CommandResult bad = shell(other + " --trust-paths");
  EXPECT_EQ(bad.code, 1);
  EXPECT_THAT(bad.err, HasSubstr("secret.bin, which is missing"));
  // The scene's folder is there to read only.
  std::string into_uploads = command;
  into_uploads.replace(into_uploads.find("/out/bake"), 9, "/in/bake");
  EXPECT_EQ(shell(into_uploads).code, 1);
}

}  // namespace
}  // namespace luxel::testing_support
