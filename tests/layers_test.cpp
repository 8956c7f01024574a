// --layers: a lightmap of each light.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "luxel/export/baked_glb.h"
#include "luxel/scene/procedural.h"
#include "luxel/scene/shapes.h"
#include "tests/command.h"
#include "tests/pictures.h"

namespace luxel::testing_support {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

/// The Cornell box with two lamps without area besides its own.
fs::path write_box(const ScratchFolder& s, const std::string& name, bool left, bool right) {
  scene::Scene box = scene::cornell_box();
  const Box3 bounds = scene::world_bounds(box);
  const Vec3 size = bounds.upper - bounds.lower;
  for (const bool is_left : {true, false}) {
    if (!(is_left ? left : right)) continue;
    scene::PunctualLight lamp;
    lamp.name = is_left ? "lamp.001" : "lamp.002";
    lamp.position =
        bounds.lower + Vec3{size.x * (is_left ? 0.2f : 0.8f), size.y * 0.8f, size.z * 0.6f};
    lamp.intensity = is_left ? Rgb{0.3f, 0.1f, 0} : Rgb{0, 0.1f, 0.3f};
    box.lights.push_back(lamp);
  }
  if (!left || !right)
    for (scene::Material& m : box.materials) m.emission = {};
  const auto glb = export_::scene_glb(box);
  EXPECT_TRUE(glb && write_file_atomically(s.path / name, *glb));
  return s.path / name;
}

nlohmann::json bake(const fs::path& scene, const fs::path& output, const std::string& options) {
  const CommandResult r =
      luxel("bake " + scene.string() + " -o " + output.string() + " --json " + options);
  EXPECT_EQ(r.code, 0) << r.err;
  return r.code == 0 ? nlohmann::json::parse(r.out) : nlohmann::json();
}

double mean_of_layer(const image::Image& light) {
  double sum = 0;
  int covered = 0;
  for (int y = 0; y < light.height; ++y)
    for (int x = 0; x < light.width; ++x)
      if (light.at(x, y)[3] > 0) sum += double(luminance(light.rgb(x, y))), ++covered;
  return sum / covered;
}

/// The largest difference of the sum of layers to the whole, relative to the value or the mean.
double sum_error(const fs::path& folder, const nlohmann::json& json, size_t page) {
  const auto file_of = [&](const nlohmann::json& files) {
    return folder / files[page].get<std::string>();
  };
  const image::Image whole =
      exr_at(folder / json["atlas"]["pages"][page]["file"].get<std::string>());
  image::Image sum(whole.width, whole.height, 4);
  for (const nlohmann::json& layer : json["layers"]) {
    const image::Image own = exr_at(file_of(layer["files"]));
    EXPECT_EQ(own.data.size(), sum.data.size());
    for (int y = 0; y < sum.height; ++y)
      for (int x = 0; x < sum.width; ++x) {
        EXPECT_EQ(own.at(x, y)[3], whole.at(x, y)[3]);
        sum.set_rgb(x, y, sum.rgb(x, y) + own.rgb(x, y));
      }
  }
  const double mean = mean_of_layer(whole);
  double largest = 0;
  for (int y = 0; y < sum.height; ++y)
    for (int x = 0; x < sum.width; ++x)
      for (int c = 0; c < 3; ++c) {
        const double a = double(sum.rgb(x, y)[c]), b = double(whole.rgb(x, y)[c]);
        largest = std::max(largest, std::abs(a - b) / std::max(b, mean));
      }
  return largest;
}

// Sums of a few floats: 1e-4 is asked for, rounding is what is left. Hidden texels refilled, seams
// stitched, gutters dilated and several pages are in it.
TEST(Layers, AddUpToTheLightmap) {
  const ScratchFolder s;
  const fs::path scene = write_box(s, "box.glb", true, true);
  const std::string options = " --samples 64 --uv unwrap --background 0.1,0.2,0.3 ";
  const auto one = bake(scene, s.path / "a", "--layers per-light --resolution 96" + options);
  ASSERT_EQ(one["layers"].size(), 4u);
  EXPECT_THAT(one["layers"][0]["files"], ElementsAre("lightmap-lamp.001.exr"));
  EXPECT_THAT(one["layers"][3]["lights"], ElementsAre("sky"));
  EXPECT_LT(sum_error(s.path / "a", one, 0), 1e-5);
  double share = 0;
  for (const nlohmann::json& layer : one["layers"]) share += layer["share"].get<double>();
  EXPECT_NEAR(share, 1, 1e-6);

  const auto two = bake(scene, s.path / "b",
                        "--layers groups --resolution 64 --pages 2 --formats hdr" + options);
  ASSERT_EQ(two["layers"].size(), 3u);
  EXPECT_THAT(two["layers"][0]["lights"], ElementsAre("lamp.001", "lamp.002"));
  EXPECT_THAT(two["layers"][0]["files"], ElementsAre("lightmap-lamp-0.exr", "lightmap-lamp-0.hdr",
                                                     "lightmap-lamp-1.exr", "lightmap-lamp-1.hdr"));
  for (const nlohmann::json& layer : two["layers"])
    for (const nlohmann::json& file : layer["files"])
      EXPECT_TRUE(fs::exists(s.path / "b" / file.get<std::string>())) << file;
}

// The lightmap itself has the same bits with layers and without. A default bake adds rays here.
TEST(Layers, LeaveTheLightmapAsItIs) {
  const ScratchFolder s;
  const fs::path scene = write_box(s, "box.glb", true, true);
  for (const std::string options : {"--samples 32 --resolution 64 ", "--resolution 64 "}) {
    bake(scene, s.path / "a", options);
    bake(scene, s.path / "b", options + "--layers per-light");
    EXPECT_EQ(slurp(s.path / "a" / "lightmap.exr"), slurp(s.path / "b" / "lightmap.exr"));
  }
}

/// Root mean square difference of luminance.
double rms_between(const image::Image& a, const image::Image& b) {
  double sum2 = 0;
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x) {
      const double d = double(luminance(a.rgb(x, y)) - luminance(b.rgb(x, y)));
      sum2 += d * d;
    }
  return std::sqrt(sum2 / double(a.width * a.height));
}

