#include "export/baked_glb.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "base/file.h"
#include "base/random.h"
#include "image/codec.h"
#include "image/color.h"
#include "tests/support.h"

namespace luxel::export_ {
namespace {

using nlohmann::json;
using testing::ElementsAre;

// A reader of our own, by the text of the glTF 2.0 specification.

struct Document {
  json j;
  std::vector<std::byte> binary;
};

uint32_t u32_at(std::span<const std::byte> bytes, size_t at) {
  uint32_t v;
  std::memcpy(&v, bytes.data() + at, 4);
  return v;
}

Document parse(std::span<const std::byte> glb) {
  EXPECT_EQ(u32_at(glb, 0), 0x46546C67u);
  EXPECT_EQ(u32_at(glb, 4), 2u);
  EXPECT_EQ(u32_at(glb, 8), glb.size());
  const size_t json_size = u32_at(glb, 12);
  EXPECT_EQ(u32_at(glb, 16), 0x4E4F534Au);
  EXPECT_EQ(json_size % 4, 0u);
  const char* text = reinterpret_cast<const char*>(glb.data()) + 20;
  Document document{json::parse(text, text + json_size), {}};
  const size_t rest = 20 + json_size;
  if (rest < glb.size()) {
    EXPECT_EQ(u32_at(glb, rest + 4), 0x004E4942u);
    EXPECT_EQ(u32_at(glb, rest), glb.size() - rest - 8);
    document.binary.assign(glb.begin() + std::ptrdiff_t(rest) + 8, glb.end());
  }
  return document;
}

std::vector<float> floats(const Document& d, const json& accessor) {
  const json& view = d.j["bufferViews"][accessor["bufferView"].get<size_t>()];
  const std::string type = accessor["type"];
  const size_t components = type == "SCALAR" ? 1 : type == "VEC2" ? 2 : 3;
  std::vector<float> out(accessor["count"].get<size_t>() * components);
  EXPECT_EQ(accessor["componentType"], 5126);
  EXPECT_EQ(view["byteLength"], out.size() * 4);
  std::memcpy(out.data(), d.binary.data() + view["byteOffset"].get<size_t>(), out.size() * 4);
  return out;
}

template <class T>
std::vector<T> vectors(const Document& d, const json& attributes, const char* name) {
  const std::vector<float> raw = floats(d, d.j["accessors"][attributes[name].get<size_t>()]);
  std::vector<T> out(raw.size() * sizeof(float) / sizeof(T));
  std::memcpy(static_cast<void*>(out.data()), raw.data(), raw.size() * sizeof(float));
  return out;
}

std::vector<uint32_t> indices(const Document& d, const json& primitive) {
  const json& accessor = d.j["accessors"][primitive["indices"].get<size_t>()];
  const json& view = d.j["bufferViews"][accessor["bufferView"].get<size_t>()];
  const std::byte* at = d.binary.data() + view["byteOffset"].get<size_t>();
  std::vector<uint32_t> out(accessor["count"].get<size_t>());
  for (size_t i = 0; i < out.size(); ++i)
    if (accessor["componentType"] == 5123) {
      uint16_t v;
      std::memcpy(&v, at + 2 * i, 2);
      out[i] = v;
    } else {
      std::memcpy(&out[i], at + 4 * i, 4);
    }
  return out;
}

Mat34 rotation(const json& q) {
  const double x = q[0], y = q[1], z = q[2], w = q[3];
  Mat34 m;
  m.row[0] = {float(1 - 2 * (y * y + z * z)), float(2 * (x * y - z * w)),
              float(2 * (x * z + y * w)), 0};
  m.row[1] = {float(2 * (x * y + z * w)), float(1 - 2 * (x * x + z * z)),
              float(2 * (y * z - x * w)), 0};
  m.row[2] = {float(2 * (x * z - y * w)), float(2 * (y * z + x * w)),
              float(1 - 2 * (x * x + y * y)), 0};
  return m;
}

Mat34 local_matrix(const json& node) {
  Mat34 m;
  if (node.contains("matrix")) {
    for (size_t i = 0; i < 3; ++i)
      for (size_t j = 0; j < 4; ++j) m.row[i][j] = node["matrix"][4 * j + i];
    return m;
  }
  if (node.contains("scale")) m = scaling({node["scale"][0], node["scale"][1], node["scale"][2]});
  if (node.contains("rotation")) m = rotation(node["rotation"]) * m;
  if (node.contains("translation"))
    m = translation({node["translation"][0], node["translation"][1], node["translation"][2]}) * m;
  return m;
}

struct Corner {
  Vec3 position, normal, color;
  Vec2 uv0, uv1;
};
struct ReadTriangle {
  std::array<Corner, 3> corner;
  json material;
  std::string node;
};

void read_primitive(const Document& d, const json& primitive, const Mat34& world,
                    const std::string& name, std::vector<ReadTriangle>& out) {
  const json& attributes = primitive["attributes"];
  const auto positions = vectors<Vec3>(d, attributes, "POSITION");
  std::vector<Vec3> normals, colors;
  std::vector<Vec2> uv0, uv1;
  if (attributes.contains("NORMAL")) normals = vectors<Vec3>(d, attributes, "NORMAL");
  if (attributes.contains("COLOR_0")) colors = vectors<Vec3>(d, attributes, "COLOR_0");
  if (attributes.contains("TEXCOORD_0")) uv0 = vectors<Vec2>(d, attributes, "TEXCOORD_0");
  if (attributes.contains("TEXCOORD_1")) uv1 = vectors<Vec2>(d, attributes, "TEXCOORD_1");
  const auto index = indices(d, primitive);
  for (size_t i = 0; i < index.size(); i += 3) {
    ReadTriangle triangle;
    triangle.material = d.j["materials"][primitive["material"].get<size_t>()];
    triangle.node = name;
    for (size_t c = 0; c < 3; ++c) {
      const uint32_t v = index[i + c];
      triangle.corner[c].position = transform_point(world, positions[v]);
      if (!normals.empty()) triangle.corner[c].normal = normals[v];
      if (!colors.empty()) triangle.corner[c].color = colors[v];
      if (!uv0.empty()) triangle.corner[c].uv0 = uv0[v];
      if (!uv1.empty()) triangle.corner[c].uv1 = uv1[v];
    }
    out.push_back(triangle);
  }
}

void read_node(const Document& d, size_t index, const Mat34& parent,
               std::vector<ReadTriangle>& out) {
  const json& node = d.j["nodes"][index];
  const Mat34 world = parent * local_matrix(node);
  if (node.contains("mesh"))
    for (const json& primitive : d.j["meshes"][node["mesh"].get<size_t>()]["primitives"])
      read_primitive(d, primitive, world, node.value("name", ""), out);
  if (node.contains("children"))
    for (const json& child : node["children"]) read_node(d, child.get<size_t>(), world, out);
}

std::vector<ReadTriangle> read_triangles(const Document& d) {
  std::vector<ReadTriangle> out;
  for (const json& root : d.j["scenes"][0]["nodes"]) read_node(d, root.get<size_t>(), {}, out);
  return out;
}

// A scene with one of everything.

scene::Mesh grid_mesh() {
  scene::Mesh mesh;
  mesh.name = "grid";
  RandomStream random{21};
  for (int y = 0; y <= 6; ++y)
    for (int x = 0; x <= 6; ++x) {
      mesh.positions.push_back({float(x), random.next(), float(y)});
      mesh.normals.push_back(normalize({random.next() - 0.5f, 1, random.next() - 0.5f}));
      mesh.uv0.push_back({random.next(), random.next()});
      mesh.colors.push_back({random.next(), random.next(), random.next()});
    }
  for (uint32_t y = 0; y < 6; ++y)
    for (uint32_t x = 0; x < 6; ++x) {
      const uint32_t a = 7 * y + x;
      mesh.triangles.push_back({a, a + 7, a + 1});
      mesh.triangles.push_back({a + 1, a + 7, a + 8});
      mesh.triangle_material.push_back((x + y) % 3);  // materials change all the time
      mesh.triangle_material.push_back((x + y) % 3);
    }
  return mesh;
}

void add_materials(scene::Scene& scene) {
  scene::Texture texture;
  texture.name = "checker";
  texture.width = 2, texture.height = 2;
  texture.rgba = {255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 9, 9, 9, 0};
  scene.textures.push_back(texture);
  scene.textures.push_back(texture);
  scene.textures[1].encoded = image::encode_png({2, 2, 4, texture.rgba});
  scene.materials.resize(4);
  scene.materials[0].name = "painted";
  scene.materials[0].base_color = {0.1f, 0.2f, 0.3f};
  scene.materials[0].base_color_texture.texture = 0;
  scene.materials[0].base_color_texture.offset = {0.5f, 0};
  scene.materials[0].base_color_texture.rotation = 1;
  scene.materials[0].base_color_texture.wrap_u = scene::Wrap::mirror;
  scene.materials[1].name = "lamp";
  scene.materials[1].emission = {17.3f, 0.1f, 100};
  scene.materials[1].double_sided = true;
  scene.materials[2].name = "leaf";
  scene.materials[2].alpha_mode = scene::AlphaMode::mask;
  scene.materials[2].alpha_cutoff = 0.25f;
  scene.materials[2].metallic_texture.texture = 1;
  scene.materials[2].metallic_texture.filter = scene::Filter::nearest;
  scene.materials[3].name = "sign";
  scene.materials[3].unlit = true;
  scene.materials[3].alpha_mode = scene::AlphaMode::blend;
  scene.materials[3].base_color_texture.texture = 1;  // but its mesh has no coordinates
}

scene::Scene rich_scene() {
  scene::Scene scene;
  scene.name = "rich";
  add_materials(scene);
  scene.meshes.push_back(grid_mesh());
  scene::Mesh plain;
  plain.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {9, 9, 9}};
  plain.triangles = {{0, 1, 2}};
  plain.triangle_material = {3};
  scene.meshes.push_back(plain);
  Mat34 shear = translation({1, 2, 3});
  shear.row[0][1] = 0.7f;
  Mat34 turned = rotation({0.5, 0.5, 0.5, 0.5}) * scaling({100, 200, 300});
  scene.instances = {{"here", 0, {}},
                     {"mirrored", 0, scaling({-2, 1, 1})},
                     {"sheared", 0, shear},
                     {"sheared mirror", 0, shear * scaling({1, 1, -3})},
                     {"flat", 1, scaling({1, 0, 1})},
                     {"large", 0, turned},
                     {"plain", 1, translation({5, 0, 0})}};
  using Kind = scene::PunctualLight::Kind;
  scene.lights.resize(3);
  scene.lights[0].name = "bulb", scene.lights[0].position = {1, 2, 3};
  scene.lights[0].range_m = 7;
  scene.lights[1].kind = Kind::spot, scene.lights[1].intensity = {4, 8, 2};
  scene.lights[1].direction = normalize({1, -2, 0.5f});
  scene.lights[1].position = {-1, 4, 0};
  scene.lights[2].kind = Kind::directional, scene.lights[2].angular_radius_rad = 0.00465f;
  scene.cameras.resize(2);
  scene.cameras[0].name = "front", scene.cameras[0].aspect = 1.5f;
  scene.cameras[0].world_from_camera = translation({0, 1, 9});
  scene.cameras[1].orthographic_height_m = 4;
  scene.background = {0.5f, 0.25f, 1};
  return scene;
}

/// Every second column of the grid is a chart of its own; other triangles lie alone.
atlas::Atlas made_up_atlas(const scene::Scene& scene) {
  atlas::Atlas atlas;
  atlas.resolution = 1024;
  atlas.first_triangle = first_triangles(scene);
  for (uint32_t i = 0; i < scene.instances.size(); ++i) {
    const scene::Mesh& mesh = scene.meshes[scene.instances[i].mesh];
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      const float chart = float(t / 2 % 6 / 2);  // columns 01, 23, 45
      std::array<Vec2, 3> corners;
      for (size_t c = 0; c < 3; ++c) {
        const Vec3 p = mesh.positions[mesh.triangles[t][c]];
        corners[c] = {100 * float(i) + p.x * 8 + 10 * chart, p.z * 8 + p.y};
      }
      atlas.corners.push_back(corners);
      atlas.chart.push_back(uint32_t(chart));
    }
  }
  return atlas;
}

