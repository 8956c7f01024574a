// glTF 2.0: the document and its buffers through tinygltf, then our parts from it.
#include <algorithm>
#include <array>
#include <cmath>

#include "luxel/import/gltf_checks.h"
#include "luxel/import/gltf_load.h"
#include "luxel/import/gltf_parts.h"

namespace luxel::import {
namespace {

/// glTF has no word for the light around a scene; luxel's own files say it in the scene's extras.
/// Values other than three finite numbers >= 0 are somebody else's and are left alone.
Rgb background_of(const nlohmann::json& document) {
  const size_t scene = document.value("scene", size_t(0));
  const nlohmann::json none;
  const auto member = [&](const nlohmann::json& object, const char* key) -> const nlohmann::json& {
    return object.is_object() && object.contains(key) ? object.at(key) : none;
  };
  const nlohmann::json& scenes = member(document, "scenes");
  if (!scenes.is_array() || scene >= scenes.size()) return {};
  const nlohmann::json& value =
      member(member(member(scenes[scene], "extras"), "luxel"), "background");
  if (!value.is_array() || value.size() != 3) return {};
  std::array<float, 3> c{};
  for (size_t k = 0; k < 3; ++k) {
    if (!value[k].is_number()) return {};
    c[k] = value[k].get<float>();
    if (!(c[k] >= 0) || !std::isfinite(c[k])) return {};
  }
  return {c[0], c[1], c[2]};
}

/// Exporters that leave lights out unless they are told otherwise.
std::string about_lost_lights(const std::string& generator) {
  if (generator.starts_with("Khronos glTF Blender I/O"))
    return "Blender leaves lights out of a glTF file unless 'Punctual Lights' is ticked under "
           "Include > Data of its export window";
  return {};
}

}  // namespace

Result<Imported> read_gltf(const SourceFile& source, ExactPlaces& exact) {
  LUXEL_TRY(const LoadedGltf loaded, load_gltf(source));
  const auto& [document, model] = loaded;

  Imported imported;
  GltfReader reader{document, model, source, imported, exact, world_transforms(model)};
  for (const std::string& extension : ignored_extensions(document))
    reader.warn("{} is not supported and is ignored", extension);
  LUXEL_TRY_STATUS(read_materials(reader));
  LUXEL_TRY_STATUS(read_meshes(reader));
  LUXEL_TRY_STATUS(read_nodes(reader));
  imported.scene.background = background_of(document);
  imported.about_lost_lights = about_lost_lights(model.asset.generator);
  if (!model.scenes.empty())
    imported.scene.name = model.scenes[size_t(std::max(model.defaultScene, 0))].name;
  return imported;
}

}  // namespace luxel::import
