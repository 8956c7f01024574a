// Traces every element's cosine-distributed rays once and remembers what they met.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "luxel/atlas/atlas.h"
#include "luxel/base/part_store.h"
#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/light/light_layers.h"
#include "luxel/light/lights.h"
#include "luxel/light/texel_scene.h"
#include "luxel/scene/scene.h"
#include "luxel/solve/gather/rays/traced_hits.h"
#include "luxel/solve/gather/reuse/earlier_rays.h"
#include "luxel/solve/gather/trace/tile_watch.h"
#include "luxel/trace/ray_tracer.h"
#include "luxel/transport/elements.h"
#include "luxel/transport/own_side.h"

namespace luxel::gather {

/// The scene in which elements' rays are traced. The elements need not be those of a map.
struct TraceScene {
  const scene::Scene& scene;
  const atlas::Atlas& atlas;
  const transport::Elements& elements;
  const light::Lights& lights;
  const trace::RayTracer& tracer;
  const transport::OwnSides* sides = nullptr;  ///< of the map that rays will read; null: any side's
};
inline TraceScene trace_scene(const light::TexelScene& in,
                              const transport::OwnSides* sides = nullptr) {
  return {in.scene, in.atlas, in.elements, in.lights, in.tracer, sides};
}

struct TraceParams {
  uint64_t seed = 1;
  uint64_t memory_limit_bytes = UINT64_MAX;  ///< for hits; the rest goes to temporary files
  std::filesystem::path scratch_folder = ".";
  bool follows_near = false;   ///< rays that end nearby are followed on (near_paths.h)
  PartStore* parts = nullptr;  ///< where finished tiles are kept and found; null: nowhere
  PartStore* keep = nullptr;   ///< where each ray's end is kept for later bakes; null: nowhere
  const EarlierRays* earlier = nullptr;        ///< what an earlier bake's rays met; null: nothing
  const light::LightLayers* layers = nullptr;  ///< null: light is not told apart
  /// Layers as followed rays see them; null: `layers`.
  const light::LightLayers* followed_layers = nullptr;
  const TileWatch* watch = nullptr;  ///< null: nobody
  /// Whose members share tiles out; all get what is counted per element, and each keeps the hits of
  /// its tiles, in later rounds, too. Not with keep, earlier or watch. Null: no one shares.
  Team* team = nullptr;
};

/// A round of tracing: of each element the samples from those that it has up to `target`, so many
/// at most as 65535. An element that has enough keeps what it has. Of an element that has samples
/// already the new ones are at least as many, so that the old ones lie in the first half of all.
/// Directions are those of an Owen-scrambled Sobol sequence of its own per element,
/// cosine-distributed about the shading normal [Moreno05, eq. 3.7]; those below the triangle itself
/// are mirrored to above it. Errors: cancelled, disk full, another member of the team gives up;
/// hits are of no use then.
Status trace_more(const TraceScene& in, std::span<const uint16_t> target, const TraceParams& params,
                  TracedHits& hits, Progress& progress);

/// One round, the same number of samples for all elements.
Result<TracedHits> trace_hits(const TraceScene& in, int samples, const TraceParams& params,
                              Progress& progress);

/// Per element, the place on the other side of the surface, as a hit: its own where the surface has
/// but one side. Empty where nothing scatters light through.
std::vector<StoredHit> places_behind(const transport::OwnSides& sides,
                                     const transport::Elements& elements);

}  // namespace luxel::gather
