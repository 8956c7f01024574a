// A page of numbers, pictures and plots in one file that needs nothing else.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace luxel::export_ {

/// A colour ramp or single colours under a picture, with words.
struct LegendEntry {
  std::string css_background;  ///< of the swatch: a colour or a gradient
  std::string label;
  bool wide = false;  ///< a ramp rather than a dot
};

/// One picture (PNG) or plot (SVG) and what stands under it.
struct Panel {
  std::string caption;
  std::vector<std::byte> png;
  std::string svg;   ///< instead of the PNG
  int width_px = 0;  ///< of the PNG; small ones are enlarged without smoothing
  std::vector<LegendEntry> legend;
};

struct Section {
  std::string heading, text;
  std::vector<Panel> panels;
};

struct ReportPage {
  std::string title;
  std::vector<std::string> lead;                    ///< lines below the title
  std::vector<std::array<std::string, 3>> numbers;  ///< name, value, meaning
  std::vector<Section> sections;
};

/// A complete HTML page: pictures inside it as data URIs, no script, no link to anywhere, readable
/// in light and dark and without a network. All text is escaped.
std::string html(const ReportPage& page);

}  // namespace luxel::export_
