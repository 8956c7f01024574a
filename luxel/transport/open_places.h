// Places of texels that lie in the open: what samples that lie inside of solids move to.
#pragma once

#include <optional>
#include <vector>

#include "luxel/atlas/atlas.h"
#include "luxel/trace/ray_tracer.h"
#include "luxel/transport/barriers.h"

namespace luxel::transport {

/// The scene in which rays look for open places.
struct PlaceSearch {
  const scene::Scene& scene;
  const atlas::Atlas& atlas;
  const trace::RayTracer& tracer;

  /// is_in_the_open() of a place of a surface.
  bool in_the_open(const scene::SurfacePoint& p) const;
};

/// The drawn triangles of each chart: those of chart c are all[first[c]] up to all[first[c + 1]].
struct ChartTriangles {
  std::vector<uint32_t> first, all;
};

ChartTriangles triangles_of_charts(const atlas::Atlas& atlas);

/// A place of a triangle in a texel.
struct ChartPlace {
  Vec2 texels;
  uint32_t triangle = 0;  ///< among all that are drawn
  Barycentric at;
};

/// The place of a grid of 4 x 4 in the texel's triangle that is nearest to the middle of those in
/// the open; nothing: none is, or all are and the sample (`is_open`), too.
std::optional<scene::SurfacePoint> open_place_of_grid(const PlaceSearch& in,
                                                      const atlas::Texel& texel, bool is_open);
/// An open place in all that the texel's chart covers, by whichever triangle: of charts thinner
/// than a texel the grid may meet nothing.
std::optional<ChartPlace> open_place_of_chart(const PlaceSearch& in, const atlas::Texel& texel,
                                              const ChartTriangles& charts);

}  // namespace luxel::transport
