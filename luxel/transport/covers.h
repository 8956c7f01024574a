// Places that something closer than an element of light shuts off: the floor under a rug, the wall
// behind a picture. Elements larger than the gap cannot carry its light.
#pragma once

#include <vector>

#include "luxel/trace/ray_tracer.h"
#include "luxel/transport/elements.h"

namespace luxel::transport {

/// The share of the cosine-weighted hemisphere that nothing within size_m shuts, for a place that
/// is *covered*: something lies within a quarter of size_m along its normal, and less than a tenth
/// is open. 1 for any other place. Under a cover at height h a place is covered from 1.3 h inwards
/// of its border: there (1 - x / sqrt(x^2 + h^2)) / 2 = 0.1. Neither corners nor niches wider than
/// a quarter of size_m are covers, because nothing lies before them. `from` lies just off the
/// surface (trace::offset_origin); 64 fixed rays.
float open_share(const trace::RayTracer& tracer, Vec3 from, Vec3 normal, float size_m);

/// The open share of each element, by its geometric normal.
std::vector<float> open_shares(const trace::RayTracer& tracer, const Elements& elements,
                               float size_m, float diagonal_m);

}  // namespace luxel::transport
