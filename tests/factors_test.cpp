// `luxel factors`: the table, what is printed, and what is refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>

#include "luxel/base/base64.h"
#include "luxel/pipeline/command/factors.h"
#include "tests/command.h"

namespace luxel::testing_support {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

const std::string kCube =
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
    "g floor\nf 1 2 3 4\ng ceiling\nf 5 8 7 6\ng \"a, b\"\nf 1 5 6 2\no east\nf 2 6 7 3\n"
    "o north wall\nf 3 7 8 4\ng west\nf 4 8 5 1\n";

/// Cells of a CSV line as RFC 4180 writes them.
std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"' && quoted && i + 1 < line.size() && line[i + 1] == '"')
      cells.back() += line[++i];
    else if (line[i] == '"')
      quoted = !quoted;
    else if (line[i] == ',' && !quoted)
      cells.emplace_back();
    else
      cells.back() += line[i];
  }
  return cells;
}

using Table = std::map<std::string, std::map<std::string, double>>;
Table read_table(const std::filesystem::path& path) {
  std::ifstream in(path);
  std::string line;
  std::getline(in, line);
  const std::vector<std::string> header = cells_of(line);
  EXPECT_EQ(header.front(), "surface");
  Table table;
  while (std::getline(in, line)) {
    const std::vector<std::string> cells = cells_of(line);
    EXPECT_EQ(cells.size(), header.size());
    for (size_t j = 1; j < cells.size(); ++j) table[cells[0]][header[j]] = std::stod(cells[j]);
  }
  return table;
}

constexpr double kOpposite = 0.19982489569838738, kBeside = 0.20004377607540315;  // Howell

TEST(Factors, OfACubeAreExactAndClosed) {
  const ScratchFolder s;
  const std::string cube = s.write("cube.obj", kCube).string(), csv = (s.path / "f.csv").string();
  const CommandResult r = luxel("factors " + cube + " -o " + csv);
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_THAT(r.out, HasSubstr("closed"));
  EXPECT_THAT(r.out, HasSubstr("reciprocity"));
  EXPECT_THAT(slurp(csv), HasSubstr("\nfloor,0,0.199824895698"));
  const Table table = read_table(csv);
  ASSERT_EQ(table.size(), 6u);
  EXPECT_NEAR(table.at("floor").at("ceiling"), kOpposite, 1e-12);
  EXPECT_NEAR(table.at("floor").at("north wall"), kBeside, 1e-12);
  EXPECT_NEAR(table.at("\"a, b\"").at("east"), kBeside, 1e-12);  // the quotes belong to its name
  EXPECT_EQ(table.at("west").at("west"), 0);
}

TEST(Factors, JsonIsOneObjectOnStdout) {
  const ScratchFolder s;
  const std::string cube = s.write("cube.obj", kCube).string(), csv = (s.path / "f.csv").string();
  const CommandResult r = luxel("factors " + cube + " -o " + csv + " --json");
  ASSERT_EQ(r.code, 0) << r.err;
  const nlohmann::json json = nlohmann::json::parse(r.out);
  EXPECT_EQ(json.at("surfaces").size(), 6u);
  EXPECT_EQ(json.at("surfaces")[1].at("name"), "ceiling");
  EXPECT_NEAR(json.at("surfaces")[1].at("area_m2").get<double>(), 1, 1e-12);
  EXPECT_NEAR(json.at("surfaces")[1].at("row_sum").get<double>(), 1, 1e-12);
  EXPECT_EQ(json.at("closed"), true);
  EXPECT_LT(json.at("reciprocity_error").get<double>(), 1e-12);
  EXPECT_EQ(json.at("output"), csv);
}

TEST(Factors, FromAndToLeaveOneEntry) {
  const ScratchFolder s;
  const std::string cube = s.write("cube.obj", kCube).string(), csv = (s.path / "f.csv").string();
  const CommandResult r = luxel("factors " + cube + " -o " + csv + " --from floor --to ceiling");
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_THAT(r.out, HasSubstr("F(floor -> ceiling) = 0.19982489569"));
  const Table table = read_table(csv);
  ASSERT_EQ(table.size(), 1u);
  EXPECT_EQ(table.at("floor").size(), 1u);
  EXPECT_NEAR(table.at("floor").at("ceiling"), kOpposite, 1e-12);
}

