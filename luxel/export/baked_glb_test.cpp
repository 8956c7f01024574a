#include "luxel/export/baked_glb.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <set>

#include "luxel/base/file.h"
#include "luxel/export/glb_test_support.h"
#include "luxel/export/gltf_material.h"
#include "luxel/export/scene_test_support.h"
#include "luxel/image/codec.h"
#include "luxel/scene/shapes.h"
#include "tests/support.h"

namespace luxel::export_ {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::Pair;

struct Baked {
  scene::Scene scene = rich_scene();
  atlas::Atlas atlas = made_up_atlas(scene);
  image::Image lightmap = ramp_lightmap();
  std::vector<std::byte> bytes;
  Document document;

  Baked() {
    const auto glb = baked_glb(scene, atlas, lightmap);
    EXPECT_TRUE(glb);
    bytes = *glb;
    document = parse(bytes);
  }
};

/// The triangles of an instance in the order of the file: by material, in order of first use.
std::vector<uint32_t> file_order(const scene::Mesh& mesh) {
  std::vector<uint32_t> materials, order;
  for (const uint32_t m : mesh.triangle_material)
    if (std::find(materials.begin(), materials.end(), m) == materials.end()) materials.push_back(m);
  for (const uint32_t m : materials)
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t)
      if (mesh.triangle_material[t] == m) order.push_back(t);
  return order;
}

void expect_same_triangle(const scene::Scene& scene, uint32_t instance, uint32_t t,
                          const ReadTriangle& read) {
  const scene::Mesh& mesh = scene.meshes[scene.instances[instance].mesh];
  EXPECT_EQ(read.node, scene.instances[instance].name);
  EXPECT_EQ(read.material["name"], scene.materials[mesh.triangle_material[t]].name);
  const scene::Triangle3 world = world_triangle(scene, instance, t);
  const std::array<Vec3, 3> positions{world.a, world.b, world.c};
  for (size_t c = 0; c < 3; ++c) {
    const uint32_t v = mesh.triangles[t][c];
    const Corner& corner = read.corner[c];
    expect_close(corner.position, positions[c], 1e-6f * (10 + length(positions[c])));
    if (!mesh.normals.empty()) {
      EXPECT_EQ(corner.normal, mesh.normals[v]);
    }
    if (!mesh.colors.empty()) {
      EXPECT_EQ(corner.color, mesh.colors[v]);
    }
    if (!mesh.uv0.empty()) {
      EXPECT_EQ(corner.uv0, mesh.uv0[v]);
    }
  }
}

TEST(BakedGlb, ReadBackGivesTheSameTriangles) {
  const Baked baked;
  const std::vector<ReadTriangle> triangles = read_triangles(baked.document);
  ASSERT_EQ(triangles.size(), baked.atlas.corners.size());
  size_t next = 0;
  for (uint32_t i = 0; i < baked.scene.instances.size(); ++i)
    for (const uint32_t t : file_order(baked.scene.meshes[baked.scene.instances[i].mesh])) {
      const ReadTriangle& read = triangles[next++];
      expect_same_triangle(baked.scene, i, t, read);
      const auto& place = baked.atlas.corners[baked.atlas.triangle_number(i, t)];
      for (size_t c = 0; c < 3; ++c)
        EXPECT_EQ(read.corner[c].uv1, (Vec2{place[c].x / 1024, place[c].y / 1024}));
    }
}

TEST(BakedGlb, VerticesAreSplitOnlyWhereChartsPart) {
  scene::Scene scene;
  scene.materials.resize(1);
  scene.meshes.push_back(grid_mesh());
  scene.meshes[0].triangle_material.assign(72, 0);
  scene.instances.push_back({"one", 0, {}});
  const auto glb = baked_glb(scene, made_up_atlas(scene), ramp_lightmap());
  ASSERT_TRUE(glb);
  const Document d = parse(*glb);
  const size_t positions = d.j["meshes"][0]["primitives"][0]["attributes"]["POSITION"];
  // Three strips of 3 x 7 vertices.
  EXPECT_EQ(d.j["accessors"][positions]["count"], 63);
}

