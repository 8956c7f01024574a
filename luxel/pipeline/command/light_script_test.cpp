#include "luxel/pipeline/command/light_script.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace luxel::pipeline {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using Kind = scene::PunctualLight::Kind;

LightScript script_of(const std::string& text) {
  auto read = parse_light_script(text, "moves.json");
  EXPECT_TRUE(read) << read.error().message;
  return read ? std::move(*read) : LightScript{};
}

std::string error_of(const std::string& text) {
  const auto read = parse_light_script(text, "moves.json");
  EXPECT_FALSE(read) << text;
  if (read) return "";
  EXPECT_EQ(read.error().code, ErrorCode::bad_input);
  return read.error().message;
}

Track track_of(std::initializer_list<Track::Key> keys) { return {keys}; }

TEST(LightScript, MayBeEmpty) {
  const LightScript script = script_of("{}");
  EXPECT_EQ(script.frames, 24);
  EXPECT_EQ(script.frames_per_second, 24);
  EXPECT_EQ(script.width, 640);
  EXPECT_EQ(script.height, 480);
  EXPECT_TRUE(std::holds_alternative<std::monostate>(script.camera));
  EXPECT_TRUE(script.exposure.automatic);
  EXPECT_FALSE(script.keep_lights);
  EXPECT_FALSE(script.background);
  EXPECT_TRUE(script.lights.empty() && script.glows.empty());
  EXPECT_TRUE(lights_at(script, 0).empty());
}

TEST(LightScript, ReadsEveryFieldOfAPicture) {
  const LightScript script = script_of(R"({"frames": 7, "frames_per_second": 12.5,
    "size": [320, 200], "exposure": -1.5, "keep_lights": true, "background": [0.5, 1, 2],
    "camera": {"eye": [1, 2, 3], "look_at": [4, 5, 6], "fov_deg": 60}})");
  EXPECT_EQ(script.frames, 7);
  EXPECT_EQ(script.frames_per_second, 12.5);
  EXPECT_EQ(script.width, 320);
  EXPECT_EQ(script.height, 200);
  EXPECT_FALSE(script.exposure.automatic);
  EXPECT_EQ(script.exposure.stops, -1.5);
  EXPECT_TRUE(script.keep_lights);
  ASSERT_TRUE(script.background);
  EXPECT_EQ(value_at(*script.background, 3), (Vec3{0.5f, 1, 2}));
  const auto& view = std::get<LightScript::View>(script.camera);
  EXPECT_EQ(view.eye, (Vec3{1, 2, 3}));
  EXPECT_EQ(view.look_at, (Vec3{4, 5, 6}));
  EXPECT_EQ(view.fov_deg, 60);
  const LightScript other = script_of(R"({"camera": "door", "exposure": "auto:95"})");
  EXPECT_EQ(std::get<std::string>(other.camera), "door");
  EXPECT_TRUE(other.exposure.automatic);
  EXPECT_EQ(other.exposure.percentile, 95);
}

TEST(LightScript, ReadsLightsOfEveryKind) {
  const LightScript script = script_of(R"({"lights": [
    {"position": [1, 2, 3]},
    {"kind": "spot", "position": [0, 9, 0], "direction": [0, 0, -5], "intensity": [4, 5, 6],
     "range_m": 7, "inner_cone_deg": 30, "outer_cone_deg": 60},
    {"kind": "directional", "direction": [3, -4, 0]}]})");
  const auto lights = lights_at(script, 1);
  ASSERT_EQ(lights.size(), 3u);
  EXPECT_EQ(lights[0].kind, Kind::point);
  EXPECT_EQ(lights[0].position, (Vec3{1, 2, 3}));
  EXPECT_EQ(lights[0].intensity, (Rgb{1, 1, 1}));
  EXPECT_EQ(lights[0].range_m, 0);
  EXPECT_EQ(lights[1].kind, Kind::spot);
  EXPECT_EQ(lights[1].position, (Vec3{0, 9, 0}));
  EXPECT_EQ(lights[1].direction, (Vec3{0, 0, -1}));
  EXPECT_EQ(lights[1].intensity, (Rgb{4, 5, 6}));
  EXPECT_EQ(lights[1].range_m, 7);
  EXPECT_FLOAT_EQ(lights[1].inner_cone_rad, kPi / 6);
  EXPECT_FLOAT_EQ(lights[1].outer_cone_rad, kPi / 3);
  EXPECT_EQ(lights[2].kind, Kind::directional);
  EXPECT_FLOAT_EQ(lights[2].direction.x, 0.6f);
  EXPECT_FLOAT_EQ(lights[2].direction.y, -0.8f);
}

