#include "base/text_tables.h"

#include <gtest/gtest.h>

namespace luxel {
namespace {

TEST(TextTables, CsvCellsMayHoldCommasAndQuotes) {
  const auto rows = csv_rows("# a comment\nname,value\na,1\n\"b, the \"\"second\"\"\",\r\n\n,x");
  const std::vector<TextRow> expected{{"a", "1"}, {"b, the \"second\"", ""}, {"", "x"}};
  EXPECT_EQ(rows, expected);
  EXPECT_TRUE(csv_rows("only,a,header\n").empty());
  EXPECT_TRUE(csv_rows("").empty());
}

TEST(TextTables, TheMarkdownTableUnderItsHeading) {
  const char* text =
      "# One\n| n | v |\n|---|---|\n| 1 | no |\n\n## Two, the second\nwords\n| x | y |\n|---|---|\n"
      "| 5 | 6 |\n\n| n | v |\n|---|---|\n| 7 |  8 a  |\n| 9 | |\nend\n| 3 | 4 |\n";
  const std::vector<TextRow> expected{{"7", "8 a"}, {"9", ""}};
  EXPECT_EQ(markdown_rows(text, "second", "n"), expected);
  EXPECT_TRUE(markdown_rows(text, "Three", "n").empty());
  EXPECT_TRUE(markdown_rows(text, "second", "w").empty());
}

}  // namespace
}  // namespace luxel