TEST(BakedGlb, AccessorsAreAlignedBoundedAndInside) {
  const Baked baked;
  const json& j = baked.document.j;
  EXPECT_EQ(j["buffers"].size(), 1u);
  EXPECT_EQ(j["buffers"][0]["byteLength"], baked.document.binary.size());
  for (const json& view : j["bufferViews"]) {
    EXPECT_EQ(view["byteOffset"].get<size_t>() % 4, 0u);
    EXPECT_GT(view["byteLength"], 0u);
    EXPECT_LE(view["byteOffset"].get<size_t>() + view["byteLength"].get<size_t>(),
              baked.document.binary.size());
  }
  for (const json& accessor : j["accessors"]) {
    const json& view = j["bufferViews"][accessor["bufferView"].get<size_t>()];
    if (accessor["type"] == "SCALAR") {
      EXPECT_EQ(view["target"], 34963);
      EXPECT_FALSE(view.contains("byteStride"));
      continue;
    }
    EXPECT_EQ(view["target"], 34962);
    const std::vector<float> values = floats(baked.document, accessor);
    const size_t n = accessor["min"].size();
    EXPECT_EQ(view["byteStride"], 4 * n);
    for (size_t c = 0; c < n; ++c) {
      float lower = INFINITY, upper = -INFINITY;
      for (size_t i = c; i < values.size(); i += n)
        lower = std::min(lower, values[i]), upper = std::max(upper, values[i]);
      EXPECT_EQ(accessor["min"][c].get<float>(), lower);
      EXPECT_EQ(accessor["max"][c].get<float>(), upper);
    }
  }
  for (const json& mesh : j["meshes"])
    for (const json& primitive : mesh["primitives"]) {
      const size_t vertices =
          j["accessors"][primitive["attributes"]["POSITION"].get<size_t>()]["count"];
      for (const uint32_t i : indices(baked.document, primitive)) EXPECT_LT(i, vertices);
      for (const json& a : primitive["attributes"])
        EXPECT_EQ(j["accessors"][a.get<size_t>()]["count"], vertices);
    }
}

TEST(BakedGlb, MaterialsKeepTheirMeaning) {
  const Baked baked;
  std::map<std::string, json> materials;
  for (const json& m : baked.document.j["materials"]) materials[m["name"]] = m;
  ASSERT_EQ(materials.size(), 4u);

  const json painted = materials["painted"];
  EXPECT_THAT(painted["pbrMetallicRoughness"]["baseColorFactor"].get<std::vector<float>>(),
              ElementsAre(0.1f, 0.2f, 0.3f, 1.0f));
  const json info = painted["pbrMetallicRoughness"]["baseColorTexture"];
  EXPECT_EQ(info["extensions"]["KHR_texture_transform"]["offset"][0], 0.5f);
  EXPECT_EQ(info["extensions"]["KHR_texture_transform"]["rotation"], 1.0f);

  const json lamp = materials["lamp"];
  EXPECT_EQ(lamp["doubleSided"], true);
  const float strength = lamp["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"];
  for (size_t c = 0; c < 3; ++c) {
    EXPECT_LE(lamp["emissiveFactor"][c], 1);
    EXPECT_EQ(lamp["emissiveFactor"][c].get<float>() * strength,
              baked.scene.materials[1].emission[int(c)]);
  }
  EXPECT_EQ(materials["leaf"]["alphaMode"], "MASK");
  EXPECT_EQ(materials["leaf"]["alphaCutoff"], 0.25f);
  EXPECT_EQ(materials["sign"]["alphaMode"], "BLEND");
  EXPECT_TRUE(materials["sign"]["extensions"].contains("KHR_materials_unlit"));
  EXPECT_FALSE(materials["sign"]["extensions"].contains("MOZ_lightmap"));
  EXPECT_FALSE(materials["sign"]["pbrMetallicRoughness"].contains("baseColorTexture"));

  const std::set<std::string> used = baked.document.j["extensionsUsed"];
  EXPECT_THAT(used, ElementsAre("KHR_lights_punctual", "KHR_materials_emissive_strength",
                                "KHR_materials_unlit", "KHR_texture_transform", "MOZ_lightmap"));
}

