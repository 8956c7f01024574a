#include "luxel/export/baked_glb.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <exception>

#include "luxel/atlas/pages.h"
#include "luxel/base/check.h"
#include "luxel/base/parallel.h"
#include "luxel/base/vec_double.h"
#include "luxel/export/gltf_mesh.h"
#include "luxel/export/gltf_node.h"
#include "luxel/export/json_parts.h"
#include "luxel/image/codec.h"
#include "luxel/image/white_level.h"
#include "luxel/scene/light_kinds.h"

namespace luxel::export_ {
namespace {

using nlohmann::json;

/// Values of asset.extras.luxel.attached.
constexpr const char *kCombined = "combined", *kEmissive = "emissive";

/// linear(picture) * intensity = E, up to 8 bits and clipping.
std::vector<std::byte> lightmap_png(const image::Image& lightmap, float intensity) {
  image::Image scaled(lightmap.width, lightmap.height, 3);
  for (int y = 0; y < lightmap.height; ++y)
    for (int x = 0; x < lightmap.width; ++x)
      scaled.set_rgb(x, y, lightmap.rgb(x, y) * (1 / intensity));
  return image::encode_png(image::to_srgb8(scaled));
}

/// KHR_lights_punctual knows no profiles: such a light gets the mean of what it sends into its
/// cone, a point light into all directions, so that its flux stays.
scene::PunctualLight as_even_light(const scene::Scene& scene, scene::PunctualLight light) {
  if (light.profile == scene::kNone) return light;
  const double half_angle_rad =
      scene::has_cone(light.kind) ? double(light.outer_cone_rad) : kPiDouble;
  light.intensity *= float(scene::mean_candela(scene.profiles[light.profile], half_angle_rad));
  return light;
}

/// Holds the properties that glTF has no word for.
json& luxel_extras(json& object) { return object_in(object, {"extras", "luxel"}); }

void append_lights_and_cameras(Glb& glb, const scene::Scene& scene, json& roots) {
  for (const scene::PunctualLight& light : scene.lights)
    roots.push_back(append_light(glb, as_even_light(scene, light)));
  const float diagonal = std::max(world_bounds(scene).diagonal(), 1e-6f);
  for (const scene::Camera& camera : scene.cameras)
    roots.push_back(append_camera(glb, camera, 1e-3f * diagonal, 10 * diagonal));
}

Result<std::vector<std::byte>> finish_scene(Glb glb, const scene::Scene& scene, json roots) {
  json root = json::object();
  if (!roots.empty()) root["nodes"] = std::move(roots);
  if (!scene.name.empty()) root["name"] = scene.name;
  if (scene.background != Rgb{})  // glTF has no word for it
    luxel_extras(root)["background"] = {scene.background.x, scene.background.y, scene.background.z};
  json& asset = object_in(glb.json, {"asset"});
  asset["version"] = "2.0";
  asset["generator"] = "luxel";
  glb.json["scenes"] = json::array({std::move(root)});
  glb.json["scene"] = 0;
  return finish(std::move(glb));
}

json instance_node(const scene::Instance& instance, size_t mesh) {
  json node = {{"mesh", mesh}};
  if (!instance.name.empty()) node["name"] = instance.name;
  if (instance.texel_density != 1) luxel_extras(node)["density"] = instance.texel_density;
  if (!instance.lightmapped) luxel_extras(node)["bake"] = false;
  return node;
}

/// One intensity for all pages: the same light is the same byte on each.
void append_lightmaps(Glb& glb, MaterialBook& book, std::span<const image::Image> lightmaps) {
  const float intensity = image::white_level(lightmaps);
  json names = json::array();
  for (size_t p = 0; p < lightmaps.size(); ++p) {
    const std::string name = lightmap_name(p, lightmaps.size());
    const size_t texture =
        append_lightmap_texture(glb, book, lightmap_png(lightmaps[p], intensity), name);
    book.lightmap.push_back(
        {{{"index", texture}, {"texCoord", 1}, {"intensity", intensity}}, name});
    names.push_back(name + ".exr");
  }
  json& about = luxel_extras(object_in(glb.json, {"asset"}));
  about = {{"irradiance",
            "E [W/m^2] = intensity * linear(picture), the picture in sRGB; " +
                std::string(lightmaps.size() == 1 ? "lightmap.exr holds" : "lightmap-N.exr hold") +
                " E itself"}};
  if (lightmaps.size() == 1)
    about["lightmap"] = names[0];
  else
    about["lightmaps"] = names;
}

/// Pictures are encoded side by side: there may be dozens.
struct EncodedLayer {
  float intensity = 1;
  std::vector<std::vector<std::byte>> png;  ///< per page
};
std::vector<EncodedLayer> encode_layers(std::span<const LightmapLayer> layers) {
  std::vector<EncodedLayer> out(layers.size());
  parallel_for(layers.size(), 1, [&](size_t l, size_t) {
    out[l].intensity = image::white_level(layers[l].lightmaps);
    for (const image::Image& page : layers[l].lightmaps)
      out[l].png.push_back(lightmap_png(page, out[l].intensity));
  });
  return out;
}

void append_layers(Glb& glb, MaterialBook& book, std::span<const LightmapLayer> layers) {
  const std::vector<EncodedLayer> encoded = encode_layers(layers);
  for (size_t l = 0; l < layers.size(); ++l) {
    json about = {{"name", layers[l].name}, {"lights", layers[l].lights}};
    if (layers[l].surroundings) about["surroundings"] = true;
    const size_t pages = encoded[l].png.size();
    if (pages > 0) about["intensity"] = encoded[l].intensity;
    for (size_t p = 0; p < pages; ++p)
      array_in(about, "textures")
          .push_back(append_lightmap_texture(glb, book, encoded[l].png[p],
                                             lightmap_name(p, pages, layers[l].name)));
    array_in(luxel_extras(object_in(glb.json, {"asset"})), "layers").push_back(std::move(about));
  }
}

void append_pictures(Glb& glb, MaterialBook& book, const LitPictures& pictures) {
  std::vector<std::vector<std::byte>> png(pictures.pages.size());
  parallel_for(png.size(), 1,
               [&](size_t p, size_t) { png[p] = image::encode_png(pictures.pages[p]); });
  for (size_t p = 0; p < png.size(); ++p) {
    const std::string name = lightmap_name(p, png.size());
    const size_t texture = append_lightmap_texture(glb, book, png[p], name, pictures.scale > 1);
    book.lightmap.push_back({{{"index", texture}, {"texCoord", 1}}, name});
  }
  json& about = luxel_extras(object_in(glb.json, {"asset"}));
  about["attached"] = book.attach == Attach::combined ? kCombined : kEmissive;
  about["exposure"] = pictures.exposure;
}

/// The scene with the light that the book has by now.
Result<std::vector<std::byte>> write_baked(Glb& glb, MaterialBook& book, const scene::Scene& scene,
                                           const atlas::Atlas& atlas,
                                           std::span<const LightmapLayer> layers) {
  append_layers(glb, book, layers);
  glb.origin = scene.origin;
  const std::vector<atlas::Page> pages = atlas::pages_of(atlas);
  json roots = json::array();
  for (uint32_t i = 0; i < scene.instances.size(); ++i) {
    const scene::Mesh& mesh = scene.meshes[scene.instances[i].mesh];
    if (mesh.triangles.empty()) continue;
    LightmapCoordinates places = lightmap_places(atlas, pages, i);
    places.attached = scene.instances[i].lightmapped;
    const size_t index = append_mesh(glb, book, scene, mesh, places);
    json node = instance_node(scene.instances[i], index);
    for (const LightmapLayer& layer : layers)
      if (std::ranges::find(layer.instances, i) != layer.instances.end())
        luxel_extras(node)["layer"] = layer.name;
    roots.push_back(append_node(glb, scene.instances[i].world_from_object, std::move(node)));
  }
  append_lights_and_cameras(glb, scene, roots);
  return finish_scene(std::move(glb), scene, std::move(roots));
}

Result<std::vector<std::byte>> write_scene(const scene::Scene& scene, json extras) {
  Glb glb;
  glb.origin = scene.origin;
  MaterialBook book;
  if (!extras.empty()) luxel_extras(object_in(glb.json, {"asset"})) = std::move(extras);
  std::vector<size_t> index_of(scene.meshes.size(), SIZE_MAX);
  json roots = json::array();
  for (const scene::Instance& instance : scene.instances) {
    const scene::Mesh& mesh = scene.meshes[instance.mesh];
    if (mesh.triangles.empty()) continue;
    size_t& index = index_of[instance.mesh];
    if (index == SIZE_MAX) index = append_mesh(glb, book, scene, mesh, {});
    roots.push_back(append_node(glb, instance.world_from_object, instance_node(instance, index)));
  }
  append_lights_and_cameras(glb, scene, roots);
  return finish_scene(std::move(glb), scene, std::move(roots));
}

/// The JSON of a file that export has written.
Result<json> document_of(std::span<const std::byte> glb, const std::string& name) {
  // Header, then the JSON chunk's length and type.
  constexpr size_t kBefore = 20;
  uint32_t length = 0;
  if (glb.size() >= kBefore) std::memcpy(&length, glb.data() + 12, sizeof length);
  const bool whole = glb.size() >= kBefore && length <= glb.size() - kBefore;
  const char* text = reinterpret_cast<const char*>(glb.data()) + kBefore;
  json document =
      whole ? json::parse(text, text + length, nullptr, false) : json(json::value_t::discarded);
  if (!document.is_object())
    return fail(ErrorCode::bad_input, "{} is not a binary glTF file; bake the scene again", name);
  return document;
}

}  // namespace

Result<std::vector<std::byte>> baked_glb(const scene::Scene& scene, const atlas::Atlas& atlas,
                                         std::span<const image::Image> lightmaps,
                                         std::span<const LightmapLayer> layers) {
  LUXEL_CHECK(lightmaps.size() == atlas::pages_of(atlas).size());
  for (const image::Image& lightmap : lightmaps) LUXEL_CHECK(lightmap.channels == 4);
  LUXEL_CHECK(atlas.first_triangle.size() == scene.instances.size() + 1);
  try {
    Glb glb;
    MaterialBook book;
    append_lightmaps(glb, book, lightmaps);
    return write_baked(glb, book, scene, atlas, layers);
  } catch (const std::exception& e) {  // nlohmann-json and memory
    return fail(ErrorCode::io, "the baked scene cannot be written as .glb: {}", e.what());
  }
}

Result<std::vector<std::byte>> lit_glb(const scene::Scene& scene, const atlas::Atlas& atlas,
                                       const LitPictures& pictures) {
  LUXEL_CHECK(pictures.attach != Attach::lightmap && pictures.strength > 0);
  LUXEL_CHECK(pictures.pages.size() == atlas::pages_of(atlas).size());
  LUXEL_CHECK(atlas.first_triangle.size() == scene.instances.size() + 1);
  try {
    Glb glb;
    MaterialBook book;
    book.attach = pictures.attach, book.strength = pictures.strength;
    book.shown = materials_without_light(scene, pictures.attach);
    append_pictures(glb, book, pictures);
    return write_baked(glb, book, scene, atlas, {});
  } catch (const std::exception& e) {  // nlohmann-json and memory
    return fail(ErrorCode::io, "the baked scene cannot be written as .glb: {}", e.what());
  }
}

std::string lightmap_name(size_t page, size_t pages, std::string_view layer) {
  const std::string name = layer.empty() ? "lightmap" : fmt::format("lightmap-{}", layer);
  return pages == 1 ? name : fmt::format("{}-{}", name, page);
}

Result<std::vector<std::string>> lightmap_files_of(std::span<const std::byte> glb,
                                                   const std::string& name) {
  LUXEL_TRY(const json document, document_of(glb, name));
  std::vector<std::string> out;
  const json::json_pointer where("/extras/luxel/lightmap");
  for (const json& material : document.value("materials", json::array()))
    out.push_back(material.contains(where) && material[where].is_string()
                      ? material[where].get<std::string>()
                      : std::string());
  return out;
}

Result<Attach> attach_of(std::span<const std::byte> glb, const std::string& name) {
  LUXEL_TRY(const json document, document_of(glb, name));
  const json::json_pointer where("/asset/extras/luxel/attached");
  const json attached = document.contains(where) ? document[where] : json();
  return attached == kCombined   ? Attach::combined
         : attached == kEmissive ? Attach::emissive
                                 : Attach::lightmap;
}

Result<FileLayers> layers_of(std::span<const std::byte> glb, const std::string& name) {
  LUXEL_TRY(const json document, document_of(glb, name));
  FileLayers out;
  const json::json_pointer where("/asset/extras/luxel/layers"), of_node("/extras/luxel/layer");
  const json layers = document.contains(where) ? document[where] : json::array();
  for (const json& layer : layers)
    if (layer.is_object() && layer.contains("name") && layer["name"].is_string())
      out.layers.push_back({layer["name"].get<std::string>(), layer.contains("surroundings")});
  for (const json& node : document.value("nodes", json::array())) {
    if (!node.contains("mesh")) continue;
    const json layer = node.contains(of_node) ? node[of_node] : json();
    const auto found = std::ranges::find_if(
        out.layers, [&](const FileLayers::Layer& known) { return layer == known.name; });
    out.shines_in.push_back(size_t(found - out.layers.begin()));
  }
  return out;
}

Result<std::vector<std::byte>> vertex_lit_glb(const scene::Scene& scene, float intensity) {
  try {
    return write_scene(scene, {{"intensity", intensity},
                               {"irradiance",
                                "E [W/m^2] = intensity * COLOR_0, linear; where the "
                                "scene had vertex colours, times those"}});
  } catch (const std::exception& e) {
    return fail(ErrorCode::io, "the baked scene cannot be written as .glb: {}", e.what());
  }
}

Result<std::vector<std::byte>> scene_glb(const scene::Scene& scene) {
  try {
    return write_scene(scene, json::object());
  } catch (const std::exception& e) {
    return fail(ErrorCode::io, "the scene cannot be written as .glb: {}", e.what());
  }
}

}  // namespace luxel::export_
