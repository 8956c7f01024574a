// A browser's pictures of a bake, held against preview.png: Chromium and WebGL share no line with
// luxel/display/draw.cpp.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "luxel/base/file.h"
#include "luxel/export/baked_glb.h"
#include "luxel/image/codec.h"
#include "luxel/image/color.h"
#include "luxel/scene/procedural.h"
#include "luxel/scene/shapes.h"
#include "tests/command.h"

namespace luxel::testing_support {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

bool has_command(const char* name) {
  return std::system((std::string("command -v ") + name + " >/dev/null 2>&1").c_str()) == 0;
}

/// A sentence on what is missing for drawing pages; empty: nothing.
std::string missing_browser() {
  if (!has_command("node")) return "node is not installed";
  if (!has_command("${CHROMIUM:-chromium}")) return "chromium is not installed";
  return {};
}

image::Image8 picture_of(const std::filesystem::path& file) {
  const auto bytes = read_file(file);
  EXPECT_TRUE(bytes) << file;
  const auto picture = image::decode_ldr(*bytes, file.string());
  EXPECT_TRUE(picture) << file;
  return *picture;
}

struct Shot {
  image::Image8 picture;
  nlohmann::json page;  ///< what tools/screenshot.mjs says
};

/// A page to draw as large as a picture.
struct Page {
  std::string url;
  image::Image8 like;
};

/// Pages as one Chromium draws them, whose start takes longer than a page.
std::vector<Shot> shoot(const std::vector<Page>& pages, const std::string& options = "") {
  const ScratchFolder s;
  const auto file = [&](size_t k) { return s.path / ("shot" + std::to_string(k) + ".png"); };
  std::string command = "node " LUXEL_SOURCE_DIR "/tools/screenshot.mjs " + options;
  for (size_t k = 0; k < pages.size(); ++k)
    command += " --size " + std::to_string(pages[k].like.width) + "x" +
               std::to_string(pages[k].like.height) + " '" + pages[k].url + "' " + file(k).string();
  command += " >" + (s.path / "out").string() + " 2>" + (s.path / "err").string();
  EXPECT_EQ(std::system(command.c_str()), 0) << command << "\n"
                                             << slurp(s.path / "out") << slurp(s.path / "err");
  std::istringstream lines(slurp(s.path / "out"));
  std::vector<Shot> shots;
  for (std::string line; std::getline(lines, line);)
    shots.push_back({picture_of(file(shots.size())), nlohmann::json::parse(line)});
  EXPECT_EQ(shots.size(), pages.size());
  shots.resize(pages.size());
  return shots;
}

/// Differences of two pictures of 4 channels, alpha aside, over the pixels that `counts` accepts.
struct Difference {
  double mean = 0, bias = 0;  ///< of the channels' differences, in 255ths; bias with its sign
  double share_beyond = 0;    ///< of pixels with a channel more than `step` away
  double pixels = 0;
};
template <class Counts>
Difference difference(const image::Image8& a, const image::Image8& b, int step, Counts counts) {
  Difference d;
  EXPECT_EQ(a.data.size(), b.data.size());
  for (size_t i = 0; i + 3 < std::min(a.data.size(), b.data.size()); i += 4) {
    if (!counts(&b.data[i])) continue;
    int worst = 0;
    for (size_t c = 0; c < 3; ++c) {
      const int delta = int(a.data[i + c]) - int(b.data[i + c]);
      d.mean += std::abs(delta), d.bias += delta;
      worst = std::max(worst, std::abs(delta));
    }
    d.share_beyond += worst > step ? 1 : 0;
    ++d.pixels;
  }
  d.mean /= 3 * d.pixels, d.bias /= 3 * d.pixels, d.share_beyond /= d.pixels;
  return d;
}
bool every_pixel(const uint8_t*) { return true; }

void expect_same(const Difference& d, const char* what) {
  std::printf("%s: mean %.3f, bias %.3f, %.3f %% beyond\n", what, d.mean, d.bias,
              100 * d.share_beyond);
  EXPECT_LT(d.mean, 0.5) << what;
  EXPECT_LT(std::abs(d.bias), 0.3) << what;
  EXPECT_LT(d.share_beyond, 0.02) << what;
}

/// A unit square in the plane of `x` and `y`, its front towards x cross y, cut into two triangles.
void add_square(scene::Scene& scene, Vec3 corner, Vec3 x, Vec3 y, scene::Material material,
                bool colored = false) {
  scene::Mesh mesh;
  mesh.positions = {{}, x, x + y, y};
  mesh.uv0 = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  if (colored) mesh.colors = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.triangle_material.assign(2, uint32_t(scene.materials.size()));
  scene.materials.push_back(std::move(material));
  scene.instances.push_back({"square", uint32_t(scene.meshes.size()), translation(corner)});
  scene.meshes.push_back(std::move(mesh));
}

/// Squares on a wall under a white sky, one for each thing that a material can say.
scene::Scene one_of_each() {
  scene::Scene scene;
  scene.background = {0.4f, 0.6f, 1};
  scene::Texture texture;
  texture.width = texture.height = 4;
  for (int i = 0; i < 16; ++i)
    for (const int v : {16 * i, 255 - 12 * i, i % 3 * 100, i % 2 ? 255 : 40})
      texture.rgba.push_back(uint8_t(v));
  scene.textures.push_back(texture);
  scene::TextureRef look;
  look.texture = 0;
  const Vec3 x{1, 0, 0}, y{0, 1, 0};
  const auto place = [](int i, int j) { return Vec3{1.2f * float(i), 1.2f * float(j), 0}; };
  scene::Material plain;
  plain.base_color = {0.7f, 0.5f, 0.3f};
  add_square(scene, {-1, -1, -0.5f}, x * 6, y * 5, plain);
  scene::Material textured = plain;
  textured.base_color_texture = look;
  add_square(scene, place(0, 0), x, y, textured);
  scene::Material turned = textured;
  turned.base_color_texture.rotation = 0.7f;
  turned.base_color_texture.scale = {2, 0.5f};
  turned.base_color_texture.offset = {0.3f, 0.1f};
  turned.base_color_texture.wrap_u = scene::Wrap::mirror;
  add_square(scene, place(1, 0), x, y, turned, true);
  scene::Material masked = textured;
  masked.alpha_mode = scene::AlphaMode::mask;
  masked.base_color_texture.filter = scene::Filter::nearest;
  masked.double_sided = true;
  add_square(scene, place(2, 0) + x, -x, y, masked);  // seen from behind
  scene.meshes.back().alphas = {1, 1, 0, 0};          // the upper half is cut off
  scene::Material metal = plain;
  metal.metallic = 0.8f;
  metal.metallic_texture = look;
  add_square(scene, place(0, 1), x, y, metal);
  scene::Material lamp = plain;
  lamp.emission = {1.5f, 0.2f, 0.1f};
  lamp.emission_texture = look;
  add_square(scene, place(1, 1), x, y, lamp);
  scene::Material unlit = plain;
  unlit.unlit = true;
  unlit.base_color = {1, 1, 1};  // and over 0.99
  add_square(scene, place(2, 1), x, y, unlit);
  add_square(scene, place(0, 2) + x, -x, y, plain);  // one-sided, seen from behind: not there
  add_square(scene, place(1, 2) + x, x, y, textured);
  scene.instances.back().world_from_object =  // mirrored: its front stays in front
      translation(place(1, 2) + x) * scaling({-1, 1, 1});
  scene::Camera camera;
  camera.world_from_camera = translation({2, 1.6f, 6});
  camera.fov_y_rad = 0.7f;
  scene.cameras.push_back(camera);
  return scene;
}

/// A copy of a page as it would be if a name could become markup.
std::string with_a_script(const std::filesystem::path& page) {
  std::string html = slurp(page);
  html.insert(html.find("<body>") + 6,
              "<script>console.log('the script ran')</script><p style='display:none' hidden></p>");
  const std::filesystem::path copy = page.parent_path() / ("script-" + page.filename().string());
  std::ofstream(copy, std::ios::binary) << html;
  return copy.string();
}

class ViewHtml : public ::testing::Test {
 protected:
  void SetUp() override {
    if (const std::string missing = missing_browser(); !missing.empty()) GTEST_SKIP() << missing;
  }
  /// Bakes into `folder`; false, and the test is skipped, in a luxel without the page.
  bool bake(const std::string& scene, const std::filesystem::path& folder,
            const std::string& options) {
    const CommandResult r =
        luxel("bake " + scene + " -o " + folder.string() + " --html " + options);
    if (r.code != 0 && r.err.find("this luxel has no --html") != std::string::npos) {
      [&] { GTEST_SKIP() << r.err; }();
      return false;
    }
    EXPECT_EQ(r.code, 0) << r.err;
    return r.code == 0;
  }
  /// The page of a bake, which is to be like its preview.
  static Page page_of(const std::filesystem::path& folder) {
    return {(folder / "view.html").string() + "#bare", picture_of(folder / "preview.png")};
  }
};

// One step of 8 bits comes from rounding, others from where a card puts a texel's weights (8 bits
// of fraction) and from rims of charts, where the preview leaves out the gutter that a card looks
// up. Silhouettes are drawn with other samples: 4 a pixel here, 9 there, and averaged after the
// tone curve, not before. On 720 x 720 pixels the edges of a box and its furniture, about 5000
// pixels long and a pixel or two wide, are under 2 %.
TEST_F(ViewHtml, ShowsWhatThePreviewShows) {
  const ScratchFolder s;
  const std::vector<std::string> names{"cornell-box.glb", "spheres-and-cube.glb"};
  std::vector<Page> pages;
  for (const std::string& name : names) {
    if (!bake(scene_file(name), s.path / name, "--resolution 256 --samples 32")) return;
    pages.push_back(page_of(s.path / name));
  }
  // The report of `luxel compare`, and both pages with a script and a style of somebody else's.
  const std::filesystem::path box = s.path / names[0];
  ASSERT_EQ(
      luxel("compare " + box.string() + " " + box.string() + " --quiet --report " + box.string())
          .code,
      0);
  pages.push_back({(box / "report.html").string(), pages[0].like});
  pages.push_back({with_a_script(box / "report.html"), pages[0].like});
  pages.push_back({with_a_script(box / "view.html") + "#bare", pages[0].like});
  const std::vector<Shot> shots = shoot(pages);
  for (size_t k = 0; k < names.size(); ++k)
    expect_same(difference(shots[k].picture, pages[k].like, 3, every_pixel), names[k].c_str());
  EXPECT_EQ(shots[4].picture.data, shots[0].picture.data) << "works as before";
  for (size_t k = 0; k < shots.size(); ++k) {
    const Shot& shot = shots[k];
    EXPECT_EQ(shot.page["requests"], nlohmann::json::array()) << "the page fetched something";
    const std::string said = shot.page["messages"].dump();
    EXPECT_THAT(said, Not(HasSubstr("the script ran")));
    if (k < 3) {
      EXPECT_THAT(said, Not(HasSubstr("Content Security Policy"))) << pages[k].url;
    } else {
      EXPECT_THAT(said, AllOf(HasSubstr("script-src"), HasSubstr("style-src"),
                              HasSubstr("Content Security Policy")))
          << pages[k].url;
    }
  }
}

// Three squares that share the meshes out, and one for each mesh: every texel must be looked up on
// its own page.
TEST_F(ViewHtml, ShowsEveryPage) {
  const ScratchFolder s;
  std::vector<Page> shown;
  for (const char* pages : {"--resolution 128 --pages 3", "--resolution 64 --pages mesh"}) {
    const std::filesystem::path folder = s.path / std::to_string(shown.size());
    if (!bake(scene_file("spheres-and-cube.glb"), folder,
              std::string("--samples 32 --uv unwrap ") + pages))
      return;
    shown.push_back(page_of(folder));
  }
  const std::vector<Shot> shots = shoot(shown);
  for (size_t k = 0; k < shots.size(); ++k)
    expect_same(difference(shots[k].picture, shown[k].like, 3, every_pixel),
                k == 0 ? "three pages" : "a page for each mesh");
}

/// Smooth all around, another colour in every direction, `width` pixels wide.
std::vector<std::byte> colourful_map(int width) {
  image::Image map(width, width / 2, 3);
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x) {
      const float phi = 2 * kPi * (float(x) + 0.5f) / float(map.width);
      const float theta = kPi * (float(y) + 0.5f) / float(map.height);
      const float s = std::sin(theta);
      map.set_rgb(x, y, {1 + s * std::cos(phi), 1.2f + std::cos(theta), 1 + s * std::sin(3 * phi)});
    }
  return image::encode_hdr(map);
}