TEST(BakedGlb, LightmapPictureTimesIntensityIsIrradiance) {
  const Baked baked;
  const json& j = baked.document.j;
  const json& extension = j["materials"][0]["extensions"]["MOZ_lightmap"];
  EXPECT_EQ(extension["texCoord"], 1);
  const float intensity = extension["intensity"];
  const json& texture = j["textures"][extension["index"].get<size_t>()];
  const json& picture = j["images"][texture["source"].get<size_t>()];
  const json& view = j["bufferViews"][picture["bufferView"].get<size_t>()];
  const auto png = std::span(baked.document.binary)
                       .subspan(view["byteOffset"].get<size_t>(), view["byteLength"].get<size_t>());
  const image::Image& e = baked.lightmap;
  image::Image scaled(64, 64, 3);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) scaled.set_rgb(x, y, e.rgb(x, y) / intensity);
  EXPECT_THAT(std::vector(png.begin(), png.end()),
              testing::ContainerEq(image::encode_png(image::to_srgb8(scaled))));
  // One covered texel in a thousand may clip: 3840 texels, the ramp's largest values in the end.
  int clipped = 0;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 60; ++x) clipped += max_component(e.rgb(x, y)) > intensity ? 1 : 0;
  EXPECT_GE(clipped, 1);
  EXPECT_LE(clipped, 4);
}

TEST(BakedGlb, ABlackLightmapHasIntensityOne) {
  const scene::Scene scene = rich_scene();
  const auto glb = baked_glb(scene, made_up_atlas(scene), image::Image(8, 8, 4));
  ASSERT_TRUE(glb);
  EXPECT_EQ(parse(*glb).j["materials"][0]["extensions"]["MOZ_lightmap"]["intensity"], 1);
}

TEST(SceneGlb, SharedMeshesStayShared) {
  const scene::Scene scene = rich_scene();
  const auto glb = scene_glb(scene);
  ASSERT_TRUE(glb);
  const Document d = parse(*glb);
  EXPECT_EQ(d.j["meshes"].size(), 2u);
  const std::vector<ReadTriangle> triangles = read_triangles(d);
  size_t next = 0;
  for (uint32_t i = 0; i < scene.instances.size(); ++i)
    for (const uint32_t t : file_order(scene.meshes[scene.instances[i].mesh]))
      expect_same_triangle(scene, i, t, triangles[next++]);
  EXPECT_EQ(next, triangles.size());
  EXPECT_FALSE(d.j["materials"][0].value("extensions", json::object()).contains("MOZ_lightmap"));
}

// Each instance has a mesh of its own, for its place in the lightmap. What is alike of them stands
// in the file once.
TEST(BakedGlb, InstancesShareWhatIsAlike) {
  scene::Scene scene;
  scene::add_material(scene, "grey", {0.5f, 0.5f, 0.5f});
  scene::Mesh ball = scene::sphere("ball", 1, 16, 8, 0);
  scene::place(scene, std::move(ball));
  const auto bytes_of = [&] {
    Progress progress;
    const auto atlas =
        atlas::make_atlas(scene, {.uv = atlas::UvMode::unwrap, .resolution = 256}, progress);
    return baked_glb(scene, *atlas, image::Image(1, 1, 4)).value();
  };
  const size_t of_one = bytes_of().size();
  for (const float x : {3.0f, 6.0f, 9.0f}) {
    scene.instances.push_back(scene.instances[0]);
    scene.instances.back().world_from_object = translation({x, 0, 0});
  }
  const std::vector<std::byte> glb = bytes_of();
  const Document d = parse(glb);
  std::set<size_t> positions, indices, places;
  for (const json& mesh : d.j["meshes"]) {
    const json& primitive = mesh["primitives"][0];
    positions.insert(primitive["attributes"]["POSITION"].get<size_t>());
    places.insert(primitive["attributes"]["TEXCOORD_1"].get<size_t>());
    indices.insert(primitive["indices"].get<size_t>());
  }
  EXPECT_EQ(places.size(), 4u);
  EXPECT_EQ(positions.size(), 1u);
  EXPECT_EQ(indices.size(), 1u);
  EXPECT_LT(glb.size(), 3 * of_one);
  EXPECT_EQ(read_triangles(d).size(), 4 * scene.meshes[0].triangles.size());
}

