#include "luxel/light/layer_instances.h"

#include <map>
#include <set>

#include "luxel/base/check.h"

namespace luxel::light {

std::vector<std::vector<uint32_t>> instances_of_layers(const Lights& lights,
                                                       const LightLayers& layers) {
  LUXEL_CHECK(layers.of_triangle.size() == lights.triangles.size());
  std::map<uint32_t, std::set<uint8_t>> layers_of;
  for (size_t k = 0; k < lights.triangles.size(); ++k)
    layers_of[lights.triangles[k].instance].insert(layers.of_triangle[k]);
  std::vector<std::vector<uint32_t>> out(layers.size());
  for (const auto& [instance, own] : layers_of)
    if (own.size() == 1) out[*own.begin()].push_back(instance);
  return out;
}

}  // namespace luxel::light
