// A page of numbers, pictures and plots in one file that needs nothing else.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "luxel/image/false_color.h"

namespace luxel::export_ {

/// A colour, or a ramp of several from left to right, under a picture, with words.
struct LegendEntry {
  std::vector<image::Color8> colors;
  std::string label;
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
/// in light and dark and without a network. All text is escaped. Its Content-Security-Policy allows
/// no script, and no style but those that are in it [CSP Level 3, section 8.3].
std::string html(const ReportPage& page);

}  // namespace luxel::export_
