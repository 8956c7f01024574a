// Bad files: a sentence that names the file and the place, never a crash.
#include <gmock/gmock.h>

#include <cmath>

#include "luxel/import/import_test_support.h"

namespace luxel::import {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(BadInput, FilesThatAreNone) {
  const TemporaryFolder folder;
  EXPECT_THAT(error_of(import_scene(folder.path() / "absent.glb")), HasSubstr("no such file"));
  EXPECT_THAT(error_of(import_scene(folder.path())), HasSubstr("is a folder"));
  for (const char* name : {"a.glb", "a.gltf", "a.obj", "a.ply", "a.fbx"})
    EXPECT_THAT(error_of(import_text(name, "")), AllOf(HasSubstr(name), HasSubstr("is empty")));
  EXPECT_THAT(error_of(import_text("a.docx", "x")),
              AllOf(HasSubstr("its ending '.docx'"), HasSubstr(".glb"), HasSubstr(".obj")));
}

TEST(BadInput, GarbageUnderEveryName) {
  const std::string garbage = "\x01\x02 what? \xff\xfe { [ 1 2 3";
  for (const char* name : {"a.glb", "a.gltf", "a.obj", "a.ply", "a.fbx", "a.dae", "a.x"})
    EXPECT_THAT(error_of(import_text(name, garbage)), HasSubstr(name));
}

TEST(BadInput, WrongJson) {
  EXPECT_THAT(error_of(import_text("a.gltf", "{\"asset\": ")), HasSubstr("JSON is broken"));
  EXPECT_THAT(error_of(import_text("a.gltf", "[1, 2]")), HasSubstr("not an object"));
  EXPECT_THAT(error_of(import_text("a.gltf", "{}")), HasSubstr("asset.version"));
  EXPECT_THAT(error_of(import_text("a.gltf", R"({"asset": {"version": "1.0"}})")),
              HasSubstr("glTF 1.0"));
  EXPECT_THAT(error_of(import_text("a.gltf", R"({"asset": {"version": "2.0"}, "meshes": 7})")),
              HasSubstr("meshes is not a list"));
  EXPECT_THAT(error_of(import_text("a.gltf", std::string(1000000, '['))), HasSubstr("too deep"));
}

TEST(BadInput, TruncatedGlb) {
  const std::string glb = square_gltf().glb();
  EXPECT_THAT(error_of(import_text("a.glb", glb.substr(0, glb.size() - 10))),
              HasSubstr("truncated"));
  EXPECT_THAT(error_of(import_text("a.glb", glb.substr(0, 11))), HasSubstr("not a .glb"));
}

TEST(BadInput, RequiredExtensionsAreNamed) {
  Gltf gltf = square_gltf();
  gltf.json["extensionsRequired"] = {"KHR_texture_transform", "XYZ_magic", "ABC_more"};
  const auto imported = import_glb(gltf);
  EXPECT_THAT(error_of(imported), HasSubstr("requires XYZ_magic, ABC_more"));
  EXPECT_EQ(imported.error().code, ErrorCode::unsupported);
}

/// The square's document with one value replaced.
std::string error_with(const char* pointer, const nlohmann::json& value) {
  Gltf gltf = square_gltf();
  gltf.json[nlohmann::json::json_pointer(pointer)] = value;
  return error_of(import_glb(gltf));
}

TEST(BadInput, IndicesOutOfRangeNameTheirHolder) {
  EXPECT_THAT(error_with("/meshes/0/primitives/0/indices", 9),
              AllOf(HasSubstr("mesh 0 (thing), primitive 0"), HasSubstr("indices 9")));
  EXPECT_THAT(error_with("/meshes/0/primitives/0/attributes/POSITION", -1),
              HasSubstr("POSITION -1 is out of range"));
  EXPECT_THAT(error_with("/meshes/0/primitives/0/material", 3), HasSubstr("material 3"));
  EXPECT_THAT(error_with("/nodes/0/mesh", 3), HasSubstr("node 0: mesh 3"));
  EXPECT_THAT(error_with("/nodes/0/children", {4}), HasSubstr("children 4"));
  EXPECT_THAT(error_with("/nodes/0/children", {0}), HasSubstr("own ancestor"));
  EXPECT_THAT(error_with("/scene", 5), HasSubstr("scene 5"));
  EXPECT_THAT(error_with("/scenes/0/nodes", {5}), HasSubstr("nodes 5"));
  EXPECT_THAT(error_with("/accessors/0/bufferView", 7), HasSubstr("bufferView 7"));
  EXPECT_THAT(error_with("/bufferViews/0/buffer", 2), HasSubstr("buffer 2"));
  EXPECT_THAT(error_with("/nodes/0/extensions", {{"KHR_lights_punctual", {{"light", 0}}}}),
              HasSubstr("light 0 is out of range"));
}

TEST(BadInput, VertexIndexOutOfRangeNamesMeshAndPrimitive) {
  Gltf gltf = square_gltf();
  gltf.buffer[48 + 4] = 4;  // the third index; vertices are 0 to 3
  EXPECT_THAT(error_of(import_glb(gltf)),
              AllOf(HasSubstr("mesh 0 (thing), primitive 0"), HasSubstr("vertex index 4")));
}

TEST(BadInput, RangesPastTheirEnd) {
  EXPECT_THAT(error_with("/accessors/0/count", 5), HasSubstr("accessor 0: 5 elements"));
  EXPECT_THAT(error_with("/accessors/0/count", 1e15), HasSubstr("too many"));
  EXPECT_THAT(error_with("/accessors/0/byteOffset", 4), HasSubstr("from byte 4"));
  EXPECT_THAT(error_with("/bufferViews/1/byteLength", 1000), HasSubstr("past"));
  EXPECT_THAT(error_with("/bufferViews/1/byteOffset", -4), HasSubstr("whole number"));
  EXPECT_THAT(error_with("/accessors/0/componentType", 5130), HasSubstr("componentType"));
  EXPECT_THAT(error_with("/accessors/0/type", "VEC9"), HasSubstr("accessor 0"));
  EXPECT_THAT(error_with("/accessors/0/sparse", {{"count", 1}}), HasSubstr("sparse"));
}

// tinygltf would read 0, or nothing. 2^31 - 1 is the last number that it can hold.
TEST(BadInput, MembersOfAnotherKindAreNamed) {
  const auto place = [](nlohmann::json offset) {
    return nlohmann::json{
        {"count", 1},
        {"indices", {{"bufferView", 0}, {"byteOffset", 0}, {"componentType", 5121}}},
        {"values", {{"bufferView", 0}, {"byteOffset", std::move(offset)}}}};
  };
  EXPECT_THAT(error_with("/accessors/0/sparse", place(0x80000000)),
              HasSubstr("accessors/0/sparse/values/byteOffset is 2147483648, must be a whole"));
  EXPECT_THAT(error_with("/accessors/0/sparse", place("4")), HasSubstr("is \"4\", must be"));
  EXPECT_THAT(error_with("/nodes/0/matrix", {1, 2, 3}),
              HasSubstr("nodes/0/matrix is [1,2,3], must be a list of 16 numbers"));
  EXPECT_THAT(error_with("/materials/0/emissiveFactor", "x"),
              HasSubstr("emissiveFactor is \"x\", must be a list of 3 numbers"));
  EXPECT_THAT(error_with("/meshes/0/primitives/0/mode", 0x100000004),
              HasSubstr("mode is 4294967300"));
  EXPECT_THAT(error_with("/asset/minVersion", "99"), HasSubstr("it needs glTF 99"));
}

// JavaScript and Python write whole numbers so.
TEST(BadInput, WholeNumbersMayHaveADecimalPoint) {
  Gltf gltf = square_gltf();
  const scene::Scene plain = scene_of(import_glb(gltf));
  for (const char* list : {"accessors", "bufferViews"})
    for (auto& object : gltf.json[list])
      for (auto& item : object.items())
        if (item.value().is_number()) item.value() = item.value().get<double>();
  const scene::Scene scene = scene_of(import_glb(gltf));
  ASSERT_EQ(scene.meshes.size(), 1u);
  EXPECT_EQ(scene.meshes[0].positions, plain.meshes[0].positions);
  EXPECT_EQ(scene.meshes[0].triangles, plain.meshes[0].triangles);
}

TEST(BadInput, NotFiniteVerticesNameMeshAndVertex) {
  for (const float bad : {NAN, INFINITY, -INFINITY}) {
    Gltf gltf = square_gltf();
    std::memcpy(&gltf.buffer[12 * 2 + 4], &bad, 4);
    EXPECT_THAT(error_of(import_glb(gltf)),
                AllOf(HasSubstr("mesh 0 (thing), vertex 2"), HasSubstr("not finite")));
  }
}

TEST(BadInput, NothingToLight) {
  Gltf gltf = square_gltf();
  gltf.json["nodes"] = nlohmann::json::array({nlohmann::json::object()});
  EXPECT_THAT(error_of(import_glb(gltf)), HasSubstr("no triangles"));
}

TEST(BadInput, MissingBufferFile) {
  nlohmann::json document = square_gltf().json;
  document["buffers"] = {{{"byteLength", 60}, {"uri", "lost.bin"}}};
  EXPECT_THAT(error_of(import_text("a.gltf", document.dump())),
              AllOf(HasSubstr("a.gltf"), HasSubstr("lost.bin")));
}

TEST(BadInput, ObjNamesTheLine) {
  const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  EXPECT_THAT(error_of(import_text("a.obj", vertices + "f 1 2 4\n")),
              AllOf(HasSubstr("line 4"), HasSubstr("index 4")));
  EXPECT_THAT(error_of(import_text("a.obj", vertices + "f -1 -2 -4\n")), HasSubstr("line 4"));
  EXPECT_THAT(error_of(import_text("a.obj", vertices + "f 0 1 2\n")), HasSubstr("index 0"));
  EXPECT_THAT(error_of(import_text("a.obj", vertices + "f 1/1 2/1 3/1\n")),
              HasSubstr("0 texture coordinates"));
  EXPECT_THAT(error_of(import_text("a.obj", "v 0 nan 0\n" + vertices + "f 1 2 3\n")),
              AllOf(HasSubstr("line 1"), HasSubstr("nan")));
  EXPECT_THAT(error_of(import_text("a.obj", "v 0 1e99 0\n" + vertices + "f 1 2 3\n")),
              HasSubstr("line 1"));
  EXPECT_THAT(error_of(import_text("a.obj", vertices)), HasSubstr("no triangles"));
}

/// A document that uses most of what the reader knows.
std::string rich_glb() {
  Gltf gltf = square_gltf();
  const int uv = gltf.floats({0, 1, 1, 1, 1, 0, 0, 0}, "VEC2", 2);
  auto& primitive = gltf.json["meshes"][0]["primitives"][0];
  primitive["attributes"]["TEXCOORD_0"] = uv;
  primitive["material"] = 0;
  const int picture = gltf.view(png_of(4, 4, {9, 8, 7, 255}));
  gltf.json["images"] = {{{"bufferView", picture}, {"mimeType", "image/png"}}};
  gltf.json["textures"] = {{{"source", 0}}};
  gltf.json["materials"] = {
      {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}, {"metallicFactor", 0}}},
       {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 3}}}}}}};
  const int index_view = gltf.view(bytes_of<uint8_t>({2}));
  const int value_view = gltf.view(bytes_of<float>({1, 1, 0}));
  gltf.json["accessors"][0]["sparse"] = {
      {"count", 1},
      {"indices", {{"bufferView", index_view}, {"componentType", 5121}}},
      {"values", {{"bufferView", value_view}}}};
  return gltf.glb();
}

