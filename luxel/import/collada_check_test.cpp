// Lists in .dae files that Assimp would take on trust: it waits for ever at a word that is no
// number, and reads past the ends of short lists.
#include <gmock/gmock.h>

#include "luxel/import/import_test_support.h"

namespace luxel::import {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// A square whose corners and normals are listed apart, `lists` of its faces, and a skin.
std::string square_dae(const std::string& lists, const std::string& controllers = "") {
  return R"(<?xml version="1.0"?>
<COLLADA version="1.4.1"><asset><up_axis>Y_UP</up_axis></asset><library_geometries>
<geometry id="g"><mesh><source id="p"><float_array id="pa" count="12">0 0 0 1 0 0 1 1 0 0 1 0</float_array>
<technique_common><accessor source="#pa" count="4" stride="3"><param name="X"/><param name="Y"/><param name="Z"/>
</accessor></technique_common></source>
<source id="n"><float_array id="na" count="6">0 0 1 0 0 1</float_array>
<technique_common><accessor source="#na" count="2" stride="3"><param name="X"/><param name="Y"/><param name="Z"/>
</accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
)" + lists +
         "\n</mesh></geometry></library_geometries>" + controllers +
         R"(<library_visual_scenes><visual_scene id="all"><node><instance_geometry url="#g"/></node>
</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#all"/></scene></COLLADA>)";
}

constexpr const char* kInputs =
    "<input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/>"
    "<input semantic=\"NORMAL\" source=\"#n\" offset=\"1\"/>";

std::string faces(const char* kind, int count, const std::string& lists) {
  return fmt::format("<{} count=\"{}\">{}{}</{}>", kind, count, kInputs, lists, kind);
}

std::string error_of_lists(const std::string& lists, const std::string& controllers = "") {
  const auto imported = import_text("a.dae", square_dae(lists, controllers));
  return imported ? "no error" : imported.error().message;
}

constexpr const char* kTriangles = "<p>0 0 1 0 2 0 0 1 2 1 3 1</p>";

TEST(ColladaCheck, RightListsOfEveryKindAreRead) {
  const std::pair<const char*, std::string> right[] = {
      {"triangles", faces("triangles", 2, kTriangles)},
      {"over lines", faces("triangles", 2, "<p>\n0 0\t1 0\r\n2 0 0 1\n2 1 3 1\n</p>")},
      {"polylist", faces("polylist", 1, "<vcount> 4 </vcount><p>0 0 1 0 2 0 3 0</p>")},
      {"polygons", faces("polygons", 1, "<p>0 0 1 0 2 0 3 0</p>")},
      {"trifans", faces("trifans", 1, "<p>0 0 1 0 2 0 3 0</p>")},
      {"tristrips", faces("tristrips", 1, "<p>0 0 1 0 3 0 2 0</p>")},
      {"wrong count of lines",
       faces("lines", 7, "<p>0 0 1 0</p>") + faces("triangles", 2, kTriangles)},
      {"no lists", faces("triangles", 2, kTriangles) + faces("triangles", 0, "")}};
  for (const auto& [what, lists] : right) {
    const auto imported = import_text("a.dae", square_dae(lists));
    ASSERT_TRUE(imported) << what << ": " << imported.error().message;
    EXPECT_NEAR(drawn_area(imported->scene), 1, 1e-6f) << what;
  }
}

// Each of the words `x`, `nan`, ... made Assimp fill 3 GB before it gave up.
TEST(ColladaCheck, AWordThatIsNoIndexIsNamedWithItsLine) {
  for (const char* word : {"x", "nan", "1.5", "-1", "1e3", "0x1", "<!-- 1 -->", "<![CDATA[x]]>",
                           "99999999999999999999", "&#49;", "\v1"}) {
    const std::string list = fmt::format("<p>0 0 1\n{} 2 0 0 1 2 1 3 1</p>", word);
    EXPECT_THAT(error_of_lists(faces("triangles", 2, list)),
                AllOf(HasSubstr("a.dae, line 11: '"), HasSubstr("in <p> is not a whole number")))
        << word;
  }
  EXPECT_THAT(error_of_lists(faces("polylist", 1, "<vcount>x</vcount><p>0 0 1 0 2 0 3 0</p>")),
              HasSubstr("line 10: 'x' in <vcount> is not a whole number"));
}

TEST(ColladaCheck, IndicesOutOfRangeNameWhatTheyIndex) {
  EXPECT_THAT(error_of_lists(faces("triangles", 2, "<p>0 0 1 0 4 0 0 1 2 1 3 1</p>")),
              HasSubstr("line 10: index 4 in <p> is out of range, 'v' has 4 entries"));
  EXPECT_THAT(error_of_lists(faces("triangles", 2, "<p>0 0 1 0 2 2 0 1 2 1 3 1</p>")),
              HasSubstr("index 2 in <p> is out of range, 'n' has 2 entries"));
}

