// .dae files: units, axes, the node tree, materials, lights and cameras.
#include <gmock/gmock.h>

#include "luxel/import/import_test_support.h"
#include "luxel/scene/digest.h"

namespace luxel::import {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr const char* kCentimetresZUp =
    R"(<unit name="centimeter" meter="0.01"/><up_axis>Z_UP</up_axis>)";
constexpr const char* kPerspective =
    "<perspective><yfov>60</yfov><aspect_ratio>2</aspect_ratio></perspective>";

/// The square from 0 to 100 in x and y, with normals that lean.
constexpr const char* kSquare = R"(
<library_geometries><geometry id="square"><mesh>
  <source id="p"><float_array id="pa" count="12">0 0 0 100 0 0 100 100 0 0 100 0</float_array>
    <technique_common><accessor source="#pa" count="4" stride="3"><param name="X" type="float"/>
    <param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common>
  </source>
  <source id="n"><float_array id="na" count="3">0 0.6 0.8</float_array>
    <technique_common><accessor source="#na" count="1" stride="3"><param name="X" type="float"/>
    <param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common>
  </source>
  <source id="t"><float_array id="ta" count="8">0 0.25 1 0.25 1 1 0 1</float_array>
    <technique_common><accessor source="#ta" count="4" stride="2"><param name="S" type="float"/>
    <param name="T" type="float"/></accessor></technique_common>
  </source>
  <vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
  <polylist material="its_material" count="1"><input semantic="VERTEX" source="#v" offset="0"/>
    <input semantic="NORMAL" source="#n" offset="1"/>
    <input semantic="TEXCOORD" source="#t" offset="2" set="0"/>
    <vcount>4</vcount><p>0 0 0 1 0 1 2 0 2 3 0 3</p></polylist>
</mesh></geometry></library_geometries>
)";

constexpr const char* kMaterials = R"(
<library_images><image id="pic"><init_from>pics/red%20paint.png</init_from></image></library_images>
<library_effects>
  <effect id="fx_paint"><profile_COMMON>
    <newparam sid="surf"><surface type="2D"><init_from>pic</init_from></surface></newparam>
    <newparam sid="samp"><sampler2D><source>surf</source></sampler2D></newparam>
    <technique sid="common"><phong><diffuse><texture texture="samp" texcoord="map"/></diffuse>
    <specular><color>0.1 0.2 0.3 1</color></specular><shininess><float>42</float></shininess>
    </phong></technique></profile_COMMON></effect>
  <effect id="fx_glow"><profile_COMMON><technique sid="common"><lambert>
    <emission><color>17 12 4 1</color></emission><diffuse><color>0.1 0.2 0.3 1</color></diffuse>
    </lambert></technique></profile_COMMON></effect>
</library_effects>
<library_materials>
  <material id="paint" name="paint"><instance_effect url="#fx_paint"/></material>
  <material id="glow" name="glow"><instance_effect url="#fx_glow"/></material>
</library_materials>
)";

constexpr const char* kLights = R"(
<library_lights>
  <light id="bulb"><technique_common><point><color>3 2 1</color></point></technique_common></light>
  <light id="beam"><technique_common><spot><color>1 1 1</color><falloff_angle>60</falloff_angle>
    </spot></technique_common></light>
  <light id="sun"><technique_common><directional><color>5 5 5</color></directional>
    </technique_common></light>
  <light id="sky"><technique_common><ambient><color>1 1 1</color></ambient></technique_common></light>
</library_lights>
)";

std::string draw(const char* id, const char* placed, const char* material) {
  return fmt::format(R"(<node id="{}">{}<instance_geometry url="#square"><bind_material>
    <technique_common><instance_material symbol="its_material" target="#{}"/></technique_common>
    </bind_material></instance_geometry></node>)",
                     id, placed, material);
}

std::string document(const std::string& asset, const std::string& libraries,
                     const std::string& nodes) {
  return R"(<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><created>2020-01-01T00:00:00</created><modified>2020-01-01T00:00:00</modified>)" +
         asset + "</asset>" + libraries + R"(<library_visual_scenes><visual_scene id="all">)" +
         nodes +
         R"(</visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#all"/></scene></COLLADA>)";
}

