#include "transport/polygon_form_factor.h"

#include <gtest/gtest.h>

#include "tests/reference_data.h"

namespace luxel::transport {
namespace {

namespace shared = luxel::testing_support;

TEST(PolygonFormFactor, MatchesTheExactTable) {
  LUXEL_NEEDS_SHARED("reference/view-factors.csv");
  int checked = 0;
  for (const auto& row : shared::csv_rows("reference/view-factors.csv")) {
    if (row[1] != "poly" || !row[4].empty()) continue;
    const Polygon a = shared::parse_polygon(row[2]), b = shared::parse_polygon(row[3]);
    const double exact = std::stod(row[5]);
    const double factor = polygon_form_factor(a, b);
    EXPECT_NEAR(factor, exact, 1e-11 * exact) << row[0];
    ++checked;
  }
  EXPECT_GE(checked, 30);
}

}  // namespace
}  // namespace luxel::transport