image::Image ramp_lightmap() {
  image::Image lightmap(64, 64, 4);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 60; ++x) {
      const float e = 0.01f * float(64 * y + x);
      lightmap.set_rgb(x, y, {e, 2 * e, 0.5f * e});
      lightmap.at(x, y)[3] = 1;
    }
  return lightmap;
}

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

void expect_close(Vec3 a, Vec3 b, float tolerance) {
  EXPECT_LE(length(a - b), tolerance)
      << a.x << " " << a.y << " " << a.z << " for " << b.x << " " << b.y << " " << b.z;
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

TEST(SceneGlb, LightsShineAlongTheirDirection) {
  const scene::Scene scene = rich_scene();
  const Document d = parse(*scene_glb(scene));
  const json& lights = d.j["extensions"]["KHR_lights_punctual"]["lights"];
  ASSERT_EQ(lights.size(), 3u);
  for (const json& node : d.j["nodes"]) {
    if (!node.contains("extensions")) continue;
    const size_t index = node["extensions"]["KHR_lights_punctual"]["light"];
    const scene::PunctualLight& light = scene.lights[index];
    const json& read = lights[index];
    const Mat34 m = local_matrix(node);
    if (index > 0) expect_close(transform_vector(m, {0, 0, -1}), light.direction, 1e-6f);
    expect_close(transform_point(m, {}), light.position, 1e-6f);
    for (size_t c = 0; c < 3; ++c)
      EXPECT_FLOAT_EQ(read["color"][c].get<float>() * read["intensity"].get<float>(),
                      light.intensity[int(c)]);
  }
  EXPECT_EQ(lights[0]["range"], 7.0f);
  EXPECT_EQ(lights[1]["type"], "spot");
  EXPECT_FLOAT_EQ(lights[1]["spot"]["outerConeAngle"].get<float>(), kPi / 4);
  EXPECT_EQ(lights[2]["type"], "directional");
}

TEST(SceneGlb, CamerasAreKept) {
  const Document d = parse(*scene_glb(rich_scene()));
  ASSERT_EQ(d.j["cameras"].size(), 2u);
  EXPECT_EQ(d.j["cameras"][0]["perspective"]["yfov"], 0.8f);
  EXPECT_EQ(d.j["cameras"][0]["perspective"]["aspectRatio"], 1.5f);
  EXPECT_EQ(d.j["cameras"][1]["orthographic"]["ymag"], 2.0f);
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

/// tools/validate_gltf.mjs puts these before the Khronos validator.
TEST(SceneGlb, LeavesSamplesForTheValidator) {
  const std::filesystem::path folder = std::filesystem::path(LUXEL_BINARY_DIR) / "glb_samples";
  std::filesystem::create_directories(folder);
  EXPECT_TRUE(write_file_atomically(folder / "baked.glb", Baked().bytes));
  EXPECT_TRUE(write_file_atomically(folder / "scene.glb", *scene_glb(rich_scene())));
}

}  // namespace
}  // namespace luxel::export_
