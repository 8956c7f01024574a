// Hierarchical radiosity from outside: bakes, pictures, probes, and what they refuse.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "luxel/base/file.h"
#include "luxel/image/codec.h"
#include "tests/command.h"
#include "tests/pictures.h"

namespace luxel::testing_support {
namespace {

using ::testing::HasSubstr;

CommandResult bake_for_hierarchical(const std::filesystem::path& output,
                                    const std::string& options) {
  return luxel("bake " + scene_file("cornell-box.glb") +
               " --solver hierarchical --resolution 64 -o " + output.string() + " " + options);
}

TEST(HierarchicalBake, SaysWhatItUsed) {
  const ScratchFolder s;
  const CommandResult r =
      bake_for_hierarchical(s.path / "b", "--eps 0.1 --max-leaf-lines 4 --json");
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_EQ(files_in(s.path / "b"), kBakeFiles);
  const auto json = nlohmann::json::parse(r.out);
  EXPECT_EQ(json["settings"]["hierarchical"]["eps"], 0.1);
  EXPECT_EQ(json["settings"]["hierarchical"]["max_leaf_lines"], 4);
  EXPECT_GT(uint64_t(json["counts"]["elements"]), 300u);
  EXPECT_GT(double(json["relative_error"]), 0);
  // Measured by paths: links that may err by 0.2 of the mean light err less when light is fed back.
  EXPECT_GT(double(json["relative_error"]), 0.003);
  EXPECT_LT(double(json["relative_error"]), 0.1);
  for (const char* stage : {"join polygons", "link", "refine", "discontinuities", "irradiance"})
    EXPECT_TRUE(json["seconds"].contains(stage)) << stage;
}

TEST(HierarchicalBake, GivesTheSameBitsWithAnyNumberOfThreads) {
  const ScratchFolder s;
  ASSERT_EQ(bake_for_hierarchical(s.path / "1", "--eps 0.2 --threads 1").code, 0);
  ASSERT_EQ(bake_for_hierarchical(s.path / "2", "--eps 0.2 --threads 2").code, 0);
  EXPECT_EQ(slurp(s.path / "1" / "lightmap.exr"), slurp(s.path / "2" / "lightmap.exr"));
}

TEST(HierarchicalBake, RefusesWhatCannotWork) {
  const ScratchFolder s;
  for (const auto& [options, sentence] :
       {std::pair{"--eps -1", "--eps -1 is not an error"},
        std::pair{"--min-area -1", "--min-area -1 is not an area"},
        std::pair{"--min-weight -1", "--min-weight -1 is not a weight"},
        std::pair{"--ranking size", "--ranking size is not known; choose from: slope, nearness"},
        std::pair{"--max-leaf-lines 2000", "--max-leaf-lines 2000 is outside 0 to 1000"},
        std::pair{"--samples 16", "does not use --samples"},
        std::pair{"--patches 16", "does not use --patches"}}) {
    const CommandResult r = bake_for_hierarchical(s.path / "b", options);
    EXPECT_EQ(r.code, 1) << options << r.err;
    EXPECT_THAT(r.err, HasSubstr(sentence)) << options;
    EXPECT_FALSE(std::filesystem::exists(s.path / "b")) << options;
  }
}

/// Overlapping, crossing, duplicated, sliver and flat polygons: an .obj of the worst.
constexpr const char* kBadPolygons = R"(
o floor
v 0 0 0
v 4 0 0
v 4 0 4
v 0 0 4
f 4 3 2 1
o again
v 1 0 1
v 3 0 1
v 3 0 3
v 1 0 3
f 8 7 6 5
o through
v 2 -1 1
v 2 -1 3
v 2 1 3
v 2 1 1
f 9 10 11 12
o sliver
v 0 1 0
v 4 1 0
v 2 1.0000001 0
f 13 14 15
o bent
v 0 2 0
v 1 2 0
v 1 2.5 1
v 0 2 1
f 16 17 18 19
o nothing
v 1 1 1
v 1 1 1
v 1 1 1
f 20 21 22
)";

TEST(HierarchicalPictures, SurviveBadPolygonsAndNameThem) {
  const ScratchFolder s;
  const auto scene = s.write("bad.obj", kBadPolygons);
  const CommandResult r = luxel("probe " + scene.string() +
                                " --at 3.5,0,3.5 --normal 0,1,0 --eps 0 --min-area 0.05 "
                                "--background 1,1,1 --solver hierarchical --json");
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_THAT(r.err, HasSubstr("faces coincide"));
  EXPECT_THAT(r.err, HasSubstr("'floor' and 'again'"));
  EXPECT_THAT(r.err, HasSubstr("faces intersect"));
  EXPECT_THAT(r.err, HasSubstr("'through'"));
  const double e = nlohmann::json::parse(r.out)["irradiance"][0];
  EXPECT_GT(e, 0.5 * M_PI);  // most of a white sky
  EXPECT_LT(e, M_PI);
}

double difference(const std::filesystem::path& a, const std::filesystem::path& b) {
  const image::Image x = exr_at(a), y = exr_at(b);
  double sum = 0, all = 0;
  for (size_t k = 0; k < x.data.size(); ++k)
    if (k % 4 != 3) {
      const double d = double(x.data[k]) - double(y.data[k]);
      sum += d * d, all += double(y.data[k]) * double(y.data[k]);
    }
  return std::sqrt(sum / all);
}

// The pictures of one solution, the better the nearer to exact light at every pixel; the lamp, of
// which all show the same, is most of the square.
TEST(HierarchicalPictures, ComeNearerToExactLightOneByOne) {
  const ScratchFolder s;
  const auto draw = [&](const std::string& technique) {
    const auto path = s.path / (technique + ".exr");
    const CommandResult r =
        luxel("render " + scene_file("cornell-box.glb") + " --size 80x80 --eps 0.1 --technique " +
              technique + " -o " + path.string());
    EXPECT_EQ(r.code, 0) << technique << r.err;
    return path;
  };
  const auto exact = draw("rayshade");
  const double flat = difference(draw("flat"), exact);
  const double gouraud = difference(draw("gouraud"), exact);
  const double cut = difference(draw("gouraud-disc"), exact);
  const double quadratic = difference(draw("lerpshade"), exact);
  EXPECT_LT(quadratic, 0.7 * cut);
  EXPECT_LT(cut, 0.7 * gouraud);
  EXPECT_LT(gouraud, flat);
  // One ray per pixel instead of four: edges, above all the lamp's, which is a hundred times as
  // bright as the rest.
  EXPECT_LT(difference(draw("interpolant"), exact), 0.5);
}

TEST(HierarchicalPictures, RefuseWhatTheyDoNotUse) {
  const ScratchFolder s;
  const CommandResult r = luxel("render " + scene_file("cornell-box.glb") +
                                " --technique path --eps 1 -o " + (s.path / "x.png").string());
  EXPECT_EQ(r.code, 1);
  EXPECT_THAT(r.err, HasSubstr("does not use --eps"));
}

TEST(Probe, SaysWhereLightComesFrom) {
  const ScratchFolder s;
  const auto picture = s.path / "sources.png";
  const CommandResult r =
      luxel("probe " + scene_file("cornell-box.glb") +
            " --at 0.1,0.01,0.4 --solver hierarchical --json -o " + picture.string());
  ASSERT_EQ(r.code, 0) << r.err;
  const auto json = nlohmann::json::parse(r.out);
  double sum = 0, factors = 0;
  for (const auto& source : json["sources"]) {
    sum += double(source["irradiance"][1]), factors += double(source["form_factor"]);
    EXPECT_LE(double(source["visible"]), 1 + 1e-9);
  }
  const double exact = json["irradiance"][1];
  EXPECT_NEAR(sum, exact, 1e-3 * exact);
  EXPECT_NEAR(json["irradiance_interpolated"][1], exact, 0.02 * exact);
  EXPECT_LE(factors, 1 + 1e-9);  // the box is open in front
  EXPECT_EQ(json["sources"][0]["surface"], "light");
  EXPECT_NEAR(double(json["position"][1]), 0, 1e-6);
  EXPECT_TRUE(image::decode_ldr(*read_file(picture), "sources.png"));
}

TEST(Probe, RefusesWhatCannotBe) {
  const ScratchFolder s;
  for (const auto& [options, sentence] :
       {std::pair{"--at 1,2", "--at '1,2' is not a point"},
        std::pair{"--at 50,0,0", "no surface within"},
        std::pair{"--at 0,0,0 --normal 0,0,0", "is not a direction"},
        std::pair{"--at 0,0,0 -o x.jpg", "must end in .png"},
        std::pair{"--at 0,0,0 -o x.png", "--solver hierarchical"},
        std::pair{"--at 0,0,0 --eps 1", "does not use --eps"},
        std::pair{"--at 0,0,0 --max-error 0", "--max-error 0"},
        std::pair{"--at 0,0,0 --solver hierarchical --in-air", "leave out --in-air"},
        std::pair{"--at 0,0,0 --from x --solver paths", "leave one of them out"}}) {
    const CommandResult r = luxel("probe " + scene_file("cornell-box.glb") + " " + options);
    EXPECT_EQ(r.code, 1) << options;
    EXPECT_THAT(r.err, HasSubstr(sentence)) << options;
  }
}

}  // namespace
}  // namespace luxel::testing_support
