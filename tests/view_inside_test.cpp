// luxel-view --inside hierarchical: what it shows of a solution is what `luxel render` draws.
#include <gmock/gmock.h>

#include <numeric>

#include "luxel/image/flip.h"
#include "tests/pictures.h"
#include "tests/view_command.h"

namespace luxel::testing_support {
namespace {

using ::testing::HasSubstr;

const std::string kInsideBox = scene_file("cornell-box.glb");
/// Coarse, since meshes of finer ones take seconds more.
const std::string kCoarse = " --eps 0.5 ";

/// The box, or another scene, after these events, as a file.
std::filesystem::path seen_inside(const ScratchFolder& s, const std::string& name,
                                  const std::string& size, const std::string& events,
                                  const std::string& scene = kInsideBox) {
  const auto play = s.write(name + ".json", "{\"end\": 0, \"events\": [" + events + "]}");
  const auto picture = s.path / (name + ".png");
  const CommandResult r =
      view(scene + " --inside hierarchical" + kCoarse + "--offscreen --size " + size + " --play " +
           play.string() + " --screenshot " + picture.string());
  EXPECT_EQ(r.code, 0) << r.err;
  return picture;
}

std::filesystem::path rendered(const ScratchFolder& s, const std::string& technique,
                               const std::string& size, const std::string& more = "",
                               const std::string& scene = kInsideBox,
                               const std::string& stops = "2") {
  const auto picture = s.path / ("render-" + technique + ".png");
  const CommandResult r =
      luxel("render " + scene + kCoarse + "--exposure " + stops + " --technique " + technique +
            " --size " + size + " -o " + picture.string() + " --quiet" + more);
  EXPECT_EQ(r.code, 0) << r.err;
  return picture;
}

double mean_flip(const std::filesystem::path& a, const std::filesystem::path& b) {
  const image::Image flip = image::flip(png_at(a), png_at(b));
  return std::accumulate(flip.data.begin(), flip.data.end(), 0.0) / double(flip.data.size());
}

/// A kind of light, the technique that draws it, and steps that lead to what that draws.
struct KindCase {
  const char *kind, *technique, *steps, *size, *scene, *stops;
};
constexpr const char* kAllLinks = R"({"at": 0, "do": "converge"}, )";
constexpr const char* kAll =
    R"({"at": 0, "do": "converge"}, {"at": 0, "do": "converge-interpolants"}, )";

class InsideKinds : public ::testing::TestWithParam<KindCase> {};

// 0.026 to 0.034 in these small pictures, by edges, which have other samples there. Of lerpshade,
// as interpolant has one sample for each pixel.
TEST_P(InsideKinds, AreWhatRenderDraws) {
  const ScratchFolder s;
  if (!has_device(s)) GTEST_SKIP() << "no graphics device";
  const KindCase& c = GetParam();
  const std::string scene = scene_file(c.scene);
  const std::string exposed =
      std::string(R"({"at": 0, "set": {"exposure": )") + c.stops + "}}, {\"at\": 0, \"show\": \"";
  const auto seen = seen_inside(s, "seen", c.size, c.steps + exposed + c.kind + "\"}", scene);
  EXPECT_LT(mean_flip(seen, rendered(s, c.technique, c.size, "", scene, c.stops)), 0.05);
}

// An empty box is solved within a fraction of a second; shadows have the kinds that follow them.
constexpr const char *kShadows = "cornell-box.glb", *kEmpty = "radiosity-box.glb";
INSTANTIATE_TEST_SUITE_P(
    Hierarchical, InsideKinds,
    ::testing::Values(KindCase{"flat", "flat", kAllLinks, "120x90", kShadows, "2"},
                      KindCase{"gouraud", "gouraud", kAll, "120x90", kEmpty, "0"},
                      KindCase{"gouraud-disc", "gouraud-disc", kAll, "120x90", kShadows, "2"},
                      KindCase{"interpolant", "lerpshade", kAll, "120x90", kShadows, "2"},
                      KindCase{"rayshade", "rayshade", kAll, "120x90", kEmpty, "0"}),
    [](const auto& tested) {
      return std::string(1, tested.param.kind[0]) + std::to_string(tested.index);
    });

// Lines that the processor draws lie where the device draws them.
TEST(ViewInside, OverlaysAreWhatRenderDraws) {
  const ScratchFolder s;
  if (!has_device(s)) GTEST_SKIP() << "no graphics device";
  const std::string size = "240x180";
  const std::string steps =
      std::string(kAllLinks) +
      R"({"at": 0, "set": {"exposure": 2}}, {"at": 0, "set": {"most-links": 300}}, )";
  const auto with = [&](const std::string& overlay) {
    return "{\"at\": 0, \"overlay\": {\"" + overlay + "\": true}}";
  };
  const auto none = seen_inside(s, "none", size, steps + R"({"at": 0, "show": "flat"})");
  for (const std::string overlay : {"mesh", "discontinuities"}) {
    const auto seen = seen_inside(s, overlay, size, steps + with(overlay));
    const auto drawn = rendered(s, "flat", size, " --overlay " + overlay);
    EXPECT_LT(mean_flip(seen, drawn), 0.5 * mean_flip(none, drawn)) << overlay;
    EXPECT_GT(mean_flip(seen, none), 0.01) << overlay << " is drawn";
  }
  // A mesh to depth 0 has fewer lines, and without faces their ground is black.
  const auto roots = seen_inside(s, "roots", size,
                                 steps + with("mesh") + R"(, {"at": 0, "set": {"mesh-depth": 0}})");
  EXPECT_LT(mean_flip(roots, none), 0.8 * mean_flip(s.path / "mesh.png", none));
  const image::Image bare = png_at(seen_inside(s, "bare", size, steps + with("no-faces")));
  EXPECT_EQ(std::accumulate(bare.data.begin(), bare.data.end(), 0.0), 0);
}

TEST(ViewInside, AWindowShowsWhatIsDrawnWithoutOne) {
  const ScratchFolder s;
  if (!has_device(s)) GTEST_SKIP() << "no graphics device";
  if (!has_virtual_display()) GTEST_SKIP() << "needs Xvfb (package xvfb)";
  const std::string events =
      R"({"at": 0, "do": "iterate"}, {"at": 0, "show": "rayshade"},
         {"at": 0, "overlay": {"links": true}}, {"at": 0, "key": "+"}, {"at": 0, "wait": "bake"})";
  const auto without = seen_inside(s, "without", "48x36", events);
  const std::string state = (s.path / "state").string();
  const CommandResult window = view(
      kInsideBox + " --inside hierarchical" + kCoarse + "--size 48x36 --play " +
          (s.path / "without.json").string() + " --screenshot " + (s.path / "window.png").string(),
      "XDG_STATE_HOME=" + state + " " + kInWindow);
  ASSERT_EQ(window.code, 0) << window.err;
  EXPECT_EQ(window.out + window.err, "") << "the validation layer has nothing to say";
  EXPECT_EQ(slurp(s.path / "window.png"), slurp(without));
}

// Whatever a tool has found is drawn, and leaves nothing behind.
TEST(ViewInside, ToolsAreDrawnUntilNothingIsSelected) {
  const ScratchFolder s;
  if (!has_device(s)) GTEST_SKIP() << "no graphics device";
  const std::string steps = std::string(kAllLinks) + R"({"at": 0, "wait": "bake"},
      {"at": 0, "show": "interpolant"}, {"at": 0, "wait": "bake"}, )";
  const auto none = seen_inside(s, "none", "120x90", steps + R"({"at": 0, "tool": "element"})");
  const auto with = [&](const std::string& name, const std::string& events) {
    return seen_inside(s, name, "120x90", steps + events);
  };
  const std::string at = R"("pixel": [60, 84]})";
  const auto element = with("element", R"({"at": 0, "use": "element", )" + at);
  for (const auto& [name, events] : {
           std::pair<std::string, std::string>{"link", R"({"at": 0, "use": "element", )" + at +
                                                           R"(, {"at": 0, "selection": "next"})"},
           {"triangle", R"({"at": 0, "use": "triangle", )" + at},
           {"graph", R"({"at": 0, "use": "graph", "pixel": [40, 84], "to_pixel": [80, 84]})"},
           {"irradiance", R"({"at": 0, "use": "irradiance", )" + at},
           {"backprojection", R"({"at": 0, "use": "backprojection", )" + at},
       }) {
    EXPECT_GT(mean_flip(with(name, events), none), 1e-3) << name;
    EXPECT_NE(slurp(s.path / (name + ".png")), slurp(element)) << name;
  }
  const auto gone = with("gone", R"({"at": 0, "use": "backprojection", )" + at +
                                     R"(, {"at": 0, "wait": "bake"}, {"at": 0, "use": "none"})");
  EXPECT_EQ(slurp(gone), slurp(none));
  // The area of an element is yellow: less blue in the pixel that was pointed at.
  const image::Image before = png_at(none), after = png_at(element);
  const size_t pixel = 3 * (84 * 120 + 60);
  EXPECT_LT(after.data[pixel + 2] / after.data[pixel], before.data[pixel + 2] / before.data[pixel]);
}

