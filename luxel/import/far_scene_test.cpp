// Scenes far from the origin of their file keep their shape, and near ones their coordinates.
#include "luxel/import/far_scene.h"

#include <gmock/gmock.h>

#include <algorithm>

#include "luxel/import/import_test_support.h"
#include "luxel/scene/digest.h"
#include "luxel/scene/origin.h"

namespace luxel::import {
namespace {

using ::testing::HasSubstr;

DBox3 box_around(DVec3 middle, DVec3 size) { return {middle - size * 0.5, middle + size * 0.5}; }

// A box of 1 x 2 x 2 m has a diagonal of 3 m, so 4 m is the power of two.
TEST(OriginFor, IsTheNearestMultipleOfAPowerOfTwo) {
  const DVec3 size{1, 2, 2};
  EXPECT_EQ(origin_for(box_around({24, 0, 0}, size)), (DVec3{}));  // eight times the size
  EXPECT_EQ(origin_for(box_around({24.25, 0, 0}, size)), (DVec3{24, 0, 0}));
  EXPECT_EQ(origin_for(box_around({1e6, 87.5, -5403210.125}, size)), (DVec3{1e6, 88, -5403212}));
  EXPECT_EQ(origin_for(box_around({102, -98, 0}, size)), (DVec3{104, -100, 0}));  // both are ties
  // A size that is a power of two itself gets the next one, 8.
  EXPECT_EQ(origin_for(box_around({100, 0, 0}, {4, 0, 0})), (DVec3{104, 0, 0}));
}

TEST(OriginFor, LeavesAloneWhatItCannotHelp) {
  EXPECT_EQ(origin_for({}), (DVec3{}));
  EXPECT_EQ(origin_for(box_around({NAN, 0, 0}, {1, 1, 1})), (DVec3{}));
  DBox3 lumps = box_around({0, 0, 0}, {1, 1, 1});
  lumps.extend({1e6, 0, 0});
  EXPECT_EQ(origin_for(lumps), (DVec3{})) << "one part lies at 0";
}

/// Squares of one mesh in a chain of turned and scaled nodes, a lamp and a camera; a node above
/// them moves all.
Gltf chain_at(DVec3 place) {
  Gltf gltf = square_gltf();
  gltf.json["extensionsUsed"] = {"KHR_lights_punctual"};
  gltf.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}},
                                                              {{"type", "directional"}}};
  gltf.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 1}}}}};
  const auto light = [](int index) {
    return nlohmann::json{{"KHR_lights_punctual", {{"light", index}}}};
  };
  gltf.json["nodes"] = {
      {{"mesh", 0}, {"scale", {1.1, 1.3, 0.7}}, {"children", {1}}},
      {{"mesh", 0}, {"rotation", {0.1, 0.7, 0.1, 0.7}}, {"translation", {0.3, 1.7, 2.9}}},
      {{"translation", {0.1, 1.9, 0.7}}, {"extensions", light(0)}},
      {{"rotation", {0, 0.6, 0, 0.8}}, {"extensions", light(1)}},
      {{"camera", 0}, {"translation", {3.1, 1.6, 2.3}}},
      {{"translation", {place.x, place.y, place.z}}, {"children", {0, 2, 3, 4}}}};
  gltf.json["scenes"][0]["nodes"] = {5};
  return gltf;
}

TEST(FarScenes, NearOnesKeepTheirBits) {
  for (const DVec3 place : {DVec3{}, DVec3{1, 2, 3}, DVec3{-20.3, 0, 7.7}}) {
    const TemporaryFolder folder;
    const auto file = folder.write("a.glb", chain_at(place).glb());
    const scene::Scene scene = scene_of(import_scene(file));
    EXPECT_EQ(scene.origin, (DVec3{}));
    // As floats multiply: this is what light was baked with.
    const Mat34 root = translation(to_float(place)), first = root * scaling({1.1f, 1.3f, 0.7f});
    EXPECT_EQ(scene.instances[0].world_from_object, first);
    EXPECT_EQ(scene.lights[0].position, transform_point(root, {0.1f, 1.9f, 0.7f}));
  }
}

TEST(FarScenes, MovedByANodeAreTheNearOne) {
  const scene::Scene near = scene_of(import_glb(chain_at({})));
  for (const double far : {1e4, 1e5, 1e6}) {
    const auto imported = import_glb(chain_at({far, -far, 0}));
    const scene::Scene scene = scene_of(imported);
    EXPECT_EQ(scene.origin, (DVec3{far, -far, 0}));
    EXPECT_EQ(scene::difference(scene::digests_of(near), scene::digests_of(scene)), "") << far;
    EXPECT_EQ(all_of(imported->warnings), "");
  }
}