std::string cameras(const std::string& optics) {
  return "<library_cameras><camera id=\"lens\"><optics><technique_common>" + optics +
         "</technique_common></optics></camera></library_cameras>";
}

constexpr const char* kCameraNode =
    "<node id=\"eye\"><translate>0 -500 100</translate><rotate>1 0 0 90</rotate>"
    "<instance_camera url=\"#lens\"/></node>";

/// A room that holds a floor and its twin, and a lamp that looks down on them.
std::string room(const std::string& asset, const std::string& optics) {
  const std::string in_room =
      draw("floor", "<translate>200 0 0</translate>", "paint") +
      draw("twin", "<translate>0 0 50</translate>", "paint") +
      draw("lamp", "<translate>0 0 300</translate><rotate>1 0 0 180</rotate>", "glow");
  const std::string lights =
      "<node id=\"n_bulb\"><translate>10 20 200</translate><instance_light url=\"#bulb\"/></node>"
      "<node id=\"n_beam\"><translate>10 20 200</translate><instance_light url=\"#beam\"/></node>"
      "<node id=\"n_sun\"><rotate>1 0 0 90</rotate><instance_light url=\"#sun\"/></node>"
      "<node id=\"n_sky\"><instance_light url=\"#sky\"/></node>";
  return document(asset, cameras(optics) + kLights + kMaterials + kSquare,
                  "<node id=\"room\"><translate>0 0 100</translate>" + in_room + "</node>" +
                      kCameraNode + lights);
}

Result<Imported> import_room(const std::string& asset = kCentimetresZUp,
                             const std::string& optics = kPerspective) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.path() / "pics");
  folder.write("pics/red paint.png", png_of(3, 1, {255, 0, 0, 255}));
  return import_scene(folder.write("a.dae", room(asset, optics)));
}

TEST(Collada, CentimetresAndZUpBecomeMetresAndYUp) {
  expect_room_in_metres(scene_of(import_room()));
}

TEST(Collada, EveryUnitAndAxisIsTurnedIntoOurs) {
  const auto normal_and_area = [](const std::string& asset) {
    const scene::Scene scene = scene_of(import_room(asset));
    return std::pair(scene::front_normal(scene, 0, 0), drawn_area(scene) / 3);
  };
  const auto [y_normal, y_area] = normal_and_area("<up_axis>Y_UP</up_axis>");
  expect_near(y_normal, {0, 0, 1}, 1e-6f);
  EXPECT_NEAR(y_area, 1e4f, 0.1f) << "metres when no unit is stated";
  const auto [x_normal, x_area] =
      normal_and_area(R"(<unit meter="0.0254" name="inch"/><up_axis>X_UP</up_axis>)");
  // Up is x, and the file's y points to the left: its z to the viewer.
  expect_near(x_normal, {0, 0, 1}, 1e-6f);
  EXPECT_NEAR(x_area, 6.4516f, 1e-4f);
}

TEST(Collada, AMeshUsedTwiceIsStoredOnce) {
  const scene::Scene scene = scene_of(import_room());
  ASSERT_EQ(scene.instances.size(), 3u);
  EXPECT_EQ(scene.meshes.size(), 2u) << "once for each material";
  EXPECT_EQ(scene.instances[0].mesh, scene.instances[1].mesh);
}

TEST(Collada, MaterialsTexturesAndCoordinates) {
  const scene::Scene scene = scene_of(import_room());
  ASSERT_EQ(scene.instances.size(), 3u);
  const scene::SurfacePoint floor{0, 0, {0.3f, 0.3f}}, lamp{2, 0, {0.3f, 0.3f}};
  EXPECT_EQ(scene::material_at(scene, floor).name, "paint");
  expect_near(scene::reflectance_at(scene, floor), {0.99f, 0, 0}, 1e-5f);
  expect_near(scene::emission_at(scene, floor), {0, 0, 0}, 0);
  expect_near(scene::reflectance_at(scene, lamp), {0.1f, 0.2f, 0.3f}, 1e-5f);
  expect_near(scene::emission_at(scene, lamp), {17, 12, 4}, 1e-5f);
  expect_near(scene::material_at(scene, floor).specular, {0.1f, 0.2f, 0.3f}, 1e-6f);
  EXPECT_FLOAT_EQ(scene::material_at(scene, floor).sharpness, 42);
  EXPECT_EQ(scene::material_at(scene, lamp).specular, Rgb{}) << "lambert; Assimp makes up 0.4";
  ASSERT_EQ(scene.textures.size(), 1u);
  EXPECT_EQ(scene.textures[0].width, 3);
  // The file's v grows upwards, ours downwards.
  const scene::Mesh& mesh = scene.meshes[scene.instances[0].mesh];
  ASSERT_EQ(mesh.uv0.size(), 4u);
  for (size_t v = 0; v < 4; ++v) {
    EXPECT_FLOAT_EQ(mesh.uv0[v].x, mesh.positions[v].x > 0 ? 1.0f : 0.0f);
    EXPECT_FLOAT_EQ(mesh.uv0[v].y, mesh.positions[v].y > 0 ? 0.0f : 0.75f);
  }
}