// The map as it is (16 pixels around: the picture shows three of them, blended), turned and scaled;
// one that the page carries smaller, which is as smooth as before; with a background's radiance
// before it; a sky, whose lower half is the ground; and parallel rays, which all see the same.
TEST_F(ViewHtml, ShowsTheSurroundings) {
  scene::Scene scene;
  scene::Material plain;
  plain.base_color = {0.7f, 0.5f, 0.3f};
  add_square(scene, {-0.5f, -0.5f, -4}, {1, 0, 0}, {0, 1, 0}, plain);
  const ScratchFolder s;
  for (const int width : {16, 1200})
    ASSERT_TRUE(write_file_atomically(s.path / ("map" + std::to_string(width) + ".hdr"),
                                      colourful_map(width)));
  const std::string map = "--environment " + (s.path / "map").string();
  const std::vector<std::string> lights{map + "16.hdr,100,2", map + "1200.hdr,-37",
                                        map + "16.hdr --background 0.5,0,1", "--sky 20,15"};
  std::vector<Page> pages;
  for (const bool parallel : {false, true})
    for (const std::string& light : lights) {
      scene.cameras.assign(1, {});  // towards -Z, half a radian up at the picture's top
      scene.cameras[0].fov_y_rad = 1.2f;
      scene.cameras[0].orthographic_height_m = parallel ? 3 : 0;
      ASSERT_TRUE(write_file_atomically(s.path / "plate.glb", *export_::scene_glb(scene)));
      const std::filesystem::path folder = s.path / std::to_string(pages.size());
      if (!bake((s.path / "plate.glb").string(), folder, "--resolution 32 --samples 64 " + light))
        return;
      pages.push_back(page_of(folder));
    }
  const std::vector<Shot> shots = shoot(pages);
  for (size_t k = 0; k < shots.size(); ++k)
    expect_same(difference(shots[k].picture, pages[k].like, 3, every_pixel),
                lights[k % lights.size()].c_str());
}

