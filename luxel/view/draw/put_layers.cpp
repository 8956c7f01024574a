#include "luxel/view/draw/put_layers.h"

#include "luxel/image/half.h"

namespace luxel::view {

Status put_layers(gpu::Commands& commands, const Layers& layers,
                  std::span<const LayerSetting> settings, std::span<const image::Image> mixed,
                  uint32_t which, DeviceScene& scene) {
  std::vector<image::HalfImage> halves;
  for (const image::Image& page : mixed) halves.push_back(image::to_half(page));
  LUXEL_TRY_STATUS(put_light(commands, halves, which, scene));
  scene.second_light = float(which);
  scene.surroundings_factor = {1, 1, 1};
  for (const LayerLight& layer : layers.layers)
    if (layer.has_surroundings) scene.surroundings_factor = factor_of(settings, layer.name);
  for (uint32_t i = 0; i < scene.mesh_of.size() && i < layers.shines_in.size(); ++i)
    if (const size_t layer = layers.shines_in[i]; layer < layers.layers.size())
      set_emission_factor(i, factor_of(settings, layers.layers[layer].name), scene);
  return {};
}

}  // namespace luxel::view
