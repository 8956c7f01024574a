#include "luxel/validate/exact_cases.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/reference_data.h"

namespace luxel::validate {
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
  const std::string text = shared::reference_text("reference/exact-solutions.md");
  const auto cases = *exact_cases(text);
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
  const auto cases = *exact_cases(shared::reference_text("reference/exact-solutions.md"));
  const ExactCase& cube = case_named(cases, "cube");
  // Mean of E over six walls is mean(e) / (1 - rho); extrapolation leaves 1e-5.
  const double sum = cube.parts[0].irradiance({}) + cube.parts[1].irradiance({}) +
                     4 * cube.parts[2].irradiance({});
  EXPECT_NEAR(sum / 6, 1.0 / 6 / 0.5, 3e-5);
}

// Section 1: e, rho and B of the table.
TEST(ExactCases, TheFurnacesAreThoseOfTheReference) {
  const auto cases = *exact_cases("");
  const auto rows = shared::markdown_rows("reference/exact-solutions.md", "Furnace", "rho");
  ASSERT_EQ(rows.size(), 2u);
  for (const auto& row : rows) {
    const ExactCase& c = case_named(cases, "furnace, rho " + row[0] + ", e " + row[1]);
    EXPECT_NEAR(c.parts[0].irradiance({}), std::stod(row[2]), 1e-12);
  }
}

// Section 2: "lx" holds the indirect part; 10 000 lm over 96 m^2 come directly.
TEST(ExactCases, TheRoomsWithAPointLightAreThoseOfTheReference) {
  const auto cases = *exact_cases("");
  const auto rows = shared::markdown_rows("reference/exact-solutions.md", "Mean law", "rho");
  ASSERT_EQ(rows.size(), 1u);
  for (const auto& [rho, column] : {std::pair{"0.3", 3}, {"0.9", 6}}) {
    const ExactCase& c = case_named(cases, std::string("point light, rho ") + rho);
    EXPECT_NEAR(c.parts[0].irradiance({}) - 10000.0 / 96, std::stod(rows[0][size_t(column)]), 1e-6);
  }
}

// Sections 4 and 5 print B = e + rho E with as many digits as here.
TEST(ExactCases, ThePlatesAndConcentricSpheresAreThoseOfTheReference) {
  const std::string text = shared::reference_text("reference/exact-solutions.md");
  const auto cases = *exact_cases("");
  const auto e = [&](const char* name, size_t part) {
    return case_named(cases, name).parts[part].irradiance({});
  };
  const auto expect_in_text = [&](const std::string& numbers) {
    EXPECT_NE(text.find(numbers), text.npos) << numbers;
  };
  expect_in_text(fmt::format("e = (1, 0.25): B = ({:.3f}, {:.2f})", 1 + 0.5 * e("plates", 0),
                             0.25 + 0.8 * e("plates", 1)));
  expect_in_text(fmt::format("e = (1, 0): B = ({:.12f}, {:.12f})",
                             1 + 0.3 * e("the inner shines", 0), 0.7 * e("the inner shines", 1)));
  expect_in_text(fmt::format("e = (0, 1): B = ({:.12f}, {:.12f})", 0.3 * e("the outer shines", 0),
                             1 + 0.7 * e("the outer shines", 1)));
}

// Section 3: B of the zones; whole facets make up the areas to 1e-4.
TEST(ExactCases, TheZonesOfTheSphereAreThoseOfTheReference) {
  const std::string text = shared::reference_text("reference/exact-solutions.md");
  const auto cases = *exact_cases("");
  const ExactCase& c = case_named(cases, "sphere in three zones");
  const size_t at = text.find("e 1, 0, 0: B = ");
  ASSERT_NE(at, text.npos);
  std::istringstream numbers(text.substr(at + 15));
  for (const auto& [e, rho] : {std::pair{1.0, 0.8}, {0.0, 0.5}, {0.0, 0.2}}) {
    double b = 0;
    char comma = 0;
    numbers >> b >> comma;
    EXPECT_NEAR(e + rho * c.parts[0].irradiance({}), b, 2e-4);
  }
}

TEST(ExactCases, WithoutTheReferenceOnlyTheCubeIsMissing) {
  const auto cases = *exact_cases("");
  EXPECT_TRUE(std::none_of(cases.begin(), cases.end(),
                           [](const ExactCase& c) { return c.name.find("cube") == 0; }));
  EXPECT_GE(cases.size(), 13u);
}

TEST(ExactCases, ABrokenTableIsASentence) {
  const std::string head = "## 6 Cube\n| n | a | b | c |\n|---|---|---|---|\n";
  const std::string good = "| 1 | 1 | 1 | 1 |\n| 2 | 1 | 1 | 1 |\n| 4 | 1 | 1 | 1 |\n";
  const auto no_number = exact_cases(head + good + "| 8 | 1 | x | 1 |\n| 16 | 1 | 1 | 1 |\n");
  ASSERT_FALSE(no_number);
  EXPECT_EQ(no_number.error().message, "'x' is not a number");
  const auto too_short = exact_cases(head + good + "| 8 | 1 | 1 |\n| 16 | 1 | 1 | 1 |\n");
  ASSERT_FALSE(too_short);
  EXPECT_NE(too_short.error().message.find("row '8' is too short"), std::string::npos);
}

}  // namespace
}  // namespace luxel::validate
