// Materials of glTF files.
#include <gmock/gmock.h>
#include <webp/encode.h>

#include "luxel/base/base64.h"
#include "luxel/import/import_test_support.h"
#include "luxel/scene/specular.h"

namespace luxel::import {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
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
  gltf.json["materials"] = nlohmann::json::array({std::move(material)});
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

// A base colour of 0.8: the share 0.5 * (102 / 255) goes through, in the colour (0.5, 1, 0.25)
// times the texture's (1, 0, 1): 0.2 (0.5, 0, 0.25), and 0.8 * 0.8 is reflected.
TEST(GltfMaterial, DiffuseTransmission) {
  Gltf gltf = square_with_material(
      {{"pbrMetallicRoughness", {{"baseColorFactor", {0.8, 0.8, 0.8, 1}}, {"metallicFactor", 0}}},
       {"extensions",
        {{"KHR_materials_diffuse_transmission",
          {{"diffuseTransmissionFactor", 0.5},
           {"diffuseTransmissionTexture", {{"index", 0}}},
           {"diffuseTransmissionColorFactor", {0.5, 1, 0.25}},
           {"diffuseTransmissionColorTexture", {{"index", 0}}}}}}}});
  add_texture(gltf, png_of(1, 1, {255, 0, 255, 102}));
  const scene::Scene scene = scene_of(import_glb(gltf));
  const scene::SurfacePoint p{0, 0, {0.3f, 0.3f}};
  expect_near(scene::diffuse_transmittance_at(scene, p), {0.1f, 0, 0.05f}, 1e-6f);
  expect_near(scene::reflectance_at(scene, p), Rgb{1, 1, 1} * 0.64f, 1e-6f);
  EXPECT_TRUE(scene::reflects_from_behind(scene.materials[0]));
  // Metal lets nothing through, and both together never send back more than 0.99.
  gltf.json["materials"][0]["pbrMetallicRoughness"]["metallicFactor"] = 0.5;
  expect_near(scene::diffuse_transmittance_at(scene_of(import_glb(gltf)), p), {0.05f, 0, 0.025f},
              1e-6f);
  gltf.json["materials"][0]["pbrMetallicRoughness"] = {{"metallicFactor", 0}};
  auto& extension = gltf.json["materials"][0]["extensions"]["KHR_materials_diffuse_transmission"];
  extension["diffuseTransmissionColorFactor"] = {1, 1, 1};
  const scene::Scene white = scene_of(import_glb(gltf));
  expect_near(scene::reflectance_at(white, p) + scene::diffuse_transmittance_at(white, p),
              {0.99f, 0.8f * 0.99f, 0.99f}, 1e-6f);  // white is 0.99, of which 0.2 is scattered
}

TEST(GltfMaterial, PicturesThatNobodyUsesAreNotDecoded) {
  Gltf gltf = square_with_material({{"occlusionTexture", {{"index", 0}}}});
  add_texture(gltf, "this is no picture");
  EXPECT_TRUE(import_glb(gltf));
}

TEST(GltfMaterial, NormalMapsAreKept) {
  Gltf gltf = square_with_material(
      {{"name", "brick"}, {"normalTexture", {{"index", 0}, {"texCoord", 0}, {"scale", 0.25}}}});
  add_texture(gltf, png_of(4, 1, {128, 128, 255, 255}));
  const scene::Scene scene = scene_of(import_glb(gltf));
  EXPECT_EQ(scene.materials[0].normal_texture.texture, 0u);
  EXPECT_EQ(scene.materials[0].normal_scale, 0.25f);
  ASSERT_EQ(scene.textures.size(), 1u);
  EXPECT_EQ(scene.textures[0].rgba[2], 255);
}

TEST(GltfMaterial, ABrokenNormalMapIsLeftOutAndSaid) {
  Gltf gltf = square_with_material({{"name", "brick"}, {"normalTexture", {{"index", 0}}}});
  add_texture(gltf, "this is no picture");
  const auto imported = import_glb(gltf);
  ASSERT_TRUE(imported);
  EXPECT_EQ(imported->scene.materials[0].normal_texture.texture, scene::kNone);
  EXPECT_THAT(imported->warnings,
              Contains(HasSubstr("(texture of material 0 (brick)); its normal map is left out")));
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

// A picture is colour only: a bake goes on without one that is lost, and says so once.
TEST(GltfMaterial, LostTexturesLeaveTheColourAndAreSaid) {
  Gltf gltf = square_with_material(
      {{"name", "brick"}, {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
  gltf.json["materials"].push_back(gltf.json["materials"][0]);
  gltf.json["images"] = {{{"uri", "nowhere.png"}}};
  gltf.json["textures"] = {{{"source", 0}}};
  auto& factors = gltf.json["materials"][0]["pbrMetallicRoughness"];
  factors["metallicFactor"] = gltf.json["materials"][1]["pbrMetallicRoughness"]["metallicFactor"] =
      0;
  for (const bool has_color : {false, true}) {
    if (has_color) factors["baseColorFactor"] = {0.5, 0.25, 0.125, 1};
    const TemporaryFolder folder;
    const std::filesystem::path file = folder.write("a.glb", gltf.glb());
    const auto imported = import_scene(file);
    const scene::Scene scene = scene_of(imported);
    expect_near(scene.materials[0].base_color,
                has_color ? Rgb{0.5f, 0.25f, 0.125f} : Rgb{0.8f, 0.8f, 0.8f}, 1e-6f);
    EXPECT_EQ(scene.materials[0].base_color_texture.texture, scene::kNone);
    ASSERT_EQ(imported->warnings.size(), 1u);
    EXPECT_THAT(imported->warnings[0],
                HasSubstr("the texture of material 0 (brick) is nowhere.png, which is missing; put "
                          "it beside the scene or name its folder with --search-path; the "
                          "material's colour is used"));
    folder.write("nowhere.png", "GIF89a");
    EXPECT_THAT(all_of(import_scene(file)->warnings),
                HasSubstr("nowhere.png: the picture is none of PNG, JPEG, WebP, BMP and TGA"));
  }
}

TEST(GltfMaterial, WhatALostTextureWouldHaveLimitedIsNotThere) {
  Gltf gltf = square_with_material(
      {{"name", "panel"},
       {"emissiveFactor", {1, 1, 1}},
       {"emissiveTexture", {{"index", 0}}},
       {"alphaMode", "MASK"},
       {"pbrMetallicRoughness",
        {{"baseColorTexture", {{"index", 0}}}, {"metallicRoughnessTexture", {{"index", 0}}}}},
       {"extensions",
        {{"KHR_materials_transmission",
          {{"transmissionFactor", 1}, {"transmissionTexture", {{"index", 0}}}}}}}});
  gltf.json["images"] = {{{"uri", "nowhere.png"}}};
  gltf.json["textures"] = {{{"source", 0}}};
  const auto imported = import_glb(gltf);
  const scene::Material& m = scene_of(imported).materials[0];
  EXPECT_EQ(max_component(m.emission), 0) << "a panel does not glow all over";
  EXPECT_EQ(m.metallic, 0);
  EXPECT_EQ(m.transmission, 0);
  EXPECT_EQ(m.alpha, 1);
  for (const char* end : {"; it does not glow", "; the material's colour is used, without holes",
                          "; it is no metal", "; it lets no light through"})
    EXPECT_THAT(imported->warnings, Contains(HasSubstr(end)));
}

TEST(GltfMaterial, DamagedTexturesAreErrorsThatNameFileAndMaterial) {
  Gltf gltf = square_with_material(
      {{"name", "brick"}, {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
  gltf.json["images"] = {{{"uri", "nowhere.png"}}};
  gltf.json["textures"] = {{{"source", 0}}};
  const std::string good = png_of(8, 8, {1, 2, 3, 255});
  std::string flipped = good;
  flipped[good.size() / 2] ^= 1;
  for (const std::string& bad : {good.substr(0, good.size() / 2), flipped}) {
    const TemporaryFolder folder;
    folder.write("nowhere.png", bad);
    const auto imported = import_scene(folder.write("a.glb", gltf.glb()));
    ASSERT_FALSE(imported);
    EXPECT_THAT(imported.error().message, HasSubstr("nowhere.png"));
    EXPECT_THAT(imported.error().message, HasSubstr("brick"));
  }
}

/// The square with one base colour texture, whose JSON this is, and a picture for each string.
Gltf square_with_texture(nlohmann::json texture, const std::vector<std::string>& pictures) {
  Gltf gltf = square_with_material(
      {{"name", "brick"},
       {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}, {"metallicFactor", 0}}}});
  for (const std::string& picture : pictures) add_texture(gltf, picture);
  gltf.json["textures"] = nlohmann::json::array({std::move(texture)});
  return gltf;
}

std::string webp_of(std::array<uint8_t, 4> rgba) {
  uint8_t* bytes = nullptr;
  const size_t size = WebPEncodeLosslessRGBA(rgba.data(), 1, 1, 4, &bytes);
  const std::string file(reinterpret_cast<const char*>(bytes), size);
  WebPFree(bytes);
  return file;
}

TEST(GltfMaterial, WebpTexturesAreReadWhereNoOtherPictureIs) {
  const std::string webp = webp_of({90, 80, 70, 255}), png = png_of(1, 1, {1, 2, 3, 255});
  const nlohmann::json extension = {{"EXT_texture_webp", {{"source", 0}}}};
  Gltf gltf = square_with_texture({{"extensions", extension}}, {webp, png});
  gltf.json["extensionsRequired"] = {"EXT_texture_webp"};
  const scene::Texture only = scene_of(import_glb(gltf)).textures[0];
  EXPECT_EQ(only.rgba, (std::vector<uint8_t>{90, 80, 70, 255}));
  EXPECT_EQ(only.mime_type, "image/webp");
  gltf.json["textures"][0]["source"] = 1;
  EXPECT_EQ(scene_of(import_glb(gltf)).textures[0].rgba[0], 1);
  gltf.json["textures"][0] = {{"extensions", {{"EXT_texture_webp", {{"source", 2}}}}}};
  const auto imported = import_glb(gltf);
  ASSERT_FALSE(imported);
  EXPECT_THAT(imported.error().message, HasSubstr("EXT_texture_webp: source 2 is out of range"));
}

std::string data_uri(const std::string& type, const std::string& bytes) {
  return "data:" + type + ";base64," + base64(std::as_bytes(std::span(bytes.data(), bytes.size())));
}

TEST(GltfMaterial, PicturesInDataUris) {
  const std::string webp = webp_of({90, 80, 70, 255}), png = png_of(1, 1, {1, 2, 3, 255});
  Gltf gltf = square_with_texture({{"source", 0}}, {png});
  const auto imported_with = [&](const std::string& uri) {
    gltf.json["images"] = {{{"uri", uri}}};
    return import_glb(gltf);
  };
  EXPECT_EQ(scene_of(imported_with(data_uri("image/png", png))).textures.at(0).rgba[2], 3);
  EXPECT_EQ(scene_of(imported_with(data_uri("", png))).textures.at(0).rgba[2], 3);
  const std::string only_webp = data_uri("image/webp", webp);
  EXPECT_EQ(scene_of(imported_with(only_webp)).textures.at(0).rgba[1], 80);
  for (const std::string& uri : {only_webp + "*", std::string("data:image/svg+xml,%3Csvg/%3E")})
    EXPECT_THAT(
        error_of(imported_with(uri)),
        HasSubstr("a.glb: the texture of material 0 (brick) is a data URI that is no base64"));
  gltf.json["images"][0] = {{"name", "pic"}};
  EXPECT_THAT(error_of(import_glb(gltf)), HasSubstr("has neither a uri nor a bufferView"));
}

TEST(GltfMaterial, Ktx2IsReplacedByItsFallbackOrSaid) {
  const std::string ktx2 = "\xabKTX 20\xbb";
  const nlohmann::json extension = {{"KHR_texture_basisu", {{"source", 0}}}};
  Gltf gltf = square_with_texture({{"extensions", extension}, {"source", 1}},
                                  {ktx2, png_of(1, 1, {1, 2, 3, 255})});
  gltf.json["extensionsUsed"] = {"KHR_texture_basisu"};
  const nlohmann::json in_view = gltf.json["images"][0];
  for (const nlohmann::json& image :
       {in_view, nlohmann::json{{"uri", data_uri("image/ktx2", ktx2)}},
        nlohmann::json{{"uri", "nowhere.ktx2"}, {"mimeType", "image/ktx2"}}}) {
    gltf.json["images"][0] = image;
    const auto fallback = import_glb(gltf);
    EXPECT_EQ(scene_of(fallback).textures.at(0).rgba[1], 2) << image;
    EXPECT_EQ(all_of(fallback->warnings), "") << image;
  }
  gltf.json["extensionsRequired"] = {"KHR_texture_basisu"};
  gltf.json["textures"][0].erase("source");
  const auto needed = import_glb(gltf);
  expect_near(scene_of(needed).materials[0].base_color, {0.8f, 0.8f, 0.8f}, 1e-6f);
  EXPECT_THAT(needed->warnings,
              Contains(HasSubstr("a.glb: texture 0 of material 0 (brick) exists only as KTX2 "
                                 "(KHR_texture_basisu), which luxel cannot decode; export it with "
                                 "PNG or JPEG textures; the material's colour is used")));
}

// A lost normal map matters little; the same picture as a colour is said again.
TEST(GltfMaterial, AMissingTextureIsSaidForEachUse) {
  Gltf gltf = square_with_texture({{"source", 0}}, {});
  gltf.json["images"] = {{{"uri", "leaves.png"}}};
  const nlohmann::json needs_it = gltf.json["materials"][0];
  gltf.json["materials"] = {{{"name", "first"}, {"normalTexture", {{"index", 0}}}}, needs_it};
  const auto imported = import_glb(gltf);
  ASSERT_TRUE(imported);
  EXPECT_THAT(imported->warnings, Contains(HasSubstr("; its normal map is left out")));
  EXPECT_THAT(imported->warnings,
              Contains(HasSubstr("the texture of material 1 (brick) is leaves.png, which is "
                                 "missing")));
}

// Some programs keep a set for textures beyond that of the lightmap.
TEST(GltfMaterial, TheSetThatTexturesLookAtIsRead) {
  Gltf gltf = square_with_texture({{"source", 0}}, {png_of(4, 1, {99, 0, 0, 255})});
  const int set = gltf.floats({0.25f, 0.5f, 1, 0.5f, 1, 1, 0.25f, 1}, "VEC2", 2);
  gltf.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_3"] = set;
  auto& material = gltf.json["materials"][0];
  material["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"] = 3;
  const auto imported = import_glb(gltf);
  const scene::Scene scene = scene_of(imported);
  EXPECT_THAT(imported->warnings, IsEmpty());
  EXPECT_EQ(scene.materials[0].base_color_texture.uv_set, 0);
  EXPECT_EQ(scene.meshes[0].uv0, (std::vector<Vec2>{{0.25f, 0.5f}, {1, 0.5f}, {1, 1}, {0.25f, 1}}));
  EXPECT_EQ(scene.meshes[0].uv1[2], (Vec2{1, 1})) << "the lightmap's";
  // A mesh has no third set.
  material["emissiveFactor"] = {1, 1, 1};
  material["emissiveTexture"] = {{"index", 0}, {"texCoord", 0}};
  EXPECT_THAT(import_glb(gltf)->warnings,
              Contains(HasSubstr("material 0 (brick) uses more than two sets of texture "
                                 "coordinates; TEXCOORD_1 and TEXCOORD_3 are read")));
}

nlohmann::json glossy(nlohmann::json values) {
  return {{"name", "gold"},
          {"extensions", {{"KHR_materials_pbrSpecularGlossiness", std::move(values)}}}};
}

TEST(GltfMaterial, SpecularGlossinessIsDiffuseAndHighlight) {
  const scene::Material m =
      scene_of(import_glb(square_with_material(glossy({{"diffuseFactor", {0.8, 0.4, 0.2, 0.5}},
                                                       {"specularFactor", {0.1, 0.2, 0}},
                                                       {"glossinessFactor", 0.5}}))))
          .materials[0];
  expect_near(m.base_color, {0.8f, 0.4f, 0.2f}, 1e-6f);
  EXPECT_FLOAT_EQ(m.alpha, 0.5f);
  EXPECT_EQ(m.metallic, 0);
  EXPECT_FLOAT_EQ(m.roughness, 0.5f);
  EXPECT_FLOAT_EQ(m.sharpness, kHalfRough);
  expect_near(m.specular, Rgb{0.1f, 0.2f, 0} * ((kHalfRough + 1) / 2), 1e-5f);
}

// ((1.2 - 1) / (1.2 + 1))^2 = 1 / 121.
TEST(GltfMaterial, TheIndexOfRefractionSetsTheHighlight) {
  const auto specular = [](double ior) {
    return scene_of(
               import_glb(square_with_material(
                   {{"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 0.5}}},
                    {"extensions", {{"KHR_materials_ior", {{"ior", ior}}}}}})))
        .materials[0]
        .specular.x;
  };
  EXPECT_NEAR(specular(1.2), (kHalfRough + 1) / 2 / 121, 1e-6f);
  EXPECT_NEAR(specular(1.5), (kHalfRough + 1) / 2 * 0.04f, 1e-6f);
  EXPECT_EQ(specular(0), 1);
}

TEST(GltfMaterial, SpecularGlossinessTextures) {
  Gltf gltf = square_with_material(
      glossy({{"diffuseTexture",
               {{"index", 0},
                {"texCoord", 1},
                {"extensions", {{"KHR_texture_transform", {{"scale", {2, 3}}}}}}}},
              {"glossinessFactor", 0.5},
              {"specularGlossinessTexture", {{"index", 1}}}}));
  add_texture(gltf, png_of(1, 1, {255, 0, 255, 255}));
  add_texture(gltf, "this is no picture");
  const auto imported = import_glb(gltf);
  const scene::Scene scene = scene_of(imported);
  const scene::Material& m = scene.materials[0];
  EXPECT_EQ(m.base_color_texture.texture, 0u);
  EXPECT_EQ(m.base_color_texture.uv_set, 1);
  EXPECT_EQ(m.base_color_texture.scale, (Vec2{2, 3}));
  EXPECT_NEAR(scene::f0_of(m.specular, m.sharpness).x, 0.04f, 1e-3f) << "glTF's own";
  gltf.json["materials"][0]["extensions"]["KHR_materials_pbrSpecularGlossiness"]["diffuseTexture"]
           ["index"] = 9;
  const auto wrong = import_glb(gltf);
  ASSERT_FALSE(wrong);
  EXPECT_THAT(wrong.error().message, HasSubstr("diffuseTexture: index 9 is out of range"));
}

}  // namespace
}  // namespace luxel::import