TEST(LightScript, ReadsWhatGlows) {
  const LightScript script = script_of(R"({"emission": [
    {"material": "lamp", "radiance": [10, 9, 8]},
    {"material": "sign", "radiance": [{"at": 0, "value": [0, 0, 0]},
                                      {"at": 2, "value": [2, 4, 6]}]}]})");
  ASSERT_EQ(script.glows.size(), 2u);
  EXPECT_EQ(script.glows[0].material, "lamp");
  EXPECT_EQ(value_at(script.glows[0].radiance, 5), (Rgb{10, 9, 8}));
  EXPECT_EQ(script.glows[1].material, "sign");
  EXPECT_EQ(value_at(script.glows[1].radiance, 1), (Rgb{1, 2, 3}));
}

TEST(Tracks, AreLinearBetweenKeysAndConstantOutside) {
  const Track track = track_of({{1, {0, 4, 8}}, {2, {2, 4, 0}}, {4, {2, 0, 0}}});
  for (const auto& [time_s, want] : {std::pair{-9.0, Vec3{0, 4, 8}},
                                     {1.0, {0, 4, 8}},
                                     {1.25, {0.5f, 4, 6}},
                                     {1.5, {1, 4, 4}},
                                     {2.0, {2, 4, 0}},
                                     {3.0, {2, 2, 0}},
                                     {4.0, {2, 0, 0}},
                                     {1e9, {2, 0, 0}}})
    EXPECT_EQ(value_at(track, time_s), want) << time_s;
  for (const double time_s : {-1.0, 0.0, 7.0})
    EXPECT_EQ(value_at(track_of({{0, {1, 2, 3}}}), time_s), (Vec3{1, 2, 3}));
}

TEST(Tracks, MoveLightsAndTurnThem) {
  const LightScript script = script_of(R"({"lights": [{"kind": "spot",
    "position": [{"at": 0, "value": [0, 0, 0]}, {"at": 1, "value": [8, 0, -4]}],
    "direction": [{"at": 0, "value": [1, 0, 0]}, {"at": 1, "value": [0, -1, 0]},
                  {"at": 2, "value": [0, 1, 0]}],
    "intensity": [{"at": -1, "value": [0, 0, 0]}, {"at": 1, "value": [2, 2, 2]}]}]})");
  const auto early = lights_at(script, 0.5), late = lights_at(script, 1.5);
  EXPECT_EQ(early[0].position, (Vec3{4, 0, -2}));
  EXPECT_EQ(early[0].intensity, (Rgb{1.5f, 1.5f, 1.5f}));
  // Half way between two directions, and of unit length.
  EXPECT_FLOAT_EQ(early[0].direction.x, std::sqrt(0.5f));
  EXPECT_FLOAT_EQ(early[0].direction.y, -std::sqrt(0.5f));
  // Half way between opposite ones there is no direction.
  EXPECT_FLOAT_EQ(length(late[0].direction), 1);
}

/// A script with a mistake, and the place and words that the message must hold.
struct Wrong {
  std::string text, where, what;
};

void expect_refused(const std::vector<Wrong>& cases) {
  for (const Wrong& w : cases)
    EXPECT_THAT(error_of(w.text), AllOf(HasSubstr("moves.json" + w.where), HasSubstr(w.what)))
        << w.text;
}

TEST(LightScript, RefusesWhatIsNoScript) {
  expect_refused({{"", "", "it is not JSON"},
                  {"{\"frames\": 3", "", "it is not JSON"},
                  {"{\"frames\": 1e999}", "", "it is not JSON"},
                  {"[1, 2]", " is [1,2]", "it should be an object"},
                  {"3", " is 3", "it should be an object"},
                  {R"({"lamps": []})", "", "'lamps' is not known; choose from: frames, "}});
}

