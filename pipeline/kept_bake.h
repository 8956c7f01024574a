// What a bake with --keep leaves for the next bake of the same scene, besides its rays.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pipeline/solvers.h"
#include "pipeline/texel_layout.h"
#include "scene/change.h"
#include "solve/gather/adaptive.h"

namespace luxel::pipeline {

/// Which layer the lights of the scene's file belong to.
struct LayersOfLights {
  static constexpr uint8_t kNoLayer = 255;
  std::vector<uint8_t> of_lamp;                   ///< per lamp
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
  transport::DirectLight direct;  ///< by layer, too
  gather::DirectLevels levels;
  TexelLight light;  ///< as gather gave it, with its layers, which are those of `layers`
};

/// A digest of each element's place and normals.
std::vector<uint64_t> places_of(const transport::Elements& elements);

LayersOfLights layers_of_lights(const scene::Scene& scene, const transport::Lights& lights,
                                const transport::LightLayers& layers);

std::vector<std::byte> bytes_of(const KeptBake& kept);
/// Nothing where the bytes are not those of a kept bake.
std::optional<KeptBake> kept_bake_of(std::span<const std::byte> bytes);

}  // namespace luxel::pipeline
