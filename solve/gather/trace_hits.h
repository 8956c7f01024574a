// Shoots every element's cosine-distributed rays once and remembers what they met.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "atlas/atlas.h"
#include "base/part_store.h"
#include "base/progress.h"
#include "base/result.h"
#include "scene/scene.h"
#include "solve/gather/earlier_rays.h"
#include "solve/gather/hit_store.h"
#include "trace/ray_tracer.h"
#include "transport/elements.h"
#include "transport/light_layers.h"
#include "transport/lights.h"

namespace luxel::gather {

struct TraceParams {
  uint64_t seed = 1;
  uint64_t memory_limit_bytes = UINT64_MAX;  ///< for hits; the rest goes to temporary files
  std::filesystem::path scratch_folder = ".";
  /// What rays look for that are followed on where they end nearby (near_paths.h); null: none are.
  const transport::Lights* near_lights = nullptr;
  PartStore* parts = nullptr;  ///< where finished tiles are kept and found; null: nowhere
  PartStore* keep = nullptr;   ///< where each ray's end is kept for later bakes; null: nowhere
  const EarlierRays* earlier = nullptr;  ///< what an earlier bake's rays met; null: nothing
  const transport::LightLayers* layers = nullptr;  ///< null: light is not told apart
};

/// What rays have met, in rounds of tracing: each adds samples to some of the elements.
struct TracedHits {
  std::vector<HitStore> rounds;
  std::vector<uint16_t> samples;    ///< per element, of all rounds
  std::vector<uint8_t> last_round;  ///< per element, that which added to it last
  /// Per element, how many of its rays left the scene, and how many met the back of a one-sided
  /// surface close by or far: those bring no light, and many of them mean that the element lies
  /// inside a solid (kept for leak repair).
  /// Backs of double-sided surfaces send the light of their front (docs/method/gather.md); they are
  /// counted too.
  std::vector<uint16_t> escaped, met_back, met_double_sided_back;
  /// Per element, what its escaped rays saw of the surroundings' soft light, and what rays brought
  /// that were followed on, but for what they read in the map in the end: the sum of radiances,
  /// that of their squared luminances, and that of the first half of the samples' luminances minus
  /// the other half's.
  std::vector<Rgb> sky;
  std::vector<float> sky_luminance2, sky_first_less_second;
  std::vector<Rgb> sky_by_layer;  ///< with layers: `sky`, layer by layer for each element
  /// With EarlierRays::sent, per element: by how much more its rays bring of the light of then than
  /// they did, as a sum of radiosities; and 1 where of some of them nothing was known, so that it
  /// is not all. Empty otherwise.
  std::vector<Rgb> change;
  std::vector<uint8_t> unknown;
  uint64_t rays = 0;       ///< that were traced
  uint64_t rays_kept = 0;  ///< that an earlier bake had traced

  size_t size() const { return samples.size(); }
  uint64_t bytes_in_memory() const;
  uint64_t bytes_in_file() const;
};

/// Whether an element lies inside a solid, under a floor or behind a wall: most of what it sees is
/// the back of one-sided surfaces. Its own light means nothing to anybody.
inline bool is_hidden(const TracedHits& hits, size_t element) {
  return 2 * int(hits.met_back[element]) > int(hits.samples[element]);
}

/// Nothing traced yet. `layers`: how many there are; 0: light is not told apart.
TracedHits no_hits(size_t elements, size_t layers = 0);

/// A round of tracing: of each element the samples from those that it has up to `target`, so many
/// at most as 65535. An element that has enough keeps what it has. Of an element that has samples
/// already the new ones are at least as many, so that the old ones lie in the first half of all.
/// Directions are those of an Owen-scrambled Sobol sequence of its own per element,
/// cosine-distributed about the shading normal [Moreno05, eq. 3.7]; those below the triangle itself
/// are mirrored to above it. Errors: cancelled, disk full; hits are of no use then.
Status trace_more(const scene::Scene& scene, const atlas::Atlas& atlas,
                  const transport::Elements& elements, const transport::Surroundings& around,
                  const trace::RayTracer& tracer, std::span<const uint16_t> target,
                  const TraceParams& params, TracedHits& hits, Progress& progress);

/// One round, the same number of samples for all elements.
Result<TracedHits> trace_hits(const scene::Scene& scene, const atlas::Atlas& atlas,
                              const transport::Elements& elements,
                              const transport::Surroundings& around, const trace::RayTracer& tracer,
                              int samples, const TraceParams& params, Progress& progress);

/// Per element, the place on the other side of the surface, as a hit: its own where the surface has
/// but one side. Empty where nothing scatters light through.
std::vector<StoredHit> places_behind(const scene::Scene& scene, const atlas::Atlas& atlas,
                                     const atlas::TexelMap& map,
                                     const transport::Elements& elements);

}  // namespace luxel::gather