TEST(Factors, OtherMethodsComeCloseAndSmoothingKeepsTheLaws) {
  const ScratchFolder s;
  const std::string cube = s.write("cube.obj", kCube).string(), csv = (s.path / "f.csv").string();
  // A ray meets the wall or not: a standard error of sqrt(0.2 * 0.8 / samples), here four of them.
  // 64 hemicubes stand in strata of an eighth of a side, over which F(point) of the wall beside
  // falls by 0.06: a deviation of 0.06 / sqrt(12) each, 0.002 in their mean, here three of it.
  const auto four_errors = [](double samples) { return 4 * std::sqrt(0.16 / samples); };
  for (const auto& [method, tolerance] : std::initializer_list<std::pair<std::string, double>>{
           {"rays --samples 65536", four_errors(65536)},
           {"hemicube --samples 64 --hemicube 32", 0.006},
           {"rays --samples 16384 --smooth", four_errors(16384)}}) {
    const CommandResult r = luxel("factors " + cube + " -o " + csv + " --quiet --method " + method);
    ASSERT_EQ(r.code, 0) << r.err;
    EXPECT_EQ(r.out, "");
    const Table table = read_table(csv);
    EXPECT_NEAR(table.at("floor").at("ceiling"), kOpposite, tolerance) << method;
    EXPECT_NEAR(table.at("floor").at("east"), kBeside, tolerance) << method;
    if (method.find("smooth") == std::string::npos) continue;
    for (const auto& [name, row] : table) {
      double sum = 0;
      for (const auto& [other, factor] : row) {
        sum += factor;
        EXPECT_NEAR(factor, table.at(other).at(name), 1e-13);  // the file has 13 digits
      }
      EXPECT_NEAR(sum, 1, 1e-12) << name;
    }
  }
}

TEST(Factors, AGroupIsOneSurfaceWhateverItsMaterialsAndOrder) {
  const ScratchFolder s;
  s.write("m.mtl", "newmtl red\nKd 0.5 0 0\nnewmtl blue\nKd 0 0 0.5\n");
  const std::string scene =
      s.write("s.obj",
              "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\nv 0 0 1\n"
              "v 2 0 1\nv 2 1 1\nv 0 1 1\ng floor\nusemtl red\nf 1 2 3 4\ng lid\nf 7 10 9 8\n"
              "g floor\nusemtl blue\nf 2 5 6 3\n")
          .string();
  const std::string csv = (s.path / "f.csv").string();
  const CommandResult r = luxel("factors " + scene + " -o " + csv);
  ASSERT_EQ(r.code, 0) << r.err;
  const Table table = read_table(csv);
  ASSERT_EQ(table.size(), 2u);
  EXPECT_NEAR(table.at("floor").at("lid"), 0.28587538485071472, 1e-12);  // 1 x 2 plates
}

TEST(Factors, BentQuadsAndSurfacesWithoutAreaAreSaid) {
  const ScratchFolder s;
  std::string text = kCube + "g thread\nf 1 2 2\n";
  text.replace(text.find("v 1 1 1\n"), 8, "v 1 1 1.1\n");
  const std::string scene = s.write("s.obj", text).string(), csv = (s.path / "f.csv").string();
  const CommandResult r = luxel("factors " + scene + " -o " + csv);
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_THAT(r.err, HasSubstr("'ceiling'"));
  EXPECT_THAT(r.err, HasSubstr("one plane"));
  const Table table = read_table(csv);
  EXPECT_EQ(table.size(), 6u);
  for (const auto& [name, row] : table)
    for (const auto& [other, factor] : row) {
      EXPECT_TRUE(std::isfinite(factor));
      EXPECT_GE(factor, 0);
    }
  const std::string nothing =
      s.write("n.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\ng thread\nf 1 2 3\n").string();
  const CommandResult refused = luxel("factors " + nothing + " -o " + csv);
  EXPECT_EQ(refused.code, 1);
  EXPECT_THAT(refused.err, HasSubstr("n.obj"));
}

