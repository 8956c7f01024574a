#include "luxel/export/html_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "luxel/base/base64.h"
#include "luxel/base/sha256.h"
#include "luxel/export/plot.h"
#include "luxel/image/codec.h"

namespace luxel::export_ {
namespace {

constexpr const char* kStyle = R"(
:root{color-scheme:light dark;--ink:#1c1e21;--soft:#5c6168;--line:#d9dce0;--page:#fff;--card:#f5f6f8}
@media(prefers-color-scheme:dark){:root{--ink:#e4e6e9;--soft:#9aa0a8;--line:#34383e;--page:#15171a;--card:#1e2125}}
*{box-sizing:border-box}
body{margin:0 auto;max-width:1200px;padding:2.5rem 1.5rem 4rem;background:var(--page);color:var(--ink);
font:16px/1.5 system-ui,-apple-system,"Segoe UI",Roboto,"Helvetica Neue",sans-serif}
h1{font-size:1.75rem;line-height:1.25;margin:0 0 .5rem}
h2{font-size:1.2rem;margin:2.75rem 0 .25rem}
p{margin:.25rem 0 1rem;max-width:75ch;color:var(--soft)}
p.lead{margin:0;color:var(--ink);max-width:none;overflow-wrap:anywhere}
table{margin-top:1.25rem;border-collapse:collapse;width:100%;font-variant-numeric:tabular-nums}
td{padding:.35rem .75rem .35rem 0;border-top:1px solid var(--line);vertical-align:baseline}
td:nth-child(2){text-align:right;white-space:nowrap;font-weight:600}
td:nth-child(3){color:var(--soft);padding-left:1.25rem;width:60%}
.panels{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(340px,100%),1fr));gap:1.25rem}
figure{margin:0;padding:.75rem;background:var(--card);border-radius:6px}
figure img,figure>svg{display:block;width:100%;height:auto}
img.small{image-rendering:pixelated}
figcaption{margin-top:.5rem;font-size:.9rem}
.legend{display:flex;flex-wrap:wrap;gap:.25rem 1rem;margin-top:.35rem;font-size:.8rem;color:var(--soft)}
.legend span{display:inline-flex;align-items:center;gap:.4rem}
figure img.key{display:inline-block;width:.8rem;height:.8rem;border-radius:2px}
figure img.wide{width:12rem;max-width:50vw}
)";

using Out = std::back_insert_iterator<std::string>;

void write_legend(const std::vector<LegendEntry>& legend, Out out) {
  if (legend.empty()) return;
  fmt::format_to(out, "<div class=\"legend\">");
  for (const LegendEntry& e : legend) {
    // A picture, since a style of one element's own is what the page's policy forbids.
    image::Image8 swatch{int(e.colors.size()), 1, 3, {}};
    for (const image::Color8& c : e.colors)
      swatch.data.insert(swatch.data.end(), c.begin(), c.end());
    fmt::format_to(
        out, "<span><img class=\"key{}\" alt=\"\" src=\"data:image/png;base64,{}\">{}</span>",
        e.colors.size() > 1 ? " wide" : "", base64(image::encode_png(swatch)), escape_xml(e.label));
  }
  fmt::format_to(out, "</div>");
}

void write_panel(const Panel& panel, Out out) {
  constexpr int kSmall = 600;  // about a column's width
  fmt::format_to(out, "<figure>");
  if (panel.svg.empty())
    fmt::format_to(out, "<img{} alt=\"{}\" src=\"data:image/png;base64,{}\">",
                   panel.width_px < kSmall ? " class=\"small\"" : "", escape_xml(panel.caption),
                   base64(panel.png));
  else
    fmt::format_to(out, "{}", panel.svg);
  fmt::format_to(out, "<figcaption>{}", escape_xml(panel.caption));
  write_legend(panel.legend, out);
  fmt::format_to(out, "</figcaption></figure>\n");
}

void write_section(const Section& section, Out out) {
  fmt::format_to(out, "<section>\n<h2>{}</h2>\n", escape_xml(section.heading));
  if (!section.text.empty()) fmt::format_to(out, "<p>{}</p>\n", escape_xml(section.text));
  fmt::format_to(out, "<div class=\"panels\">\n");
  for (const Panel& panel : section.panels) write_panel(panel, out);
  fmt::format_to(out, "</div>\n</section>\n");
}

/// Hashes of the different style elements in a page, as its policy lists them. Text of others
/// cannot make one: it is escaped.
std::string style_hashes(std::string_view page) {
  constexpr std::string_view kBegin = "<style>", kEnd = "</style>";
  std::vector<std::string_view> styles;
  for (size_t at = 0; (at = page.find(kBegin, at)) != page.npos;) {
    at += kBegin.size();
    const std::string_view style = page.substr(at, page.find(kEnd, at) - at);
    if (std::ranges::find(styles, style) == styles.end()) styles.push_back(style);
  }
  std::string out;
  for (const std::string_view style : styles)
    out += fmt::format(" 'sha256-{}'", base64(sha256(style)));
  return out;
}

/// All behind the policy.
std::string content(const ReportPage& page) {
  std::string text;
  const Out out(text);
  fmt::format_to(out,
                 "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n"
                 "<title>{0}</title>\n<style>{1}</style>\n</head>\n<body>\n<h1>{0}</h1>\n",
                 escape_xml(page.title), kStyle);
  for (const std::string& line : page.lead)
    fmt::format_to(out, "<p class=\"lead\">{}</p>\n", escape_xml(line));
  fmt::format_to(out, "<table>\n");
  for (const auto& [name, value, meaning] : page.numbers)
    fmt::format_to(out, "<tr><td>{}</td><td>{}</td><td>{}</td></tr>\n", escape_xml(name),
                   escape_xml(value), escape_xml(meaning));
  fmt::format_to(out, "</table>\n");
  for (const Section& section : page.sections) write_section(section, out);
  fmt::format_to(out, "</body>\n</html>\n");
  return text;
}

}  // namespace

std::string html(const ReportPage& page) {
  const std::string text = content(page);
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; "
      "style-src{}\">\n{}",
      style_hashes(text), text);
}

}  // namespace luxel::export_
