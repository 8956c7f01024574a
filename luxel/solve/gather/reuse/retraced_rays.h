// The rays of an earlier bake that are traced again, all those of a tile together.
// docs/method/rebake.md
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "luxel/solve/gather/reuse/earlier_rays.h"
#include "luxel/transport/elements.h"

namespace luxel::gather {

/// An element's rays, what those met that were traced, and which of an earlier bake's rays are
/// traced again; reused from element to element.
struct RetraceBuffers {
  RayBatch batch;
  std::vector<trace::Hit> hits;  ///< of the batch's rays, where they were traced
  std::vector<Rgb> tint;         ///< of what rays have passed; empty where nothing has a colour
  /// Where rays of an earlier bake are known: those that may meet something else, which have a
  /// direction, and of them those that are traced again; ascending.
  std::vector<uint32_t> maybe, retraced;
  std::vector<uint8_t> marked;  ///< per ray, 1: traced again
};

/// Takes the rays of a tile's elements one after another from what an earlier bake knew.
struct EarlierCursor {
  const RayTile* tile = nullptr;
  size_t next_ray = 0, next_followed = 0;
  EarlierElement of{};

  /// Those of the tile's k-th element, whose rays are `count`. False: they are not known.
  bool advance(size_t k, size_t count, bool knows_escaped);
};

/// The data by which rays to be retraced are chosen.
struct RetraceScene {
  const transport::Elements& elements;
  const EarlierRays& earlier;
  const CellCones& cell_cones;
  bool tints = false;  ///< RayTracer::has_tints()
  /// transport::lookups_near(): hits that may be read elsewhere now; empty: none.
  std::span<const uint64_t> doubtful{};
};

/// Finds the rays of an element that may meet something else than in the earlier bake, and of those
/// that were followed on the ones that may bring something else. Of rays that escaped through
/// something coloured the colour is not known. All that do are in buffers.retraced then, are 1 in
/// buffers.marked, and have directions in the batch, which is filled unless there are none.
void choose_retraced(const RetraceScene& in, size_t element, Vec3 origin, uint64_t seed,
                     Samples samples, const EarlierElement& before, RetraceBuffers& buffers);

/// The rays of a tile's elements that are traced again: packets of a few elements' rays are full
/// where those of one would be nearly empty.
struct RetracedRays {
  std::vector<EarlierElement> known;
  std::vector<uint8_t> is_known;  ///< per element; 0: nothing is known of its rays
  std::vector<uint32_t> end;      ///< per element: one past its last ray in what follows
  std::vector<uint32_t> ray, sample;
  std::vector<trace::Ray> rays;
  std::vector<trace::Hit> hits;
  std::vector<Rgb> tints;  ///< empty where nothing has a colour

  /// Numbers of the k-th element's rays.
  std::span<const uint32_t> rays_of(size_t k) const {
    const uint32_t first = k == 0 ? 0 : end[k - 1];
    return std::span(ray).subspan(first, end[k] - first);
  }
  const EarlierElement* of(size_t k) const { return is_known[k] ? &known[k] : nullptr; }
};

void clear(RetracedRays& rays);
/// Adds buffers.retraced as those of the next element. `before` is what is known of it; null:
/// nothing.
void add_retraced(const EarlierElement* before, const RetraceBuffers& buffers, RetracedRays& out);
void retrace(const trace::RayTracer& tracer, RetracedRays& rays);
/// Puts the rays of the k-th element, which is known, back into `buffers`, as if they had been
/// traced there.
void take_retraced(const RetracedRays& rays, size_t k, RetraceBuffers& buffers);

}  // namespace luxel::gather