TEST(Factors, WrongRequestsAreRefusedAndLeaveNothing) {
  const ScratchFolder s;
  const std::string cube = s.write("cube.obj", kCube).string(), csv = (s.path / "f.csv").string();
  const auto refused = [&](const std::string& arguments, int code, const std::string& words) {
    const CommandResult r = luxel("factors " + arguments);
    EXPECT_EQ(r.code, code) << arguments << "\n" << r.err;
    EXPECT_THAT(r.err, HasSubstr(words)) << arguments;
    EXPECT_EQ(r.out, "") << arguments;
    EXPECT_EQ(files_in(s.path), (std::set<std::string>{"cube.obj"})) << arguments;
  };
  refused(cube + " -o " + csv + " --from flor", 1, "choose from: floor, ceiling");
  refused(cube + " -o " + csv + " --to nowhere", 1, "'nowhere'");
  refused(cube + " -o " + csv + " --tolerance 0", 1, "--tolerance 0");
  refused(cube + " -o " + csv + " --tolerance nan", 1, "--tolerance nan");
  refused(cube + " -o " + csv + " --samples 5", 1, "--samples has no meaning");
  refused(cube + " -o " + csv + " --method rays --samples 0", 1, "--samples 0");
  refused(cube + " -o " + csv + " --method hemicube --hemicube 7", 1, "--hemicube 7");
  refused(cube + " -o " + csv + " --smooth --from floor", 1, "--smooth");
  refused(cube + " -o " + (s.path / "none" / "f.csv").string(), 1, "there is no folder");
  refused(cube + " -o " + s.path.string(), 1, "is a folder");
  refused((s.path / "none.obj").string() + " -o " + csv, 1, "no such file");
  refused(cube + " -o " + csv + " --method fast", 2, "fast");
  refused(cube, 2, "--output");
  refused(scene_file("cornell-box-empty.glb") + " -o " + csv + " --smooth", 1, "closed enclosure");
}

/// A floor, a ceiling 1 m above it, and between them a plate whose mask is one hole.
std::string masked_scene() {
  const auto square = [](float y, bool up) {
    const std::array<std::array<float, 2>, 4> at{{{0, 0}, {0, 1}, {1, 1}, {1, 0}}};
    std::vector<float> out;
    for (const size_t k :
         up ? std::array<size_t, 6>{0, 1, 2, 0, 2, 3} : std::array<size_t, 6>{0, 2, 1, 0, 3, 2})
      out.insert(out.end(), {at[k][0], y, at[k][1]});
    return base64(std::as_bytes(std::span(out)));
  };
  nlohmann::json gltf{{"asset", {{"version", "2.0"}}}, {"scene", 0}};
  gltf["scenes"] = {{{"nodes", {0, 1, 2}}}};
  gltf["materials"] = {{{"name", "plain"}},
                       {{"name", "holes"},
                        {"alphaMode", "MASK"},
                        {"pbrMetallicRoughness", {{"baseColorFactor", {1.0, 1.0, 1.0, 0.1}}}}}};
  const std::array<std::string, 3> names{"floor", "ceiling", "grille"};
  const std::array<float, 3> height{0, 1, 0.5f};
  for (size_t i = 0; i < 3; ++i) {
    gltf["nodes"].push_back({{"name", names[i]}, {"mesh", i}});
    gltf["meshes"].push_back(
        {{"primitives", {{{"attributes", {{"POSITION", i}}}, {"material", i == 2 ? 1 : 0}}}}});
    gltf["accessors"].push_back({{"bufferView", i},
                                 {"componentType", 5126},
                                 {"count", 6},
                                 {"type", "VEC3"},
                                 {"min", {0.0, height[i], 0.0}},
                                 {"max", {1.0, height[i], 1.0}}});
    gltf["bufferViews"].push_back({{"buffer", i}, {"byteOffset", 0}, {"byteLength", 72}});
    gltf["buffers"].push_back(
        {{"byteLength", 72},
         {"uri", "data:application/octet-stream;base64," + square(height[i], i != 1)}});
  }
  return gltf.dump();
}

TEST(Factors, HolesOfMasksAreSolidByEveryMethodAndSaid) {
  const ScratchFolder s;
  const std::string scene = s.write("s.gltf", masked_scene()).string();
  const std::string csv = (s.path / "f.csv").string();
  // Howell's C-11 for squares at half their side; the ceiling lies behind the plate.
  constexpr double kHalfApart = 0.41525327;
  for (const std::string method :
       {"analytic", "rays --samples 65536", "hemicube --samples 64 --hemicube 32"}) {
    const CommandResult r = luxel("factors " + scene + " -o " + csv + " --method " + method);
    ASSERT_EQ(r.code, 0) << r.err;
    EXPECT_THAT(r.err, HasSubstr("count as solid")) << method;
    EXPECT_THAT(r.err, HasSubstr("'grille'")) << method;
    EXPECT_THAT(r.err, Not(HasSubstr("'floor'"))) << method;
    const Table table = read_table(csv);
    EXPECT_EQ(table.at("floor").at("ceiling"), 0) << method;
    EXPECT_NEAR(table.at("grille").at("ceiling"), kHalfApart, 0.01) << method;
  }
}

