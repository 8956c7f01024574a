// Files whose parts lie in each other too deep, in circles, or in more copies than memory holds:
// Assimp's stack would overflow, or it would never end.
#include <gmock/gmock.h>
#include <zlib.h>

#include "luxel/import/test_files.h"

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
  // What is no element does not hide any: a comment in quotes, a quote in a comment.
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
  // What Assimp says of the same file with less of it: no objects.
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

TEST(Nesting, OtherFormatsThatAssimpCallsItselfFor) {
  const std::pair<const char*, std::string> files[] = {
      {"a.bvh",
       "HIERARCHY\nROOT r\n" + nested("{ OFFSET 0 0 0 CHANNELS 0 JOINT j\n", "}\n", kDeep)},
      {"a.ac", "AC3Db\n" + repeated("OBJECT group\nkids 1\n", kDeep)},
      {"a.xgl", "<WORLD>" + nested("<OBJECT>", "</OBJECT>", kDeep) + "</WORLD>"},
      {"a.ase", "*3DSMAX_ASCIIEXPORT 200\n*MATERIAL_LIST {\n*MATERIAL_COUNT 1\n*MATERIAL 0 {\n" +
                    nested("*NUMSUBMTLS 1\n*SUBMATERIAL 0 {\n", "}\n", kDeep)},
      {"a.ifc",
       "ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('IFC2X3'));\nENDSEC;\nDATA;\n"
       "#1=IFCPROJECT('a'," +
           nested("(", ")", kDeep) + ");\nENDSEC;\n"},
      {"a.lws", "LWSC\n3\n\n" + nested("{ Item\n", "}\n", kDeep)}};
  for (const auto& [name, text] : files)
    EXPECT_THAT(error_of_text(name, text),
                AllOf(HasSubstr(fmt::format("{}, line ", name)), HasSubstr("more than 1000")));
}

/// Each item's parent is the one before it.
std::string lws_chain(int count) {
  std::string text = "LWSC\n3\n\nAddNullObject first\nParentItem 0\n";
  for (int i = 1; i < count; ++i)
    text += fmt::format("AddNullObject item\nParentItem {:x}\n", 0x10000000 + i - 1);
  return text;
}

TEST(Nesting, ParentsOfLightWaveItems) {
  EXPECT_THAT(error_of_text("a.lws", lws_chain(kDeep)),
              HasSubstr("a.lws, line 8005: more than 4000 items have a parent"));
}

/// The longest chain that Assimp gets leaves room on its stack.
TEST(Nesting, TheLongestChainOfLightWaveItemsGivesAResult) {
  EXPECT_THAT(error_of_text("a.lws", lws_chain(4000)), HasSubstr("a.lws"));
}

std::string deflated(const std::string& text) {
  std::string out(text.size() + 1000, '\0');
  z_stream stream{};
  EXPECT_EQ(deflateInit2(&stream, 9, Z_DEFLATED, -MAX_WBITS, 9, Z_DEFAULT_STRATEGY), Z_OK);
  std::string in = text;
  stream.next_in = reinterpret_cast<Bytef*>(in.data()), stream.avail_in = uInt(in.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data()), stream.avail_out = uInt(out.size());
  EXPECT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}

/// A zip archive of files; their names and texts.
std::string zipped(const std::vector<std::pair<std::string, std::string>>& files) {
  std::string archive, list;
  for (const auto& [name, text] : files) {
    const std::string packed = deflated(text);
    const auto crc =
        uint32_t(crc32(0, reinterpret_cast<const Bytef*>(text.data()), uInt(text.size())));
    const std::string about =
        bytes_of<uint16_t>({20, 0, 8, 0, 0x21}) +
        bytes_of<uint32_t>({crc, uint32_t(packed.size()), uint32_t(text.size())}) +
        bytes_of<uint16_t>({uint16_t(name.size()), 0});
    list += "PK\1\2" + bytes_of<uint16_t>({20}) + about + bytes_of<uint16_t>({0, 0, 0}) +
            bytes_of<uint32_t>({0, uint32_t(archive.size())}) + name;
    archive += "PK\3\4" + about + name + packed;
  }
  const auto count = uint16_t(files.size());
  return archive + list + "PK\5\6" + bytes_of<uint16_t>({0, 0, count, count}) +
         bytes_of<uint32_t>({uint32_t(list.size()), uint32_t(archive.size())}) +
         bytes_of<uint16_t>({0});
}

