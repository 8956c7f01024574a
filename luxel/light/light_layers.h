// Division of light into the layers of a bake: each layer becomes a lightmap of its own.
//
// Light adds up: E = sum over layers of E_l, where E_l is what the scene would get from the lights
// of that layer alone. docs/method/layers.md
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "luxel/base/result.h"
#include "luxel/base/vec.h"
#include "luxel/light/lights.h"
#include "luxel/scene/scene.h"

namespace luxel::light {

/// per_light: punctual lights, instances that shine, and the surroundings, each by itself. groups:
/// punctual lights of one name and surfaces that shine by materials of one name, numbers at names'
/// ends left off, and the surroundings.
enum class LayerMode : uint8_t { none, per_light, groups };

inline constexpr size_t kMaxLayers = 64;

/// Lights that are told apart from the others together.
struct LightLayer {
  std::string name;  ///< letters, digits, '.', '_' and '-'; no two alike, in any case
  std::vector<std::string> lights;  ///< as the scene names them
};

/// All layers, and which of them each light belongs to.
struct LightLayers {
  std::vector<LightLayer> layers;
  std::vector<uint8_t> of_triangle;  ///< layer per Lights::triangles
  std::vector<uint8_t> of_punctual;  ///< layer per Lights::punctual
  std::optional<uint8_t> of_surroundings;

  /// The number of layers.
  size_t size() const { return layers.size(); }
};

/// The layers of a scene's lights, mode none aside: punctual lights in the scene's order, then
/// instances, then the surroundings, called "sky". Lights without power are left out. Error
/// (bad_setting): more than kMaxLayers.
Result<LightLayers> light_layers(const scene::Scene& scene, const Lights& lights, LayerMode mode);

/// Scales the layers' light at one place, channel by channel, so that it adds up to `whole`. Where
/// no layer has any, nothing is done. Returns what the sum had missed.
Rgb share_out(Rgb whole, std::span<Rgb> by_layer);

/// "lamp.001", "lamp_2", "lamp 3" and "lamp" are "lamp"; a name that is nothing but a number stays.
std::string_view without_number(std::string_view name);

}  // namespace luxel::light
