#include "luxel/export/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "luxel/base/shown_text.h"
#include "luxel/export/plot_axis.h"

namespace luxel::export_ {
namespace {

/// Colours that most colour-blind readers tell apart; the first is lighter on a dark page.
constexpr const char* kPlotStyle =
    ".lp{font:12px system-ui,sans-serif;fill:#222}.lp .t{font-size:14px;font-weight:600}"
    ".lp .g{stroke:#8888;stroke-width:.5}.lp .m{stroke:#8884;stroke-width:.5}"
    ".lp .f{stroke:#888;fill:none}.lp .s{fill:none;stroke-width:1.8;stroke-linejoin:round}"
    ".lp .a{fill-opacity:.3;stroke-width:1}"
    ".lp .c0{stroke:#0072b2;color:#0072b2}.lp .c1{stroke:#d55e00;color:#d55e00}"
    ".lp .c2{stroke:#009e73;color:#009e73}.lp .c3{stroke:#b8609a;color:#b8609a}"
    ".lp .c4{stroke:#c28500;color:#c28500}.lp .c5{stroke:#777;color:#777}"
    "@media(prefers-color-scheme:dark){.lp{fill:#ddd}.lp .c0{stroke:#56b4e9;color:#56b4e9}}";
constexpr size_t kColors = 6;

/// The rectangle between the axes, in pixels.
struct Frame {
  double left, top, right, bottom;
  Axis x, y;
  double px(double v) const { return left + x.position(v) * (right - left); }
  double py(double v) const { return bottom - y.position(v) * (bottom - top); }
};

using Out = std::back_insert_iterator<std::string>;

Axis axis_for(const Plot& plot, size_t dimension) {
  const bool log = dimension == 0 ? plot.log_x : plot.log_y;
  const auto& range = dimension == 0 ? plot.x_range : plot.y_range;
  if (range) return make_axis((*range)[0], (*range)[1], log, true);
  double low = INFINITY, high = -INFINITY;
  const Axis any{plot.log_x, 0, 1, {}}, other{plot.log_y, 0, 1, {}};
  for (const Series& s : plot.series) {
    for (const auto& p : s.points)
      if (any.can_show(p[0]) && other.can_show(p[1]))
        low = std::min(low, p[dimension]), high = std::max(high, p[dimension]);
    // Areas stand on the ground.
    if (s.stroke == Stroke::steps && dimension == 1 && !log) low = std::min(low, 0.0);
  }
  return make_axis(low, high, log, false);
}

size_t longest_label(const Axis& axis) {
  size_t longest = 0;
  for (const Tick& t : axis.ticks) longest = std::max(longest, t.label.size());
  return longest;
}

Frame frame_of(const Plot& plot) {
  Frame f{0, 0, 0, 0, axis_for(plot, 0), axis_for(plot, 1)};
  size_t longest_name = 0;
  for (const Series& s : plot.series) longest_name = std::max(longest_name, s.name.size());
  const double letter = 6.6;  // about the width of one at 12 px
  f.left = (plot.y_label.empty() ? 16.0 : 34.0) + letter * double(longest_label(f.y));
  f.right = plot.width - (longest_name ? 40 + letter * double(longest_name) : 16.0);
  f.right = std::max(f.right, f.left + 50);
  f.top = plot.title.empty() ? 12 : 34;
  f.bottom = plot.height - (plot.x_label.empty() ? 26 : 44);
  return f;
}

void draw_axes(const Plot& plot, const Frame& f, Out out) {
  // Grid lines with labels, finer ones without; then the frame, the title and the axes' labels.
  for (const Tick& t : f.x.ticks) {
    const double x = f.px(t.value);
    fmt::format_to(out, "<path class=\"{}\" d=\"M{:.1f} {:.1f}V{:.1f}\"/>",
                   t.label.empty() ? "m" : "g", x, f.top, f.bottom);
    if (!t.label.empty())
      fmt::format_to(out, "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>", x,
                     f.bottom + 16, t.label);
  }
  for (const Tick& t : f.y.ticks) {
    const double y = f.py(t.value);
    fmt::format_to(out, "<path class=\"{}\" d=\"M{:.1f} {:.1f}H{:.1f}\"/>",
                   t.label.empty() ? "m" : "g", f.left, y, f.right);
    if (!t.label.empty())
      fmt::format_to(out, "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>",
                     f.left - 6, y + 4, t.label);
  }
  fmt::format_to(out,
                 "<rect class=\"f\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"/>",
                 f.left, f.top, f.right - f.left, f.bottom - f.top);
  const double mid_x = (f.left + f.right) / 2, mid_y = (f.top + f.bottom) / 2;
  if (!plot.title.empty())
    fmt::format_to(out, "<text class=\"t\" x=\"{:.1f}\" y=\"20\">{}</text>", f.left,
                   escape_xml(plot.title));
  if (!plot.x_label.empty())
    fmt::format_to(out, "<text x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\">{}</text>", mid_x,
                   plot.height - 8, escape_xml(plot.x_label));
  if (!plot.y_label.empty())
    fmt::format_to(out,
                   "<text transform=\"translate(16 {:.1f})rotate(-90)\" "
                   "text-anchor=\"middle\">{}</text>",
                   mid_y, escape_xml(plot.y_label));
}

/// In pixels. Far outside the frame points are moved to where numbers stay small; the clip hides
/// them. A step whose height cannot be shown (0 on a logarithmic axis) lies on the ground.
std::vector<std::array<double, 2>> pixels_of(const Series& s, const Frame& f) {
  std::vector<std::array<double, 2>> out;
  for (const auto& p : s.points) {
    const bool ground = s.stroke == Stroke::steps && !f.y.can_show(p[1]);
    if (!f.x.can_show(p[0]) || (!f.y.can_show(p[1]) && !ground)) continue;
    const double y = ground ? f.bottom : f.py(p[1]);
    out.push_back({std::clamp(f.px(p[0]), -1e4, 1e4), std::clamp(y, -1e4, 1e4)});
  }
  return out;
}

void draw_steps(const std::vector<std::array<double, 2>>& points, const Frame& f, size_t color,
                Out out) {
  fmt::format_to(out, "<path class=\"a c{}\" fill=\"currentColor\" d=\"M{:.1f} {:.1f}", color,
                 points.front()[0], f.bottom);
  for (size_t i = 0; i < points.size(); ++i) {
    // The last step is as wide as the one before; one alone goes on to the end.
    const bool last = i + 1 == points.size();
    const double next = !last               ? points[i + 1][0]
                        : points.size() > 1 ? 2 * points[i][0] - points[i - 1][0]
                                            : f.right;
    fmt::format_to(out, "V{:.1f}H{:.1f}", points[i][1], next);
  }
  fmt::format_to(out, "V{:.1f}Z\"/>", f.bottom);
}

void draw_series(const Series& s, const Frame& f, size_t color, Out out) {
  const auto points = pixels_of(s, f);
  if (points.empty()) return;
  if (s.stroke == Stroke::steps) return draw_steps(points, f, color, out);
  fmt::format_to(out, "<polyline class=\"s c{}\"{} points=\"", color,
                 s.stroke == Stroke::dashed ? " stroke-dasharray=\"6 4\"" : "");
  for (const auto& p : points) fmt::format_to(out, "{:.1f},{:.1f} ", p[0], p[1]);
  fmt::format_to(out, "\"/>");
  if (s.stroke != Stroke::markers) return;
  for (const auto& p : points)
    fmt::format_to(
        out, "<circle class=\"c{}\" fill=\"currentColor\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\"/>",
        color, p[0], p[1]);
}

void draw_legend(const Plot& plot, const Frame& f, Out out) {
  double y = f.top + 10;
  for (size_t i = 0; i < plot.series.size(); ++i) {
    const Series& s = plot.series[i];
    if (s.name.empty()) continue;
    fmt::format_to(out, "<path class=\"s c{}\"{} d=\"M{:.1f} {:.1f}h16\"/>", i % kColors,
                   s.stroke == Stroke::dashed ? " stroke-dasharray=\"6 4\"" : "", f.right + 10, y);
    fmt::format_to(out, "<text x=\"{:.1f}\" y=\"{:.1f}\">{}</text>", f.right + 31, y + 4,
                   escape_xml(s.name));
    y += 18;
  }
}

}  // namespace

std::string escape_xml(const std::string& text) {
  std::string out;
  for (const char c : shown_text(text)) {  // XML has no control characters, either
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else if (c == '\'')
      out += "&#39;";
    else
      out += c;
  }
  return out;
}

std::string svg(const Plot& plot) {
  const Frame f = frame_of(plot);
  std::string text;
  const Out out(text);
  fmt::format_to(out,
                 "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"lp\" width=\"{0}\" "
                 "height=\"{1}\" viewBox=\"0 0 {0} {1}\" role=\"img\"><style>{2}</style>",
                 plot.width, plot.height, kPlotStyle);
  draw_axes(plot, f, out);
  // An svg inside has its own edges: what lies outside the frame is not seen.
  fmt::format_to(out,
                 "<svg x=\"{0:.1f}\" y=\"{1:.1f}\" width=\"{2:.1f}\" height=\"{3:.1f}\" "
                 "viewBox=\"{0:.1f} {1:.1f} {2:.1f} {3:.1f}\">",
                 f.left, f.top, f.right - f.left, f.bottom - f.top);
  for (size_t i = 0; i < plot.series.size(); ++i) draw_series(plot.series[i], f, i % kColors, out);
  fmt::format_to(out, "</svg>");
  draw_legend(plot, f, out);
  fmt::format_to(out, "</svg>\n");
  return text;
}

}  // namespace luxel::export_
