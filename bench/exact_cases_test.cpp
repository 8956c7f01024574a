#include "bench/exact_cases.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/reference_data.h"

namespace luxel::bench {
namespace {

namespace shared = luxel::testing_support;

const ExactCase& case_named(const std::vector<ExactCase>& cases, const std::string& words) {
  const auto found = std::find_if(cases.begin(), cases.end(), [&](const ExactCase& c) {
    return c.name.find(words) != std::string::npos;
  });
  EXPECT_NE(found, cases.end()) << words;
  return *found;
}

// Rows of two tables: "x", then places; "E", then values.
TEST(ExactCases, ThePenumbraIsThatOfTheReference) {
  LUXEL_NEEDS_SHARED("reference/exact-solutions.md");
  const std::string text = shared::shared_text("reference/exact-solutions.md");
  const auto cases = exact_cases(text);
  const ExactPart& receiver = case_named(cases, "penumbra").parts.front();
  int checked = 0;
  std::string rest = text.substr(text.find("## 10"));
  for (size_t at; (at = rest.find("| x |")) != std::string::npos;) {
    rest = rest.substr(at);
    std::istringstream lines(rest);
    std::string places, rule, values;
    std::getline(lines, places), std::getline(lines, rule), std::getline(lines, values);
    std::istringstream xs(places), es(values);
    std::string x, e;
    for (int column = 0; std::getline(xs, x, '|') && std::getline(es, e, '|'); ++column) {
      if (column < 2) continue;  // the empty one before the first bar, and the name
      EXPECT_NEAR(receiver.irradiance({std::stof(x), 0, 0.5f}), std::stod(e), 1e-8) << "x " << x;
      ++checked;
    }
    rest = rest.substr(5);
  }
  EXPECT_EQ(checked, 11);
}

TEST(ExactCases, TheCubeKeepsTheMeanLaw) {
  LUXEL_NEEDS_SHARED("reference/exact-solutions.md");
  const auto cases = exact_cases(shared::shared_text("reference/exact-solutions.md"));
  const ExactCase& cube = case_named(cases, "cube");
  // Mean of E over six walls is mean(e) / (1 - rho); extrapolation leaves 1e-5.
  const double sum = cube.parts[0].irradiance({}) + cube.parts[1].irradiance({}) +
                     4 * cube.parts[2].irradiance({});
  EXPECT_NEAR(sum / 6, 1.0 / 6 / 0.5, 3e-5);
}

TEST(ExactCases, WithoutTheReferenceOnlyTheCubeIsMissing) {
  const auto cases = exact_cases("");
  EXPECT_TRUE(std::none_of(cases.begin(), cases.end(),
                           [](const ExactCase& c) { return c.name.find("cube") == 0; }));
  EXPECT_GE(cases.size(), 13u);
}

}  // namespace
}  // namespace luxel::bench
