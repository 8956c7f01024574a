// Materials of glTF files.
#include <gmock/gmock.h>

#include "import/test_files.h"

namespace luxel::import {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// The square with texture coordinates in both sets and this material.
Gltf square_with_material(nlohmann::json material) {
  Gltf gltf = square_gltf();
  const int uv0 = gltf.floats({0, 1, 1, 1, 1, 0, 0, 0}, "VEC2", 2);
  const int uv1 = gltf.floats({0, 0, 1, 0, 1, 1, 0, 1}, "VEC2", 2);
  auto& primitive = gltf.json["meshes"][0]["primitives"][0];
  primitive["attributes"]["TEXCOORD_0"] = uv0;
  primitive["attributes"]["TEXCOORD_1"] = uv1;
  primitive["material"] = 0;
  gltf.json["materials"] = {std::move(material)};
  return gltf;
}

/// Adds a picture as an embedded image, and a texture that shows it.
void add_texture(Gltf& gltf, const std::string& picture) {
  const int view = gltf.view(picture);
  gltf.json["images"].push_back({{"bufferView", view}, {"mimeType", "image/png"}, {"name", "pic"}});
  gltf.json["textures"].push_back({{"source", gltf.json["images"].size() - 1}});
}

TEST(GltfMaterial, FactorsModesAndStrength) {
  const scene::Scene scene = scene_of(import_glb(square_with_material(
      {{"name", "m"},
       {"pbrMetallicRoughness",
        {{"baseColorFactor", {0.1, 0.2, 0.3, 0.4}},
         {"metallicFactor", 0.25},
         {"roughnessFactor", 0.5}}},
       {"emissiveFactor", {1, 0.5, 0.25}},
       {"alphaMode", "MASK"},
       {"alphaCutoff", 0.7},
       {"doubleSided", true},
       {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 8}}}}}})));
  ASSERT_EQ(scene.materials.size(), 1u);
  const scene::Material& m = scene.materials[0];
  EXPECT_EQ(m.name, "m");
  expect_near(m.base_color, {0.1f, 0.2f, 0.3f}, 1e-6f);
  EXPECT_FLOAT_EQ(m.alpha, 0.4f);
  EXPECT_FLOAT_EQ(m.metallic, 0.25f);
  EXPECT_FLOAT_EQ(m.roughness, 0.5f);
  expect_near(m.emission, {8, 4, 2}, 1e-5f);
  EXPECT_EQ(m.alpha_mode, scene::AlphaMode::mask);
  EXPECT_FLOAT_EQ(m.alpha_cutoff, 0.7f);
  EXPECT_TRUE(m.double_sided);
  expect_near(scene::emission_at(scene, {0, 0, {0.2f, 0.2f}}), {8, 4, 2}, 1e-5f);
}

/// roughness 0.5: alpha = 1/4, Blinn's exponent 2 * 16 - 2 = 30, Phong's a quarter of it.
constexpr float kHalfRough = 7.5f;

TEST(GltfMaterial, RoughnessAndMetallicBecomeAHighlight) {
  const auto material = [](nlohmann::json json) {
    return scene_of(import_glb(square_with_material(std::move(json)))).materials[0];
  };
  const nlohmann::json plastic = {{"metallicFactor", 0}, {"roughnessFactor", 0.5}};
  const scene::Material dielectric = material({{"pbrMetallicRoughness", plastic}});
  EXPECT_FLOAT_EQ(dielectric.sharpness, kHalfRough);
  expect_near(dielectric.specular, Rgb{1, 1, 1} * (0.04f * (kHalfRough + 1) / 2), 1e-6f);
  const scene::Material metal =
      material({{"pbrMetallicRoughness",
                 {{"baseColorFactor", {0.2, 0.1, 0.05, 1}}, {"roughnessFactor", 0.5}}}});
  expect_near(metal.specular, Rgb{0.2f, 0.1f, 0.05f} * ((kHalfRough + 1) / 2), 1e-6f);
  const scene::Material tinted =
      material({{"pbrMetallicRoughness", plastic},
                {"extensions",
                 {{"KHR_materials_specular",
                   {{"specularFactor", 0.5}, {"specularColorFactor", {1, 2, 0}}}}}}});
  expect_near(tinted.specular, Rgb{1, 2, 0} * (0.02f * (kHalfRough + 1) / 2), 1e-6f);
}

TEST(GltfMaterial, HighlightsOfTexturedMetalsTakeTheTexturesMean) {
  Gltf gltf = square_with_material(
      {{"pbrMetallicRoughness", {{"metallicRoughnessTexture", {{"index", 0}}}}}});
  add_texture(gltf, png_of(2, 2, {0, 128, 0, 255}));  // roughness 128 / 255, no metal
  const scene::Material m = scene_of(import_glb(gltf)).materials[0];
  EXPECT_NEAR(m.sharpness, kHalfRough, 0.2f);
  EXPECT_NEAR(m.specular.x, 0.04f * (kHalfRough + 1) / 2, 0.01f) << "a metal would have 1";
}