// WebP may come in by an extension; what goes out needs none.
TEST(SceneGlb, PicturesThatGltfDoesNotKnowBecomePngs) {
  scene::Scene scene = rich_scene();
  const std::string webp = "RIFF....WEBP";
  const auto* first = reinterpret_cast<const std::byte*>(webp.data());
  scene.textures[0].encoded.assign(first, first + webp.size());
  scene.textures[0].mime_type = "image/webp";
  const Document d = parse(*scene_glb(scene));
  ASSERT_FALSE(d.j["images"].empty());
  EXPECT_EQ(d.j["images"][0]["mimeType"], "image/png");
  const json& view = d.j["bufferViews"][d.j["images"][0]["bufferView"].get<size_t>()];
  const auto picture =
      image::decode_ldr(std::span(d.binary).subspan(view["byteOffset"].get<size_t>(),
                                                    view["byteLength"].get<size_t>()),
                        "picture");
  ASSERT_TRUE(picture);
  EXPECT_EQ(picture->data, scene.textures[0].rgba);
}

TEST(SceneGlb, ManyVerticesGetWideIndices) {
  scene::Scene scene;
  scene.materials.resize(1);
  scene::Mesh mesh;
  for (uint32_t i = 0; i < 70000; ++i) {
    mesh.positions.push_back({float(i), float(i % 7), 0});
    if (i >= 2) mesh.triangles.push_back({i - 2, i - 1, i});
  }
  mesh.triangle_material.assign(mesh.triangles.size(), 0);
  scene.meshes.push_back(mesh);
  scene.instances.push_back({"strip", 0, {}});
  const Document d = parse(*scene_glb(scene));
  const json& primitive = d.j["meshes"][0]["primitives"][0];
  EXPECT_EQ(d.j["accessors"][primitive["indices"].get<size_t>()]["componentType"], 5125);
  EXPECT_EQ(read_triangles(d).size(), mesh.triangles.size());
}

TEST(SceneGlb, NamesThatAreNotUtf8DoNotStopIt) {
  scene::Scene scene = rich_scene();
  scene.instances[0].name = "caf\xe9";
  const auto glb = scene_glb(scene);
  ASSERT_TRUE(glb);
  EXPECT_EQ(parse(*glb).j["nodes"][0]["name"], "caf\xef\xbf\xbd");
}

/// Grey pictures of the rich scene.
Document lit_document(Attach attach, std::vector<std::byte>* bytes = nullptr) {
  const scene::Scene scene = rich_scene();
  LitPictures pictures;
  pictures.attach = attach, pictures.strength = attach == Attach::emissive ? 2 : 1;
  pictures.exposure = 0.25f, pictures.scale = 2;
  const int channels = attach == Attach::combined ? 4 : 3;
  pictures.pages.push_back({8, 8, channels, std::vector<uint8_t>(size_t(64 * channels), 128)});
  const auto glb = lit_glb(scene, made_up_atlas(scene), pictures);
  EXPECT_TRUE(glb);
  if (bytes) *bytes = *glb;
  EXPECT_EQ(*attach_of(*glb, "baked.glb"), attach);
  const Document d = parse(*glb);
  EXPECT_EQ(d.j["asset"]["extras"]["luxel"]["exposure"], 0.25f);
  return d;
}