// Textures, their transforms, vertex colours, metal, masks, one-sided backs, mirrors, no lightmap
// texel alike: everything that a material of baked.glb may say.
TEST_F(ViewHtml, KnowsEveryMaterial) {
  const ScratchFolder s;
  const auto glb = export_::scene_glb(one_of_each());
  ASSERT_TRUE(glb);
  ASSERT_TRUE(write_file_atomically(s.path / "each.glb", *glb));
  if (!bake((s.path / "each.glb").string(), s.path / "b", "--resolution 256 --samples 64")) return;
  const Page page = page_of(s.path / "b");
  expect_same(difference(shoot({page})[0].picture, page.like, 3, every_pixel), "one of each");
}

// Orthographic; rolled and tilted; wider than high, which the picture then is; looking straight
// down.
TEST_F(ViewHtml, StartsWithAnyCamera) {
  std::vector<scene::Camera> cameras(4);
  const Vec3 aside = normalize(Vec3{0.2f, 0.1f, 1}), up = normalize(Vec3{0.5f, 1, 0.3f});
  const Vec3 right = normalize(cross(up, aside));
  cameras[0].world_from_camera = translation({1.8f, 1.7f, 4}) * scaling({2, 3, 4});
  cameras[0].orthographic_height_m = 4;
  cameras[1].world_from_camera = from_columns(right, cross(aside, right), aside, {2.6f, 2.2f, 5});
  cameras[2].world_from_camera = translation({2, 1.6f, 5});
  cameras[2].aspect = 1.6f;
  cameras[3].world_from_camera = from_columns({1, 0, 0}, {0, 0, -1}, {0, 1, 0}, {1.7f, 8, 0});
  const ScratchFolder s;
  std::vector<Page> pages;
  for (size_t i = 0; i < cameras.size(); ++i) {
    scene::Scene scene = one_of_each();
    if (i == 3)  // lay the wall down
      for (scene::Instance& instance : scene.instances)
        instance.world_from_object =
            from_columns({1, 0, 0}, {0, 0, -1}, {0, 1, 0}, {}) * instance.world_from_object;
    scene.cameras = {cameras[i]};
    ASSERT_TRUE(write_file_atomically(s.path / "each.glb", *export_::scene_glb(scene)));
    const std::filesystem::path folder = s.path / std::to_string(i);
    if (!bake((s.path / "each.glb").string(), folder, "--resolution 128 --samples 16")) return;
    pages.push_back(page_of(folder));
  }
  const std::vector<Shot> shots = shoot(pages);
  for (size_t i = 0; i < shots.size(); ++i)
    expect_same(difference(shots[i].picture, pages[i].like, 3, every_pixel),
                std::to_string(i).c_str());
}

