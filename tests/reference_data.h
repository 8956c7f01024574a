// Reading the exact answers in tests/data/reference, so that no test copies a number by hand.
#pragma once

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "luxel/base/text_tables.h"
#include "luxel/base/vec.h"
#include "tests/support.h"

namespace luxel::testing_support {

/// The text of a file below tests/data. One that is not there fails the test.
inline std::string reference_text(const std::string& file) {
  const auto path = std::filesystem::path(LUXEL_SOURCE_DIR) / "tests" / "data" / file;
  std::ifstream in(path);
  EXPECT_TRUE(in) << path << " cannot be read";
  return {std::istreambuf_iterator<char>(in), {}};
}

/// As base's markdown_rows, of a file below tests/data.
inline std::vector<TextRow> markdown_rows(const std::string& file, const std::string& section,
                                          const std::string& first_header) {
  return base::markdown_rows(reference_text(file), section, first_header);
}

/// "x y z"
inline Vec3 parse_vec3(const std::string& text) {
  std::istringstream in(text);
  Vec3 v;
  in >> v.x >> v.y >> v.z;
  return v;
}

/// "x y z; x y z; ..."
inline std::vector<Vec3> parse_points(const std::string& text) {
  std::vector<Vec3> points;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, ';');) points.push_back(parse_vec3(part));
  return points;
}

/// As base's; a broken table fails the test.
inline std::vector<DVec3> parse_polygon(const std::string& text) {
  const auto polygon = base::parse_polygon(text);
  EXPECT_TRUE(polygon) << polygon.error().message;
  return polygon.value_or(std::vector<DVec3>{});
}
inline std::vector<std::vector<DVec3>> parse_polygons(const std::string& text) {
  const auto polygons = base::parse_polygons(text);
  EXPECT_TRUE(polygons) << polygons.error().message;
  return polygons.value_or(std::vector<std::vector<DVec3>>{});
}

/// As base's csv_rows, of a file below tests/data.
inline std::vector<TextRow> csv_rows(const std::string& file) {
  return base::csv_rows(reference_text(file));
}

}  // namespace luxel::testing_support