std::map<std::string, json> materials_of(const Document& d) {
  std::map<std::string, json> out;
  for (const json& m : d.j["materials"]) out[m["name"]] = m;
  return out;
}

// A viewer that knows only the core of glTF needs colour by TEXCOORD_1, alpha and sides.
TEST(LitGlb, CombinedIsUnlitColor) {
  const Document d = lit_document(Attach::combined);
  std::map<std::string, json> materials = materials_of(d);
  ASSERT_EQ(materials.size(), 4u);
  for (const char* name : {"painted", "lamp", "leaf"}) {
    const json& m = materials[name];
    EXPECT_EQ(
        m["pbrMetallicRoughness"]["baseColorTexture"],
        (json{{"index", m["pbrMetallicRoughness"]["baseColorTexture"]["index"]}, {"texCoord", 1}}));
    EXPECT_EQ(m["pbrMetallicRoughness"]["baseColorFactor"], json({1.0, 1.0, 1.0, 1.0}));
    EXPECT_TRUE(m["extensions"].contains("KHR_materials_unlit")) << name;
    EXPECT_FALSE(m.contains("emissiveFactor")) << name;
    EXPECT_EQ(m["extras"]["luxel"]["lightmap"], "lightmap.exr");
  }
  EXPECT_EQ(materials["lamp"]["doubleSided"], true);
  EXPECT_EQ(materials["leaf"]["alphaMode"], "MASK");
  EXPECT_EQ(materials["leaf"]["alphaCutoff"], 0.25f);
  EXPECT_EQ(materials["sign"]["alphaMode"], "BLEND") << "unlit in the scene: as it was";
  EXPECT_FALSE(materials["sign"].contains("extras"));
  const std::set<std::string> used = d.j["extensionsUsed"];
  EXPECT_THAT(used, ElementsAre("KHR_lights_punctual", "KHR_materials_unlit"));
  // Some programs look up every texture by TEXCOORD_0.
  for (const json& mesh : d.j["meshes"])
    for (const json& primitive : mesh["primitives"])
      EXPECT_EQ(primitive["attributes"]["TEXCOORD_0"], primitive["attributes"]["TEXCOORD_1"]);
  // The pictures hold vertex colours; they are finer than the lightmap, so they have mipmaps.
  for (const ReadTriangle& t : read_triangles(d)) EXPECT_EQ(t.corner[0].color, Vec3{});
  EXPECT_EQ(d.j["samplers"][0]["minFilter"], 9987);
}

TEST(LitGlb, EmissiveIsEmissionOfBlackSurfaces) {
  const Document d = lit_document(Attach::emissive);
  std::map<std::string, json> materials = materials_of(d);
  for (const char* name : {"painted", "lamp", "leaf"}) {
    const json& m = materials[name];
    EXPECT_EQ(m["emissiveTexture"]["texCoord"], 1);
    EXPECT_EQ(m["emissiveFactor"], json({1, 1, 1}));
    EXPECT_EQ(m["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"], 2);
    EXPECT_EQ(m["extensions"]["KHR_materials_specular"]["specularFactor"], 0);
    EXPECT_EQ(m["pbrMetallicRoughness"]["baseColorFactor"], json({0.0, 0.0, 0.0, 1.0}));
    EXPECT_EQ(m["pbrMetallicRoughness"]["metallicFactor"], 0.0);
    EXPECT_FALSE(m["pbrMetallicRoughness"].contains("baseColorTexture")) << name;
  }
  EXPECT_FALSE(materials["sign"]["extensions"].contains("KHR_materials_specular"));
}