/// A .3mf file of these objects, which builds object 1.
std::string printed(const std::string& objects) {
  return zipped(
      {{"[Content_Types].xml", "<Types/>"},
       {"_rels/.rels",
        "<Relationships><Relationship Target=\"/3D/a.model\" Id=\"rel0\" "
        "Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>"},
       {"3D/a.model", "<?xml version=\"1.0\"?><model unit=\"meter\"><resources>\n" + objects +
                          "</resources><build><item objectid=\"1\"/></build></model>"}});
}

std::string object_of_others(int id, const std::string& others) {
  return fmt::format("<object id=\"{}\"><components>{}</components></object>\n", id, others);
}

TEST(Nesting, ScenesInArchives) {
  const std::string deep = nested("<node>\n", "</node>", kDeep);
  EXPECT_THAT(error_of_text("a.zae", zipped({{"b.png", "x"}, {"c", dae("", deep)}})),
              AllOf(HasSubstr("a.zae, c, line 1"), HasSubstr("more than 1000 elements")));
  EXPECT_THAT(
      error_of_text("a.zgl", "xx" + deflated("<WORLD>" + nested("<OBJECT>", "</OBJECT>", kDeep))),
      HasSubstr("a.zgl, line 1: more than 1000 elements"));
  EXPECT_THAT(
      error_of_text("a.ifczip", zipped({{"b.ifc", "ISO-10303-21;\n" + nested("(", ")", kDeep)}})),
      HasSubstr("a.ifczip, b.ifc, line 2: more than 1000 brackets"));
  EXPECT_THAT(error_of_text("a.3mf", printed(object_of_others(1, "<component objectid=\"1\"/>"))),
              HasSubstr("a.3mf, 3D/a.model, line 2: the object there holds itself"));
  std::string chain;
  for (int i = 1; i <= kDeep; ++i)
    chain += object_of_others(i, fmt::format("<component objectid=\"{}\"/>", i + 1));
  EXPECT_THAT(error_of_text("a.3mf", printed(chain)),
              HasSubstr("holds more than 1000 nested others"));
  EXPECT_THAT(error_of_text("a.3mf", "PK\5\6"), HasSubstr("not a zip archive"));
}

TEST(Nesting, AnArchiveThatIsRightIsRead) {
  const scene::Scene scene = scene_of(import_text(
      "a.3mf",
      printed("<object id=\"2\"><mesh><vertices><vertex x=\"0\" y=\"0\" z=\"0\"/><vertex x=\"2\" "
              "y=\"0\" z=\"0\"/><vertex x=\"0\" y=\"1\" z=\"0\"/></vertices><triangles><triangle "
              "v1=\"0\" v2=\"1\" v3=\"2\"/></triangles></mesh></object>" +
              object_of_others(1, "<component objectid=\"2\"/>"))));
  EXPECT_NEAR(drawn_area(scene), 1, 1e-6f);
}

TEST(Nesting, ADamagedArchiveAlwaysGivesAResult) {
  const std::string archive = printed(object_of_others(1, "<component objectid=\"2\"/>"));
  const TemporaryFolder folder;
  for (size_t length = 0; length < archive.size(); length += 17)
    EXPECT_FALSE(import_scene(folder.write("cut.3mf", archive.substr(0, length)))) << length;
  for (size_t at = 0; at < archive.size(); at += 5) {
    std::string damaged = archive;
    damaged[at] = char(damaged[at] ^ "\x01\x80\xff"[at % 3]);
    (void)import_scene(folder.write("flipped.3mf", damaged));
  }
}

}  // namespace
}  // namespace luxel::import