TEST(LightScript, RefusesWrongPictures) {
  expect_refused(
      {{R"({"frames": 0})", ".frames is 0", "a whole number from 1 to"},
       {R"({"frames": "many"})", ".frames is \"many\"", "a whole number from 1 to"},
       {R"({"frames": 2.5})", ".frames is 2.5", "a whole number"},
       {R"({"frames": 1000000})", ".frames is 1000000", "to 100000"},
       {R"({"frames_per_second": 0})", ".frames_per_second is 0", "a number from"},
       {R"({"size": 100})", ".size is 100", "[width, height]"},
       {R"({"size": [100, 100, 3]})", ".size is", "[width, height]"},
       {R"({"size": [100, 0]})", ".size[1] is 0", "a whole number from 1"},
       {R"({"size": [9000, 10]})", ".size[0] is 9000", "to 8192"},
       {R"({"size": [64, 48.5]})", ".size[1] is 48.5", "a whole number"},
       {R"({"exposure": "bright"})", ".exposure is \"bright\"", "\"auto\" or a number of stops"},
       {R"({"exposure": [1]})", ".exposure is [1]", "\"auto\" or a number of stops"},
       {R"({"keep_lights": 1})", ".keep_lights is 1", "true or false"},
       {R"({"background": [1, -1, 0]})", ".background is", "never negative"},
       {R"({"background": 1})", ".background is 1", "three numbers"}});
}

TEST(LightScript, RefusesWrongCameras) {
  expect_refused(
      {{R"({"camera": 1})", ".camera is 1", "a camera's name, or {"},
       {R"({"camera": {"eye": [0, 0, 1]}})", ".camera is", "a camera's name, or {"},
       {R"({"camera": {"eye": [0, 0, 1], "look_at": [0, 0]}})", ".camera.look_at", "three numbers"},
       {R"({"camera": {"eye": [1, 2, 3], "look_at": [1, 2, 3]}})", ".camera", "looks somewhere"},
       {R"({"camera": {"eye": [0, 0, 1], "look_at": [0, 0, 0], "fov_deg": 180}})",
        ".camera.fov_deg is 180", "from 1 to 170"},
       {R"({"camera": {"eye": [0, 0, 1], "look_at": [0, 0, 0], "roll": 1}})", ".camera",
        "'roll' is not known; choose from: eye, look_at, fov_deg"}});
}

TEST(LightScript, RefusesWrongLights) {
  const auto lights = [](const std::string& fields) { return "{\"lights\": [" + fields + "]}"; };
  expect_refused(
      {{R"({"lights": {}})", ".lights is {}", "a list"},
       {lights("3"), ".lights[0] is 3", "a light, as {"},
       {lights(R"({"kind": "area"})"), ".lights[0].kind is \"area\"", "\"point\", \"spot\" or"},
       {lights("{}"), ".lights[0]", "needs a position"},
       {lights(R"({"position": [0, 0, 0]}, {"kind": "spot"})"), ".lights[1]", "needs a position"},
       {lights(R"({"kind": "spot", "position": [0, 0, 0]})"), ".lights[0]", "needs a direction"},
       {lights(R"({"kind": "directional"})"), ".lights[0]", "needs a direction"},
       {lights(R"({"kind": "directional", "direction": [0, 1, 0], "position": [0, 0, 0]})"),
        ".lights[0]", "has no position"},
       {lights(R"({"position": [0, 0, 0], "direction": [0, 1, 0]})"), ".lights[0]",
        "has no direction"},
       {lights(R"({"kind": "directional", "direction": [0, 0, 0]})"), ".lights[0].direction",
        "not 0, 0, 0"},
       {lights(R"({"position": [0, 0, 0], "intensity": [1, 1, 1e31]})"), ".lights[0].intensity",
        "light of at most 1e+30"},
       {lights(R"({"position": [0, 1e19, 0]})"), ".lights[0].position",
        "a place with coordinates up to 1e+18 m"},
       {lights(R"({"position": [0, 0, 0], "intensity": [1, 1, -0.5]})"), ".lights[0].intensity",
        "never negative"},
       {lights(R"({"position": [0, 0, 0], "range_m": -1})"), ".lights[0].range_m is -1", "from 0"},
       {lights(R"({"position": [0, 0, 0], "outer_cone_deg": 91})"), ".lights[0].outer_cone_deg",
        "to 90"},
       {lights(R"({"position": [0, 0, 0], "inner_cone_deg": 46})"), ".lights[0].inner_cone_deg",
        "to 45"},
       {lights(R"({"position": [0, 0, 0], "colour": [1, 1, 1]})"), ".lights[0]",
        "'colour' is not known; choose from: kind, intensity, "}});
}

