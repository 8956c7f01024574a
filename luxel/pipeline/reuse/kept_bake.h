// The data that a bake with --keep leaves for the next bake of the same scene, besides its rays.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "luxel/pipeline/texels/solve_input.h"
#include "luxel/pipeline/texels/texel_layout.h"
#include "luxel/scene/change.h"
#include "luxel/solve/gather/budget/adaptive.h"

namespace luxel::pipeline {

/// The layer that each light of the scene's file belongs to.
struct LayersOfLights {
  static constexpr uint8_t kNoLayer = 255;
  std::vector<uint8_t> of_punctual;               ///< per punctual light
  std::vector<std::vector<uint8_t>> of_instance;  ///< per instance, ascending: by its surfaces
  uint8_t of_surroundings = kNoLayer;
  friend bool operator==(const LayersOfLights&, const LayersOfLights&) = default;
};

struct KeptBake {
  scene::SceneState scene;  ///< as it was read, with its outside light
  double seconds = 0;       ///< of the whole bake, up to the end of its light
  KeptLayout layout;
  std::vector<uint64_t> places;          ///< places_of()
  std::vector<std::string> layer_names;  ///< empty: light is not told apart
  LayersOfLights layers;
  light::DirectLight direct;  ///< by layer, too
  light::DirectLevels levels;
  TexelLight light;  ///< as gather gave it, with its layers, which are those of `layers`
};

/// A digest of each element's place and normals.
std::vector<uint64_t> places_of(const transport::Elements& elements);

LayersOfLights layers_of_lights(const scene::Scene& scene, const light::Lights& lights,
                                const light::LightLayers& layers);

/// In parts, which are written and read one by one, those of a size.
inline constexpr size_t kKeptParts = 6;
std::vector<std::byte> bytes_of(const KeptBake& kept, size_t part);
/// Reads a part into `kept`. False where the bytes are not those of it.
bool read_part(std::span<const std::byte> bytes, size_t part, KeptBake& kept);
/// True: the parts are those of one bake. All of them have been read.
bool is_whole(const KeptBake& kept);

}  // namespace luxel::pipeline