// Where a pixel's middle lies beside a face that is seen edge-on, the light is looked up on the
// face all the same, and not where its plane goes on in the atlas. A block under a sun, its sides
// slanted so that a camera above sees a fifth of a pixel of them: nothing is as dark as its bottom.
TEST_F(ViewHtml, FacesSeenEdgeOnHaveTheirOwnLight) {
  scene::Scene scene;
  const uint32_t white = scene::add_material(scene, "white", {0.5f, 0.5f, 0.5f});
  const float a = 1, b = 4.0f / 3 + 1e-3f;  // rays from 4 m up that pass the top go by the sides
  scene::Mesh block;
  const std::array<Vec3, 4> top{{{-a, 1, a}, {a, 1, a}, {a, 1, -a}, {-a, 1, -a}}};
  const std::array<Vec3, 4> foot{{{-b, 0, b}, {b, 0, b}, {b, 0, -b}, {-b, 0, -b}}};
  scene::add_quad(block, top, white);
  scene::add_quad(block, {foot[3], foot[2], foot[1], foot[0]}, white);
  for (size_t k = 0; k < 4; ++k) {
    const size_t next = (k + 1) % 4;
    scene::add_quad(block, {foot[k], foot[next], top[next], top[k]}, white);
  }
  scene::place(scene, std::move(block));
  // Rectangles under the floor are dark and fill most of the atlas.
  for (const float y : {-0.5f, -1.0f, -1.5f, -2.0f, -2.5f})
    scene::add_rectangle(scene, {-3, 3, -3, 3}, y, true, white);
  scene.lights.emplace_back();
  scene.lights[0].kind = scene::PunctualLight::Kind::directional;
  scene.lights[0].intensity = {3, 3, 3};
  scene.cameras.emplace_back();
  const Vec3 right = normalize(Vec3{1, 0, 0.1f}), up = normalize(Vec3{0.1f, 0, -1});
  scene.cameras[0].world_from_camera = from_columns(right, up, {0, 1, 0}, {0, 4, 0});
  const ScratchFolder s;
  ASSERT_TRUE(write_file_atomically(s.path / "block.glb", *export_::scene_glb(scene)));
  if (!bake((s.path / "block.glb").string(), s.path / "b", "--resolution 256 --samples 64")) return;
  const Page page = page_of(s.path / "b");
  const Shot shot = shoot({page})[0];
  const auto darkest = [](const image::Image8& picture) {
    uint8_t least = 255;
    for (size_t i = 0; i < picture.data.size(); i += 4) least = std::min(least, picture.data[i]);
    return int(least);
  };
  // Sides have some third of the light around them; of a pixel's samples there are 4 here and 9 in
  // the preview, blended after the tone curve here and before it there. Looked up in the dark, one
  // sample of 4 took 50 from the pixel's 200.
  EXPECT_GT(darkest(page.like), 100);
  EXPECT_GT(darkest(shot.picture), darkest(page.like) - 15);
}