TEST(Collada, Lights) {
  const auto imported = import_room();
  const scene::Scene scene = scene_of(imported);
  ASSERT_EQ(scene.lights.size(), 3u);
  EXPECT_THAT(all_of(imported->warnings), HasSubstr("'n_sky' is neither"));
  EXPECT_EQ(scene.lights[0].kind, scene::PunctualLight::Kind::point);
  expect_near(scene.lights[0].position, {0.1f, 2, -0.2f}, 1e-5f);
  expect_near(scene.lights[0].intensity, {3, 2, 1}, 1e-5f);
  EXPECT_EQ(scene.lights[1].kind, scene::PunctualLight::Kind::spot);
  expect_near(scene.lights[1].direction, {0, -1, 0}, 1e-5f);
  EXPECT_NEAR(scene.lights[1].outer_cone_rad, kPi / 6, 1e-5f) << "60 degrees from side to side";
  EXPECT_EQ(scene.lights[2].kind, scene::PunctualLight::Kind::directional);
  expect_near(scene.lights[2].direction, {0, 0, -1}, 1e-5f);
}

TEST(Collada, ACameraHasThePlaceAndTheLensThatItsFileStates) {
  const auto camera_of = [](const std::string& optics) {
    const scene::Scene scene = scene_of(import_room(kCentimetresZUp, optics));
    EXPECT_EQ(scene.cameras.size(), 1u);
    return scene.cameras.empty() ? scene::Camera{} : scene.cameras[0];
  };
  const scene::Camera eye = camera_of(kPerspective);
  expect_near(transform_point(eye.world_from_camera, {}), {0, 1, 5}, 1e-5f);
  expect_near(transform_vector(eye.world_from_camera, {0, 0, -1}), {0, 0, -1}, 1e-5f);
  expect_near(transform_vector(eye.world_from_camera, {0, 1, 0}), {0, 1, 0}, 1e-5f);
  EXPECT_FLOAT_EQ(eye.aspect, 2);
  EXPECT_NEAR(eye.fov_y_rad, kPi / 3, 1e-5f);

  const auto perspective = [&](const std::string& text) {
    return camera_of("<perspective>" + text + "</perspective>");
  };
  const scene::Camera alone = perspective("<yfov sid=\"fov\"> 60 </yfov>");
  EXPECT_NEAR(alone.fov_y_rad, kPi / 3, 1e-5f);
  EXPECT_EQ(alone.aspect, 0) << "that of the picture";
  const scene::Camera both = perspective("<xfov>90</xfov><yfov>60</yfov>");
  EXPECT_NEAR(both.fov_y_rad, kPi / 3, 1e-5f);
  EXPECT_NEAR(both.aspect, std::sqrt(3.0f), 1e-5f);
  const scene::Camera wide = perspective("<xfov>90</xfov><aspect_ratio>2</aspect_ratio>");
  EXPECT_NEAR(wide.fov_y_rad, 2 * std::atan(0.5f), 1e-5f);
  const scene::Camera flat = camera_of(
      "<orthographic><xmag>300</xmag><aspect_ratio>2</aspect_ratio><znear>1</znear></"
      "orthographic>");
  EXPECT_NEAR(flat.orthographic_height_m, 3, 1e-5f) << "6 m wide, half as high";
  EXPECT_FLOAT_EQ(flat.aspect, 2);
}

