#include "transport/visible_form_factor.h"

#include <gtest/gtest.h>

#include "tests/reference_data.h"

namespace luxel::transport {
namespace {

namespace shared = luxel::testing_support;

TEST(VisibleFormFactor, MatchesTheExactTable) {
  LUXEL_NEEDS_SHARED("reference/view-factors.csv");
  int checked = 0;
  for (const auto& row : shared::csv_rows("reference/view-factors.csv")) {
    if (row[1] != "poly" || row[4].empty()) continue;
    const Polygon a = shared::parse_polygon(row[2]), b = shared::parse_polygon(row[3]);
    std::vector<Polygon> blockers;
    std::istringstream parts(row[4]);
    for (std::string part; std::getline(parts, part, '|');)
      blockers.push_back(shared::parse_polygon(part));
    const double exact = std::stod(row[5]);
    for (const double tolerance : {1e-3, 1e-4, 1e-5}) {
      const FormFactor factor = form_factor(a, b, blockers, tolerance);
      EXPECT_NEAR(factor.value, exact, tolerance * exact) << row[0];
      EXPECT_LE(factor.error, tolerance * exact) << row[0];
    }
    ++checked;
  }
  EXPECT_GE(checked, 5);
}

}  // namespace
}  // namespace luxel::transport