// The alpha of black surfaces is in their colour texture, which has coordinates of its own.
TEST(LitGlb, ATextureThatStaysKeepsItsCoordinates) {
  scene::Scene scene = rich_scene();
  scene.materials[2].base_color_texture.texture = 1;
  LitPictures pictures;
  pictures.attach = Attach::emissive;
  pictures.pages.push_back({8, 8, 3, std::vector<uint8_t>(192, 128)});
  const auto glb = lit_glb(scene, made_up_atlas(scene), pictures);
  ASSERT_TRUE(glb);
  const Document d = parse(*glb);
  for (const json& mesh : d.j["meshes"])
    for (const json& primitive : mesh["primitives"]) {
      const bool is_leaf = d.j["materials"][primitive["material"].get<size_t>()]["name"] == "leaf";
      const json& attributes = primitive["attributes"];
      EXPECT_EQ(attributes["TEXCOORD_0"] != attributes["TEXCOORD_1"], is_leaf);
    }
}

// The Khronos validator wants colours up to 1, and no other extension beside KHR_materials_unlit.
TEST(SceneGlb, UnlitMaterialsAndColorsAreValid) {
  scene::Scene scene = rich_scene();
  scene.meshes[0].colors[0] = {2, 0.5f, -1};
  scene.materials[3].specular = {0.5f, 0.5f, 0.5f};
  const auto glb = scene_glb(scene);
  ASSERT_TRUE(glb);
  const Document d = parse(*glb);
  EXPECT_EQ(read_triangles(d)[0].corner[0].color, (Vec3{1, 0.5f, 0}));
  EXPECT_EQ(materials_of(d)["sign"]["extensions"].size(), 1u);
}

/// COLOR_0 of each primitive whose material has this name, by its type.
std::map<std::string, std::vector<float>> colors_of(const Document& d,
                                                    const std::string& material) {
  std::map<std::string, std::vector<float>> out;
  for (const json& mesh : d.j["meshes"])
    for (const json& primitive : mesh["primitives"]) {
      if (d.j["materials"][primitive["material"].get<size_t>()]["name"] != material) continue;
      if (!primitive["attributes"].contains("COLOR_0")) continue;
      const json& accessor = d.j["accessors"][primitive["attributes"]["COLOR_0"].get<size_t>()];
      out[accessor["type"]] = floats(d, accessor);
    }
  return out;
}

// Only where the material counts it; pictures that hold alpha hold it once.
TEST(SceneGlb, VertexAlphaIsTheFourthNumberOfColours) {
  scene::Scene scene = rich_scene();
  scene::Mesh& mesh = scene.meshes[0];
  for (size_t v = 0; v < mesh.positions.size(); ++v)
    mesh.alphas.push_back(float(v + 1) / float(mesh.positions.size() + 1));
  const auto glb = scene_glb(scene);
  ASSERT_TRUE(glb);
  const Document d = parse(*glb);
  EXPECT_THAT(colors_of(d, "painted"), ElementsAre(Pair("VEC3", ::testing::_)));
  const auto leaf = colors_of(d, "leaf");
  ASSERT_THAT(leaf, ElementsAre(Pair("VEC4", ::testing::_)));
  const std::vector<float>& rgba = leaf.at("VEC4");
  for (size_t i = 0; i < rgba.size(); i += 4) {
    const auto same = std::ranges::find(mesh.alphas, rgba[i + 3]);
    ASSERT_NE(same, mesh.alphas.end());
    const Rgb color = mesh.colors[size_t(same - mesh.alphas.begin())];
    EXPECT_EQ((Rgb{rgba[i], rgba[i + 1], rgba[i + 2]}), color);
  }
  LitPictures pictures;
  pictures.pages.push_back({8, 8, 4, std::vector<uint8_t>(256, 128)});
  pictures.attach = Attach::combined;
  EXPECT_THAT(colors_of(parse(*lit_glb(scene, made_up_atlas(scene), pictures)), "leaf"), IsEmpty());
  pictures.attach = Attach::emissive;
  const auto emissive = colors_of(parse(*lit_glb(scene, made_up_atlas(scene), pictures)), "leaf");
  ASSERT_THAT(emissive, ElementsAre(Pair("VEC4", ::testing::_)));
  EXPECT_EQ(emissive.at("VEC4")[0], 1) << "white: the colour is in the picture";
  EXPECT_NE(std::ranges::find(mesh.alphas, emissive.at("VEC4")[3]), mesh.alphas.end());
}