TEST(ColladaCheck, CountsMustAgree) {
  const std::pair<std::string, const char*> wrong[] = {
      {faces("triangles", 3, kTriangles), "holds 12 numbers where 18 are needed"},
      {faces("triangles", 1, kTriangles), "holds 12 numbers where 6 are needed"},
      {faces("triangles", 1000000000, kTriangles), "a count of '1000000000'"},
      {faces("triangles", -1, kTriangles), "a count of '-1'"},
      {faces("polygons", 1, "<p>0 0 1 0 2</p>"), "5 numbers, which cannot be 2 for each point"},
      {faces("polylist", 2, "<vcount>4</vcount><p>0 0 1 0 2 0 3 0</p>"), "<vcount> holds 1 numb"},
      {faces("polylist", 1, "<vcount>5</vcount><p>0 0 1 0 2 0 3 0</p>"), "where 10 are needed"},
      {faces("polylist", 1, "<p>0 0 1 0 2 0 3 0</p>"), "before its <vcount>"},
      {faces("tristrips", 1, "<p>0 0</p>"), "a strip of 1 points; it needs 3"},
      {faces("tristrips", 1, "<p/>"), "a strip of 0 points; it needs 3"},
      {faces("linestrips", 1, "<p></p>"), "a strip of 0 points; it needs 2"},
      {"<triangles count=\"1\"><p>0 1 2</p></triangles>", "semantic VERTEX"},
      {"<triangles count=\"1\"><input semantic=\"VERTEX\" source=\"#v\" offset=\"-1\"/><p>0 1 "
       "2</p></triangles>",
       "offset '-1' is not"},
      {"<triangles count=\"1\"><input semantic=\"VERTEX\" source=\"#v\" "
       "offset=\"999999999\"/><p>0</p></triangles>",
       "the offset 999999999"}};
  for (const auto& [lists, message] : wrong)
    EXPECT_THAT(error_of_lists(lists), AllOf(HasSubstr("a.dae, line 10: "), HasSubstr(message)));
}

/// Weights of two joints for the square.
std::string skin(const std::string& weights) {
  return R"(<library_controllers><controller id="c"><skin source="#g">
<source id="j"><Name_array id="ja" count="2">a b</Name_array><technique_common>
<accessor source="#ja" count="2"><param name="JOINT"/></accessor></technique_common></source>
<source id="w"><float_array id="wa" count="1">1</float_array><technique_common>
<accessor source="#wa" count="1"><param name="WEIGHT"/></accessor></technique_common></source>
)" + weights +
         "</skin></controller></library_controllers>";
}
std::string weights(int count, const std::string& lists) {
  return fmt::format(
      "<vertex_weights count=\"{}\"><input semantic=\"JOINT\" source=\"#j\" offset=\"0\"/>"
      "<input semantic=\"WEIGHT\" source=\"#w\" offset=\"1\"/>{}</vertex_weights>",
      count, lists);
}

TEST(ColladaCheck, WeightsOfSkins) {
  const std::string square = faces("triangles", 2, kTriangles);
  const auto error = [&](const std::string& lists) { return error_of_lists(square, skin(lists)); };
  EXPECT_EQ(error(weights(4, "<vcount>1 1 1 1</vcount><v>0 0 1 0 0 0 -1 0</v>")), "no error");
  EXPECT_THAT(error(weights(4, "<vcount>1 1 1 4000000000</vcount><v>0 0</v>")),
              HasSubstr("'4000000000' in <vcount>"));
  EXPECT_THAT(error(weights(4, "<vcount>1 1 1 2000000000</vcount><v>0 0 1 0 0 0 1 0</v>")),
              HasSubstr("<v> holds 8 numbers where 4000000006 are needed"));
  EXPECT_THAT(error(weights(4, "<vcount>1 1 1 1</vcount><v>0 0 2 0 0 0 1 0</v>")),
              HasSubstr("index 2 in <v> is out of range, 'j' has 2 entries"));
  EXPECT_THAT(error(weights(4, "<vcount>1 1 1 1</vcount><v>0 0 1 1 0 0 1 0</v>")),
              HasSubstr("index 1 in <v> is out of range, 'w' has 1 entries"));
  EXPECT_THAT(error(weights(3, "<vcount>1 1 1</vcount><v>0 0 1 0 0 0</v>")),
              HasSubstr("weights for 3 vertices, but 'g' has 4"));
}

// A name that a parser reads in another way than it stands there would get round the checks.
TEST(ColladaCheck, NamesAreComparedAsTheyStand) {
  std::string text = square_dae(faces("triangles", 2, kTriangles));
  text.replace(text.find("id=\"pa\" count=\"12\""), 18, "id=\"&#112;a\" count=\"1\"");
  const auto imported = import_text("a.dae", text);
  ASSERT_FALSE(imported);
  EXPECT_THAT(imported.error().message, HasSubstr("the id '&#112;a' holds a reference"));
  // The first attribute of a name counts, and none in another's quotes.
  text = square_dae(faces("triangles", 2, kTriangles));
  text.replace(text.find("count=\"4\""), 9, "name=\"> count='4'\" count=\"9\"");
  EXPECT_THAT(import_text("a.dae", text).error().message, HasSubstr("past the float_array 'pa'"));
}

}  // namespace
}  // namespace luxel::import