TEST(FarScenes, TakeTheOriginThatIsWished) {
  const TemporaryFolder folder;
  ImportParams params;
  params.origin = DVec3{1e6 - 16, 32, 0};
  const auto file = folder.write("a.glb", chain_at({1e6, 0, 0}).glb());
  const scene::Scene scene = scene_of(import_scene(file, params)),
                     near = scene_of(import_scene(file));
  EXPECT_EQ(scene.origin, *params.origin);
  EXPECT_EQ(scene.cameras[0].world_from_camera,
            translation({16, -32, 0}) * near.cameras[0].world_from_camera);
  for (size_t i = 0; i < 2; ++i)
    expect_near(column(scene.instances[i].world_from_object, 3),
                column(near.instances[i].world_from_object, 3) + Vec3{16, -32, 0}, 4e-6f);
}

TEST(FarScenes, AreRefusedWhereNothingIsHeld) {
  EXPECT_THAT(error_of(import_glb(chain_at({1e12, 0, 0}))),
              HasSubstr("coordinates go up to 1e+09 m"));
}

// A sun that is a point light, as some exporters write it: that far away nothing is refused.
TEST(FarScenes, KeepLampsThatAreFurtherStill) {
  Gltf gltf = chain_at({1e6, 0, 0});
  gltf.json["nodes"][2]["translation"] = {0, 1.5e11, 0};
  const scene::Scene scene = scene_of(import_glb(gltf));
  EXPECT_EQ(scene.lights[0].position, (Vec3{0, 1.5e11f, 0}));
}

// A house in survey coordinates, as text with millimetres or in double precision. Single precision
// has steps of 0.5 m there.

struct Box {
  DVec3 lower, upper;
};
constexpr DVec3 kPlace{512345.678, 87.5, -5403210.123};

/// A slab, three walls and a roof.
std::vector<Box> house() {
  std::vector<Box> out{{{-10, -0.3, -10}, {10, 0, 10}},
                       {{-3, 0, -3}, {-2.8, 2.5, 3}},
                       {{2.8, 0, -3}, {3, 2.5, 3}},
                       {{-2.8, 0, -3}, {2.8, 2.5, -2.8}},
                       {{-3.5, 2.5, -3.5}, {3.5, 2.7, 3.5}}};
  for (Box& box : out) box.lower += kPlace, box.upper += kPlace;
  return out;
}

double area_of(const std::vector<Box>& boxes) {
  double area = 0;
  for (const Box& box : boxes) {
    const DVec3 e = box.upper - box.lower;
    area += 2 * (e.x * e.y + e.y * e.z + e.z * e.x);
  }
  return area;
}

DVec3 corner_of(const Box& box, int i) {
  return {i & 1 ? box.upper.x : box.lower.x, i & 2 ? box.upper.y : box.lower.y,
          i & 4 ? box.upper.z : box.lower.z};
}
/// Eight corners for each box, and twelve triangles.
std::vector<DVec3> corners() {
  std::vector<DVec3> out;
  for (const Box& box : house())
    for (int i = 0; i < 8; ++i) out.push_back(corner_of(box, i));
  return out;
}
std::vector<std::array<int, 3>> triangles() {
  std::vector<std::array<int, 3>> out;
  for (int b = 0; b < 5; ++b)
    for (const auto& [i, j, k] : std::initializer_list<std::array<int, 3>>{{0, 1, 4},
                                                                           {1, 5, 4},
                                                                           {2, 6, 3},
                                                                           {3, 6, 7},
                                                                           {0, 4, 2},
                                                                           {2, 4, 6},
                                                                           {1, 3, 5},
                                                                           {3, 7, 5},
                                                                           {0, 2, 1},
                                                                           {1, 2, 3},
                                                                           {4, 5, 6},
                                                                           {5, 7, 6}})
      out.push_back({8 * b + i, 8 * b + j, 8 * b + k});
  return out;
}

std::string obj_house() {
  std::string out;
  for (const DVec3 p : corners()) out += fmt::format("v {:.3f} {:.3f} {:.3f}\n", p.x, p.y, p.z);
  for (const auto& [a, b, c] : triangles()) out += fmt::format("f {} {} {}\n", a + 1, b + 1, c + 1);
  return out;
}