TEST(GltfMaterial, DefaultReflectsAndMetalIsReported) {
  EXPECT_EQ(scene_of(import_glb(square_gltf())).materials[0].base_color, (Rgb{0.8f, 0.8f, 0.8f}));
  const auto metal = import_glb(square_with_material({{"name", "steel"}}));
  ASSERT_TRUE(metal);
  EXPECT_THAT(all_of(metal->warnings), HasSubstr("fully metallic"));
  const auto unlit = import_glb(
      square_with_material({{"extensions", {{"KHR_materials_unlit", nlohmann::json::object()}}}}));
  ASSERT_TRUE(unlit);
  EXPECT_TRUE(unlit->scene.materials[0].unlit);
  EXPECT_THAT(all_of(unlit->warnings), Not(HasSubstr("fully metallic")));
}

TEST(GltfMaterial, TexturesComeWithSamplerTransformAndEncodedBytes) {
  const std::string png = png_of(2, 2, {255, 0, 0, 128});
  Gltf gltf = square_with_material({{"pbrMetallicRoughness",
                                     {{"metallicFactor", 0},
                                      {"baseColorTexture",
                                       {{"index", 0},
                                        {"texCoord", 0},
                                        {"extensions",
                                         {{"KHR_texture_transform",
                                           {{"offset", {0.25, 0.5}},
                                            {"scale", {2, 3}},
                                            {"rotation", 0.5},
                                            {"texCoord", 1}}}}}}}}},
                                    {"emissiveFactor", {2, 2, 2}},
                                    {"emissiveTexture", {{"index", 0}}}});
  add_texture(gltf, png);
  gltf.json["textures"][0]["sampler"] = 0;
  gltf.json["samplers"] = {{{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}}};
  const scene::Scene scene = scene_of(import_glb(gltf));
  ASSERT_EQ(scene.textures.size(), 1u) << "one picture, used twice";
  EXPECT_EQ(scene.textures[0].width, 2);
  EXPECT_EQ(scene.textures[0].mime_type, "image/png");
  ASSERT_EQ(scene.textures[0].encoded.size(), png.size());
  EXPECT_EQ(std::memcmp(scene.textures[0].encoded.data(), png.data(), png.size()), 0);
  EXPECT_EQ(scene.textures[0].rgba[3], 128);
  const scene::TextureRef& ref = scene.materials[0].base_color_texture;
  EXPECT_EQ(ref.uv_set, 1);
  EXPECT_EQ(ref.wrap_u, scene::Wrap::clamp);
  EXPECT_EQ(ref.wrap_v, scene::Wrap::mirror);
  EXPECT_EQ(ref.filter, scene::Filter::nearest);
  EXPECT_EQ(ref.offset, (Vec2{0.25f, 0.5f}));
  EXPECT_EQ(ref.scale, (Vec2{2, 3}));
  EXPECT_FLOAT_EQ(ref.rotation, 0.5f);
  EXPECT_EQ(scene.materials[0].emission_texture.uv_set, 0);
  const scene::SurfacePoint p{0, 0, {0.3f, 0.3f}};
  expect_near(scene::reflectance_at(scene, p), {0.99f, 0, 0}, 1e-6f);
  expect_near(scene::emission_at(scene, p), {2, 0, 0}, 1e-6f);
}

TEST(GltfMaterial, PicturesThatNobodyUsesAreNotDecoded) {
  Gltf gltf = square_with_material({{"normalTexture", {{"index", 0}}}});
  add_texture(gltf, "this is no picture");
  EXPECT_TRUE(import_glb(gltf));
}

TEST(GltfMaterial, ExternalTextureIsFoundBesideTheFile) {
  const TemporaryFolder folder;
  folder.write("red one.png", png_of(4, 1, {200, 0, 0, 255}));
  Gltf gltf =
      square_with_material({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
  gltf.json["images"] = {{{"uri", "red%20one.png"}}};
  gltf.json["textures"] = {{{"source", 0}}};
  const scene::Scene scene = scene_of(import_scene(folder.write("a.glb", gltf.glb())));
  ASSERT_EQ(scene.textures.size(), 1u);
  EXPECT_EQ(scene.textures[0].width, 4);
}

TEST(GltfMaterial, MissingAndCorruptTexturesNameFileAndMaterial) {
  Gltf gltf = square_with_material(
      {{"name", "brick"}, {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
  gltf.json["images"] = {{{"uri", "nowhere.png"}}};
  gltf.json["textures"] = {{{"source", 0}}};
  auto imported = import_glb(gltf);
  ASSERT_FALSE(imported);
  EXPECT_THAT(imported.error().message, HasSubstr("nowhere.png"));
  EXPECT_THAT(imported.error().message, HasSubstr("brick"));

  const std::string good = png_of(8, 8, {1, 2, 3, 255});
  std::string flipped = good;
  flipped[good.size() / 2] ^= 1;
  for (const std::string& bad : {good.substr(0, good.size() / 2), std::string("GIF89a"), flipped}) {
    const TemporaryFolder folder;
    folder.write("nowhere.png", bad);
    imported = import_scene(folder.write("a.glb", gltf.glb()));
    ASSERT_FALSE(imported);
    EXPECT_THAT(imported.error().message, HasSubstr("nowhere.png"));
    EXPECT_THAT(imported.error().message, HasSubstr("brick"));
  }
}

}  // namespace
}  // namespace luxel::import