TEST(LightScript, RefusesWrongTracks) {
  const auto at = [](const std::string& value) {
    return R"({"lights": [{"position": )" + value + "}]}";
  };
  const std::string where = ".lights[0].position";
  expect_refused(
      {{at("[1, 2]"), where + " is [1,2]", "three numbers"},
       {at("[1, 2, \"3\"]"), where, "three numbers"},
       {at("[1, 2, 1e39]"), where, "three numbers"},
       {at("[]"), where + " is []", "three numbers"},
       {at("{\"at\": 0, \"value\": [0, 0, 0]}"), where, "three numbers"},
       {at("[{\"at\": 0}]"), where + "[0]", "a key, as {"},
       {at("[{\"at\": 0, \"value\": [0, 0, 0]}, 7]"), where + "[1] is 7", "a key, as {"},
       {at("[{\"at\": \"now\", \"value\": [0, 0, 0]}]"), where + "[0].at is \"now\"", "a number"},
       {at("[{\"at\": 0, \"value\": [0, 0]}]"), where + "[0].value", "three numbers"},
       {at("[{\"at\": 0, \"value\": [0, 0, 0], \"ease\": 1}]"), where + "[0]",
        "'ease' is not known; choose from: at, value"},
       {at("[{\"at\": 1, \"value\": [0, 0, 0]}, {\"at\": 1, \"value\": [1, 1, 1]}]"),
        where + "[1].at is 1", "later than the key before it"},
       {at("[{\"at\": 1, \"value\": [0, 0, 0]}, {\"at\": 0.5, \"value\": [1, 1, 1]}]"),
        where + "[1].at is 0.5", "later than the key before it"}});
}

void expect_same(const Track& a, const Track& b) {
  ASSERT_EQ(a.keys.size(), b.keys.size());
  for (size_t k = 0; k < a.keys.size(); ++k) {
    EXPECT_EQ(a.keys[k].at_s, b.keys[k].at_s);
    EXPECT_EQ(a.keys[k].value, b.keys[k].value);
  }
}

TEST(LightScript, IsReadAsItWasWritten) {
  const LightScript script = script_of(R"({"frames": 3, "frames_per_second": 0.1,
    "size": [320, 200], "exposure": -1.3, "keep_lights": true, "background": [0.1, 1e-7, 2],
    "camera": {"eye": [0.1, 2, 3], "look_at": [4, 0.7, 6], "fov_deg": 33.3},
    "lights": [
      {"kind": "spot", "position": [{"at": 0.1, "value": [0.1, 0.2, 0.3]},
                                    {"at": 0.7, "value": [1, 2e5, 3]}],
       "direction": [0, 0, 1], "intensity": [0.07, 1e9, 0], "range_m": 0.3,
       "inner_cone_deg": 10, "outer_cone_deg": 90},
      {"kind": "directional", "direction": [0, -1, 0], "intensity": [0.3, 0.2, 0.1]},
      {"kind": "point", "position": [1, 2, 3]}],
    "emission": [{"material": "a \"lamp\"", "radiance": [1.1, 2.2, 3.3]}]})");
  const LightScript again = script_of(text_of(script));
  EXPECT_EQ(again.frames, 3);
  EXPECT_EQ(again.frames_per_second, 0.1);
  EXPECT_EQ(again.width, 320);
  EXPECT_EQ(again.height, 200);
  EXPECT_FALSE(again.exposure.automatic);
  EXPECT_EQ(again.exposure.stops, -1.3);
  EXPECT_TRUE(again.keep_lights);
  ASSERT_TRUE(again.background);
  expect_same(*again.background, *script.background);
  const auto& view = std::get<LightScript::View>(again.camera);
  EXPECT_EQ(view.eye, (Vec3{0.1f, 2, 3}));
  EXPECT_EQ(view.look_at, (Vec3{4, 0.7f, 6}));
  EXPECT_EQ(view.fov_deg, 33.3);
  ASSERT_EQ(again.lights.size(), 3u);
  for (size_t k = 0; k < 3; ++k) {
    const LightScript::MovingLight &a = again.lights[k], &b = script.lights[k];
    EXPECT_EQ(a.light.kind, b.light.kind);
    EXPECT_EQ(a.light.range_m, b.light.range_m);
    EXPECT_NEAR(a.light.inner_cone_rad, b.light.inner_cone_rad, 1e-6);
    EXPECT_NEAR(a.light.outer_cone_rad, b.light.outer_cone_rad, 1e-6);
    expect_same(a.intensity, b.intensity);
    expect_same(a.position, b.position);
    expect_same(a.direction, b.direction);
  }
  ASSERT_EQ(again.glows.size(), 1u);
  EXPECT_EQ(again.glows[0].material, "a \"lamp\"");
  expect_same(again.glows[0].radiance, script.glows[0].radiance);
  for (const char* exposure : {"\"auto\"", "\"auto:95\""}) {
    const Exposure read = script_of(std::string("{\"exposure\": ") + exposure + "}").exposure;
    LightScript other;
    other.exposure = read;
    EXPECT_EQ(script_of(text_of(other)).exposure.percentile, read.percentile);
    EXPECT_TRUE(script_of(text_of(other)).exposure.automatic);
  }
  LightScript named;
  named.camera = "door";
  EXPECT_EQ(std::get<std::string>(script_of(text_of(named)).camera), "door");
}