TEST(ViewInside, SaysWhatIsWrong) {
  const ScratchFolder s;
  const std::string shot = " --offscreen --screenshot " + (s.path / "x.png").string();
  const auto error = [&](const std::string& arguments) {
    const CommandResult r = view(arguments + shot);
    EXPECT_EQ(r.code, 1);
    return r.err;
  };
  EXPECT_THAT(error(kInsideBox + " --inside gather"),
              HasSubstr("--inside gather is not known; choose from: hierarchical, hemicube"));
  EXPECT_THAT(error(s.path.string() + " --inside hierarchical"),
              HasSubstr("--inside needs the file of a scene"));
  EXPECT_THAT(error(kInsideBox + " --inside hierarchical --solver gather"),
              HasSubstr("--solver gather contradicts --inside hierarchical"));
  EXPECT_THAT(error(kInsideBox + " --inside hierarchical --bounces 2"), HasSubstr("--bounces"));
  EXPECT_THAT(error(kInsideBox + " --inside hierarchical --samples 2"), HasSubstr("--samples"));
  EXPECT_THAT(error(kInsideBox + " --inside hierarchical -o x"), HasSubstr("--output"));
  if (!has_device(s)) GTEST_SKIP() << "no graphics device";
  const auto play = [&](const std::string& event) {
    return " --play " + s.write("wrong.json", "{\"end\": 0, \"events\": [" + event + "]}").string();
  };
  EXPECT_THAT(error(kInsideBox + " --inside hierarchical" + play(R"({"at": 0, "do": "dance"})")),
              HasSubstr("'dance' is not known"));
  EXPECT_THAT(
      error(kInsideBox + " --resolution 32 --samples 1" + play(R"({"at": 0, "do": "iterate"})")),
      HasSubstr("--inside opens one"));
  EXPECT_THAT(error(kInsideBox + " --resolution 32 --samples 1" +
                    play(R"({"at": 0, "use": "element", "pixel": [1, 2]})")),
              HasSubstr("--inside opens one"));
  EXPECT_THAT(error((s.path / "none.glb").string() + " --inside hierarchical"),
              HasSubstr("none.glb is not one"));
}

}  // namespace
}  // namespace luxel::testing_support
