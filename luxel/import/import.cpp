// The reader that takes a file, and what every file goes through before and after it.
#include "luxel/import/import.h"

#include <algorithm>
#include <exception>
#include <new>

#include "luxel/base/file.h"
#include "luxel/import/readers.h"
#include "luxel/scene/sides.h"
#include "luxel/scene/validate.h"

namespace luxel::import {
namespace {

std::string lower_case(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
  return text;
}

Result<Imported> read_scene(const SourceFile& source) {
  if (source.extension == ".gltf" || source.extension == ".glb") return read_gltf(source);
  return read_with_assimp(source);
}

Result<Imported> read_checked(const SourceFile& source) {
  LUXEL_TRY_STATUS(check_extension(source));
  if (source.bytes.empty()) return fail(ErrorCode::bad_input, "{}: the file is empty", source.name);
  // Third-party readers throw; nothing of it leaves this room.
  try {
    LUXEL_TRY(Imported imported, read_scene(source));
    if (imported.scene.name.empty()) imported.scene.name = source.path.stem().string();
    LUXEL_TRY(std::vector<std::string> repairs, scene::validate(imported.scene, source.name));
    imported.warnings.insert(imported.warnings.end(), repairs.begin(), repairs.end());
    scene::link_sides(imported.scene);
    return imported;
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::out_of_memory, "{}: not enough memory to read it", source.name);
  } catch (const std::exception& e) {
    return fail(ErrorCode::bad_input, "{}: cannot be read: {}", source.name,
                one_sentence(e.what()));
  }
}

}  // namespace

Result<Imported> import_scene(const std::filesystem::path& path) {
  SourceFile source{path, path.string(), lower_case(path.extension().string()), {}};
  LUXEL_TRY(source.bytes, read_file(path));
  return read_checked(source);
}

Result<Imported> import_glb(std::vector<std::byte> bytes, const std::string& name) {
  return read_checked({name, name, ".glb", std::move(bytes)});
}

}  // namespace luxel::import