TEST(Factors, TablesThatDoNotFitAreRefusedBeforeTheWork) {
  const ScratchFolder s;
  const std::string cube = s.write("cube.obj", kCube).string(), csv = (s.path / "f.csv").string();
  const std::string limit = "factors " + cube + " -o " + csv + " --max-memory 700M";
  EXPECT_EQ(luxel(limit + " --method hemicube --samples 1 --hemicube 64").code, 0);
  std::filesystem::remove(csv);
  const CommandResult r = luxel(limit + " --method hemicube --samples 1 --hemicube 4096");
  EXPECT_EQ(r.code, 3);
  EXPECT_THAT(r.err, HasSubstr("--max-memory"));
  EXPECT_THAT(r.err, HasSubstr("MiB"));
  EXPECT_FALSE(std::filesystem::exists(csv));
  EXPECT_EQ(luxel("factors " + cube + " -o " + csv + " --max-memory 1 --smooth").code, 3);
  EXPECT_EQ(luxel("factors " + cube + " -o " + csv + " --max-memory none").code, 1);
}

// Two tables of doubles stay; smoothing takes a third, the text of the table three more.
TEST(Factors, SmoothingAndTextCountAsMemory) {
  const uint64_t table = 8ull * 10000 * 10000;
  pipeline::FactorSettings settings;
  EXPECT_EQ(pipeline::factor_table_bytes(10000, settings), 2 * table);
  settings.smooth = true;
  EXPECT_EQ(pipeline::factor_table_bytes(10000, settings), 3 * table);
  settings.output = "f.csv";
  EXPECT_EQ(pipeline::factor_table_bytes(10000, settings), 5 * table);
}

/// Two nodes of one name share a unit square that faces up: one lies at y = 0, the other, turned
/// over, at y = 1.
std::string two_plates() {
  std::vector<std::byte> bytes(4 * 12 + 6 * 2);
  const float corners[12] = {0, 0, 0, 0, 0, 1, 1, 0, 1, 1, 0, 0};
  const uint16_t indices[6] = {0, 1, 2, 0, 2, 3};
  std::memcpy(bytes.data(), corners, sizeof corners);
  std::memcpy(bytes.data() + sizeof corners, indices, sizeof indices);
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,1]}],
    "nodes":[{"name":"plate","mesh":0},
             {"name":"plate","mesh":0,"rotation":[1,0,0,0],"translation":[0,1,1]}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3",
                  "min":[0,0,0],"max":[1,0,1]},
                 {"bufferView":1,"componentType":5123,"count":6,"type":"SCALAR"}],
    "bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":12}],
    "buffers":[{"byteLength":60,"uri":"data:application/octet-stream;base64,)" +
         base64(bytes) + "\"}]}";
}

TEST(Factors, EqualNamesAreToldApart) {
  const ScratchFolder s;
  const std::string csv = (s.path / "f.csv").string();
  const CommandResult r =
      luxel("factors " + s.write("plates.gltf", two_plates()).string() + " -o " + csv);
  ASSERT_EQ(r.code, 0) << r.err;
  const Table table = read_table(csv);
  ASSERT_EQ(table.size(), 2u);
  EXPECT_NEAR(table.at("plate").at("plate#2"), kOpposite, 1e-12);
  EXPECT_NEAR(table.at("plate#2").at("plate"), kOpposite, 1e-12);
}

TEST(Factors, AnOpenSceneIsSaidToBeOpen) {
  const ScratchFolder s;
  const std::string csv = (s.path / "f.csv").string();
  const CommandResult r =
      luxel("factors " + scene_file("cornell-box-empty.glb") + " -o " + csv + " --threads 1");
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_THAT(r.out, HasSubstr("open"));
  const Table table = read_table(csv);
  EXPECT_EQ(table.count("back wall"), 1u);
  // A cube but for 2 % of its sides.
  EXPECT_NEAR(table.at("back wall").at("left wall"), kBeside, 0.04 * kBeside);
}

}  // namespace
}  // namespace luxel::testing_support
