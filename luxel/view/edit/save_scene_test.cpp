// Edited scenes as files: what is read back is the edited scene, and all else is what it was.
#include "luxel/view/edit/save_scene.h"

#include <gmock/gmock.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "luxel/base/base64.h"
#include "luxel/base/file.h"
#include "luxel/export/baked_glb.h"
#include "luxel/import/import.h"
#include "luxel/scene/digest.h"
#include "luxel/scene/procedural.h"
#include "luxel/view/edit/placement.h"
#include "tests/scratch_folder.h"

namespace luxel::view {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Json = nlohmann::ordered_json;

/// A triangle, three copies of it by EXT_mesh_gpu_instancing, lights, a camera, and much that luxel
/// does not know.
constexpr const char* kHall = R"({
  "asset": {"version": "2.0", "extras": {"z": 1.5e-7, "a": "two \"words\"", "n": [3, 2.50, null]}},
  "extensionsUsed": ["KHR_lights_punctual", "EXT_mesh_gpu_instancing", "ACME_thing"],
  "extensions": {"ACME_thing": {"deep": {"b": true, "a": 12345678901234567}},
    "KHR_lights_punctual": {"lights": [
      {"type": "point", "intensity": 10, "extras": {"bulb": "E27"}},
      {"type": "spot", "intensity": 4, "color": [1, 0.5, 0.25], "range": 9,
       "spot": {"outerConeAngle": 0.5}}]}},
  "scene": 0, "scenes": [{"nodes": [0, 3, 4, 5], "extras": {"of": "scene"}}],
  "nodes": [
    {"name": "table", "mesh": 0, "translation": [1, 0, 2], "scale": [2, 2, 2],
     "rotation": [0, 0.70710678, 0, 0.70710678], "children": [1, 2], "extras": {"legs": 4}},
    {"name": "cup", "mesh": 0, "translation": [0, 0.5, 0], "extensions": {"ACME_thing": {"x": 1}}},
    {"name": "lamp", "mesh": 1, "camera": 0, "translation": [0, 1, 0],
     "extensions": {"KHR_lights_punctual": {"light": 0}}},
    {"name": "spot a", "translation": [0, 3, 0], "extensions": {"KHR_lights_punctual": {"light": 1}}},
    {"name": "spot b", "translation": [2, 3, 0], "extensions": {"KHR_lights_punctual": {"light": 1}}},
    {"name": "row", "mesh": 0, "translation": [0, 0, -5],
     "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 1}}}}],
  "cameras": [{"type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.1}}],
  "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}], "extras": {"m": 1}},
             {"primitives": [{"attributes": {"POSITION": 0}}]}],
  "materials": [{"name": "wood", "extras": {"tree": "oak"}, "pbrMetallicRoughness":
    {"baseColorFactor": [0.5, 0.25, 0.125, 0.75], "metallicFactor": 0, "roughnessFactor": 0.3}}],
  "accessors": [
    {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
     "min": [0, 0, 0], "max": [1, 1, 0]},
    {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC3"}],
  "bufferViews": [{"buffer": 0, "byteLength": 36},
                  {"buffer": 0, "byteOffset": 36, "byteLength": 36}],
  "buffers": [{"uri": "some%20bytes.bin", "byteLength": 72, "extras": {"of": "buffer"}}]
})";
constexpr float kHallBytes[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, -1, 0, 0, 0, 0, 0, 1, 0, 0};

class SaveScene : public ::testing::Test {
 protected:
  /// Reads a file of these bytes in the scratch folder, as a window does.
  EditDesk open(const std::string& name, std::span<const std::byte> bytes) {
    settings_.scene = folder_ / name, settings_.output = folder_ / "out";
    EXPECT_TRUE(write_file_atomically(settings_.scene, bytes));
    auto imported = import::import_scene(settings_.scene, {.origin = origin_});
    EXPECT_TRUE(imported) << imported.error().message;
    auto read = std::make_shared<ReadScene>();
    read->scene = std::move(imported->scene);
    return begin_editing(read);
  }
  EditDesk open_hall() {
    const auto bytes = std::as_bytes(std::span(kHallBytes));
    EXPECT_TRUE(write_file_atomically(folder_ / "some bytes.bin", bytes));
    return open("hall.gltf", std::as_bytes(std::span(kHall, std::strlen(kHall))));
  }
  std::filesystem::path save(const EditDesk& desk) {
    const auto saved = save_scene({desk.read, desk.now, settings_});
    EXPECT_TRUE(saved) << saved.error().message;
    return *saved;
  }
  scene::Scene read_back(const EditDesk& desk) {
    auto imported = import::import_scene(save(desk), {.origin = origin_});
    EXPECT_TRUE(imported) << imported.error().message;
    return std::move(imported->scene);
  }

  testing_support::ScratchFolder scratch_;
  std::filesystem::path folder_ = scratch_.path;
  pipeline::BakeSettings settings_;
  std::optional<DVec3> origin_;  ///< of what is read
};

void expect_same(const scene::PunctualLight& a, const scene::PunctualLight& b) {
  EXPECT_EQ(a.kind, b.kind);
  EXPECT_LE(length(a.intensity - b.intensity), 1e-6f * length(b.intensity));
  EXPECT_LE(length(a.position - b.position), 1e-5f);
  EXPECT_LE(length(a.direction - b.direction), 1e-5f);
  EXPECT_EQ(a.range_m, b.range_m);
  EXPECT_FLOAT_EQ(a.inner_cone_rad, b.inner_cone_rad);
  EXPECT_FLOAT_EQ(a.outer_cone_rad, b.outer_cone_rad);
  EXPECT_EQ(a.angular_radius_rad, b.angular_radius_rad);
}

/// All but deleted lamps.
void expect_same(const scene::Scene& saved, const EditDesk& desk) {
  const scene::Scene now = edited(desk.read->scene, desk.now);
  ASSERT_EQ(saved.instances.size(), now.instances.size());
  for (size_t i = 0; i < now.instances.size(); ++i) {
    SCOPED_TRACE(now.instances[i].name);
    EXPECT_EQ(saved.instances[i].name, now.instances[i].name);
    for (int k = 0; k < 4; ++k)
      EXPECT_LE(length(column(saved.instances[i].world_from_object, k) -
                       column(now.instances[i].world_from_object, k)),
                1e-5f);
  }
  ASSERT_EQ(saved.materials.size(), now.materials.size());
  for (size_t m = 0; m < now.materials.size(); ++m) {
    EXPECT_EQ(saved.materials[m].base_color, now.materials[m].base_color);
    EXPECT_EQ(saved.materials[m].emission, now.materials[m].emission);
    EXPECT_EQ(saved.materials[m].alpha, now.materials[m].alpha);
    EXPECT_EQ(saved.materials[m].metallic, now.materials[m].metallic);
  }
  size_t next = 0;
  for (size_t i = 0; i < now.lights.size(); ++i) {
    if (desk.now.lamps[i].is_deleted) continue;
    ASSERT_LT(next, saved.lights.size());
    SCOPED_TRACE(now.lights[i].name);
    expect_same(saved.lights[next++], now.lights[i]);
  }
  EXPECT_EQ(next, saved.lights.size());
  ASSERT_EQ(saved.cameras.size(), now.cameras.size());
  for (size_t c = 0; c < now.cameras.size(); ++c)
    for (int k = 0; k < 4; ++k)
      EXPECT_LE(length(column(saved.cameras[c].world_from_camera, k) -
                       column(now.cameras[c].world_from_camera, k)),
                1e-5f);
}

Json json_of(const std::filesystem::path& file) {
  const auto bytes = read_file(file);
  EXPECT_TRUE(bytes);
  const char* text = reinterpret_cast<const char*>(bytes->data());
  return Json::parse(text, text + bytes->size());
}

uint32_t instance_of(const EditDesk& desk, const std::string& name) {
  uint32_t out = 0;
  while (desk.read->scene.instances.at(out).name != name) ++out;
  return out;
}

void move(EditDesk& desk, uint32_t instance, const Mat34& by) {
  const Mat34 to = by * desk.now.world_from_object[instance];
  do_edit(InstanceMoved{instance, to}, desk);
}

TEST_F(SaveScene, WithoutEditsTheDocumentIsWhatItWas) {
  const EditDesk desk = open_hall();
  ASSERT_EQ(desk.read->scene.instances.size(), 6u);
  Json saved = json_of(save(desk)), before = Json::parse(kHall);
  EXPECT_EQ(saved["buffers"][0]["uri"],
            "data:application/octet-stream;base64," + base64(std::as_bytes(std::span(kHallBytes))));
  saved["buffers"][0]["uri"] = before["buffers"][0]["uri"];
  EXPECT_EQ(saved.dump(), before.dump()) << "numbers, order, and all that is not known";
}

TEST_F(SaveScene, AnEditedSceneIsReadBack) {
  EditDesk desk = open_hall();
  move(desk, instance_of(desk, "table"), turned_about({1, 0, 1}, {0.6f, 0.8f, 0}, 0.7f));
  move(desk, instance_of(desk, "lamp"), translation({0.5f, 0, 0}));
  move(desk, instance_of(desk, "row") + 1, scaled_about({}, {}, {1, 2, 1}));
  Lamp bulb = desk.now.lamps[0], a = desk.now.lamps[1];
  bulb.light.intensity = {1, 2, 3};
  a.light.direction = normalize(Vec3{1, -1, 0}), a.light.outer_cone_rad = 0.3f;
  do_edit(LampSet{0, bulb.light}, desk), do_edit(LampSet{1, a.light}, desk);
  scene::PunctualLight sun, spot;
  sun.kind = scene::PunctualLight::Kind::directional, sun.angular_radius_rad = 0.00465f;
  sun.direction = normalize(Vec3{1, -2, 3}), sun.intensity = {1e5f, 9e4f, 8e4f};
  spot.kind = scene::PunctualLight::Kind::spot, spot.position = {1, 2, 3};
  do_edit(LampCreated{sun}, desk), do_edit(LampCreated{spot}, desk);
  do_edit(MaterialSet{0, {0.1f, 0.2f, 0.3f}, {7, 0, 0.5f}, 0.75f}, desk);
  do_edit(MaterialSet{1, {0.3f, 0.3f, 0.4f}, {}}, desk);  // glTF's default
  expect_same(read_back(desk), desk);
  do_edit(LampDeleted{2}, desk), do_edit(LampDeleted{4}, desk);
  do_edit(LampSet{0, bulb.light, false}, desk);
  expect_same(read_back(desk), desk);
}

TEST_F(SaveScene, WhatIsNotEditedStaysInTheFile) {
  EditDesk desk = open_hall();
  move(desk, instance_of(desk, "table"), translation({0, 1, 0}));
  Lamp a = desk.now.lamps[1];
  a.light.intensity = {9, 9, 9};
  do_edit(LampSet{1, a.light}, desk);
  do_edit(MaterialSet{0, {0.1f, 0.2f, 0.3f}, {}}, desk);
  const Json saved = json_of(save(desk)), before = Json::parse(kHall);
  for (const char* key :
       {"asset", "extensionsUsed", "scenes", "cameras", "meshes", "accessors", "bufferViews"})
    EXPECT_EQ(saved[key].dump(), before[key].dump());
  EXPECT_EQ(saved["extensions"]["ACME_thing"].dump(), before["extensions"]["ACME_thing"].dump());
  EXPECT_EQ(saved["buffers"][0]["extras"].dump(), before["buffers"][0]["extras"].dump());
  EXPECT_EQ(saved["nodes"][0]["extras"].dump(), before["nodes"][0]["extras"].dump());
  EXPECT_EQ(saved["nodes"][1]["extensions"].dump(), before["nodes"][1]["extensions"].dump());
  EXPECT_EQ(saved["nodes"][4].dump(), before["nodes"][4].dump()) << "the other node of the light";
  EXPECT_EQ(saved["nodes"][5].dump(), before["nodes"][5].dump());
  EXPECT_EQ(saved["materials"][0]["extras"].dump(), before["materials"][0]["extras"].dump());
  EXPECT_EQ(saved["materials"][0]["pbrMetallicRoughness"]["roughnessFactor"], 0.3);
  const Json& lights = saved["extensions"]["KHR_lights_punctual"]["lights"];
  EXPECT_EQ(lights[1].dump(), before["extensions"]["KHR_lights_punctual"]["lights"][1].dump());
  EXPECT_EQ(lights[0]["extras"].dump(), R"({"bulb":"E27"})");
}

/// A .glb with a chunk that nobody knows.
std::vector<std::byte> with_a_chunk(std::vector<std::byte> glb) {
  const std::array<uint32_t, 3> chunk{4, 0x454D4341, 42};
  const auto bytes = std::as_bytes(std::span(chunk));
  glb.insert(glb.end(), bytes.begin(), bytes.end());
  const auto whole = uint32_t(glb.size());
  std::memcpy(glb.data() + 8, &whole, sizeof whole);
  return glb;
}

TEST_F(SaveScene, ChunksOfAGlbStayByteByByte) {
  const auto glb = export_::scene_glb(scene::cornell_box());
  ASSERT_TRUE(glb);
  const std::vector<std::byte> file = with_a_chunk(*glb);
  EditDesk desk = open("box.glb", file);
  move(desk, 1, translation({0.125f, 0, 0}));
  do_edit(MaterialSet{0, {0.25f, 0.5f, 0.75f}, {}}, desk);
  const std::filesystem::path first = save(desk);
  EXPECT_EQ(first.filename(), "box-edited.glb");
  const auto saved = read_file(first);
  ASSERT_TRUE(saved);
  uint32_t json_length = 0, saved_length = 0;
  std::memcpy(&json_length, file.data() + 12, 4), std::memcpy(&saved_length, saved->data() + 12, 4);
  const auto rest = std::span(file).subspan(20 + json_length);
  const auto saved_rest = std::span(*saved).subspan(20 + saved_length);
  EXPECT_TRUE(std::ranges::equal(rest, saved_rest));
  // Numbers that a binary fraction has exactly: the same bits.
  const scene::Scene again = read_back(desk);
  EXPECT_THAT(scene::difference(scene::digests_of(edited(desk.read->scene, desk.now)),
                                scene::digests_of(again)),
              IsEmpty());
  EXPECT_EQ(save(desk).filename(), "box-edited-3.glb") << "nothing is written over";
}

// glTF without a factor is all metal; glossy materials of old know none.
TEST_F(SaveScene, MetalIsThatOfTheFileReadBack) {
  std::string file = kHall;
  const std::string factor = R"("metallicFactor": 0, )";
  file.erase(file.find(factor), factor.size());
  file.replace(file.find(R"("materials": [)"), 14, R"("materials": [
    {"extensions": {"KHR_materials_pbrSpecularGlossiness":
      {"diffuseFactor": [0.5, 0.25, 0.125, 1], "glossinessFactor": 0.25}}}, )");
  const auto bytes = std::as_bytes(std::span(kHallBytes));
  ASSERT_TRUE(write_file_atomically(folder_ / "some bytes.bin", bytes));
  EditDesk desk = open("hall.gltf", std::as_bytes(std::span(file)));
  ASSERT_EQ(desk.now.materials[0].metallic, 0);
  ASSERT_EQ(desk.now.materials[1].metallic, 1);
  for (uint32_t m : {0u, 1u}) {
    const MaterialLook& look = desk.now.materials[m];
    do_edit(MaterialSet{m, look.base_color, look.emission, 0.5f}, desk);
  }
  expect_same(read_back(desk), desk);
  const Json saved = json_of(save(desk));
  EXPECT_EQ(saved["materials"][0]["pbrMetallicRoughness"]["roughnessFactor"], 0.75);
  EXPECT_EQ(saved["materials"][1]["extras"]["tree"], "oak");
}

TEST_F(SaveScene, OtherFilesBecomeGlb) {
  constexpr std::string_view kObj = "v 0 0 0\nv 1 0 0\nv 0 1 0\no leaf\nf 1 2 3\n";
  EditDesk desk = open("leaf.obj", std::as_bytes(std::span(kObj)));
  move(desk, 0, translation({1, 2, 3}));
  do_edit(LampCreated{}, desk);
  const std::filesystem::path file = save(desk);
  EXPECT_EQ(file.filename(), "leaf-edited.glb");
  const auto again = import::import_scene(file);
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(column(again->scene.instances[0].world_from_object, 3), (Vec3{1, 2, 3}));
  EXPECT_EQ(again->scene.lights.size(), 1u);
}

TEST_F(SaveScene, LightOfOptionsIsSavedWhereItWasEdited) {
  const EditDesk opened = open_hall();
  auto lit = std::make_shared<ReadScene>();
  lit->scene = opened.read->scene;
  lit->scene.lights.resize(lit->scene.lights.size() + 2);  // by --sun, say
  EditDesk desk = begin_editing(lit);
  scene::PunctualLight moved = lit->scene.lights[4];
  moved.position = {1, 2, 3};
  do_edit(LampSet{4, moved}, desk);
  const scene::Scene saved = read_back(desk);
  ASSERT_EQ(saved.lights.size(), 4u);
  EXPECT_EQ(saved.lights[3].position, (Vec3{1, 2, 3}));
}

/// Where a file's node is, in double precision.
DMat34 world_of(const Json& file, size_t node) {
  const auto local_of = [](const Json& n) {
    const auto t = n.value("translation", std::array<double, 3>{});
    DMat34 out = moved_by({t[0], t[1], t[2]});
    if (n.contains("matrix"))
      for (size_t i = 0; i < 3; ++i)
        for (size_t j = 0; j < 4; ++j) out.row[i][j] = n["matrix"][4 * j + i].get<double>();
    // The only turn in these files, by a quarter about y, and the only scale.
    constexpr double s = 2;
    if (n.contains("rotation")) out = out * DMat34{{{{0, 0, s, 0}, {0, s, 0, 0}, {-s, 0, 0, 0}}}};
    return out;
  };
  DMat34 out = local_of(file["nodes"][node]);
  for (size_t n = 0; n < file["nodes"].size(); ++n) {
    const Json children = file["nodes"][n].value("children", Json::array());
    if (std::ranges::find(children, Json(node)) != children.end()) return world_of(file, n) * out;
  }
  return out;
}

DVec3 place_of(const Json& file, size_t node) { return translation_of(world_of(file, node)); }

void expect_near(DVec3 a, DVec3 b) {
  EXPECT_LE(length(a - b), 1e-6) << fmt::format("({}, {}, {}) for ({}, {}, {})", a.x, a.y, a.z, b.x,
                                                b.y, b.z);
}

/// The hall, in survey coordinates.
class SaveFarScene : public SaveScene {
 protected:
  void SetUp() override {
    origin_ = DVec3{512344, 88, -5403216};
    const auto replace = [&](const std::string& what, const std::string& by) {
      file_.replace(file_.find(what), what.size(), by);
    };
    replace("[1, 0, 2]", "[512345.678, 87.5, -5403210.123]");
    replace("[0, 3, 0]", "[512344.3, 90.5, -5403211.1]");
    replace("[2, 3, 0]", "[512346.3, 90.5, -5403211.1]");
    replace("[0, 0, -5]", "[512344.3, 87.5, -5403216.7]");
    before_ = Json::parse(file_);
    open_hall();  // for its bytes
    desk_ = open("far.gltf", std::as_bytes(std::span(file_)));
    ASSERT_EQ(desk_.read->scene.origin, *origin_);
  }

  std::string file_ = kHall;
  Json before_;
  EditDesk desk_;
};

TEST_F(SaveFarScene, WhatIsMovedByOneMetreIsSoInTheFile) {
  move(desk_, instance_of(desk_, "table"), translation({1, 0, 0}));
  const Json saved = json_of(save(desk_));
  const DMat34 now = world_of(saved, 0), was = world_of(before_, 0);
  expect_near(translation_of(now), {512346.678, 87.5, -5403210.123});
  EXPECT_EQ(translation_of(now).z, -5403210.123) << "the file's own digits";
  for (size_t i = 0; i < 3; ++i)
    for (size_t j = 0; j < 3; ++j) EXPECT_NEAR(now.row[i][j], was.row[i][j], 1e-7);
  for (const size_t child : {1u, 2u}) expect_near(place_of(saved, child), place_of(before_, child));
  for (const size_t other : {3u, 4u, 5u})
    EXPECT_EQ(saved["nodes"][other].dump(), before_["nodes"][other].dump());
  expect_same(read_back(desk_), desk_);
}

TEST_F(SaveFarScene, CopiesAndLampsStandInTheWorldOfTheFile) {
  move(desk_, instance_of(desk_, "row") + 1, translation({0, 0, 1}));
  Lamp a = desk_.now.lamps[1];
  a.light.position = a.light.position + Vec3{-1, 0, 0};
  do_edit(LampSet{1, a.light}, desk_);
  scene::PunctualLight more;
  more.position = {1.5f, 2, -0.25f};
  do_edit(LampCreated{more}, desk_);
  const Json saved = json_of(save(desk_));
  const size_t first = before_["nodes"].size();  // of the copies, the last of which comes first
  expect_near(place_of(saved, first + 2), {512343.3, 87.5, -5403216.7});
  expect_near(place_of(saved, first + 1), {512344.3, 87.5, -5403215.7});
  expect_near(place_of(saved, 3), {512343.3, 90.5, -5403211.1});
  expect_near(place_of(saved, saved["nodes"].size() - 1), {512345.5, 90, -5403216.25});
  for (const size_t other : {0u, 1u, 2u, 4u})
    EXPECT_EQ(saved["nodes"][other].dump(), before_["nodes"][other].dump());
  expect_same(read_back(desk_), desk_);
}

// Turned, scaled, and with meshes whose own vertices lie far away.
TEST_F(SaveFarScene, IsReadBackWhereItWasPut) {
  move(desk_, instance_of(desk_, "table"), turned_about({1, 0, 1}, {0.6f, 0.8f, 0}, 0.7f));
  move(desk_, instance_of(desk_, "cup"), scaled_about({}, {}, {1, 2, 1}));
  expect_same(read_back(desk_), desk_);
  origin_ = DVec3{65536, 0, 0};
  constexpr float kFarBytes[] = {65536, 0, 0, 65537, 0, 0, 65536, 1, 0, -1, 0, 0, 0, 0, 0, 1, 0, 0};
  ASSERT_TRUE(
      write_file_atomically(folder_ / "some bytes.bin", std::as_bytes(std::span(kFarBytes))));
  Json file = before_;
  file["nodes"] = Json::array({{{"name", "wall"}, {"mesh", 0}}, before_["nodes"][5]});
  file["nodes"][1].erase("translation");
  file["scenes"][0]["nodes"] = {0, 1};
  const std::string text = file.dump();
  EditDesk desk = open("vertices.gltf", std::as_bytes(std::span(text)));
  ASSERT_EQ(desk.read->scene.instances.size(), 4u);
  EXPECT_LE(scene::world_bounds(desk.read->scene).diagonal(), 4);
  move(desk, 0, turned_about({0.5f, 0, 0}, {0, 1, 0}, 1.5f));
  move(desk, instance_of(desk, "row") + 2, turned_about({1, 0, 0}, {0, 0, 1}, 0.5f));
  const scene::Scene saved = read_back(desk);
  expect_same(saved, desk);
  const Box3 box = scene::world_bounds(saved),
             wanted = scene::world_bounds(edited(desk.read->scene, desk.now));
  EXPECT_LE(length(box.lower - wanted.lower), 1e-5f);
  EXPECT_LE(length(box.upper - wanted.upper), 1e-5f);
}

TEST_F(SaveScene, AFileThatHasChangedIsNotSaved) {
  const EditDesk desk = open_hall();
  std::string other = kHall;
  other.replace(other.find("[0, 0, -5]"), 10, "[0, 0, -6]");
  ASSERT_TRUE(write_file_atomically(settings_.scene, std::as_bytes(std::span(other))));
  const auto saved = save_scene({desk.read, desk.now, settings_});
  ASSERT_FALSE(saved);
  EXPECT_THAT(saved.error().message, HasSubstr("hall.gltf has changed since it was read"));
}

TEST_F(SaveScene, WhatHangsOnJointsIsNotMoved) {
  open_hall();  // for its bytes
  std::string skinned = kHall;
  skinned.replace(skinned.find("\"cup\","), 6, "\"cup\", \"skin\": 0,");
  skinned.replace(skinned.find("\"scene\": 0"), 10, "\"skins\": [{\"joints\": [2]}], \"scene\": 0");
  EditDesk desk = open("skinned.gltf", std::as_bytes(std::span(skinned)));
  do_edit(InstanceMoved{1, translation({1, 0, 0})}, desk);
  const auto saved = save_scene({desk.read, desk.now, settings_});
  ASSERT_FALSE(saved);
  EXPECT_THAT(saved.error().message, HasSubstr("node 1 (cup) hangs on its joints"));
}

}  // namespace
}  // namespace luxel::view