/// `type`: of the coordinates.
std::string ply_header(const char* format, const char* type) {
  return fmt::format(
      "ply\nformat {0} 1.0\nelement vertex 40\nproperty {1} x\nproperty {1} y\nproperty {1} z\n"
      "element face 60\nproperty list int int vertex_indices\nend_header\n",
      format, type);
}
std::string ply_text_house(const char* type) {
  std::string out = ply_header("ascii", type);
  for (const DVec3 p : corners()) out += fmt::format("{:.3f} {:.3f} {:.3f}\n", p.x, p.y, p.z);
  for (const auto& [a, b, c] : triangles()) out += fmt::format("3 {} {} {}\n", a, b, c);
  return out;
}
std::string ply_binary_house(bool is_big) {
  std::string out = ply_header(is_big ? "binary_big_endian" : "binary_little_endian", "double");
  const auto append = [&](auto number) {
    std::string bytes = bytes_of<decltype(number)>({number});
    if (is_big) std::reverse(bytes.begin(), bytes.end());
    out += bytes;
  };
  for (const DVec3 p : corners()) append(p.x), append(p.y), append(p.z);
  for (const auto& [a, b, c] : triangles()) append(3), append(a), append(b), append(c);
  return out;
}

std::string stl_house() {
  const std::vector<DVec3> all = corners();
  std::string out = "solid house\n";
  for (const auto& triangle : triangles()) {
    out += "  facet normal 0 0 0\n    outer loop\n";
    for (const int i : triangle)
      out += fmt::format("      vertex {:.3f} {:.3f} {:.9e}\r\n", all[size_t(i)].x,
                         all[size_t(i)].y, all[size_t(i)].z);
    out += "    endloop\n  endfacet\n";
  }
  return out + "endsolid house\n";
}

/// Left-handed.
std::string x_house() {
  std::string out = "xof 0303txt 0032\nMesh house {\n40;\n";
  for (const DVec3 p : corners()) out += fmt::format("{:.3f};{:.3f};{:.3f};,\n", p.x, p.y, -p.z);
  out += "60;\n";
  for (const auto& [a, b, c] : triangles()) out += fmt::format("3;{},{},{};,\n", a, c, b);
  return out + "}\n";
}

/// In centimetres with z up.
std::string dae_house() {
  std::string places, faces;
  for (const DVec3 p : corners())
    places += fmt::format("{:.1f} {:.1f} {:.1f}\n", 100 * p.x, -100 * p.z, 100 * p.y);
  for (const auto& [a, b, c] : triangles()) faces += fmt::format("{} {} {} ", a, b, c);
  return R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="centimeter" meter="0.01"/><up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh><source id="p"><float_array id="pa" count="120">)" +
         places + R"(</float_array><technique_common><accessor source="#pa" count="40" stride="3">
<param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>
</accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="60"><input semantic="VERTEX" source="#v" offset="0"/><p>)" +
         faces + R"(</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n"><instance_geometry url="#g"/></node>
</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>
)";
}

/// A node for each box, around whose middle the mesh lies; or one node for all.
std::string gltf_house(bool has_many_nodes) {
  Gltf gltf;
  std::vector<int> children;
  for (size_t b = 0; b < 5; ++b) {
    const Box box = house()[b];
    const DVec3 at = has_many_nodes ? (box.lower + box.upper) * 0.5 : kPlace;
    std::vector<float> places;
    for (int i = 0; i < 8; ++i) {
      const Vec3 p = to_float(corner_of(box, i) - at);
      places.insert(places.end(), {p.x, p.y, p.z});
    }
    std::vector<uint16_t> indices;
    const std::vector<std::array<int, 3>> all = triangles();
    for (size_t t = 0; t < 12; ++t)
      for (const int i : all[t]) indices.push_back(uint16_t(i));
    const int positions = gltf.floats(places, "VEC3", 3);
    const int list = gltf.add<uint16_t>(indices, 5123, "SCALAR", 1);
    gltf.json["meshes"].push_back(
        {{"primitives", {{{"attributes", {{"POSITION", positions}}}, {"indices", list}}}}});
    gltf.json["nodes"].push_back({{"mesh", b}});
    if (has_many_nodes) gltf.json["nodes"].back()["translation"] = {at.x, at.y, at.z};
    children.push_back(int(b));
  }
  gltf.json["nodes"].push_back({{"children", children}});
  if (!has_many_nodes) gltf.json["nodes"].back()["translation"] = {kPlace.x, kPlace.y, kPlace.z};
  gltf.json["scenes"][0]["nodes"] = {5};
  return gltf.glb();
}

struct Survey {
  const char *what, *file;
  std::string content;
};
class SurveyCoordinates : public ::testing::TestWithParam<Survey> {};

