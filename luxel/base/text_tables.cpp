#include "luxel/base/text_tables.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "luxel/base/shown_text.h"

namespace luxel {
inline namespace base {
namespace {

std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    if (line.ends_with('\r')) line.remove_suffix(1);
    lines.push_back(line);
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

/// The texts between the separators: one more than there are separators.
std::vector<std::string_view> parts_of(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (size_t end; (end = text.find(separator)) != text.npos; text.remove_prefix(end + 1))
    parts.push_back(text.substr(0, end));
  parts.push_back(text);
  return parts;
}

std::string trimmed(std::string_view cell) {
  const size_t first = cell.find_first_not_of(' '), last = cell.find_last_not_of(' ');
  return first == cell.npos ? "" : std::string(cell.substr(first, last - first + 1));
}

/// "| a | b |"
TextRow markdown_cells(std::string_view line) {
  TextRow cells;
  line.remove_prefix(1);
  while (!line.empty()) {
    const size_t end = line.find('|');
    if (end == line.npos) break;
    cells.push_back(trimmed(line.substr(0, end)));
    line.remove_prefix(end + 1);
  }
  return cells;
}

TextRow csv_cells(std::string_view line) {
  TextRow cells(1);
  bool quoted = false;
  for (size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == '"' && quoted && i + 1 < line.size() && line[i + 1] == '"')
      cells.back() += line[++i];
    else if (c == '"')
      quoted = !quoted;
    else if (c == ',' && !quoted)
      cells.emplace_back();
    else
      cells.back() += c;
  }
  return cells;
}

}  // namespace

std::string csv_cell(std::string_view text) {
  std::string shown = shown_text(text);
  // Blanks in front are not looked at by those that look for a formula.
  const size_t first = shown.find_first_not_of(' ');
  const bool is_formula =
      first != shown.npos && std::string_view("=+-@").find(shown[first]) != std::string_view::npos;
  if (is_formula) shown.insert(0, "'");
  if (!is_formula && shown.find_first_of(",\"") == shown.npos) return shown;
  std::string out(1, '"');
  for (const char c : shown) out.append(c == '"' ? 2 : 1, c);
  return out + '"';
}

std::vector<TextRow> csv_rows(std::string_view text) {
  std::vector<TextRow> rows;
  bool header = true;
  for (const std::string_view line : lines_of(text)) {
    if (line.empty() || line.front() == '#') continue;
    if (!header) rows.push_back(csv_cells(line));
    header = false;
  }
  return rows;
}

std::vector<TextRow> markdown_rows(std::string_view text, std::string_view section,
                                   std::string_view first_header) {
  std::vector<TextRow> rows;
  bool in_section = false, in_table = false;
  for (const std::string_view line : lines_of(text)) {
    if (line.starts_with("#")) in_section = line.find(section) != line.npos;
    if (!in_section) continue;
    if (!line.starts_with("|")) {
      if (in_table) break;
      continue;
    }
    TextRow cells = markdown_cells(line);
    if (cells.empty()) continue;
    const bool header = cells.front() == first_header, rule = cells.front().starts_with("---");
    if (in_table && !rule) rows.push_back(std::move(cells));
    in_table |= header;
  }
  return rows;
}

Result<double> parse_number(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value))
    return fail(ErrorCode::bad_input, "'{}' is not a number", text);
  return value;
}

Result<std::vector<DVec3>> parse_polygon(std::string_view text) {
  std::vector<DVec3> corners;
  for (const std::string_view part : parts_of(text, ';')) {
    std::vector<double> p;
    for (const std::string_view word : parts_of(part, ' '))
      if (!word.empty()) {
        LUXEL_TRY(const double coordinate, parse_number(word));
        p.push_back(coordinate);
      }
    if (p.size() != 3)
      return fail(ErrorCode::bad_input, "'{}' is not a corner: it needs three numbers", part);
    corners.push_back({p[0], p[1], p[2]});
  }
  return corners;
}

Result<std::vector<std::vector<DVec3>>> parse_polygons(std::string_view text) {
  std::vector<std::vector<DVec3>> polygons;
  if (text.empty()) return polygons;
  for (const std::string_view part : parts_of(text, '|')) {
    LUXEL_TRY(std::vector<DVec3> polygon, parse_polygon(part));
    polygons.push_back(std::move(polygon));
  }
  return polygons;
}

}  // namespace base
}  // namespace luxel
