// glTF 2.0: checks, then tinygltf for the document and its buffers, then our parts from it.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "import/gltf_checks.h"
#include "import/gltf_parts.h"

namespace luxel::import {
namespace {

/// Keeps the encoded bytes: pictures are decoded where a material asks for them.
bool keep_encoded(tinygltf::Image* image, const int, std::string*, std::string*, int, int,
                  const unsigned char* bytes, int size, void*) {
  image->image.assign(bytes, bytes + std::max(size, 0));
  return true;
}

Result<tinygltf::Model> load_model(const SourceFile& source, const std::string& text) {
  tinygltf::TinyGLTF loader;
  loader.SetImageLoader(keep_encoded, nullptr);
  tinygltf::Model model;
  std::string error, warning;
  std::string folder = source.path.parent_path().string();
  if (folder.empty()) folder = ".";
  if (source.bytes.size() > UINT32_MAX)
    return fail(ErrorCode::unsupported, "{}: glTF files over 4 GB cannot be read", source.name);
  const bool loaded =
      source.extension == ".glb"
          ? loader.LoadBinaryFromMemory(&model, &error, &warning,
                                        reinterpret_cast<const unsigned char*>(source.bytes.data()),
                                        static_cast<unsigned int>(source.bytes.size()), folder)
          : loader.LoadASCIIFromString(&model, &error, &warning, text.data(),
                                       static_cast<unsigned int>(text.size()), folder);
  if (!loaded)
    return fail(ErrorCode::bad_input, "{}: cannot be read: {}", source.name, one_sentence(error));
  return model;
}

/// check_document() went by the stated lengths; this is what really came.
Status check_buffers(const tinygltf::Model& model, const nlohmann::json& document,
                     const SourceFile& source) {
  if (!document.contains("buffers")) return {};
  for (size_t i = 0; i < document["buffers"].size(); ++i)
    if (i >= model.buffers.size() ||
        double(model.buffers[i].data.size()) < document["buffers"][i]["byteLength"].get<double>())
      return fail(ErrorCode::bad_input, "{}: buffer {} has fewer bytes than its byteLength",
                  source.name, i);
  return {};
}

Result<std::string> text_of(const SourceFile& source) {
  if (source.extension == ".glb") return json_of_glb(source.bytes, source.name);
  return std::string(reinterpret_cast<const char*>(source.bytes.data()), source.bytes.size());
}

/// glTF has no word for the light around a scene; luxel's own files say it in the scene's extras.
/// What is not three finite numbers >= 0 is somebody else's and is left alone.
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

}  // namespace

Result<Imported> read_gltf(const SourceFile& source) {
  LUXEL_TRY(const std::string text, text_of(source));
  LUXEL_TRY(const nlohmann::json document, parse_json(text, source.name));
  LUXEL_TRY_STATUS(check_document(document, source.name));
  LUXEL_TRY(const tinygltf::Model model, load_model(source, text));
  LUXEL_TRY_STATUS(check_buffers(model, document, source));

  Imported imported;
  GltfReader reader{model, source, imported, scene::kNone};
  for (const std::string& extension : ignored_extensions(document))
    reader.warn("{} is not supported and is ignored", extension);
  LUXEL_TRY_STATUS(read_materials(reader));
  LUXEL_TRY_STATUS(read_meshes(reader));
  LUXEL_TRY_STATUS(read_nodes(reader));
  imported.scene.background = background_of(document);
  if (!model.scenes.empty())
    imported.scene.name = model.scenes[size_t(std::max(model.defaultScene, 0))].name;
  return imported;
}

}  // namespace luxel::import
