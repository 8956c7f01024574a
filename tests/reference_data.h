// Reading the exact answers in shared/reference, so that no test copies a number by hand.
#pragma once

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "base/vec.h"
#include "base/vec_double.h"
#include "tests/support.h"

namespace luxel::testing_support {

/// The cells of each row of the first markdown table whose header's first cell is `first_header`
/// and which has a column `column`, below the heading that contains `section`.
inline std::vector<std::vector<std::string>> markdown_rows(const std::string& file,
                                                           const std::string& section,
                                                           const std::string& first_header) {
  std::ifstream in(shared_folder() / file);
  std::vector<std::vector<std::string>> rows;
  bool in_section = false, in_table = false;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("#")) in_section = line.find(section) != std::string::npos;
    if (!in_section) continue;
    if (!line.starts_with("|")) {
      if (in_table) break;
      continue;
    }
    std::vector<std::string> cells;
    std::stringstream row(line.substr(1));
    for (std::string cell; std::getline(row, cell, '|');) {
      const size_t first = cell.find_first_not_of(' '), last = cell.find_last_not_of(' ');
      cells.push_back(first == std::string::npos ? "" : cell.substr(first, last - first + 1));
    }
    if (in_table && !cells.front().starts_with("---")) rows.push_back(cells);
    if (!in_table && cells.front() == first_header) in_table = true;
  }
  return rows;
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

/// The same in double precision.
inline std::vector<DVec3> parse_polygon(const std::string& text) {
  std::vector<DVec3> corners;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, ';');) {
    std::istringstream corner(part);
    DVec3 p;
    corner >> p.x >> p.y >> p.z;
    corners.push_back(p);
  }
  return corners;
}

/// Rows of a CSV file with quoted cells; comment lines and the header are left out.
inline std::vector<std::vector<std::string>> csv_rows(const std::string& file) {
  std::ifstream in(shared_folder() / file);
  std::vector<std::vector<std::string>> rows;
  bool header = true;
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line.front() == '#') continue;
    if (header) {
      header = false;
      continue;
    }
    std::vector<std::string> cells(1);
    bool quoted = false;
    for (const char c : line) {
      if (c == '"')
        quoted = !quoted;
      else if (c == ',' && !quoted)
        cells.emplace_back();
      else
        cells.back() += c;
    }
    rows.push_back(cells);
  }
  return rows;
}

}  // namespace luxel::testing_support
