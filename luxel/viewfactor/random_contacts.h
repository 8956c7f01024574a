// Polygons with blockers that touch them or nearly do, and their form factors in closed form.
#pragma once

#include <cstdint>
#include <vector>

#include "luxel/viewfactor/polygon.h"

namespace luxel::viewfactor {

/// Two polygons and opaque ones, and A_a F(a -> b) past them [m^2].
struct Contact {
  Polygon a, b;
  std::vector<Polygon> blockers;
  double exact = 0;
};

/// A square and another above it, with up to three plates, walls or slivers close to either, a
/// millionth to a tenth of the height away or touching it. They
/// are decided by the seed's random numbers from `index` on, which moves past them.
Contact random_contact(uint64_t seed, uint64_t& index);

}  // namespace luxel::viewfactor
