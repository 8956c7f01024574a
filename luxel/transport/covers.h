// Places that something closer than an element of light shuts off: the floor under a rug, the wall
// behind a picture. Elements larger than the gap cannot carry its light.
#pragma once

#include <vector>

#include "luxel/trace/ray_tracer.h"
#include "luxel/transport/elements.h"

namespace luxel::transport {

/// The share of the cosine-weighted hemisphere that is open, for a place that is *covered*: a cover
/// lies at a height of less than a quarter of size_m above it, and less than a tenth of the rays
/// leave the gap below. 1 for any other place. A ray leaves the gap when it gets half as high again
/// as the cover, or meets what does not lie over the place's own surface: the lower side of a strip
/// narrower than its gap sees the floor beside it. So places under a cover of height h are covered
/// from 1.3 h inwards of its border, and those of the cover's lower side from 1.3 h inwards of
/// theirs: there (1 - x / sqrt(x^2 + h^2)) / 2 = 0.1. Places beside a wall or under a table are
/// not, however small the room. `from` lies just off the surface (scene::off_surface); 64 fixed
/// rays, and as many back.
float open_share(const trace::RayTracer& tracer, Vec3 from, Vec3 normal, float size_m);

/// The size by which to look for covers: `size_m`, or 0, by which nothing is covered, where three
/// quarters of the emitting surface lie in gaps that are covered by `size_m`. Such light does not
/// come through the borders of gaps: elements have to carry it, as between two wide plates of
/// which one shines. One such lamp among others changes nothing: its light stays in its gap. Looks
/// at 256 places of the fronts that emit.
float size_for_covers(const scene::Scene& scene, const trace::RayTracer& tracer, float size_m);

/// The open share of each element, by its geometric normal.
std::vector<float> open_shares(const trace::RayTracer& tracer, const Elements& elements,
                               float size_m);

}  // namespace luxel::transport
