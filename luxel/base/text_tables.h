// Tables in text files: CSV, and the tables of markdown pages.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "luxel/base/result.h"
#include "luxel/base/vec_double.h"

namespace luxel {
inline namespace base {

using TextRow = std::vector<std::string>;

/// A text, not a number, as a cell of a CSV table: shown_text(), in quotes where it has a comma or
/// a quote. Spreadsheets would compute one that starts with = + - or @: an apostrophe in front, as
/// people type it, tells them that it is text.
std::string csv_cell(std::string_view text);

/// Rows of a CSV text with quoted cells (a quoted quote is doubled); empty lines, comment lines (#)
/// and the header row are left out.
std::vector<TextRow> csv_rows(std::string_view text);

/// The cells, without the blanks around them, of each row of the first markdown table whose
/// header's first cell is `first_header`, below the heading that contains `section`. Empty when
/// there is none.
std::vector<TextRow> markdown_rows(std::string_view text, std::string_view section,
                                   std::string_view first_header);

/// The whole cell as a finite number. Errors: anything else in it.
Result<double> parse_number(std::string_view text);
/// "x y z; x y z; ...": at least one corner. Errors: a corner that is not three numbers.
Result<std::vector<DVec3>> parse_polygon(std::string_view text);
/// Polygons with vertical bars between them; none in an empty text.
Result<std::vector<std::vector<DVec3>>> parse_polygons(std::string_view text);

}  // namespace base
}  // namespace luxel