TEST(Collada, AListThatIsShorterThanItsReaderThinksIsAnError) {
  const std::pair<const char*, const char*> damages[] = {
      {"count=\"12\"", "count=\"0\""},
      {"count=\"12\"", "count=\"nan\""},
      {"count=\"12\"", ""},
      {"count=\"4\" stride=\"3\"", "count=\"1000000000\" stride=\"3\""},
      {"count=\"4\" stride=\"3\"", "count=\"4\" stride=\"4\""},
      {"count=\"4\" stride=\"3\"", "count=\"-1\" stride=\"3\""},
      {"count=\"4\" stride=\"3\"", "count=\"4\" offset=\"1\" stride=\"3\""},
      {"<param name=\"Y\"", "<param name=\"W\" type=\"float\"/><param name=\"Y\""}};
  for (const auto& [from, to] : damages) {
    std::string text = document(kCentimetresZUp, kSquare, "");
    const auto imported = import_text("a.dae", text.replace(text.find(from), strlen(from), to));
    ASSERT_FALSE(imported) << to;
    EXPECT_THAT(imported.error().message, HasSubstr("past the float_array 'pa'")) << to;
  }
}

// Some writers put each value on a line of its own.
TEST(Collada, ValuesMayStandBetweenBlanks) {
  const auto read = [](const std::string& text) {
    const TemporaryFolder folder;
    std::filesystem::create_directory(folder.path() / "pics");
    folder.write("pics/red paint.png", png_of(3, 1, {255, 0, 0, 255}));
    const auto imported = import_scene(folder.write("a.dae", text));
    return imported ? imported->scene : scene_of(imported);
  };
  const std::string text = room(kCentimetresZUp, kPerspective);
  std::string spread;
  for (size_t i = 0; i < text.size(); ++i) {
    // Between a tag and a value, on either side of it.
    const bool begins = i > 0 && text[i - 1] == '>' && text[i] != '<' && text[i] != '\n';
    const bool ends = i > 0 && text[i] == '<' && text[i - 1] != '>' && text[i - 1] != '\n';
    if (begins || ends) spread += " \r\n\t";
    spread += text[i];
  }
  EXPECT_GT(spread.size(), text.size() + 200);
  const scene::Scene plain = read(text), same = read(spread);
  EXPECT_EQ(scene::difference(scene::digests_of(plain), scene::digests_of(same)), "");
  expect_near(same.materials[0].emission, {17, 12, 4}, 1e-5f);
}

TEST(Collada, BrokenXmlAndUtf16AreSaid) {
  std::string broken = room(kCentimetresZUp, kPerspective);
  broken.erase(broken.find("</asset>"), 8);
  EXPECT_THAT(import_text("a.dae", broken).error().message,
              AllOf(HasSubstr("a.dae, line "), HasSubstr("its XML is broken: ")));
  std::string wide = "\xff\xfe";
  for (const char c : room(kCentimetresZUp, kPerspective)) wide += std::string{c, '\0'};
  EXPECT_THAT(import_text("a.dae", wide).error().message, HasSubstr("it is UTF-16 or damaged; "));
}

// A name in Latin-1, as the file says of itself, becomes UTF-8.
TEST(Collada, OtherEncodingsAreRead) {
  std::string text = room(kCentimetresZUp, kPerspective);
  text.replace(text.find("utf-8"), 5, "ISO-8859-1");
  text.replace(text.find("name=\"paint\""), 12, "name=\"gr\xfcn\"");
  const auto imported = import_text("a.dae", text);
  EXPECT_EQ(scene_of(imported).materials[1].name, "gr\xc3\xbcn");
}

TEST(Collada, AttributesMayStandBehindAnyBlanks) {
  for (const char* blanks : {"\tcount = ", "\n  count="}) {
    std::string text = document(kCentimetresZUp, kSquare, draw("floor", "", "paint"));
    const size_t at = text.find(" count=\"12\"");
    ASSERT_NE(at, text.npos);
    const auto imported = import_text("a.dae", text.replace(at, 7, blanks));
    EXPECT_TRUE(imported) << imported.error().message;
  }
}

}  // namespace
}  // namespace luxel::import
