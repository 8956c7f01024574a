// `luxel compare`: numbers, exit codes, refusals, and the page it writes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "luxel/image/codec.h"
#include "tests/command.h"

namespace luxel::testing_support {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::string text_of(const std::vector<std::byte>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// 16 x 8, grey; alpha of 1 when there are four channels.
image::Image grey(float value, int channels = 3, int width = 16) {
  image::Image image(width, 8, channels);
  std::fill(image.data.begin(), image.data.end(), value);
  if (channels == 4)
    for (size_t i = 3; i < image.data.size(); i += 4) image.data[i] = 1;
  return image;
}
std::string exr(const image::Image& image) { return text_of(*image::encode_exr(image)); }
std::string hdr(const image::Image& image) { return text_of(image::encode_hdr(image)); }
std::string png(uint8_t value) {
  return text_of(image::encode_png({16, 8, 3, std::vector<uint8_t>(16 * 8 * 3, value)}));
}

CommandResult compare(const std::filesystem::path& a, const std::filesystem::path& b,
                      const std::string& options = "") {
  return luxel("compare " + a.string() + " " + b.string() + " " + options);
}

TEST(Compare, JsonHasTheKeysOfTheContractAndTheirValues) {
  const ScratchFolder s;
  const auto a = s.write("a.exr", exr(grey(0.75f))), b = s.write("b.exr", exr(grey(0.5f)));
  const CommandResult r = compare(a, b, "--json");
  ASSERT_EQ(r.code, 0) << r.err;
  const auto json = nlohmann::json::parse(r.out);
  EXPECT_DOUBLE_EQ(json["rmse"], 0.25);
  EXPECT_DOUBLE_EQ(json["rmse_over_mean"], 0.5);
  EXPECT_DOUBLE_EQ(json["relative_rmse"], 0.25 / 0.505);
  EXPECT_DOUBLE_EQ(json["bias_over_mean"], 0.5);
  EXPECT_DOUBLE_EQ(json["max_abs"], 0.25);
  EXPECT_DOUBLE_EQ(json["psnr_db"], 20 * std::log10(2.0));
  EXPECT_EQ(json["texels"], 128);
  EXPECT_GT(json["flip"], 0.01);
  EXPECT_LT(json["flip"], 1);
  EXPECT_DOUBLE_EQ(json["share_above_10"], 1);
  EXPECT_EQ(json["hdr"], true);
}

TEST(Compare, EqualPicturesHaveNoFiniteRatio) {
  const ScratchFolder s;
  const auto a = s.write("a.hdr", hdr(grey(0.5f)));
  const auto json = nlohmann::json::parse(compare(a, a, "--json").out);
  EXPECT_TRUE(json["psnr_db"].is_null());
  for (const char* key : {"rmse", "relative_rmse", "bias", "max_abs", "flip", "share_above_10"})
    EXPECT_EQ(json[key], 0) << key;
  EXPECT_THAT(compare(a, a).out, HasSubstr("inf dB"));
  EXPECT_EQ(compare(a, a, "--max-relative-rmse 0").code, 0);
}

// Two steps of 255: 20 log10(255 / 2) dB whatever the value; light is compared for the rest.
TEST(Compare, DisplayValuesHaveThePsnrThatIsUsualForThem) {
  const ScratchFolder s;
  const auto a = s.write("a.png", png(102)), b = s.write("b.png", png(100));
  const auto json = nlohmann::json::parse(compare(a, b, "--json").out);
  EXPECT_NEAR(json["psnr_db"], 20 * std::log10(127.5), 1e-12);
  const auto light = [](double v) { return std::pow((v / 255 + 0.055) / 1.055, 2.4); };
  // Light is held in floats: 2^-25 of 0.13 at most, twice.
  EXPECT_NEAR(json["bias"], light(102) - light(100), 1e-8);
  EXPECT_EQ(json["share_above_10"], 0);
  EXPECT_EQ(json["hdr"], false);
}

// One picture in two formats; 0.5 is exact in both.
TEST(Compare, FormatsAreKnownByTheirContent) {
  const ScratchFolder s;
  const auto a = s.write("a.hdr", exr(grey(0.5f))), b = s.write("b.bin", hdr(grey(0.5f)));
  const CommandResult r = compare(a, b, "--max-relative-rmse 0");
  EXPECT_EQ(r.code, 0) << r.err;
}

TEST(Compare, BeyondTheLimitIsCodeOne) {
  const ScratchFolder s;
  const auto a = s.write("a.exr", exr(grey(1.02f))), b = s.write("b.exr", exr(grey(1)));
  EXPECT_EQ(compare(a, b, "--max-relative-rmse 0.0199").code, 0);
  const CommandResult r = compare(a, b, "--json --max-relative-rmse 0.0197");
  EXPECT_EQ(r.code, 1);
  EXPECT_THAT(r.err, HasSubstr("luxel: fail: relative RMSE 0.0198"));
  EXPECT_THAT(r.err, HasSubstr("(above 0.0197)"));
  const auto limit = nlohmann::json::parse(r.out)["limits"][0];
  EXPECT_EQ(limit["measure"], "relative_rmse");
  EXPECT_EQ(limit["holds"], false);
  // 1.02 is a float.
  EXPECT_NEAR(nlohmann::json::parse(r.out)["relative_rmse"], (double(1.02f) - 1) / 1.01, 1e-12);
  const auto black = s.write("black.exr", exr(grey(0)));
  EXPECT_EQ(compare(a, black, "--max-relative-rmse 1000").code, 1);
}

// 128 pixels: 7 of them are more than 5 %, 6 are fewer. |d| / (|b| + 0.01 mean) = 0.5 / 1.01.
TEST(Compare, PercentilesAreLimits) {
  const ScratchFolder s;
  const auto b = s.write("b.exr", exr(grey(1)));
  const auto with_bright = [&](int pixels) {
    image::Image image = grey(1);
    std::fill_n(image.data.begin(), 3 * pixels, 1.5f);
    return s.write("a.exr", exr(image));
  };
  EXPECT_EQ(compare(with_bright(6), b, "--max-relative-p95 0").code, 0);
  EXPECT_EQ(compare(with_bright(6), b, "--max-relative-p95 0 --max-flip 0").code, 1);
  EXPECT_EQ(compare(with_bright(7), b, "--max-relative-p95 0.4951").code, 0);
  const CommandResult r = compare(with_bright(7), b, "--max-relative-p95 0.4950 --json");
  EXPECT_EQ(r.code, 1);
  EXPECT_NEAR(nlohmann::json::parse(r.out)["relative_p95"], 0.5 / 1.01, 1e-7);
}

// Every measure of equal pictures is 0, and every limit of 0 holds.
TEST(Compare, QuietSaysTheVerdict) {
  const ScratchFolder s;
  const auto a = s.write("a.exr", exr(grey(1))), b = s.write("b.exr", exr(grey(2)));
  const std::string all =
      "--quiet --max-relative-rmse 0 --max-relative-p95 0 --max-rmse-over-mean 0 --max-flip 0 "
      "--max-flip-p95 0";
  const CommandResult same = compare(a, a, all);
  EXPECT_EQ(same.code, 0);
  EXPECT_THAT(same.out, HasSubstr("pass: relative RMSE 0 (at most 0), "));
  EXPECT_EQ(std::count(same.out.begin(), same.out.end(), '\n'), 1);
  EXPECT_THAT(compare(b, a, "--quiet --max-rmse-over-mean 0.5").out,
              HasSubstr("fail: RMSE over the mean 1 (above 0.5)\n"));
  EXPECT_THAT(compare(b, a, "--quiet").out, HasSubstr("relative RMSE 0.990099, "));
}

/// Compares and expects a refusal with `words`, in one sentence, with no report.
void expect_refused(const std::filesystem::path& a, const std::filesystem::path& b,
                    const std::string& words) {
  const ScratchFolder scratch;
  const auto folder = scratch.path / "report";
  const CommandResult r = compare(a, b, "--quiet --json --report " + folder.string());
  EXPECT_EQ(r.code, 1) << words;
  EXPECT_THAT(r.err, testing::StartsWith("luxel: "));
  EXPECT_THAT(r.err, HasSubstr(words));
  EXPECT_EQ(std::count(r.err.begin(), r.err.end(), '\n'), 1) << r.err;
  EXPECT_EQ("luxel: " + nlohmann::json::parse(r.out)["error"]["message"].get<std::string>() + "\n",
            r.err);
  EXPECT_FALSE(std::filesystem::exists(folder)) << words;
}

TEST(Compare, WhatCannotBeReadIsRefused) {
  const ScratchFolder s;
  const auto good = s.write("good.exr", exr(grey(1)));
  expect_refused(s.path / "none.exr", good, "none.exr: no such file");
  expect_refused(good, s.write("empty.exr", ""), "empty.exr: this is not a picture");
  expect_refused(good, s.write("text.png", "hello"), "text.png: this is not a picture");
  expect_refused(s.write("half.exr", exr(grey(1)).substr(0, 300)), good, "half.exr: ");
  expect_refused(s.write("half.hdr", hdr(grey(1)).substr(0, 70)), good,
                 "half.hdr: the HDR file ends");
  expect_refused(s.write("half.png", png(1).substr(0, 50)), good, "half.png: ");
  expect_refused(s.path, good, "is a folder without lightmap.exr");
}

TEST(Compare, WhatDoesNotFitIsRefused) {
  const ScratchFolder s;
  const auto good = s.write("good.exr", exr(grey(1)));
  expect_refused(s.write("wide.exr", exr(grey(1, 3, 17))), good, "has 17 x 8 pixels and ");
  expect_refused(s.write("alpha.exr", exr(grey(1, 4))), good, "has 4 channels and ");
  expect_refused(good, s.write("shown.png", png(9)), "shown.png display values");
  image::Image empty = grey(1, 4);
  for (size_t i = 3; i < empty.data.size(); i += 4) empty.data[i] = 0.5f;
  expect_refused(s.write("dilated.exr", exr(empty)), s.write("full.exr", exr(grey(1, 4))),
                 "no pixel in common");
}

TEST(Compare, APixelThatIsNoNumberIsNamed) {
  const ScratchFolder s;
  // One pixel cannot be compressed: its floats stand in the file as they are.
  image::Image one(1, 1, 3);
  one.set_rgb(0, 0, {1, 1234.5f, 1});
  const auto good = s.write("good.exr", exr(one));
  for (const float bad : {NAN, INFINITY}) {
    std::string file = exr(one);
    const float value = 1234.5f;
    const size_t at = file.find(std::string(reinterpret_cast<const char*>(&value), 4));
    ASSERT_NE(at, std::string::npos);
    std::memcpy(file.data() + at, &bad, 4);
    expect_refused(s.write("bad.exr", file), good, "bad.exr: pixel (0, 0)");
    expect_refused(good, s.write("bad.exr", file), "bad.exr: pixel (0, 0)");
  }
}

// The pages of a bake have the names that luxel gives them: a stranger's bake.json opens no file
// elsewhere, and none a million times.
TEST(Compare, PagesLieInTheFolderOfTheBake) {
  const ScratchFolder s;
  std::filesystem::create_directories(s.path / "bake");
  s.write("outside.exr", exr(grey(1)));
  const auto refused_with = [&](const std::string& first, const std::string& second) {
    s.write("bake/bake.json",
            R"({"atlas": {"pages": [{"file": ")" + first + R"("}, {"file": ")" + second + "\"}]}}");
    return compare(s.path / "bake", s.path / "bake");
  };
  for (const char* name : {"lightmap-0.exr", "lightmap-1.exr"})
    s.write("bake/" + std::string(name), exr(grey(1)));
  EXPECT_EQ(refused_with("lightmap-0.exr", "lightmap-1.exr").code, 0);
  for (const std::string& other : {std::string("../outside.exr"), (s.path / "outside.exr").string(),
                                   std::string("lightmap-0.exr")}) {
    const CommandResult refused = refused_with("lightmap-0.exr", other);
    EXPECT_EQ(refused.code, 1) << other;
    EXPECT_THAT(refused.err, HasSubstr("page 1 of 2 is not lightmap-1.exr; bake the scene again"));
  }
}

TEST(Compare, BadSettings) {
  const ScratchFolder s;
  const auto a = s.write("a.exr", exr(grey(1)));
  EXPECT_EQ(luxel("compare " + a.string()).code, 2);
  EXPECT_EQ(compare(a, a, "--max-relative-rmse -1").code, 2);
  EXPECT_EQ(compare(a, a, "--max-relative-rmse few").code, 2);
  EXPECT_EQ(compare(a, a, "--max-relative-rmse nan").code, 2);
  for (const char* exposure : {"0", "-2", "nan", "inf", "1e300", "1e-320"}) {
    const CommandResult r = compare(a, a, std::string("--exposure ") + exposure);
    EXPECT_EQ(r.code, 1) << exposure;
    EXPECT_THAT(r.err, HasSubstr("is not a number from 1e-20 to 1e20"));
  }
}

TEST(Compare, AnExposureHasNoMeaningForDisplayValues) {
  const ScratchFolder s;
  const auto a = s.write("a.png", png(102));
  const CommandResult r = compare(a, a, "--exposure 2");
  EXPECT_EQ(r.code, 1);
  EXPECT_THAT(r.err, HasSubstr("--exposure 2 has no meaning for display values"));
  EXPECT_EQ(r.out, "");
}

// A picture without alpha is covered everywhere; of a picture with holes the rest is compared.
TEST(Compare, GreyAndRgbPicturesCoverEverything) {
  const ScratchFolder s;
  const auto file = [&](const std::string& name, int channels, uint8_t alpha) {
    image::Image8 image{16, 8, channels, std::vector<uint8_t>(size_t(16 * 8 * channels), 100)};
    if (channels % 2 == 0)
      for (size_t pixel = 0; pixel < 16 * 8; ++pixel)
        image.data[pixel * size_t(channels) + size_t(channels) - 1] = pixel < 28 ? alpha : 255;
    return s.write(name, text_of(image::encode_png(image)));
  };
  const auto grey = file("grey.png", 1, 0), rgb = file("rgb.png", 3, 0);
  for (const auto& other : {file("whole.png", 4, 255), rgb, file("grey-alpha.png", 2, 255)}) {
    const auto json = nlohmann::json::parse(compare(grey, other, "--json").out);
    EXPECT_EQ(json["texels"], 128) << other;
    EXPECT_EQ(json["rmse"], 0) << other;
  }
  const auto holes = file("holes.png", 4, 254);
  EXPECT_EQ(nlohmann::json::parse(compare(rgb, holes, "--json").out)["texels"], 100);
  EXPECT_EQ(nlohmann::json::parse(compare(holes, grey, "--json").out)["texels"], 100);
}

TEST(CompareReport, SaysWhatABlackReferenceLeavesUndefined) {
  const ScratchFolder s;
  const auto a = s.write("a.exr", exr(grey(1))), black = s.write("black.exr", exr(grey(0)));
  const auto folder = s.path / "report";
  EXPECT_EQ(compare(a, black, "--quiet --report " + folder.string()).code, 0);
  const std::string page = slurp(folder / "report.html");
  const size_t table = page.find("PSNR");
  ASSERT_NE(table, std::string::npos);
  EXPECT_THAT(page.substr(table, 60), HasSubstr("—"));
  for (const char* word : {">inf", ">-inf", ">nan", "∞"})
    EXPECT_EQ(page.find(word), page.npos) << word;
}

TEST(CompareReport, IntoAFolderThatCannotBeWritten) {
  const ScratchFolder s;
  const auto a = s.write("a.exr", exr(grey(1)));
  const CommandResult in_the_way = compare(a, a, "--report " + a.string());
  EXPECT_EQ(in_the_way.code, 1);
  EXPECT_THAT(in_the_way.err, HasSubstr("is a file; choose another name"));
  EXPECT_THAT(compare(a, a, "--report ''").err, HasSubstr("--report names no folder"));
  if (::geteuid() == 0) return;  // root may write everywhere
  const auto locked = s.path / "locked";
  std::filesystem::create_directory(locked);
  std::filesystem::permissions(locked, std::filesystem::perms(0555));
  EXPECT_THAT(compare(a, a, "--report " + locked.string()).err, HasSubstr("Permission denied"));
}

std::string without(std::string text, const std::string& part) {
  for (size_t at; (at = text.find(part)) != std::string::npos;) text.erase(at, part.size());
  return text;
}
size_t count_of(const std::string& text, const std::string& part) {
  size_t count = 0;
  for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

TEST(CompareReport, IsOnePageWithEverythingInside) {
  const ScratchFolder s;
  image::Image lit = grey(0.5f, 4);
  for (int x = 0; x < 16; ++x) lit.set_rgb(x, 3, {0.1f * float(x), 0.5f, 0.5f});
  lit.at(0, 0)[3] = 0;
  const auto a = s.write("<a>.exr", exr(grey(0.5f, 4))), b = s.write("b.exr", exr(lit));
  const CommandResult r = luxel("compare '" + a.string() + "' " + b.string() + " --report " +
                                (s.path / "out/deep").string());
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_EQ(files_in(s.path / "out/deep"), std::set<std::string>{"report.html"});
  EXPECT_THAT(r.err, HasSubstr("wrote " + (s.path / "out/deep/report.html").string()));
  const std::string html = slurp(s.path / "out/deep/report.html");
  for (const char* heading : {"Side by side", "Where they differ", "Histograms", "Contours",
                              "Pixel differences", "Relative RMSE", "HDR-FLIP", "not compared"})
    EXPECT_THAT(html, HasSubstr(heading));
  EXPECT_EQ(count_of(html, "<figure><img "), 9u);
  EXPECT_EQ(count_of(html, "<img "), count_of(html, "src=\"data:image/png;base64,iVBORw0KGgo"));
  EXPECT_EQ(count_of(html, "<svg xmlns"), 2u);
  EXPECT_THAT(html, HasSubstr("&lt;a&gt;.exr"));
  // The name of SVG is the only thing that looks like a link.
  const std::string rest = without(html, "xmlns=\"http://www.w3.org/2000/svg\"");
  for (const char* outside : {"http:", "https:", "<script", "<link", "url(", "@import", "<a>",
                              "<iframe", "unsafe-inline", " style="})
    EXPECT_THAT(rest, Not(HasSubstr(outside)));
  // Equal pictures give equal pages, bit for bit. Other pictures' page replaces the old one.
  const std::string report = " --report " + (s.path / "out/deep").string();
  const auto again = [&](const std::string& pictures) {
    EXPECT_EQ(luxel("compare " + pictures + report).code, 0);
    return slurp(s.path / "out/deep/report.html");
  };
  EXPECT_NE(again(b.string() + " " + b.string()), html);
  EXPECT_EQ(again("'" + a.string() + "' " + b.string()), html);
}

TEST(CompareReport, OfTwoBakesShowsTheScenesToo) {
  const ScratchFolder s;
  for (const char* seed : {"1", "2"})
    ASSERT_EQ(luxel("bake " + scene_file("cornell-box.glb") + " -o " + (s.path / seed).string() +
                    " --resolution 64 --samples 8 --quiet --seed " + seed)
                  .code,
              0);
  const CommandResult r =
      compare(s.path / "1", s.path / "2", "--json --report " + (s.path / "r").string());
  ASSERT_EQ(r.code, 0) << r.err;
  const auto json = nlohmann::json::parse(r.out);
  EXPECT_GT(json["texels"], 1000);
  EXPECT_LT(json["texels"], 64 * 64);
  // 8 rays through the room scatter by some 60 % each and then average over bounces: far above 1 %
  // per texel, and in the mean of 2600 texels (0.6 / sqrt(8 * 2600) = 0.4 %, twice) far below 2 %.
  EXPECT_GT(json["relative_rmse"], 0.01);
  EXPECT_LT(std::abs(double(json["bias_over_mean"])), 0.02);
  const std::string html = slurp(s.path / "r/report.html");
  EXPECT_THAT(html, HasSubstr("The scenes"));
  EXPECT_EQ(count_of(html, "<figure><img "), 11u);
}

}  // namespace
}  // namespace luxel::testing_support