/// Two lamps and a panel in a box, which a camera looks into.
scene::Scene three_lights(Rgb left, Rgb right, Rgb panel) {
  scene::Scene s = scene::cornell_box();
  const Box3 bounds = scene::world_bounds(s);
  const Vec3 size = bounds.upper - bounds.lower;
  for (scene::Material& m : s.materials)
    if (max_component(m.emission) > 0) m.emission = panel;
  s.lights.resize(2);
  for (size_t k = 0; k < 2; ++k) {
    s.lights[k].name = k == 0 ? "left" : "right";
    s.lights[k].position =
        bounds.lower + Vec3{size.x * (k == 0 ? 0.25f : 0.75f), size.y * 0.7f, size.z * 0.7f};
    s.lights[k].intensity = k == 0 ? left : right;
  }
  return s;
}

// With all sliders at 1 the page is the preview; at half, off and in another colour it is the
// preview of a bake of lamps like that. That bake has its own exposure, which the page is told in
// stops; the lamp's panel itself, which is seen, is turned down with its layer.
TEST_F(ViewHtml, SlidersAreLamps) {
  const ScratchFolder s;
  const auto write = [&](const char* name, const scene::Scene& scene) {
    EXPECT_TRUE(write_file_atomically(s.path / name, *export_::scene_glb(scene)));
    return (s.path / name).string();
  };
  const Rgb warm{0.3f, 0.2f, 0.1f}, cool{0.1f, 0.2f, 0.3f}, panel{4, 4, 4};
  const std::string options = "--resolution 192 --samples 64 --uv unwrap";
  if (!bake(write("a.glb", three_lights(warm, cool, panel)), s.path / "a",
            options + " --layers per-light"))
    return;
  const Page page = page_of(s.path / "a");
  const auto json = nlohmann::json::parse(slurp(s.path / "a" / "bake.json"));
  const auto b = three_lights(warm * 0.5f, cool * Rgb{1, 0, 0}, {});
  ASSERT_TRUE(bake(write("b.glb", b), s.path / "b", options));
  const auto other = nlohmann::json::parse(slurp(s.path / "b" / "bake.json"));
  const std::string stops = std::to_string(std::log2(other["preview"]["exposure"].get<double>() /
                                                     json["preview"]["exposure"].get<double>()));
  const std::string lamp = json["layers"][2]["name"];
  const image::Image8 wanted = picture_of(s.path / "b" / "preview.png");
  const std::vector<Shot> shots =
      shoot({page, {page.url + ",left=0.5,right=1:ff0000," + lamp + "=0,stops=" + stops, wanted}});
  expect_same(difference(shots[0].picture, page.like, 3, every_pixel), "all at 1");
  // Another bake: its own noise, of 64 rays a percent or two of the light, is a step or two.
  const Difference d = difference(shots[1].picture, wanted, 8, every_pixel);
  EXPECT_LT(d.mean, 1.5);
  EXPECT_LT(std::abs(d.bias), 0.5);
  EXPECT_LT(d.share_beyond, 0.03);
}

