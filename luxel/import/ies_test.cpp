#include "luxel/import/ies.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "luxel/base/random.h"
#include "luxel/base/vec_double.h"
#include "luxel/import/import_test_support.h"

namespace luxel::import {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// A file of LM-63 from its parts.
struct Parts {
  std::string head = "IESNA:LM-63-2002\n[TEST] 1\n[MANUFAC] none\n", tilt = "TILT=NONE\n";
  std::string lamp = "1 1000 1";
  std::string counts = "3 1", type = "1";
  std::string ballast = "1 1 60";
  std::string vertical = "0 45 90", horizontal = "0", candela = "100 70.7 0";

  std::string text() const {
    return head + tilt + lamp + " " + counts + " " + type + " 2 0.1 0.2 0\n" + ballast + "\n" +
           vertical + "\n" + horizontal + "\n" + candela + "\n";
  }
};

scene::LightProfile profile_of(const Parts& parts) {
  const Result<Ies> ies = parse_ies(parts.text(), "lamp.ies");
  EXPECT_TRUE(ies) << ies.error().message;
  return ies ? ies->profile : scene::LightProfile{};
}

std::string error_of(const std::string& text) {
  const Result<Ies> ies = parse_ies(text, "lamp.ies");
  if (ies) return "no error";
  EXPECT_NE(ies.error().message.back(), '.');
  EXPECT_EQ(ies.error().message.find('\n'), std::string::npos);
  return ies.error().message;
}
std::string error_of(const Parts& parts) { return error_of(parts.text()); }

/// I at angles of Type C, in degrees.
float candela_of(const scene::LightProfile& p, double v_deg, double h_deg) {
  const double v = v_deg * kPiDouble / 180, h = h_deg * kPiDouble / 180;
  return scene::candela_at(
      p, {0, 0, -1}, {1, 0, 0},
      to_float(DVec3{std::sin(v) * std::cos(h), std::sin(v) * std::sin(h), -std::cos(v)}));
}

TEST(Ies, ReadsAnglesAndCandela) {
  const auto ies = parse_ies(Parts{}.text(), "lamp.ies");
  ASSERT_TRUE(ies);
  EXPECT_EQ(ies->profile.name, "lamp.ies");
  EXPECT_EQ(ies->profile.angles, scene::LightProfile::Angles::c);
  EXPECT_EQ(ies->profile.vertical_rad, (std::vector<float>{0, kPi / 4, kPi / 2}));
  EXPECT_EQ(ies->profile.horizontal_rad, (std::vector<float>{0}));
  EXPECT_EQ(ies->profile.candela, (std::vector<float>{100, 70.7f, 0}));
  EXPECT_EQ(ies->lumens, 1000);
  EXPECT_TRUE(ies->warnings.empty());
}

// Files of different years differ in the first line and in the number after the ballast factor. In
// 1986 and 1991 that is a factor, since 1995 "future use", in 2019 the way the file was made, as
// 1.10000.
TEST(Ies, TheYearSaysWhatTheNumbersMean) {
  for (const char* head :
       {"", "Acme lamp\nof 1987\n", "IESNA91\n[TEST] 1\n", "\xef\xbb\xbfIESNA91\n"}) {
    Parts parts{.head = head, .ballast = "0.5 0.8 60"};
    EXPECT_FLOAT_EQ(profile_of(parts).candela[0], 40) << head;
  }
  for (const char* head : {"IESNA:LM-63-1995\n", "IESNA:LM-63-2002\r\n", "IES:LM-63-2019\n"}) {
    Parts parts{.head = head, .ballast = "0.5 1.10000 60"};
    EXPECT_FLOAT_EQ(profile_of(parts).candela[0], 50) << head;
  }
}

TEST(Ies, MultipliersAreIn) {
  EXPECT_FLOAT_EQ(profile_of({.lamp = "2 500 2.5"}).candela[1], 2.5f * 70.7f);
  EXPECT_FLOAT_EQ(profile_of({.ballast = "0.9 1 60"}).candela[1], 0.9f * 70.7f);
  // Absolute photometry: candela are as they stand.
  const auto absolute = parse_ies(Parts{.lamp = "1 -1 1"}.text(), "lamp.ies");
  ASSERT_TRUE(absolute);
  EXPECT_EQ(absolute->lumens, 0);
  EXPECT_FLOAT_EQ(absolute->profile.candela[0], 100);
  EXPECT_EQ(parse_ies(Parts{.lamp = "2 500 1"}.text(), "x")->lumens, 1000);
}

TEST(Ies, NumbersGoOverLinesAndCommas) {
  const scene::LightProfile plain = profile_of({});
  for (const Parts& parts :
       {Parts{.vertical = "0\n45\n\n 90", .candela = "100,70.7\r\n,0"},
        Parts{.lamp = "1,1000,1", .counts = "3,1", .candela = "1.0e2\t+70.7 .0"},
        Parts{.tilt = "TILT=NONE   \r\n", .candela = "100 70.7 0\n\n\x1a"}})
    EXPECT_EQ(profile_of(parts).candela, plain.candela) << parts.text();
}

// The table of tilts is read past and said; the numbers after it are the same.
TEST(Ies, TiltTables) {
  const auto included =
      parse_ies(Parts{.tilt = "TILT=INCLUDE\n1\n3\n0 90 180\n1.0 0.8\n0.9\n"}.text(), "lamp.ies");
  ASSERT_TRUE(included) << included.error().message;
  EXPECT_EQ(included->profile.candela, profile_of({}).candela);
  ASSERT_EQ(included->warnings.size(), 1u);
  EXPECT_THAT(included->warnings[0], AllOf(HasSubstr("lamp.ies"), HasSubstr("TILT")));
  EXPECT_THAT(error_of(Parts{.tilt = "TILT=hid.tlt\n"}),
              AllOf(HasSubstr("line 4"), HasSubstr("hid.tlt")));
  EXPECT_THAT(error_of(Parts{.tilt = "TILT=INCLUDE\n1\n2\n0 90\n1 x\n"}), HasSubstr("'x'"));
}

/// f of the horizontal angle at v = 90, and as much at v = 0 and 180, at these horizontal angles.
template <class F>
scene::LightProfile profile_at(const std::vector<double>& angles, const F& f) {
  Parts parts{.counts = "3 " + std::to_string(angles.size()), .vertical = "0 90 180"};
  parts.horizontal.clear(), parts.candela.clear();
  for (const double h : angles) {
    parts.horizontal += fmt::format("{} ", h);
    parts.candela += fmt::format("{0} {0} {0}\n", f(h));
  }
  return profile_of(parts);
}
std::vector<double> every_15(double from, double to) {
  std::vector<double> out;
  for (double h = from; h <= to; h += 15) out.push_back(h);
  return out;
}

// One distribution that has every symmetry, told in all ways that the format has.
TEST(Ies, SymmetriesUnfoldToTheSame) {
  const auto f = [](double h) { return 100 + 50 * std::cos(2 * h * kPiDouble / 180); };
  const scene::LightProfile whole = profile_at(every_15(0, 360), f);
  ASSERT_EQ(whole.horizontal_rad.size(), 25u);
  for (const auto& [from, to] : {std::pair{0.0, 90.0}, {0.0, 180.0}, {90.0, 270.0}, {0.0, 345.0}}) {
    const scene::LightProfile part = profile_at(every_15(from, to), f);
    ASSERT_EQ(part.horizontal_rad.size(), 25u) << from << " to " << to;
    for (size_t k = 0; k < 25; ++k)
      EXPECT_NEAR(part.horizontal_rad[k], whole.horizontal_rad[k], 1e-6f) << from << " to " << to;
    for (size_t k = 0; k < whole.candela.size(); ++k)
      EXPECT_NEAR(part.candela[k], whole.candela[k], 1e-4f) << from << " to " << to << ", " << k;
  }
}

// Each way mirrors what it says, no more: 0 to 180 left and right of that plane, 90 to 270 before
// and behind.
TEST(Ies, SymmetriesMirrorWhatTheySay) {
  const auto f = [](double h) { return 1000 - h; };
  const scene::LightProfile half = profile_at(every_15(0, 180), f);
  for (const double h : {20.0, 100.0, 170.0}) {
    EXPECT_NEAR(candela_of(half, 90, h), 1000 - h, 1e-3);
    EXPECT_NEAR(candela_of(half, 90, -h), 1000 - h, 1e-3);
  }
  const scene::LightProfile back = profile_at(every_15(90, 270), f);
  for (const double h : {95.0, 160.0, 200.0, 265.0}) {
    EXPECT_NEAR(candela_of(back, 90, h), 1000 - h, 1e-3);
    EXPECT_NEAR(candela_of(back, 90, 180 - h), 1000 - h, 1e-3) << h;
  }
}

// Uplights are measured from 90 to 180 degrees: below they are dark.
TEST(Ies, VerticalRangesAreKept) {
  const scene::LightProfile up = profile_of({.vertical = "90 135 180", .candela = "0 50 80"});
  EXPECT_EQ(candela_of(up, 60, 0), 0);
  EXPECT_NEAR(candela_of(up, 135, 10), 50, 1e-3);
  EXPECT_NEAR(candela_of(up, 180, 0), 80, 1e-3);
}

// Type B, one side: the other is alike; v turns from the aim (-z) to x, h to both sides of it.
TEST(Ies, TypeBIsMirroredAtItsMiddle) {
  const scene::LightProfile p = profile_of({.counts = "3 2",
                                            .type = "2",
                                            .vertical = "-90 0 90",
                                            .horizontal = "0 90",
                                            .candela = "10 100 40\n0 0 0"});
  EXPECT_EQ(p.angles, scene::LightProfile::Angles::b);
  const auto at = [&](Vec3 d) { return scene::candela_at(p, {0, 0, -1}, {1, 0, 0}, d); };
  EXPECT_NEAR(at({0, 0, -1}), 100, 1e-3f);
  EXPECT_NEAR(at(normalize(Vec3{1, 0, -1})), 70, 1e-3f);
  EXPECT_NEAR(at(normalize(Vec3{-1, 0, -1})), 55, 1e-3f);
  EXPECT_NEAR(at(normalize(Vec3{0, 1, -1})), 50, 1e-3f);
  EXPECT_NEAR(at(normalize(Vec3{0, -1, -1})), 50, 1e-3f);
  EXPECT_THAT(error_of(Parts{.counts = "3 2",
                             .type = "2",
                             .vertical = "0 45 90",
                             .horizontal = "0 90",
                             .candela = "1 1 1 1 1 1"}),
              HasSubstr("begin at 0"));
}

// A plate of 1000 cd that shines evenly sends pi 1000 lm. Between angles 5 degrees apart linear
// interpolation loses (5 degrees)^2 / 12 = 0.06 % of a cosine.
TEST(Ies, TheFluxIsThatOfTheFile) {
  Parts parts{.lamp = "1 3141.59 1", .counts = "19 1", .vertical = "", .candela = ""};
  for (int v = 0; v <= 90; v += 5) {
    parts.vertical += fmt::format("{} ", v);
    parts.candela += fmt::format("{:.3f} ", 1000 * std::abs(std::cos(v * kPiDouble / 180)));
  }
  const auto ies = parse_ies(parts.text(), "lamp.ies");
  ASSERT_TRUE(ies) << ies.error().message;
  const double lumens = 4 * kPiDouble * scene::mean_candela(ies->profile, kPiDouble);
  EXPECT_NEAR(lumens, ies->lumens, 1e-3 * ies->lumens);
  EXPECT_LT(lumens, ies->lumens);
}

TEST(Ies, BadFilesAreSaid) {
  EXPECT_THAT(error_of(std::string()), AllOf(HasSubstr("lamp.ies"), HasSubstr("TILT=")));
  EXPECT_THAT(error_of("\x89PNG\r\n\x1a\n"), HasSubstr("TILT="));
  EXPECT_THAT(error_of("IESNA:LM-63-2002\nTILT=NONE\n"), HasSubstr("ends in line 3"));
  EXPECT_THAT(error_of(Parts{.candela = "100 70"}), HasSubstr("candela"));
  EXPECT_THAT(error_of(Parts{.candela = "100 70 0 1"}), HasSubstr("'1' follows"));
  EXPECT_THAT(error_of(Parts{.candela = "100 -70 0"}),
              AllOf(HasSubstr("line 9"), HasSubstr("candela -70")));
  EXPECT_THAT(error_of(Parts{.candela = "100 nan 0"}), HasSubstr("'nan' is not a number"));
  EXPECT_THAT(error_of(Parts{.candela = "100 1e999 0"}), HasSubstr("'1e999' is not a number"));
  EXPECT_THAT(error_of(Parts{.candela = "100 seven 0"}), HasSubstr("candela 'seven'"));
  EXPECT_THAT(error_of(Parts{.vertical = "0 45 45"}),
              AllOf(HasSubstr("line 7"), HasSubstr("45 does not follow 45")));
  EXPECT_THAT(error_of(Parts{.vertical = "-90 45 90"}), HasSubstr("-90 to 90 are not within"));
  EXPECT_THAT(error_of(Parts{.counts = "3 2", .horizontal = "0 100", .candela = "1 1 1 1 1 1"}),
              HasSubstr("0 to 100 match no symmetry"));
  EXPECT_THAT(error_of(Parts{.type = "4"}), HasSubstr("the photometric type 4"));
  EXPECT_THAT(error_of(Parts{.counts = "2000000000 1"}), HasSubstr("2000000000 is outside 2 to"));
  EXPECT_THAT(error_of(Parts{.counts = "36000 36000"}), HasSubstr("more than luxel can read"));
  EXPECT_THAT(error_of(Parts{.counts = "3.5 1"}), HasSubstr("3.5 is not a whole number"));
  EXPECT_THAT(error_of(Parts{.counts = "1 1"}), HasSubstr("vertical angles 1"));
  EXPECT_THAT(error_of(Parts{.lamp = "1 1000 0"}), HasSubstr("the multiplier 0"));
  EXPECT_THAT(error_of(Parts{.ballast = "0 1 60"}), HasSubstr("the ballast factor 0"));
  EXPECT_THAT(error_of(Parts{.head = "", .ballast = "1 0 60"}), HasSubstr("ballast-lamp factor 0"));
  const auto absent = read_ies("/nowhere/lamp.ies");
  ASSERT_FALSE(absent);
  EXPECT_THAT(absent.error().message, HasSubstr("/nowhere/lamp.ies"));
}

void expect_sound(const scene::LightProfile& p, const std::string& text) {
  ASSERT_GE(p.vertical_rad.size(), 2u) << text;
  ASSERT_EQ(p.candela.size(), p.vertical_rad.size() * p.horizontal_rad.size()) << text;
  for (const auto* angles : {&p.vertical_rad, &p.horizontal_rad})
    for (size_t k = 1; k < angles->size(); ++k) ASSERT_LT((*angles)[k - 1], (*angles)[k]) << text;
  for (const float c : p.candela) ASSERT_TRUE(std::isfinite(c) && c >= 0) << text;
  for (const Vec3 d : {Vec3{0, 0, -1}, {0, 0, 1}, {1, 0, 0}, {0, -1, 0}, {-0.6f, 0, 0.8f}})
    ASSERT_TRUE(std::isfinite(scene::candela_at(p, {0, 0, -1}, {1, 0, 0}, d))) << text;
}

// Bytes lost, changed and added anywhere: a sentence or a sound profile, never anything else.
TEST(Ies, DamagedFilesNeverDoMoreThanFail) {
  const std::string c = Parts{.tilt = "TILT=INCLUDE\n1\n2\n0 90\n1 0.9\n",
                              .counts = "3 3",
                              .horizontal = "0 45 90",
                              .candela = "9 8 7 6 5 4 3 2 1"}
                            .text();
  const std::string b = Parts{.head = "",
                              .counts = "3 2",
                              .type = "2",
                              .vertical = "-90 0 90",
                              .horizontal = "0 90",
                              .candela = "9 8 7 6 5 4"}
                            .text();
  constexpr std::string_view kBytes = "0123456789-+.eE, \n\r\t\x1a\0nT=\xff";
  RandomStream random{11, 0};
  const auto below = [&](size_t n) { return std::min(n - 1, size_t(random.next() * float(n))); };
  size_t failed = 0;
  for (int i = 0; i < 20000; ++i) {
    std::string text = i % 2 ? c : b;
    for (size_t edits = 1 + below(3); edits > 0 && text.size() > 1; --edits) {
      const size_t at = below(text.size());
      const char byte = kBytes[below(kBytes.size())];
      switch (below(4)) {
        case 0:
          text.erase(at, 1 + below(4));
          break;
        case 1:
          text[at] = byte;
          break;
        case 2:
          text.insert(at, 1 + below(3), byte);
          break;
        default:
          text.resize(at);
          break;
      }
    }
    const Result<Ies> ies = parse_ies(text, "lamp.ies");
    if (ies) {
      expect_sound(ies->profile, text);
    } else {
      ++failed;
      EXPECT_THAT(ies.error().message, HasSubstr("lamp.ies")) << text;
    }
    if (::testing::Test::HasFatalFailure()) return;
  }
  EXPECT_GT(failed, 5000u);
  EXPECT_LT(failed, 20000u);
}

}  // namespace
}  // namespace luxel::import