/// A square in the plane of x and y, seen from z, and its mirror image beside it, with a normal
/// map.
scene::Scene bumpy_squares() {
  scene::Scene scene;
  add_materials(scene);
  scene.materials[0].base_color_texture = {};
  scene.materials[0].normal_texture.texture = 0;
  scene::Mesh mesh;
  for (const float x : {0.0f, 1.0f, 2.0f})
    for (const float y : {0.0f, 1.0f}) {
      mesh.positions.push_back({x, y, 0});
      mesh.normals.push_back({0, 0, 1});
      mesh.uv0.push_back({x < 2 ? x : 0, 1 - y});  // glTF has v = 0 at the top
    }
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {2, 4, 5}, {2, 5, 3}};
  mesh.triangle_material.assign(4, 0);
  scene.meshes.push_back(mesh);
  scene.instances.push_back({"squares", 0, {}});
  return scene;
}

// u grows along x on the first square and against it on the second; up is the picture's up on both,
// so w differs. glTF 2.0: bitangent = cross(normal, tangent) * w.
TEST(BakedGlb, NormalMapsHaveTangents) {
  const scene::Scene scene = bumpy_squares();
  const Document d = parse(*baked_glb(scene, made_up_atlas(scene), ramp_lightmap()));
  const json& primitives = d.j["meshes"][0]["primitives"];
  ASSERT_EQ(primitives.size(), 2u) << "mirrored triangles share no vertices with others";
  for (size_t k = 0; k < 2; ++k) {
    const json& accessor = d.j["accessors"][primitives[k]["attributes"]["TANGENT"].get<size_t>()];
    EXPECT_EQ(accessor["type"], "VEC4");
    const std::vector<float> found = floats(d, accessor);
    const float side = k == 0 ? 1.0f : -1.0f;
    for (size_t i = 0; i < found.size(); i += 4)
      EXPECT_THAT(std::vector(&found[i], &found[i] + 4), ElementsAre(side, 0, 0, side));
  }
  EXPECT_EQ(read_triangles(d).size(), 4u);
}

// Where coordinates have no area there is some tangent.
TEST(BakedGlb, TangentsAreUnitVectorsWhateverTheCoordinates) {
  scene::Scene scene = bumpy_squares();
  for (Vec2& uv : scene.meshes[0].uv0) uv = {0.5f, 0.5f};
  const Document d = parse(*baked_glb(scene, made_up_atlas(scene), ramp_lightmap()));
  const json& attributes = d.j["meshes"][0]["primitives"][0]["attributes"];
  const std::vector<float> found = floats(d, d.j["accessors"][attributes["TANGENT"].get<size_t>()]);
  for (size_t i = 0; i < found.size(); i += 4) {
    EXPECT_NEAR(length(Vec3{found[i], found[i + 1], found[i + 2]}), 1, 1e-5);
    EXPECT_EQ(found[i + 2], 0);
  }
}

// glTF gives meshes without normals no tangents: a bump map gets the planes' own normals.
TEST(BakedGlb, NormalMapsOfFlatMeshesHaveTangents) {
  scene::Scene scene = bumpy_squares();
  scene.meshes[0].normals.clear();
  const Document d = parse(*baked_glb(scene, made_up_atlas(scene), ramp_lightmap()));
  for (const json& primitive : d.j["meshes"][0]["primitives"])
    EXPECT_TRUE(primitive["attributes"].contains("TANGENT"));
  const std::vector<ReadTriangle> read = read_triangles(d);
  ASSERT_EQ(read.size(), 4u);
  for (uint32_t t = 0; t < 4; ++t)
    for (size_t c = 0; c < 3; ++c) {
      const uint32_t v = scene.meshes[0].triangles[t][c];
      EXPECT_EQ(read[t].corner[c].position, scene.meshes[0].positions[v]);
      EXPECT_EQ(read[t].corner[c].uv0, scene.meshes[0].uv0[v]);
      EXPECT_EQ(read[t].corner[c].normal, (Vec3{0, 0, 1}));
    }
  scene.materials[0].normal_texture = {};
  const Document plain = parse(*baked_glb(scene, made_up_atlas(scene), ramp_lightmap()));
  EXPECT_FALSE(plain.j["meshes"][0]["primitives"][0]["attributes"].contains("NORMAL"));
}