// In survey coordinates, where single precision has steps of half a metre.
TEST(LightScript, PlacesAreThoseOfTheFile) {
  constexpr DVec3 kOrigin{512344, 88, -5403216};
  const std::string text = R"({"camera": {"eye": [512345.5, 89.625, -5403210.125],
      "look_at": [512340, 88, -5403216.1]},
    "lights": [{"position": [{"at": 0, "value": [512345.678, 87.5, -5403210.123]},
                             {"at": 2, "value": [512344, 88, -5403216]}]},
               {"kind": "spot", "position": [512346.3, 90, -5403215], "direction": [0, -1, 0],
                "intensity": [512344, 88, 1]}]})";
  auto script = parse_light_script(text, "moves.json", kOrigin);
  ASSERT_TRUE(script) << script.error().message;
  for (int again = 0; again < 2; ++again) {
    const auto& view = std::get<LightScript::View>(script->camera);
    EXPECT_EQ(view.eye, (Vec3{1.5f, 1.625f, 5.875f}));
    EXPECT_EQ(view.look_at, (Vec3{-4, 0, -0.1f}));
    ASSERT_EQ(script->lights.size(), 2u);
    EXPECT_EQ(script->lights[0].position.keys[0].value, (Vec3{1.678f, -0.5f, 5.877f}));
    EXPECT_EQ(script->lights[0].position.keys[1].value, (Vec3{}));
    EXPECT_EQ(script->lights[1].position.keys[0].value, (Vec3{2.3f, 2, 1}));
    EXPECT_EQ(script->lights[1].direction.keys[0].value, (Vec3{0, -1, 0}));
    EXPECT_EQ(script->lights[1].intensity.keys[0].value, (Vec3{512344, 88, 1}));
    const std::string written = text_of(*script, kOrigin);
    for (const char* number : {"512345.678", "-5403210.123", "-5403216.1", "512346.3"})
      EXPECT_THAT(written, HasSubstr(number));
    script = parse_light_script(written, "again.json", kOrigin);
    ASSERT_TRUE(script) << script.error().message;
  }
}

TEST(LightScript, RefusesWrongGlows) {
  expect_refused({{R"({"emission": 1})", ".emission is 1", "a list"},
                  {R"({"emission": [1]})", ".emission[0] is 1", "a glowing material, as {"},
                  {R"({"emission": [{"material": "lamp"}]})", ".emission[0]", "a glowing material"},
                  {R"({"emission": [{"material": 1, "radiance": [1, 1, 1]}]})", ".emission[0]",
                   "a glowing material"},
                  {R"({"emission": [{"material": "lamp", "radiance": [1, 1, 1e16]}]})",
                   ".emission[0].radiance", "light of at most 1e+15"},
                  {R"({"emission": [{"material": "lamp", "radiance": [-1, 1, 1]}]})",
                   ".emission[0].radiance", "never negative"},
                  {R"({"emission": [{"material": "lamp", "radiance": [1, 1, 1], "on": 1}]})",
                   ".emission[0]", "'on' is not known; choose from: material, radiance"}});
}

TEST(LightScript, DeepNestingIsAnErrorToo) {
  const std::string deep(200000, '['), end(200000, ']');
  EXPECT_THAT(error_of("{\"size\": " + deep + end + "}"), HasSubstr("moves.json"));
}

}  // namespace
}  // namespace luxel::pipeline
