// Line plots and histograms as SVG text.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace luxel::export_ {

/// Drawing style of a series. `steps` fills the area under a staircase (histograms): each point is
/// a step that reaches to the next point's x, the last one as far as the one before it.
enum class Stroke { markers, line, dashed, steps };

struct Series {
  std::string name;  ///< stands in the legend; empty: not listed
  std::vector<std::array<double, 2>> points;
  Stroke stroke = Stroke::markers;  ///< a line with a mark at each point
};

struct Plot {
  std::string title, x_label, y_label;
  bool log_x = false, log_y = false;
  std::vector<Series> series;
  std::optional<std::array<double, 2>> x_range, y_range;  ///< unset: what the points need
  int width = 640, height = 400;                          ///< pixels, with title, axes and legend
};

/// One <svg> element, to be put into a page or a file of its own: no script, nothing from
/// elsewhere, light and dark after the reader's setting. Points that an axis cannot show (not
/// finite; not positive on a logarithmic axis) are left out; steps lie on the ground there. The
/// same text for the same plot.
std::string svg(const Plot& plot);

/// shown_text() with the characters escaped that mean something in XML and HTML.
std::string escape_xml(const std::string& text);

}  // namespace luxel::export_
