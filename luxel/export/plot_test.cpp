#include "luxel/export/plot.h"

#include <gmock/gmock.h>

#include <cmath>
#include <regex>

#include "luxel/export/plot_axis.h"

namespace luxel::export_ {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::vector<std::array<double, 2>> circles_of(const std::string& text) {
  std::vector<std::array<double, 2>> out;
  const std::regex circle("cx=\"([0-9.e-]+)\" cy=\"([0-9.e-]+)\"");
  for (std::sregex_iterator i(text.begin(), text.end(), circle), end; i != end; ++i)
    out.push_back({std::stod((*i)[1]), std::stod((*i)[2])});
  return out;
}

Plot power_law() {
  Plot plot{"error", "samples", "RMSE", true, true, {{"y = x^-1/2", {}, Stroke::markers}}, {}, {}};
  for (const double x : {64.0, 256.0, 1024.0, 4096.0})
    plot.series[0].points.push_back({x, 1 / std::sqrt(x)});
  return plot;
}

TEST(Plot, APowerLawIsALineOnLogarithmicAxes) {
  const auto c = circles_of(svg(power_law()));
  ASSERT_EQ(c.size(), 4u);
  for (size_t i = 1; i < 4; ++i) {
    EXPECT_NEAR(c[i][0] - c[i - 1][0], c[1][0] - c[0][0], 0.21);
    EXPECT_NEAR(c[i][1] - c[i - 1][1], c[1][1] - c[0][1], 0.21);
    EXPECT_GT(c[i][0], c[i - 1][0]);
    EXPECT_GT(c[i][1], c[i - 1][1]);  // SVG's y points down
  }
}

TEST(Plot, ANeverSeenPointIsLeftOut) {
  Plot plot = power_law();
  const auto whole = circles_of(svg(plot));
  for (const double bad : {0.0, -1.0, double(NAN), double(INFINITY)}) {
    plot.series[0].points.push_back({bad, 1});
    plot.series[0].points.push_back({100, bad});
  }
  EXPECT_EQ(circles_of(svg(plot)), whole);
  EXPECT_THAT(svg(plot), Not(testing::AnyOf(HasSubstr("nan"), HasSubstr("inf"))));
}

// Three steps of height 10, 0 and 10 on a logarithmic axis: the middle one goes down to the ground,
// where the path starts.
TEST(Plot, AnEmptyStepLiesOnTheGround) {
  Plot plot{"", "", "", false, true, {{"", {{0, 10}, {1, 0}, {2, 10}}, Stroke::steps}}, {}, {}};
  plot.x_range = {{0, 3}};
  plot.y_range = {{1, 100}};
  const std::string text = svg(plot);
  const std::regex path(" d=\"M[0-9.]+ ([0-9.]+)V([0-9.]+)H[0-9.]+V([0-9.]+)H[0-9.]+V([0-9.]+)H");
  std::smatch m;
  ASSERT_TRUE(std::regex_search(text, m, path)) << text;
  EXPECT_EQ(m[3], m[1]);
  EXPECT_EQ(m[4], m[2]);
  EXPECT_NE(m[2], m[1]);
}

// The last of two steps is as wide as the first and does not go on to the edge of the frame.
TEST(Plot, TheLastStepIsAsWideAsTheOneBefore) {
  Plot plot{"", "", "", false, false, {{"", {{0, 5}, {1, 7}}, Stroke::steps}}, {}, {}};
  plot.x_range = {{0, 10}};
  const std::string text = svg(plot);
  const std::regex path(" d=\"M([0-9.]+) [0-9.]+V[0-9.]+H([0-9.]+)V[0-9.]+H([0-9.]+)V");
  std::smatch m;
  ASSERT_TRUE(std::regex_search(text, m, path)) << text;
  const double step = std::stod(m[2]) - std::stod(m[1]);
  EXPECT_GT(step, 10);
  EXPECT_NEAR(std::stod(m[3]) - std::stod(m[2]), step, 0.11);  // tenths of a pixel
}

TEST(Plot, EveryWordIsEscaped) {
  Plot plot = power_law();
  plot.title = "<script>";
  plot.x_label = "a & b";
  plot.series[0].name = "\"q\"";
  const std::string text = svg(plot);
  EXPECT_THAT(text, HasSubstr("&lt;script&gt;"));
  EXPECT_THAT(text, HasSubstr("a &amp; b"));
  EXPECT_THAT(text, HasSubstr("&quot;q&quot;"));
  EXPECT_THAT(text, Not(HasSubstr("<script>")));
}

TEST(Plot, NothingToDrawIsStillAPicture) {
  Plot empty;
  EXPECT_THAT(svg(empty), HasSubstr("</svg>"));
  empty.log_x = empty.log_y = true;
  empty.series = {{"none", {{-1, -1}}, Stroke::steps}};
  EXPECT_THAT(svg(empty), Not(HasSubstr("nan")));
}

TEST(PlotAxis, TicksAreRoundNumbers) {
  const auto labels = [](const Axis& axis) {
    std::vector<std::string> out;
    for (const Tick& t : axis.ticks)
      if (!t.label.empty()) out.push_back(t.label);
    return out;
  };
  EXPECT_THAT(labels(make_axis(0, 1, false, false)),
              testing::ElementsAre("0", "0.2", "0.4", "0.6", "0.8", "1"));
  EXPECT_THAT(labels(make_axis(-3, 7, false, false)),
              testing::ElementsAre("-4", "-2", "0", "2", "4", "6", "8"));
  EXPECT_THAT(labels(make_axis(3e-4, 8e3, true, false)),
              testing::ElementsAre("0.001", "0.01", "0.1", "1", "10", "100", "1000", "10000"));
  EXPECT_THAT(labels(make_axis(3, 40, true, false)),
              testing::ElementsAre("2", "5", "10", "20", "50"));
}

TEST(PlotAxis, PositionsRunFromZeroToOne) {
  for (const bool log : {false, true}) {
    const Axis axis = make_axis(2, 32, log, true);
    EXPECT_DOUBLE_EQ(axis.position(2), 0);
    EXPECT_DOUBLE_EQ(axis.position(32), 1);
    EXPECT_DOUBLE_EQ(axis.position(log ? 8 : 17), 0.5);
  }
}

TEST(PlotAxis, OneValueAndNonsenseGetARange) {
  for (const bool log : {false, true})
    for (const double v : {0.0, -3.0, 5.0, double(NAN), double(INFINITY)}) {
      const Axis axis = make_axis(v, v, log, false);
      EXPECT_LT(axis.low, axis.high) << v;
      EXPECT_FALSE(axis.ticks.empty()) << v;
    }
}

TEST(PlotAxis, ValuesThatDifferInTheirLastDigitsAreOne) {
  for (const double v : {1.0, -7.0, 1e17}) {
    const Axis axis = make_axis(v, std::nextafter(v, INFINITY), false, false);
    EXPECT_LT(axis.low, v);
    EXPECT_GT(axis.high, v);
    EXPECT_LT(axis.ticks.size(), 20u);
  }
}

}  // namespace
}  // namespace luxel::export_
