// The content of a file decides what reads it, whatever its name ends in.
#include "luxel/import/format.h"

#include <gmock/gmock.h>

#include "luxel/import/import_test_support.h"
#include "luxel/import/other_process.h"

namespace luxel::import {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// A triangle of area 1/2 in the format of each ending.
std::map<std::string, std::string> triangle_in_each_format() {
  const std::string binary_stl = std::string(80, ' ') + bytes_of<uint32_t>({1}) +
                                 bytes_of<float>({0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0}) + "  ";
  Gltf gltf;
  gltf.draw({{"attributes", {{"POSITION", gltf.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3", 3)}}}});
  nlohmann::json document = gltf.json;
  document["buffers"] = {{{"byteLength", gltf.buffer.size()},
                          {"uri",
                           "data:application/octet-stream;base64,"
                           "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}}};
  return {{".glb", gltf.glb()},
          {".gltf", "\xEF\xBB\xBF \n" + document.dump()},
          {".obj", "\n# by hand\no it\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"},
          {".x", "xof 0303txt 0032\nMesh {\n3;\n0;0;0;,\n1;0;0;,\n0;1;0;;\n1;\n3;0,1,2;;\n}\n"},
          {".ply",
           "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
           "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
           "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"},
          {".stl", binary_stl},
          {".dae", R"(<?xml version="1.0"?><!-- <a> --><COLLADA version="1.4.1"><asset/>
<library_geometries><geometry id="g"><mesh><source id="p"><float_array id="a" count="9">
0 0 0 1 0 0 0 1 0</float_array><technique_common><accessor source="#a" count="3" stride="3">
<param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>
</accessor></technique_common></source><vertices id="v"><input semantic="POSITION" source="#p"/>
</vertices><triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p>
</triangles></mesh></geometry></library_geometries><library_visual_scenes><visual_scene id="s">
<node><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes><scene>
<instance_visual_scene url="#s"/></scene></COLLADA>)"}};
}

TEST(Format, TheContentDecides) {
  for (const auto& [format, text] : triangle_in_each_format())
    for (const char* name : {"a.glb", "a.OBJ", "a.fbx", "a.stl", "a.off", "a.unknown", "a"}) {
      const auto imported = import_text(name, text);
      EXPECT_NEAR(drawn_area(scene_of(imported)), 0.5f, 1e-6f) << format << " as " << name;
    }
}

TEST(Format, GltfIsToldFromOthersByItsFirstBytes) {
  const TemporaryFolder folder;
  const std::map<std::string, std::string> files = triangle_in_each_format();
  EXPECT_TRUE(is_gltf_file(folder.write("a.obj", files.at(".glb"))));
  EXPECT_TRUE(is_gltf_file(folder.write("b", files.at(".gltf"))));
  EXPECT_FALSE(is_gltf_file(folder.write("c.glb", files.at(".ply"))));
  EXPECT_TRUE(is_gltf_file("no longer there.GLB"));
}

std::string format_of_text(const std::string& text) {
  const auto bytes = std::as_bytes(std::span(text));
  return format_of({bytes.begin(), bytes.end()}, ".own");
}

TEST(Format, IsToldByMarksAndWords) {
  EXPECT_EQ(format_of_text(std::string("Kaydara FBX Binary  \0\x1a\0", 23)), ".fbx");
  EXPECT_EQ(format_of_text("; FBX 7.4.0 project file\n"), ".fbx");
  EXPECT_EQ(format_of_text("FBXHeaderExtension: {\n"), ".fbx");
  EXPECT_EQ(format_of_text("solid x\n facet normal 0 0 1\n"), ".stl");
  // Words of other formats between those of .obj, numbers that are none, JSON and XML of others.
  for (const char* other :
       {"v\nfrom 0 0 5\nat 0 0 0\n", "v 0 0 0\nsphere 1\n", "v 0 0 x\n", "f 1 2 3\n", "# v 0 0 0\n",
        "{\"scene\": 1}", "<X3D/>", "<!-- <COLLADA> --><X3D/>", "solid rock", "plywood", "BLENDER",
        "", "<", "\xEF\xBB\xBF"})
    EXPECT_EQ(format_of_text(other), ".own") << other;
}

// A damaged file goes to the reader of its name, and to no other one.
TEST(Format, TheNameCountsWhereTheContentSaysNothing) {
  EXPECT_THAT(error_of(import_text("a.ply", "plo\nformat ascii 1.0\n")), HasSubstr("a.ply"));
  for (const char* name : {"a.fbx", "a.stl", "a.x"})
    EXPECT_THAT(error_of(import_text(name, "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")),
                AllOf(HasSubstr(name), Not(HasSubstr("--any-format"))));
}

// Assimp has several readers for .xml, and would try all others when none of these wants a file.
TEST(Format, AssimpHasNoReaderOfOtherFormats) {
  const TemporaryFolder folder;
  const std::string off = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  EXPECT_TRUE(import_in_this_process(folder.write("a.off", off), {}, 0));
  EXPECT_FALSE(import_in_this_process(folder.write("a.xml", off), {}, 0));
}

TEST(Format, OthersAreRefusedByName) {
  for (const auto& [name, format] :
       {std::pair{"a.off", ".off files (OFF)"}, std::pair{"a.blend", ".blend files (Blender 3D)"},
        std::pair{"a.3DS", ".3ds files (Discreet 3DS)"}, std::pair{"a.mesh.xml", ".xml files ("},
        std::pair{"a.zae", ".zae files (Collada)"}}) {
    const auto imported = import_text(name, "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    EXPECT_THAT(error_of(imported),
                AllOf(HasSubstr(name), HasSubstr(format), HasSubstr("convert it to glTF"),
                      HasSubstr("--any-format")));
    EXPECT_EQ(imported.error().code, ErrorCode::unsupported);
  }
  for (const char* name : {"a.xyz", "a"})
    EXPECT_THAT(error_of(import_text(name, "hello")),
                AllOf(HasSubstr("neither its content nor its ending"), HasSubstr(".ply .stl .x")));
}

}  // namespace
}  // namespace luxel::import
