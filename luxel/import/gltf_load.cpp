#include "luxel/import/gltf_load.h"

#include <span>

#include "luxel/import/gltf_buffers.h"
#include "luxel/import/gltf_check_steps.h"
#include "luxel/import/gltf_checks.h"

namespace luxel::import {
namespace {

/// User data of tinygltf's file callbacks: it reads the buffers by them, and nothing else.
struct BufferFiles {
  const SourceFile& source;
  Error error{};  ///< of the first file that could not be read; no message: none
};

bool read_buffer(std::vector<unsigned char>* out, std::string*, const std::string& file,
                 void* user) {
  BufferFiles& files = *static_cast<BufferFiles*>(user);
  const SourceFile& source = files.source;
  const auto bytes = read_named_file(source.files, file, source.name + ": a buffer", source.memory);
  if (!bytes) {
    files.error = bytes.error();
    return false;
  }
  const auto* first = reinterpret_cast<const unsigned char*>(bytes->data());
  out->assign(first, first + bytes->size());
  return true;
}

/// The callbacks. A name comes as the file states it, since tinygltf is told no folder.
tinygltf::FsCallbacks callbacks_of(BufferFiles& files) {
  tinygltf::FsCallbacks out{};
  out.FileExists = [](const std::string&, void*) { return true; };  // else read_buffer() says so
  out.ExpandFilePath = [](const std::string& file, void*) { return file; };
  out.ReadWholeFile = read_buffer;
  out.WriteWholeFile = nullptr;
  out.user_data = &files;
  return out;
}

Result<tinygltf::Model> load_model(const SourceFile& source, const std::string& text,
                                   std::span<const std::byte> glb) {
  tinygltf::TinyGLTF loader;
  BufferFiles files{source};
  loader.SetFsCallbacks(callbacks_of(files));
  tinygltf::Model model;
  std::string error, warning;
  if (source.bytes.size() > UINT32_MAX)
    return fail(ErrorCode::unsupported, "{}: glTF files over 4 GB cannot be read", source.name);
  const bool loaded =
      source.extension == ".glb"
          ? loader.LoadBinaryFromMemory(&model, &error, &warning,
                                        reinterpret_cast<const unsigned char*>(glb.data()),
                                        static_cast<unsigned int>(glb.size()), "")
          : loader.LoadASCIIFromString(&model, &error, &warning, text.data(),
                                       static_cast<unsigned int>(text.size()), "");
  if (!files.error.message.empty()) return Failure{files.error};
  if (!loaded)
    return fail(ErrorCode::bad_input, "{}: cannot be read: {}", source.name, one_sentence(error));
  return model;
}

/// check_document() went by the stated lengths; this is what really came.
Status check_buffers(const tinygltf::Model& model, const Json& document,
                     const std::vector<bool>& is_placeholder, const std::string& file) {
  for (size_t i = 0; i < is_placeholder.size(); ++i)
    if (!is_placeholder[i] &&
        (i >= model.buffers.size() ||
         double(model.buffers[i].data.size()) < document["buffers"][i]["byteLength"].get<double>()))
      return fail(ErrorCode::bad_input, "{}: buffer {} has fewer bytes than its byteLength", file,
                  i);
  return {};
}

Result<std::string> json_text_of(const SourceFile& source) {
  if (source.extension == ".glb") return json_of_glb(source.bytes, source.name);
  return std::string(reinterpret_cast<const char*>(source.bytes.data()), source.bytes.size());
}

/// The document as tinygltf takes it. It takes no buffer without bytes, and would give a .glb's
/// only ones to every buffer that has no uri: one byte stands for what nobody reads. It takes no
/// indices without bytes either, as Draco's are: decode_draco() puts them in. Pictures are read
/// where a material asks for them, and may be of kinds that it refuses.
Json for_tinygltf(Json document, const std::vector<bool>& is_placeholder, const SceneFiles& files) {
  document.erase("images");
  state_true_lengths(document, files);
  for (size_t i = 0; i < is_placeholder.size(); ++i)
    if (is_placeholder[i])
      document["buffers"][i] = {{"byteLength", 1},
                                {"uri", "data:application/octet-stream;base64,AA=="}};
  if (!document.contains("meshes")) return document;
  for (Json& mesh : document["meshes"])
    for (Json& primitive : mesh["primitives"])
      if (is_draco(primitive)) primitive.erase("indices");
  return document;
}

/// A member, which leaves the document; null where there is none.
Json take(Json& document, const char* key) {
  const auto found = document.find(key);
  if (found == document.end()) return {};
  Json out = std::move(*found);
  document.erase(found);
  return out;
}

}  // namespace

Result<LoadedGltf> load_gltf(const SourceFile& source) {
  LUXEL_TRY(std::string text, json_text_of(source));
  LUXEL_TRY(Json document, parse_json(text, source.name));
  const bool was_changed = make_whole(document);
  LUXEL_TRY_STATUS(check_document(document, source.name));

  const std::vector<bool> is_placeholder = placeholder_buffers(document);
  std::vector<std::byte> new_glb;
  std::span<const std::byte> glb = source.bytes;
  {
    // A scene may have a million nodes, a kilobyte each here and once more in tinygltf, which is
    // the only one to read them: none are left when it begins.
    Json nodes = take(document, "nodes");
    Json adapted = for_tinygltf(document, is_placeholder, source.files);
    if (was_changed || adapted != document) {
      if (!nodes.is_null()) adapted["nodes"] = std::move(nodes);
      text = adapted.dump();
      if (source.extension == ".glb") glb = new_glb = glb_with_json(source.bytes, text);
    }
  }
  LUXEL_TRY(tinygltf::Model model, load_model(source, text, glb));
  LUXEL_TRY_STATUS(check_buffers(model, document, is_placeholder, source.name));
  LUXEL_TRY_STATUS(decode_meshopt(model, document, source));
  LUXEL_TRY_STATUS(decode_draco(model, document, source.name));
  convert_specular_glossiness(model);
  return LoadedGltf{std::move(document), std::move(model)};
}

}  // namespace luxel::import
