// The page is read here as a browser reads it: elements found by their ids, base64, zlib.
#include "luxel/export/view_page.h"

#include <gmock/gmock.h>
#include <zlib.h>

#include <nlohmann/json.hpp>

#include "luxel/base/random.h"
#include "luxel/export/view_template.h"

namespace luxel::export_ {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::string element(const std::string& html, const std::string& id) {
  const size_t at = html.find("<script id=\"" + id + "\"");
  if (at == std::string::npos) return "none";
  const size_t begin = html.find('>', at) + 1;
  return html.substr(begin, html.find("</script>", begin) - begin);
}

std::string unbase64(const std::string& text) {
  const std::string alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    if (c == '=') break;
    bits = bits << 6 | uint32_t(alphabet.find(c)), count += 6;
    if (count >= 8) out += char(uint8_t(bits >> (count -= 8)));
  }
  return out;
}

std::string inflated(const std::string& bytes, size_t size) {
  std::string out(size, '\0');
  uLongf length = size;
  EXPECT_EQ(uncompress(reinterpret_cast<Bytef*>(out.data()), &length,
                       reinterpret_cast<const Bytef*>(bytes.data()), uLong(bytes.size())),
            Z_OK);
  EXPECT_EQ(length, size);
  return out;
}

View some_view() {
  View view;
  view.camera.world_from_camera = translation({1, 2, 3});
  view.camera.fov_y_rad = 0.5f;
  view.width = 96, view.height = 72, view.exposure = 4;
  return view;
}

TEST(ViewJson, MatrixStandsColumnByColumn) {
  const nlohmann::json j = to_json(some_view());
  EXPECT_EQ(j["camera"]["matrix"], (std::vector{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 1, 2, 3, 1}));
  EXPECT_EQ(j["camera"]["yfov"], 0.5);
  EXPECT_EQ(j["exposure"], 4);
  EXPECT_EQ(j["width"], 96);
}

TEST(ViewJson, IsReadBack) {
  View view = some_view();
  view.camera.world_from_camera.row[0] = {0.5f, 0.25f, 7, 8};
  view.camera.aspect = 2, view.camera.orthographic_height_m = 3;
  const nlohmann::json json = to_json(view);
  const std::optional<View> read = view_of_json(json);
  ASSERT_TRUE(read);
  EXPECT_EQ(to_json(*read), json);
  EXPECT_EQ(read->camera.world_from_camera.row, view.camera.world_from_camera.row);
  for (const char* key : {"width", "exposure", "camera"}) {
    nlohmann::json damaged = json;
    damaged[key] = nullptr;
    EXPECT_FALSE(view_of_json(damaged)) << key;
    damaged[key] = -1;
    EXPECT_FALSE(view_of_json(damaged)) << key;
  }
  nlohmann::json short_matrix = json;
  short_matrix["camera"]["matrix"] = {1, 2, 3};
  EXPECT_FALSE(view_of_json(short_matrix));
  EXPECT_FALSE(view_of_json(nullptr));
}

TEST(ViewJson, StandsInTheWorldOfTheFile) {
  View view = some_view();
  view.camera.world_from_camera = translation({1.1f, 2.2f, 3.3f});
  const double shift[] = {512344, 88, -5403208};
  const DVec3 origin{shift[0], shift[1], shift[2]};
  const nlohmann::json far = to_json(view, origin), near = to_json(view);
  for (size_t k = 0; k < 3; ++k)
    EXPECT_EQ(far["camera"]["matrix"][12 + k].get<double>(),
              near["camera"]["matrix"][12 + k].get<double>() + shift[k]);
  EXPECT_EQ(view_of_json(far, origin)->camera.world_from_camera, view.camera.world_from_camera);
}

class ViewPageTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (const Status there = check_view_page(); !there) GTEST_SKIP() << there.error().message;
    RandomStream random{3};
    for (float& v : lightmap.data) v = random.next();
    lightmap.set_rgb(0, 0, {1e5f, 0.5f, 0});
    for (int i = 0; i < 1000; ++i) glb.push_back(std::byte(i * i % 251));
  }
  std::string html(const std::string& title) {
    return *view_html(
        {title, some_view(), {0.5f, 0, 0}, 7, glb, std::span(&lightmap, 1), &environment});
  }
  image::Image lightmap{5, 3, 4};
  scene::Environment environment;
  std::vector<std::byte> glb;
};

TEST_F(ViewPageTest, CarriesTheSceneAndTheLight) {
  const std::string page = html("box");
  const nlohmann::json about = nlohmann::json::parse(element(page, "about"));
  EXPECT_EQ(about["title"], "box");
  EXPECT_EQ(about["triangles"], 7);
  EXPECT_EQ(about["preview"], to_json(some_view()));
  const std::string model = inflated(unbase64(element(page, "model")), glb.size());
  EXPECT_EQ(std::memcmp(model.data(), glb.data(), glb.size()), 0);
  const std::string halves = inflated(unbase64(element(page, "light-0")), 5 * 3 * 4 * 2);
  ASSERT_EQ(about["light"].size(), 1u);
  EXPECT_EQ(about["light"][0]["file"], "lightmap.exr");
  EXPECT_TRUE(about["surroundings"].is_null());
  const double scale = about["light"][0]["scale"];
  uint16_t first;
  std::memcpy(&first, halves.data(), 2);
  // 1e5 = 1.5259 * 2^16; eleven bits of it.
  const double value = std::ldexp(1024 + (first & 1023), (first >> 10) - 25) * scale;
  EXPECT_NEAR(value, 1e5, 1e5 / 2048);
}

// A map of constant radiance stays what it is, however small the page makes it.
TEST_F(ViewPageTest, CarriesTheSurroundings) {
  environment = {1400, 700, std::vector<Rgb>(1400 * 700, {4, 0.5f, 0}), 0.25f};
  const std::string page = html("box");
  const nlohmann::json about = nlohmann::json::parse(element(page, "about"))["surroundings"];
  EXPECT_EQ(about["rotation"], 0.25);
  EXPECT_EQ(about["width"], 512);
  EXPECT_EQ(about["height"], 256);
  const std::string halves = inflated(unbase64(element(page, "surroundings")), 512 * 256 * 4 * 2);
  std::array<uint16_t, 2> last;
  std::memcpy(last.data(), halves.data() + halves.size() - 8, 4);
  for (size_t c = 0; c < 2; ++c) {
    const double half = std::ldexp(1024 + (last[c] & 1023), (last[c] >> 10) - 25);
    const double wanted = c == 0 ? 4 : 0.5;
    EXPECT_NEAR(half * about["scale"].get<double>(), wanted, wanted / 1024);
  }
}

TEST_F(ViewPageTest, TitlesCannotEndTheirElement) {
  const std::string title = "</script><script>alert(1)</script>\xff";
  const std::string page = html(title);
  EXPECT_THAT(page, Not(HasSubstr("alert(1)</script>")));
  const nlohmann::json about = nlohmann::json::parse(element(page, "about"));
  EXPECT_THAT(about["title"].get<std::string>(), HasSubstr("</script><script>alert(1)</script>"));
}

TEST_F(ViewPageTest, KeepsTheLicenceOfThreeAndForbidsTheNetwork) {
  const std::string page = html("box");
  EXPECT_THAT(page, HasSubstr("three.js authors"));
  EXPECT_THAT(page, HasSubstr("The above copyright notice and this permission notice shall be"));
  EXPECT_THAT(page, HasSubstr("default-src 'none'; script-src 'sha256-"));
  EXPECT_THAT(page, Not(HasSubstr("unsafe-")));
  for (const char* link : {"src=\"http", "href=\"http", "src=\"//", "@import", "url(http"})
    EXPECT_THAT(page, Not(HasSubstr(link)));
}

}  // namespace
}  // namespace luxel::export_
