// Helpers that the files of this room share. For this room only.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "luxel/base/result.h"
#include "luxel/import/far_scene.h"
#include "luxel/import/import.h"
#include "luxel/import/reading_memory.h"
#include "luxel/import/scene_files.h"
#include "luxel/scene/scene.h"

namespace luxel::import {

/// A file to read, already in memory.
struct SourceFile {
  std::filesystem::path path;
  std::string name;       ///< what messages call it: shown_text()
  std::string extension;  ///< of its format (format.h): lower case, with the dot
  SceneFiles files;       ///< where files that it names may lie
  ReadingMemory& memory;  ///< what is left for reading it
  std::vector<std::byte> bytes;
  Mat34 world_from_file{};        ///< for formats that state neither unit nor axes
  bool smooths_by_groups = true;  ///< false: by an angle that was asked for
};

/// Imports a binary glTF file, which counts in `memory`.
Result<Imported> import_glb(std::vector<std::byte> bytes, const std::string& name,
                            const ImportParams& params, ReadingMemory& memory);

/// The readers also say where they have put things, before anything was rounded.
Result<Imported> read_gltf(const SourceFile& source, ExactPlaces& exact);
Result<Imported> read_obj(const SourceFile& source, ExactPlaces& exact);
Result<Imported> read_with_assimp(const SourceFile& source, ExactPlaces& exact);

/// Assimp's readers trust their input, and Debian's build aborts where an assertion fails: what can
/// be told cheaply is told before. Errors: NaN, index out of range, a file that ends early.
/// Texts that Assimp gets instead have their vertices relative to `near`: it reads numbers in
/// single precision. The text of a .x file of the same surfaces; none for a binary or packed one,
/// or what is no .x. Errors: those of checks; memory.
Result<std::optional<std::string>> write_plain_x(const SourceFile& source, DVec3& near);
/// The text of a .stl file that lies far from its origin; none for another or a binary one. Errors:
/// memory.
Result<std::optional<std::string>> write_near_stl(const SourceFile& source, DVec3& near);
Status check_collada(const SourceFile& source);
/// The text of a .dae file that check_collada() has passed, in UTF-8, without blanks around values.
/// Errors: broken XML; UTF-16; memory.
Result<std::string> write_plain_collada(const SourceFile& source, DVec3& near);
Status check_fbx(const SourceFile& source);

/// Merges vertices that agree in every bit of every attribute, in the order of their first use.
void join_identical_vertices(scene::Mesh& mesh);

/// A material asks for the alpha of vertices.
inline bool counts_alpha(const scene::Scene& scene, uint32_t material) {
  return scene.materials[material].alpha_mode != scene::AlphaMode::opaque;
}
/// Most files state an alpha of 1 with every colour: it is not kept.
void drop_alphas_of_one(scene::Mesh& mesh);

/// Material of surfaces whose file states none: white that reflects 0.8. glTF's own default would
/// be base colour 1 with metallic 1, that is black to a diffuse solver; a white of 1 never loses
/// light and would be clamped.
scene::Material default_material();

/// A library's message (several lines, full stops) as the end of a sentence of ours.
std::string one_sentence(std::string text);

/// "mesh 3 (chair)"
std::string label(const char* kind, size_t index, const std::string& name);

}  // namespace luxel::import