// A plate of reflectance 1/2 that sees nothing but a white sky of radiance 1: E = pi. Its
// luminance, 1/2, is exposed to 0.6 (display::auto_exposure), so the light alone, E / pi, to 1.2.
// Both go over the shoulder, 1 - 1/2 / (1 + (x - 1/2) / (1/2)); the plate's colour is shown as it
// is.
TEST_F(ViewHtml, ShowsLightAloneAndColourAlone) {
  const ScratchFolder s;
  scene::Scene scene;
  scene.background = {1, 1, 1};
  scene::Material half;
  half.base_color = {0.5f, 0.5f, 0.5f};
  add_square(scene, {-0.5f, -0.5f, 0}, {1, 0, 0}, {0, 1, 0}, half);
  scene.cameras.emplace_back();
  scene.cameras[0].world_from_camera = translation({0, 0, 3});
  ASSERT_TRUE(write_file_atomically(s.path / "plate.glb", *export_::scene_glb(scene)));
  if (!bake((s.path / "plate.glb").string(), s.path / "b", "--resolution 32 --samples 16")) return;
  const image::Image8 size{240, 180, 4, {}};
  std::vector<Page> pages;
  for (const char* what : {"both", "light", "colour"})
    pages.push_back({page_of(s.path / "b").url + "," + what, size});
  const std::vector<Shot> shots = shoot(pages);
  const auto middle = [&](size_t k) { return int(shots[k].picture.data.at(4 * (90 * 240 + 120))); };
  const auto byte = [](double linear) {
    return 255 * double(image::srgb_from_linear(float(linear)));
  };
  const auto shoulder = [](double x) { return 1 - 0.5 / (1 + (x - 0.5) / 0.5); };
  EXPECT_NEAR(middle(0), byte(shoulder(0.6)), 1);
  EXPECT_NEAR(middle(1), byte(shoulder(1.2)), 1);
  EXPECT_NEAR(middle(2), byte(0.5), 1);
}