// The words of extras go out as they came in; what is not lightmapped has a place in the lightmap,
// which its materials name and do not show.
TEST(BakedGlb, InstancesThatAreLeftOutShowNoLightmap) {
  scene::Scene scene = rich_scene();
  scene.instances[0].lightmapped = false;
  scene.instances[1].texel_density = 2;
  LitPictures pictures;
  pictures.pages.push_back({8, 8, 3, std::vector<uint8_t>(192, 128)});
  const auto plain = baked_glb(scene, made_up_atlas(scene), ramp_lightmap());
  const auto combined = lit_glb(scene, made_up_atlas(scene), pictures);
  ASSERT_TRUE(plain && combined);
  for (const bool lit : {false, true}) {
    const Document d = parse(lit ? *combined : *plain);
    EXPECT_EQ(d.j["nodes"][0]["extras"]["luxel"], (json{{"bake", false}}));
    EXPECT_EQ(d.j["nodes"][1]["extras"]["luxel"], (json{{"density", 2.0}}));
    EXPECT_FALSE(d.j["nodes"][2].contains("extras"));
    for (const ReadTriangle& t : read_triangles(d)) {
      if (t.material["name"] != "painted") continue;
      const bool left_out = t.node == "here";
      EXPECT_EQ(t.material["extras"]["luxel"]["lightmap"], "lightmap.exr");
      EXPECT_NE(t.material.contains("extensions"), left_out) << t.node;
      EXPECT_EQ(t.corner[0].color == Vec3{}, lit && !left_out) << "colours are in the picture";
    }
  }
}

// Glass that only KHR_materials_transmission knew: of a black base colour nothing would come
// through.
TEST(LitGlb, GlassIsBlended) {
  scene::Scene scene = rich_scene();
  scene.materials[0].transmission = 0.75f;
  for (const Attach attach : {Attach::combined, Attach::emissive}) {
    const scene::Material glass = materials_without_light(scene, attach)[0];
    EXPECT_EQ(glass.alpha_mode, scene::AlphaMode::blend);
    EXPECT_EQ(glass.transmission, 0);
    EXPECT_EQ(glass.alpha, attach == Attach::emissive ? 0.25f : 1);
  }
}

/// tools/validate_gltf.mjs puts these before the Khronos validator.
TEST(SceneGlb, LeavesSamplesForTheValidator) {
  const std::filesystem::path folder = std::filesystem::path(LUXEL_BINARY_DIR) / "glb_samples";
  std::filesystem::create_directories(folder);
  EXPECT_TRUE(write_file_atomically(folder / "baked.glb", Baked().bytes));
  EXPECT_TRUE(write_file_atomically(folder / "scene.glb", *scene_glb(rich_scene())));
  const scene::Scene bumpy = bumpy_squares();
  EXPECT_TRUE(write_file_atomically(folder / "bumpy.glb",
                                    *baked_glb(bumpy, made_up_atlas(bumpy), ramp_lightmap())));
  for (const Attach attach : {Attach::combined, Attach::emissive}) {
    std::vector<std::byte> bytes;
    lit_document(attach, &bytes);
    const char* name = attach == Attach::combined ? "combined.glb" : "emissive.glb";
    EXPECT_TRUE(write_file_atomically(folder / name, bytes));
  }
}

}  // namespace
}  // namespace luxel::export_
