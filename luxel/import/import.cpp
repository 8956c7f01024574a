// The reader that takes a file, and what every file goes through before and after it.
#include "luxel/import/import.h"

#include <algorithm>
#include <exception>
#include <fstream>
#include <new>

#include "luxel/base/shown_text.h"
#include "luxel/import/format.h"
#include "luxel/import/other_process.h"
#include "luxel/import/readers.h"
#include "luxel/import/text_lines.h"
#include "luxel/scene/sides.h"
#include "luxel/scene/smooth_normals.h"
#include "luxel/scene/validate.h"

namespace luxel::import {
namespace {

/// As a reader has made it, but near its origin.
Result<Imported> read_scene(const SourceFile& source, const ImportParams& params) {
  ExactPlaces exact;
  const bool is_gltf = source.extension == ".gltf" || source.extension == ".glb";
  LUXEL_TRY(Imported imported, is_gltf                      ? read_gltf(source, exact)
                               : source.extension == ".obj" ? read_obj(source, exact)
                                                            : read_with_assimp(source, exact));
  for (std::string& told : move_towards_origin(exact, params.origin, source.name, imported))
    imported.warnings.push_back(std::move(told));
  return imported;
}

/// The crease angle for a file [degrees]. OBJ, PLY and STL leave open how a mesh without
/// normals looks, and such files are mostly of curved things; glTF says that it is flat [glTF 2.0,
/// section 3.7.2.1].
float crease_deg(const SourceFile& source, const Imported& imported, const ImportParams& params) {
  if (params.smooth_normals_deg) return *params.smooth_normals_deg;
  for (const char* open : {".obj", ".ply", ".stl"})
    if (source.extension == open && !imported.is_smoothed) return kUsualCreaseDeg;
  return 0;
}

/// World from the coordinates of a file whose format states neither axes nor unit. Errors: it
/// states them, and `params` do.
Result<Mat34> world_from_file(const SourceFile& source, const ImportParams& params) {
  if (!params.up && !params.unit_m) return Mat34{};
  for (const char* stating : {".gltf", ".glb", ".fbx", ".dae", ".zae"})
    if (source.extension == stating)
      return fail(
          ErrorCode::bad_setting,
          "{}: {} files state their unit and the axis that points up; leave --unit and --up out",
          source.name, stating);
  const float unit = params.unit_m.value_or(1);
  if (params.up != Up::z) return Mat34{{{{unit, 0, 0, 0}, {0, unit, 0, 0}, {0, 0, unit, 0}}}};
  return Mat34{{{{unit, 0, 0, 0}, {0, 0, unit, 0}, {0, -unit, 0, 0}}}};
}

/// Instances that validation has kept keep what is known of them: it drops some, and changes none.
void keep_nodes(std::span<const scene::Instance> read, Imported& imported) {
  const std::vector<scene::Instance>& kept = imported.scene.instances;
  size_t count = 0;
  for (size_t i = 0; i < read.size() && count < kept.size(); ++i) {
    if (kept[count].world_from_object != read[i].world_from_object ||
        kept[count].mesh != read[i].mesh)
      continue;
    if (!imported.node_of_instance.empty())
      imported.node_of_instance[count] = imported.node_of_instance[i];
    if (!imported.object_origin.empty()) imported.object_origin[count] = imported.object_origin[i];
    ++count;
  }
  if (!imported.node_of_instance.empty()) imported.node_of_instance.resize(count);
  if (!imported.object_origin.empty()) imported.object_origin.resize(count);
}

/// Old programs write names in Latin-1 and the like. From here on all are UTF-8: they end up in
/// JSON, which has nothing else.
void make_names_utf8(scene::Scene& scene) {
  scene.name = valid_utf8(scene.name);
  const auto all = [](auto& things) {
    for (auto& thing : things) thing.name = valid_utf8(thing.name);
  };
  all(scene.meshes), all(scene.instances), all(scene.materials), all(scene.textures);
  all(scene.lights), all(scene.cameras);
}

/// A file can be wrong in any number of places. So many of them are told.
constexpr size_t kMostWarnings = 100;
void cut(std::vector<std::string>& warnings, const std::string& file) {
  if (warnings.size() <= kMostWarnings) return;
  const size_t more = warnings.size() - kMostWarnings;
  warnings.resize(kMostWarnings);
  warnings.push_back(fmt::format("{}: {} more warnings are left out", file, more));
}

Result<Imported> read_checked(SourceFile source, const ImportParams& params) {
  LUXEL_TRY(source.world_from_file, world_from_file(source, params));
  source.smooths_by_groups = !params.smooth_normals_deg;
  if (source.bytes.empty()) return fail(ErrorCode::bad_input, "{}: the file is empty", source.name);
  // Third-party readers throw; nothing of it leaves this room. Some say by their own words that
  // there was no memory.
  try {
    Result<Imported> read = read_scene(source, params);
    if (!read && says_no_memory(read.error())) return source.memory.used_up(source.name);
    LUXEL_TRY(Imported imported, std::move(read));
    if (imported.scene.name.empty()) imported.scene.name = source.path.stem().string();
    make_names_utf8(imported.scene);
    const std::vector<scene::Instance> instances = imported.scene.instances;
    LUXEL_TRY(std::vector<std::string> repairs, scene::validate(imported.scene, source.name));
    keep_nodes(instances, imported);
    imported.warnings.insert(imported.warnings.end(), repairs.begin(), repairs.end());
    cut(imported.warnings, source.name);
    for (std::string& warning : imported.warnings) warning = valid_utf8(warning);
    const float crease_rad = crease_deg(source, imported, params) * kPi / 180;
    for (scene::Mesh& mesh : imported.scene.meshes) scene::smooth_normals(mesh, crease_rad);
    scene::link_sides(imported.scene);
    return imported;
  } catch (const std::bad_alloc&) {
    return source.memory.used_up(source.name);
  } catch (const std::exception& e) {
    return fail(ErrorCode::bad_input, "{}: cannot be read: {}", source.name,
                one_sentence(e.what()));
  }
}

std::string ending_of(const std::filesystem::path& path) {
  return lower_case(path.extension().string());
}

Result<SourceFile> open_source(const std::filesystem::path& path, const ImportParams& params,
                               ReadingMemory& memory) {
  LUXEL_TRY(std::vector<std::byte> bytes, read_counted(path, memory));
  const std::string extension = format_of(bytes, ending_of(path));
  return SourceFile{path,      shown_text(path.string()),
                    extension, {path.parent_path(), params.search_paths, params.trust_paths},
                    memory,    std::move(bytes)};
}

}  // namespace

Result<Imported> import_scene(const std::filesystem::path& path, const ImportParams& params,
                              uint64_t max_memory_bytes) {
  ReadingMemory memory(max_memory_bytes);
  LUXEL_TRY(SourceFile source, open_source(path, params, memory));
  if (params.any_format && !is_own_format(source.extension) && !name_in_assimp(path).empty()) {
    const ProcessLimits limits = usual_limits(source.bytes.size(), max_memory_bytes);
    source.bytes = {};
    return import_in_other_process(path, params, limits);
  }
  LUXEL_TRY_STATUS(check_format(source));
  return read_checked(std::move(source), params);
}

bool is_gltf_file(const std::filesystem::path& path) {
  constexpr size_t kHead = 4096;
  std::vector<std::byte> head;
  std::error_code ignored;
  if (std::filesystem::is_regular_file(path, ignored)) {  // to open a pipe is to wait for it
    head.resize(kHead);
    std::ifstream in(path, std::ios::binary);
    in.read(reinterpret_cast<char*>(head.data()), kHead);
    head.resize(size_t(in.gcount()));
  }
  const std::string format = format_of(head, ending_of(path));
  return format == ".glb" || format == ".gltf";
}

Result<Imported> import_in_this_process(const std::filesystem::path& path,
                                        const ImportParams& params, uint64_t max_memory_bytes) {
  ReadingMemory memory(max_memory_bytes);
  LUXEL_TRY(SourceFile source, open_source(path, params, memory));
  if (name_in_assimp(path).empty()) LUXEL_TRY_STATUS(check_format(source));
  return read_checked(std::move(source), params);
}

Result<Imported> import_bytes(std::vector<std::byte> bytes, const std::string& name,
                              uint64_t max_memory_bytes) {
  ReadingMemory memory(max_memory_bytes);
  LUXEL_TRY_STATUS(memory.take(bytes.size(), name));
  const std::string extension = format_of(bytes, ending_of(name));
  SourceFile source{name, shown_text(name), extension, {}, memory, std::move(bytes)};
  LUXEL_TRY_STATUS(check_format(source));
  return read_checked(std::move(source), {});
}

Result<Imported> import_glb(std::vector<std::byte> bytes, const std::string& name,
                            const ImportParams& params, ReadingMemory& memory) {
  return read_checked({name, shown_text(name), ".glb", {}, memory, std::move(bytes)}, params);
}

Result<Imported> import_glb(std::vector<std::byte> bytes, const std::string& name,
                            const ImportParams& params) {
  ReadingMemory memory(0);
  return import_glb(std::move(bytes), name, params, memory);
}

}  // namespace luxel::import
