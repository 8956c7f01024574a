#include "luxel/solve/hierarchical/known_light.h"

#include <bit>

#include "luxel/base/random.h"

namespace luxel::hierarchical {

size_t KnownLight::Hash::operator()(const Key& key) const {
  uint64_t h = key.face;
  for (const double x : {key.place.x, key.place.y, key.place.z})
    h = hash64(h, std::bit_cast<uint64_t>(x));
  return h;
}

Result<std::vector<Rgb>> continuous_irradiance_at(const Solution& s, const scene::Scene& scene,
                                                  const trace::RayTracer& tracer,
                                                  std::span<const Receiver> receivers,
                                                  PointParams params, KnownLight& known,
                                                  Progress& progress) {
  params.sharp_lights = false;
  const auto key_of = [](const Receiver& r) { return KnownLight::Key{r.face, r.position}; };
  std::vector<Receiver> asked;
  for (const Receiver& r : receivers)
    if (known.at.try_emplace(key_of(r)).second) asked.push_back(r);
  LUXEL_TRY(const std::vector<Rgb> e, irradiance_at(s, scene, tracer, asked, params, progress));
  for (size_t k = 0; k < asked.size(); ++k) known.at[key_of(asked[k])] = e[k];
  std::vector<Rgb> out;
  for (const Receiver& r : receivers) out.push_back(known.at.at(key_of(r)));
  return out;
}

}  // namespace luxel::hierarchical
