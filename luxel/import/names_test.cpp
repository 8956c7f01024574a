// Names in Latin-1, as old programs write them: whatever the format, all that is said of a scene is
// UTF-8, as JSON needs it.
#include <gmock/gmock.h>

#include "luxel/base/shown_text.h"
#include "luxel/import/import_test_support.h"

namespace luxel::import {
namespace {

using ::testing::HasSubstr;

const std::string kName = "W\xe4nde", kRead = "W\xef\xbf\xbdnde";

/// All names, and all that was said.
std::string words_of(const Imported& in) {
  std::string out = in.scene.name + "\n" + in.about_lost_lights + "\n";
  const auto add = [&](const auto& things) {
    for (const auto& thing : things) out += thing.name + "\n";
  };
  add(in.scene.meshes), add(in.scene.instances), add(in.scene.materials), add(in.scene.textures);
  add(in.scene.lights), add(in.scene.cameras);
  for (const std::string& warning : in.warnings) out += warning + "\n";
  return out;
}

std::string collada() {
  return R"(<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="meter" meter="1"/><up_axis>Y_UP</up_axis></asset>
<library_lights><light id="l" name=")" +
         kName + R"("><technique_common><point><color>1 1 1</color></point></technique_common>
</light></library_lights>
<library_geometries><geometry id="g"><mesh><source id="p">
<float_array id="a" count="9">0 0 0 1 0 0 0 1 0</float_array><technique_common>
<accessor source="#a" count="3" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices><triangles count="1">
<input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles></mesh></geometry>
</library_geometries><library_visual_scenes><visual_scene id="s"><node id="n" name=")" +
         kName + R"("><instance_geometry url="#g"/><instance_light url="#l"/></node>
</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
}

TEST(Names, AreUtf8AfterEveryReader) {
  const std::string facet =
      "facet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n"
      "endfacet\n";
  const std::pair<const char*, std::string> files[] = {
      {".stl", "solid " + kName + "\n" + facet + "endsolid " + kName + "\n"},
      {".ply", "ply\nformat ascii 1.0\ncomment TextureFile " + kName +
                   ".png\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                   "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
                   "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"},
      {".obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\no " + kName + "\nusemtl " + kName + "\nf 1 2 3\n"},
      {".dae", collada()}};
  const TemporaryFolder folder;
  for (const auto& [extension, text] : files) {
    const auto imported = import_scene(folder.write(kName + extension, text));
    ASSERT_TRUE(imported) << extension << imported.error().message;
    const std::string words = words_of(*imported);
    EXPECT_EQ(words, valid_utf8(words)) << extension;
    EXPECT_THAT(words, HasSubstr(kRead)) << extension;
    const auto refused = import_scene(folder.write(kName + extension, ""));
    EXPECT_THAT(refused.error().message, HasSubstr("W\\xe4nde")) << "the file is shown as it is";
  }
}

}  // namespace
}  // namespace luxel::import