// Within 32 m of the scene's origin floats lie within 1e-6 m of what they stand for, and sums of
// node and vertex within 2e-6 m; walls of the float's own file would stand 0.25 m off.
TEST_P(SurveyCoordinates, KeepTheHouse) {
  const auto imported = import_text(GetParam().file, GetParam().content);
  const scene::Scene scene = scene_of(imported);
  EXPECT_EQ(all_of(imported->warnings), "");
  EXPECT_EQ(scene.origin, (DVec3{512352, 96, -5403200}));
  EXPECT_NEAR(double(drawn_area(scene)), area_of(house()), 1e-3);
  const std::vector<DVec3> expected = corners();
  std::vector<int> met(expected.size());
  size_t triangles = 0;
  for (uint32_t i = 0; i < scene.instances.size(); ++i)
    for (uint32_t t = 0; t < scene.meshes[scene.instances[i].mesh].triangles.size(); ++t) {
      const auto [a, b, c] = scene::world_triangle(scene, i, t);
      ++triangles;
      for (const Vec3 p : {a, b, c}) {
        const DVec3 at = scene::in_world(scene, p);
        size_t near = 0;
        for (size_t k = 0; k < expected.size(); ++k)
          if (length(expected[k] - at) < 4e-6) ++near, ++met[k];
        EXPECT_GT(near, 0u) << at.x << " " << at.y << " " << at.z;
      }
    }
  EXPECT_EQ(triangles, 60u);
  EXPECT_EQ(std::ranges::count(met, 0), 0);
}
INSTANTIATE_TEST_SUITE_P(
    Formats, SurveyCoordinates,
    ::testing::Values(Survey{"obj", "a.obj", obj_house()},
                      Survey{"ply_text_floats", "a.ply", ply_text_house("float")},
                      Survey{"ply_text_doubles", "a.ply", ply_text_house("double")},
                      Survey{"ply_little", "a.ply", ply_binary_house(false)},
                      Survey{"ply_big", "a.ply", ply_binary_house(true)},
                      Survey{"stl", "a.stl", stl_house()}, Survey{"x", "a.x", x_house()},
                      Survey{"dae", "a.dae", dae_house()},
                      Survey{"gltf_one_node", "a.glb", gltf_house(false)},
                      Survey{"gltf_nodes", "a.glb", gltf_house(true)}),
    [](const auto& one) { return std::string(one.param.what); });

// The unit is 0.001, not the float nearest to it: that would be 0.25 m off.
TEST(FarScenes, KeepTheirPlaceInOtherUnits) {
  const TemporaryFolder folder;
  std::string obj;
  for (const DVec3 p : corners())
    obj += fmt::format("v {:.0f} {:.0f} {:.0f}\n", 1000 * p.x, 1000 * p.y, 1000 * p.z);
  for (const auto& [a, b, c] : triangles()) obj += fmt::format("f {} {} {}\n", a + 1, b + 1, c + 1);
  ImportParams params;
  params.unit_m = 0.001f;
  const scene::Scene scene = scene_of(import_scene(folder.write("a.obj", obj), params));
  const Box3 box = scene::world_bounds(scene);
  EXPECT_LT(length(scene::in_world(scene, box.lower) - (kPlace + DVec3{-10, -0.3, -10})), 4e-6);
  EXPECT_LT(length(scene::in_world(scene, box.upper) - (kPlace + DVec3{10, 2.7, 10})), 4e-6);
}

// Numbers that the file itself has rounded stay so, and a warning says it.
TEST(FarScenes, AreToldOfVerticesThatTheFileHasRounded) {
  Gltf gltf;
  std::vector<float> places;
  for (const DVec3 p : corners()) {
    const Vec3 q = to_float(p);
    places.insert(places.end(), {q.x, q.y, q.z});
  }
  std::vector<uint16_t> indices;
  for (const auto& triangle : triangles())
    for (const int i : triangle) indices.push_back(uint16_t(i));
  const int positions = gltf.floats(places, "VEC3", 3);
  const int list = gltf.add<uint16_t>(indices, 5123, "SCALAR", 1);
  gltf.draw({{"attributes", {{"POSITION", positions}}}, {"indices", list}});
  const auto imported = import_glb(gltf);
  EXPECT_THAT(all_of(imported->warnings),
              HasSubstr("mesh 0 (thing) has its vertices 5.4e+06 m from its own origin, where "
                        "single precision has steps of 0.5 m: they are rounded to that"));
}

// Assimp makes floats of the nodes of .fbx and .dae files.
TEST(FarScenes, AreToldOfNodesThatAReaderHasRounded) {
  std::string text = dae_house();
  const std::string node = "<node id=\"n\">", place = "2e8 0 0";
  text.replace(text.find(node), node.size(), node + "<translate>" + place + "</translate>");
  const auto imported = import_text("a.dae", text);
  EXPECT_THAT(all_of(imported->warnings),
              HasSubstr("single precision in which this format is read has steps of 0.16 m"));
}

}  // namespace
}  // namespace luxel::import