// By few rays most of the error is noise. Each layer loses it as all light does, and they still add
// up to that.
TEST(Layers, AreDenoisedEach) {
  const ScratchFolder s;
  const fs::path scene = write_box(s, "box.glb", true, true);
  const std::string options = "--layers per-light --resolution 64 --no-stitch ";
  bake(scene, s.path / "true", options + "--samples 1024");
  bake(scene, s.path / "raw", options + "--samples 16");
  const auto json = bake(scene, s.path / "clean", options + "--samples 16 --denoise");
  EXPECT_LT(sum_error(s.path / "clean", json, 0), 1e-5);
  ASSERT_EQ(json["layers"].size(), 3u);
  for (const nlohmann::json& layer : json["layers"]) {
    const std::string file = layer["files"][0];
    const image::Image truth = exr_at(s.path / "true" / file);
    const double raw = rms_between(exr_at(s.path / "raw" / file), truth);
    EXPECT_LT(rms_between(exr_at(s.path / "clean" / file), truth), 0.7 * raw) << file;
  }
}

// A lamp without area is sampled alike whether others shine or not: its layer is the lightmap of a
// bake in which it is alone, but for the noise of the layers' sparse sweeps and seams weighed by
// another whole. The mean knows nothing of seams, and of noise little.
TEST(Layers, AreWhatEachLampAloneGives) {
  const ScratchFolder s;
  const std::string options = "--samples 256 --resolution 96 --no-stitch ";
  const auto both =
      bake(write_box(s, "both.glb", true, true), s.path / "both", options + "--layers per-light");
  bake(write_box(s, "left.glb", true, false), s.path / "left", options);
  const image::Image layer = exr_at(s.path / "both" / "lightmap-lamp.001.exr");
  const image::Image alone = exr_at(s.path / "left" / "lightmap.exr");
  const double mean = mean_of_layer(alone);
  EXPECT_NEAR(mean_of_layer(layer), mean, 2e-3 * mean);
  EXPECT_LT(rms_between(layer, alone), 1e-2 * mean);
}

TEST(Layers, BakedGlbNamesThem) {
  const ScratchFolder s;
  bake(write_box(s, "box.glb", true, true), s.path / "a",
       "--layers per-light --resolution 64 --samples 16");
  const std::string glb = slurp(s.path / "a" / "baked.glb");
  uint32_t length = 0;
  std::memcpy(&length, glb.data() + 12, sizeof length);
  const auto json = nlohmann::json::parse(glb.substr(20, length));
  const auto& layers = json["asset"]["extras"]["luxel"]["layers"];
  ASSERT_EQ(layers.size(), 3u);
  EXPECT_EQ(layers[1]["name"], "lamp.002");
  for (const auto& layer : layers) {
    ASSERT_EQ(layer["textures"].size(), 1u);
    const auto& texture = json["textures"][layer["textures"][0].get<size_t>()];
    EXPECT_EQ(json["images"][texture["source"].get<size_t>()]["name"],
              "lightmap-" + layer["name"].get<std::string>());
    EXPECT_GT(layer["intensity"], 0);
  }
  size_t shining = 0;
  for (const auto& node : json["nodes"])
    if (node.contains("/extras/luxel/layer"_json_pointer)) {
      EXPECT_EQ(node["extras"]["luxel"]["layer"], layers[2]["name"]);
      ++shining;
    }
  EXPECT_EQ(shining, 1u);
}

TEST(Layers, AreRefusedInASentence) {
  const ScratchFolder s;
  const std::string start =
      "bake " + scene_file("cornell-box.glb") + " -o " + (s.path / "x").string() + " --layers ";
  for (const auto& [options, sentence] :
       {std::pair{"every", "--layers every is not known; choose from: per-light, groups"},
        {"groups --solver matrix", "--solver matrix does not use --layers"},
        {"groups --directional sh1", "cannot be combined with --directional"},
        {"per-light --probes 1", "cannot be combined with --probes"}}) {
    const CommandResult r = luxel(start + options);
    EXPECT_EQ(r.code, 1) << options;
    EXPECT_THAT(r.err, HasSubstr(sentence));
  }
  EXPECT_FALSE(fs::exists(s.path / "x"));
}

}  // namespace
}  // namespace luxel::testing_support
