// Files whose parts lie in each other too deep, in circles, or in more copies than memory holds:
// Assimp's stack would overflow, or it would never end.
#include <gmock/gmock.h>

#include "luxel/import/import_test_support.h"

namespace luxel::import {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// Far more than the limit, and more than Assimp's stack has room for in every format.
constexpr int kDeep = 50000;

std::string repeated(const std::string& text, int count) {
  std::string all;
  for (int i = 0; i < count; ++i) all += text;
  return all;
}

std::string nested(const std::string& open, const std::string& close, int depth) {
  return repeated(open, depth) + repeated(close, depth);
}

std::string error_of_text(const std::string& name, const std::string& text) {
  const auto imported = import_text(name, text);
  return imported ? "no error" : imported.error().message;
}

std::string dae(const std::string& libraries, const std::string& nodes) {
  return "<?xml version=\"1.0\"?>\n<COLLADA "
         "version=\"1.4.1\"><asset><up_axis>Y_UP</up_axis></asset>" +
         libraries + "<library_visual_scenes><visual_scene id=\"all\">\n" + nodes +
         "</visual_scene></library_visual_scenes>"
         "<scene><instance_visual_scene url=\"#all\"/></scene></COLLADA>";
}

/// Nodes of which each holds the next one, `times` times.
std::string library_of_nodes(int count, int times) {
  std::string nodes = "<library_nodes>\n";
  for (int i = 0; i < count; ++i)
    nodes += fmt::format("<node id=\"n{}\">{}</node>\n", i,
                         repeated(fmt::format("<instance_node url=\"#n{}\"/>", i + 1), times));
  return nodes + fmt::format("<node id=\"n{}\"/></library_nodes>", count);
}

constexpr const char* kFirstOfLibrary = "<node><instance_node url=\"#n0\"/></node>";
constexpr const char* kFbxHead =
    "FBXHeaderExtension: {\nFBXVersion: 7400\n}\nGlobalSettings: {\nVersion: 1000\n}\n";

/// Models 1 to `count`, and how they are connected: pairs of child and parent.
std::string fbx_models(int count, const std::vector<std::pair<int, int>>& pairs) {
  std::string text = std::string(kFbxHead) + "Objects: {\n";
  for (int i = 1; i <= count; ++i)
    text += fmt::format("Model: {}, \"Model::m{}\", \"Null\" {{\nVersion: 232\n}}\n", i, i);
  text += "}\nConnections: {\n";
  for (const auto& [child, parent] : pairs) text += fmt::format("C: \"OO\",{},{}\n", child, parent);
  return text + "}\n";
}

std::vector<std::pair<int, int>> chain(int count, int times) {
  std::vector<std::pair<int, int>> pairs;
  for (int i = 1; i <= count; ++i)
    for (int k = 0; k < times; ++k) pairs.emplace_back(i, i - 1);
  return pairs;
}

/// Blocks in a binary file of version 7400 end at an offset of 32 bits and hold 13 zeros last.
std::string nested_binary_fbx(int depth) {
  std::string file = std::string("Kaydara FBX Binary  \0\x1a\0", 23) + bytes_of<uint32_t>({7400});
  const size_t end = file.size() + size_t(depth) * (14 + 13);
  for (int i = 0; i < depth; ++i)
    file += bytes_of<uint32_t>({uint32_t(end - size_t(i) * 13), 0, 0}) + "\1a";
  return file + std::string(size_t(depth + 1) * 13, '\0');
}

TEST(Nesting, DeepColladaNodesNameTheLineAndTheLimit) {
  EXPECT_THAT(error_of_text("a.dae", dae("", nested("<node>\n", "</node>", kDeep))),
              AllOf(HasSubstr("a.dae, line 1"), HasSubstr("more than 1000 elements")));
  EXPECT_THAT(error_of_text("a.dae", dae("", nested("<node>", "</node>", 900))),
              HasSubstr("no triangles"));
  // Comments in quotes and quotes in comments hide no elements.
  const std::string tricks = "<x a=\"<!--\"/><!-- ' --><![CDATA[ <!-- ]]><?x <!-- ?>";
  EXPECT_THAT(error_of_text("a.dae", dae(tricks, nested("<node>", "</node>", kDeep))),
              HasSubstr("more than 1000 elements"));
  // And what is none does not count.
  EXPECT_THAT(error_of_text("a.dae", dae("<!--" + repeated("<a>", kDeep) + "-->", "<node/>")),
              HasSubstr("no triangles"));
}

TEST(Nesting, ColladaNodesThatInstanceEachOther) {
  EXPECT_THAT(error_of_text("a.dae", dae(library_of_nodes(kDeep, 1), kFirstOfLibrary)),
              AllOf(HasSubstr("a.dae, line "), HasSubstr("holds more than 1000 nested others")));
  EXPECT_THAT(
      error_of_text("a.dae", dae(library_of_nodes(40, 2), kFirstOfLibrary)),
      AllOf(HasSubstr("a.dae, line "), HasSubstr("more than 1000000 others, counting copies")));
  EXPECT_THAT(error_of_text("a.dae", dae("",
                                         "<node id=\"a\">\n<node name=\"b\"><instance_node "
                                         "url=\"#a\"/></node></node>")),
              AllOf(HasSubstr("a.dae, line 3: the node holds itself")));
  EXPECT_THAT(error_of_text("a.dae", dae(library_of_nodes(5, 1), kFirstOfLibrary)),
              HasSubstr("no triangles"));
}

TEST(Nesting, DeepBlocksOfFbx) {
  EXPECT_THAT(error_of_text("a.fbx", kFbxHead + nested("a: {\n", "}\n", kDeep)),
              AllOf(HasSubstr("a.fbx, line 1007: more than 1000 blocks")));
  EXPECT_THAT(error_of_text("a.fbx", nested_binary_fbx(kDeep)),
              AllOf(HasSubstr("a.fbx, byte 14027: more than 1000 blocks")));
  // With fewer blocks Assimp reads the same file, and finds no objects in it.
  EXPECT_THAT(error_of_text("a.fbx", kFbxHead + nested("a: {\n", "}\n", 900)),
              Not(HasSubstr("blocks")));
  EXPECT_THAT(error_of_text("a.fbx", nested_binary_fbx(900)), Not(HasSubstr("blocks")));
}

TEST(Nesting, ModelsThatFbxConnects) {
  EXPECT_THAT(error_of_text("a.fbx", fbx_models(kDeep, chain(kDeep, 1))),
              AllOf(HasSubstr("a.fbx, line "), HasSubstr("holds more than 1000 nested others")));
  EXPECT_THAT(
      error_of_text("a.fbx", fbx_models(40, chain(40, 2))),
      AllOf(HasSubstr("a.fbx, line "), HasSubstr("more than 1000000 others, counting copies")));
  EXPECT_THAT(error_of_text("a.fbx", fbx_models(2, {{1, 0}, {2, 1}, {1, 2}})),
              HasSubstr("a.fbx, line 8: the model there holds itself"));
}

}  // namespace
}  // namespace luxel::import