// LinearToneMapping and the curve of preview.png are the same line up to one half of linear light,
// 188 of 255; what is brighter is left out. The lightmap has 8 bits here, of which the picture
// stretches the dark ones: a step of E is up to two of the picture. The page looks it up bilinearly
// and the preview with a spline, so noise is kept low. The background is as black as the page's:
// where there is none, the preview has a grey of its own.
TEST_F(ViewHtml, APageOfOnesOwnShowsWhatThePreviewShows) {
  const std::filesystem::path web = std::filesystem::path(LUXEL_BINARY_DIR) / "web";
  if (!std::filesystem::exists(web / "node_modules" / "three"))
    GTEST_SKIP() << "three is not in " << web << ": the build had no npm or no network";
  const ScratchFolder s;
  ASSERT_EQ(luxel("bake " + scene_file("cornell-box.glb") + " -o " + (s.path / "b").string() +
                  " --resolution 256 --samples 256 --background 1e-6,1e-6,1e-6")
                .code,
            0);
  const image::Image8 preview = picture_of(s.path / "b" / "preview.png");
  const std::vector<Page> pages{{"index.html", preview}, {"index.html?exr", preview}};
  const std::vector<Shot> shots =
      shoot(pages, "--root " LUXEL_SOURCE_DIR "/examples/three --root " + (s.path / "b").string() +
                       " --root " + web.string());
  for (size_t k = 0; k < shots.size(); ++k) {
    const Difference d = difference(shots[k].picture, preview, 4, [](const uint8_t* p) {
      return p[0] < 188 && p[1] < 188 && p[2] < 188;
    });
    EXPECT_GT(d.pixels, 0.3 * preview.width * preview.height);
    expect_same(d, pages[k].url.c_str());
  }
}

// The page is tested with the three of the build.
TEST(ThreeExample, AsksForTheVersionThatIsTested) {
  const auto three = [](const char* package) {
    return nlohmann::json::parse(
        slurp(std::string(LUXEL_SOURCE_DIR) + package))["dependencies"]["three"];
  };
  EXPECT_EQ(three("/examples/three/package.json"), three("/luxel/export/web/package.json"));
}

TEST(ThreeExample, StandsInTheDocumentation) {
  EXPECT_THAT(slurp(LUXEL_SOURCE_DIR "/docs/format/bake.md"),
              HasSubstr("```js\n" + slurp(LUXEL_SOURCE_DIR "/examples/three/lightmap.js") + "```"));
}

}  // namespace
}  // namespace luxel::testing_support
