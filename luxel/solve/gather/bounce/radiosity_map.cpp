#include "luxel/solve/gather/bounce/radiosity_map.h"

#include "luxel/base/parallel.h"
#include "luxel/solve/gather/rays/traced_hits.h"

namespace luxel::gather {
namespace {

/// `value_at(i)`: what element i sends.
template <class ValueAt>
void fill(RadiosityMap& m, const atlas::TexelMap& map, const TracedHits& hits,
          const ValueAt& value_at) {
  parallel_for(map.texels.size(), 1 << 14, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      if (is_hidden(hits, i)) continue;
      const Rgb b = value_at(i);
      m.texels[size_t(map.texels[i].y + 1) * m.stride + map.texels[i].x + 1] =
          Float4{b.x, b.y, b.z, 1.0f};
    }
  });
}

}  // namespace

RadiosityMap empty_radiosity_map(int resolution) {
  RadiosityMap m;
  m.stride = uint32_t(resolution + 2);
  m.texels.assign(size_t(m.stride) * m.stride, Float4{});
  return m;
}

void fill_radiosity(RadiosityMap& m, const atlas::TexelMap& map,
                    const transport::Elements& elements, const TracedHits& hits,
                    std::span<const StoredHit> behind, std::span<const Rgb> irradiance) {
  const auto reflected = [&](size_t i) { return elements.reflectance[i] * irradiance[i]; };
  if (behind.empty()) return fill(m, map, hits, reflected);
  RadiosityMap light = empty_radiosity_map(map.resolution);
  fill(light, map, hits, [&](size_t i) { return irradiance[i]; });
  fill(m, map, hits, [&](size_t i) {
    if (max_component(elements.transmittance[i]) <= 0) return reflected(i);
    const Float4 e = lookup(light, behind[i]);
    return reflected(i) + elements.transmittance[i] * Rgb{e[0], e[1], e[2]};
  });
}

}  // namespace luxel::gather
