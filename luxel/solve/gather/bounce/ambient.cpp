#include "luxel/solve/gather/bounce/ambient.h"

#include <algorithm>

namespace luxel::gather {

std::vector<Rgb> with_ambient(const transport::Elements& elements, std::span<const Rgb> direct) {
  Rgb sent{}, rho{};
  for (size_t i = 0; i < direct.size(); ++i)
    sent += elements.reflectance[i] * direct[i], rho += elements.reflectance[i];
  const float part = 1 / float(std::max<size_t>(direct.size(), 1));
  const Rgb left = Rgb{1, 1, 1} - rho * part;
  const Rgb ambient = sent * part * Rgb{1 / left.x, 1 / left.y, 1 / left.z};
  std::vector<Rgb> out(direct.begin(), direct.end());
  for (Rgb& e : out) e += ambient;
  return out;
}

}  // namespace luxel::gather
