#include "luxel/base/text_tables.h"

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

TEST(TextTables, ACellIsATextWhateverItStartsWith) {
  for (const auto& [text, cell] : {std::pair("wall 1", "wall 1"),
                                   {"a,b", "\"a,b\""},
                                   {"\"a\"", "\"\"\"a\"\"\""},
                                   {"", ""},
                                   {"=1+1", "\"'=1+1\""},
                                   {"+a", "\"'+a\""},
                                   {"-1", "\"'-1\""},
                                   {"@x", "\"'@x\""},
                                   {"  =1", "\"'  =1\""},
                                   {"a=1", "a=1"},
                                   {"\t=1\n", "\\t=1\\n"},
                                   {"T\xfcr", "T\\xfcr"}}) {
    EXPECT_EQ(csv_cell(text), cell);
    const auto rows = csv_rows("header\n" + csv_cell(text) + ",2\n");
    ASSERT_EQ(rows.size(), 1u);
    EXPECT_EQ(rows[0].size(), 2u);
  }
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

TEST(TextTables, PolygonsAreCornersOfThreeNumbers) {
  const auto polygons = parse_polygons("0 0 0; 1.5 0  -2; 0 1e-3 0|4 5 6");
  ASSERT_TRUE(polygons);
  ASSERT_EQ(polygons->size(), 2u);
  ASSERT_EQ((*polygons)[0].size(), 3u);
  EXPECT_EQ((*polygons)[0][1].x, 1.5);
  EXPECT_EQ((*polygons)[0][1].z, -2);
  EXPECT_EQ((*polygons)[0][2].y, 1e-3);
  EXPECT_EQ((*polygons)[1][0].z, 6);
  EXPECT_TRUE(parse_polygons("")->empty());
}

TEST(TextTables, WhatIsNoPolygonIsASentence) {
  const auto message = [](const auto& result) { return result ? "" : result.error().message; };
  EXPECT_EQ(message(parse_polygon("0 0 0; 1 2")), "' 1 2' is not a corner: it needs three numbers");
  EXPECT_EQ(message(parse_polygon("")), "'' is not a corner: it needs three numbers");
  EXPECT_EQ(message(parse_polygon("0 0 0 0")), "'0 0 0 0' is not a corner: it needs three numbers");
  EXPECT_EQ(message(parse_polygons("0 0 0|0 0 1x")), "'1x' is not a number");
  for (const char* bad : {"", "nan", "inf", "1e999", "1 ", "-"})
    EXPECT_EQ(message(parse_number(bad)), fmt::format("'{}' is not a number", bad));
  EXPECT_EQ(*parse_number("-2.5e-1"), -0.25);
}

}  // namespace
}  // namespace luxel