// The result may be either; what counts is that there is one.
TEST(BadInput, DamagedGlbAlwaysGivesAResult) {
  const std::string glb = rich_glb();
  ASSERT_TRUE(import_text("a.glb", glb));
  const TemporaryFolder folder;
  for (size_t length = 0; length < glb.size(); length += 97)
    EXPECT_FALSE(import_scene(folder.write("cut.glb", glb.substr(0, length)))) << length;
  size_t errors = 0;
  for (size_t at = 0; at < glb.size(); ++at) {
    std::string damaged = glb;
    damaged[at] = char(damaged[at] ^ (at % 2 ? 0x11 : 0x80 >> at % 8));
    errors += !import_scene(folder.write("flipped.glb", damaged));
  }
  EXPECT_GT(errors, glb.size() / 2);
}

// Damaged files with numbers in the document replaced: digits are where indices and sizes stand.
TEST(BadInput, WrongNumbersInTheDocumentAlwaysGiveAResult) {
  const std::string glb = rich_glb();
  const TemporaryFolder folder;
  size_t tried = 0, refused = 0;
  for (size_t at = 20; at < glb.find("}]}", 20); ++at)
    for (const char digit : {'9', '-'}) {
      std::string damaged = glb;
      if (damaged[at] < '0' || damaged[at] > '9') continue;
      damaged[at] = digit;
      const auto imported = import_scene(folder.write("a.glb", damaged));
      ++tried;
      if (imported) continue;
      ++refused;
      EXPECT_THAT(imported.error().message, HasSubstr("a.glb"));
      EXPECT_EQ(imported.error().message.find('\n'), std::string::npos);
    }
  // A minus sign within a number is no JSON, and before most of them no index or size.
  EXPECT_GT(refused, tried / 3) << tried;
}

}  // namespace
}  // namespace luxel::import
