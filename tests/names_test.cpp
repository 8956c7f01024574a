// Names from files and of files, at the terminal and in JSON: those that are no UTF-8, those that a
// terminal would obey, and those of megabytes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "luxel/base/shown_text.h"
#include "tests/command.h"

namespace luxel::testing_support {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// Two walls of 1 m2 face each other; both and their material have a name in Latin-1.
std::string walls(const std::string& name) {
  return "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
         "usemtl " +
         name + "\no " + name + "\nf 1 2 3 4\no " + name + "2\nf 8 7 6 5\n";
}

/// Errors and warnings as lines that a terminal only shows.
void expect_harmless(const std::string& printed) {
  std::istringstream lines(printed);
  for (std::string line; std::getline(lines, line);) {
    EXPECT_EQ(line, shown_text(line));
    EXPECT_FALSE(line.starts_with("luxel: done")) << "forged";
    EXPECT_LT(line.size(), 5000u);
  }
}

TEST(Names, ThatAreNoUtf8EndInFilesAndValidJson) {
  const ScratchFolder s;
  const std::string name = "W\xe4nde", folder = (s.path / name).string();
  std::filesystem::create_directory(folder);
  s.write(name + "/" + name + ".obj", walls(name));
  s.write(name + "/a.mtl", "newmtl " + name + "\nKe 1 1 1\nmap_Kd " + name + ".png\n");
  const std::string scene = " '" + folder + "/" + name + ".obj' ", bake = " '" + folder + "/out' ";
  const std::string commands[] = {
      "bake" + scene + "-o" + bake + "--resolution 16 --samples 4",
      "info" + scene,
      "probe" + scene + "--at .5,.5,0 --max-error .5",
      "factors" + scene + "-o '" + folder + "/f.csv'",
      "render" + scene + "--from" + bake + "-o '" + folder + "/p.png' --size 32x24",
      "compare" + bake + bake + "--report '" + folder + "/report'",
      "info" + scene + "--up x"};
  for (const std::string& command : commands) {
    const CommandResult done = luxel(command + " --json");
    const nlohmann::json json = nlohmann::json::parse(done.out, nullptr, false);
    EXPECT_TRUE(json.is_object()) << command << done.out;
    EXPECT_EQ(done.code, command.ends_with("--up x") ? 1 : 0) << command << done.err;
    expect_harmless(done.err);
  }
  const CommandResult told =
      luxel("render" + scene + "--from" + bake + "-o '" + folder + "/p.png'");
  EXPECT_THAT(told.err, HasSubstr("W\\xe4nde/p.png\n")) << "the path is shown with an escape";
  for (const char* file : {"/out/baked.glb", "/out/bake.json", "/p.png", "/report/report.html"})
    EXPECT_TRUE(std::filesystem::exists(folder + file)) << file;
  const auto report = nlohmann::json::parse(slurp(folder + "/out/bake.json"), nullptr, false);
  EXPECT_TRUE(report.is_object());
  EXPECT_THAT(slurp(folder + "/f.csv"), HasSubstr("\nW\xef\xbf\xbdnde2,")) << "as it was imported";
  const std::string html = slurp(folder + "/report/report.html");
  EXPECT_EQ(valid_utf8(html), html);
}

/// A square of 1 m2 in glTF, with a name, whose numbers lie in a file.
std::string square(const std::string& name, const std::string& uri) {
  nlohmann::json out = nlohmann::json::parse(
      R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
      "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0, "mode": 5}]}],
      "bufferViews": [{"buffer": 0, "byteLength": 48}], "accessors": [{"bufferView": 0,
      "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}]})");
  out["nodes"] = {{{"mesh", 0}, {"name", name}}};
  out["materials"] = {{{"name", name}}};
  out["buffers"] = {{{"byteLength", 48}, {"uri", uri}}};
  return out.dump();
}
std::string corners() {
  const float numbers[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};
  return {reinterpret_cast<const char*>(numbers), sizeof numbers};
}

/// Ends the line, forges one, clears the screen, and turns what follows around.
const std::string kForged = "=a\nluxel: done\r\x1b[2J\xc2\x9b\xe2\x80\xae";

TEST(Names, MoveNoCursorAndForgeNoLine) {
  const ScratchFolder s;
  s.write("b.bin", corners());
  const std::string scene = s.write("a.gltf", square(kForged, "b.bin")).string(),
                    lost = s.write("lost.gltf", square("a", kForged + ".bin")).string(),
                    table = (s.path / "f.csv").string();
  const CommandResult factors = luxel("factors " + scene + " -o " + table);
  EXPECT_EQ(factors.code, 0) << factors.err;
  EXPECT_THAT(factors.out, HasSubstr("=a\\nluxel: done\\r\\x1b[2J\\u009b\\u202e"));
  expect_harmless(factors.out + factors.err);
  EXPECT_THAT(slurp(table), HasSubstr("\n\"'=a\\nluxel: done\\r\\x1b[2J\\u009b\\u202e\","))
      << "a text, in one line";
  const CommandResult probe = luxel("probe " + scene + " --at .5,.5,0 --max-error .5");
  EXPECT_THAT(probe.out, HasSubstr("on =a\\nluxel: done"));
  expect_harmless(probe.out + probe.err);
  for (const char* option : {"", " --json", " --progress-json"}) {
    const CommandResult error = luxel("info " + lost + option);
    EXPECT_EQ(error.code, 1);
    EXPECT_THAT(error.err, HasSubstr("done\\")) << option;
    expect_harmless(error.out + error.err);
  }
  // The user's own words are harmless, too, and so is a library's message about them.
  for (const std::string command : {"info ", "", "render a -o b --size "}) {
    const CommandResult usage = luxel(command + "'" + kForged + "'");
    EXPECT_NE(usage.code, 0);
    EXPECT_THAT(usage.err, HasSubstr("\\x1b[2J")) << command;
    expect_harmless(usage.out + usage.err);
  }
}

TEST(Names, OfMegabytesAreCutShort) {
  const ScratchFolder s;
  s.write("b.bin", corners());
  const std::string scene = s.write("a.gltf", square(std::string(2'000'000, 'x'), "b.bin"));
  const CommandResult done = luxel("factors " + scene + " -o " + (s.path / "f.csv").string());
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_THAT(done.out, HasSubstr("xxx[1999880 bytes]xxx"));
  expect_harmless(done.out + done.err);
}

}  // namespace
}  // namespace luxel::testing_support
