#include "luxel/export/html_report.h"

#include <gmock/gmock.h>

namespace luxel::export_ {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::vector<std::byte> bytes(std::initializer_list<int> values) {
  std::vector<std::byte> out;
  for (const int v : values) out.push_back(std::byte(v));
  return out;
}

ReportPage page_with(const std::string& word) {
  ReportPage page{word, {word, word}, {{word, word, word}}, {{word, word, {}}}};
  Panel picture;
  picture.caption = word;
  picture.png = bytes({'f', 'o', 'o'});
  picture.legend = {{{{18, 52, 86}}, word}, {{{0, 0, 0}, {255, 255, 255}}, "ramp"}};
  page.sections[0].panels = {picture};
  return page;
}

TEST(HtmlReport, EveryWordIsEscaped) {
  const std::string text = html(page_with("<b onclick=\"x\">'&"));
  EXPECT_THAT(text, Not(HasSubstr("<b ")));
  EXPECT_THAT(text, HasSubstr("&lt;b onclick=&quot;x&quot;&gt;&#39;&amp;"));
}

TEST(HtmlReport, PicturesAreInside) {
  ReportPage page = page_with("w");
  page.sections[0].panels[0].width_px = 100;
  EXPECT_THAT(html(page), HasSubstr("<img class=\"small\" alt=\"w\" "
                                    "src=\"data:image/png;base64,Zm9v\">"));
  page.sections[0].panels[0].width_px = 2000;
  EXPECT_THAT(html(page), HasSubstr("<img alt=\"w\" src=\"data:image/png;base64,Zm9v\">"));
  page.sections[0].panels[0].svg = "<svg></svg>";
  EXPECT_THAT(html(page), HasSubstr("<figure><svg></svg><figcaption>"));
  EXPECT_THAT(html(page), Not(HasSubstr("<figure><img")));
}

/// Every element that is opened is closed, in order.
TEST(HtmlReport, ElementsNest) {
  const std::string text = html(page_with("w"));
  std::vector<std::string> open;
  for (size_t at = text.find('<'); at != std::string::npos; at = text.find('<', at + 1)) {
    const bool closes = text[at + 1] == '/';
    const size_t begin = at + (closes ? 2 : 1);
    const std::string name = text.substr(begin, text.find_first_of(" >", begin) - begin);
    if (name == "!DOCTYPE" || name == "meta" || name == "img") continue;
    if (!closes) {
      open.push_back(name);
      continue;
    }
    ASSERT_FALSE(open.empty());
    EXPECT_EQ(open.back(), name);
    open.pop_back();
  }
  EXPECT_TRUE(open.empty());
}

}  // namespace
}  // namespace luxel::export_
