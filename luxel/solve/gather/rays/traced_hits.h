// Hits of the rays of all elements, round by round.
#pragma once

#include <cstdint>
#include <vector>

#include "luxel/base/bytes_per_entry.h"
#include "luxel/base/mapped_memory.h"
#include "luxel/base/team.h"
#include "luxel/base/vec.h"
#include "luxel/solve/gather/rays/cell_guide.h"
#include "luxel/solve/gather/rays/hit_store.h"
#include "luxel/transport/back_faces.h"

namespace luxel::gather {

class RayDevice;

/// Hits of rays, in rounds of tracing: each adds samples to some of the elements.
struct TracedHits {
  std::vector<HitStore> rounds;
  /// Where the hits of all rounds are, whose stores are empty; null: in those.
  RayDevice* device = nullptr;
  /// The team that has traced them: each member has the hits of its tiles, in all rounds. Null: all
  /// are here.
  Team* team = nullptr;
  std::vector<uint32_t> owner;      ///< with a team, per tile, its member's rank
  std::vector<uint16_t> samples;    ///< per element, of all rounds that count
  std::vector<uint8_t> last_round;  ///< per element, that which added to it last
  /// Per element, the first round that counts: 0, or that in which its rays began anew; and the
  /// level of the guide which they follow since then, 0 for none.
  std::vector<uint8_t> first_round, guided;
  Guide guide;
  /// Per element, rays whose ends the next three count: none that follow the guide.
  std::vector<uint16_t> counted;
  /// Per element, how many of those rays left the scene, and how many met the back of a one-sided
  /// surface close by or far: those bring no light, and many of them mean that the element lies
  /// inside a solid (kept for leak repair).
  /// Backs of double-sided surfaces send the light of their front (docs/method/gather.md); they are
  /// counted too.
  std::vector<uint16_t> escaped, met_back, met_double_sided_back;
  /// Per element, what its escaped rays saw of the surroundings' soft light, and what rays brought
  /// that were followed on, but for what they read in the map in the end: the sum of radiances,
  /// that of their squared luminances, and that of the first half of the samples' luminances minus
  /// the other half's.
  MappedVector<Rgb> sky;
  MappedVector<float> sky_luminance2, sky_first_less_second;
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

/// The arrays of TracedHits that no_hits() may put into mapped memory.
inline constexpr uint64_t kBroughtBytesPerElement = bytes_per_entry(
    &TracedHits::sky, &TracedHits::sky_luminance2, &TracedHits::sky_first_less_second);
/// Memory of TracedHits per element besides the hits themselves, in one round [bytes]: its own
/// arrays, and where each element's hits end.
inline constexpr uint64_t kTracedBytesPerElement =
    bytes_per_entry(&TracedHits::samples, &TracedHits::last_round, &TracedHits::first_round,
                    &TracedHits::guided, &TracedHits::counted, &TracedHits::escaped,
                    &TracedHits::met_back, &TracedHits::met_double_sided_back) +
    kBroughtBytesPerElement + bytes_per_entry(&HitTile::end);
/// The part of it that gather() gives back when it knows which elements are enclosed.
inline constexpr uint64_t kEndCountBytesPerElement =
    bytes_per_entry(&TracedHits::escaped, &TracedHits::met_double_sided_back);

/// The hits of a tile are here.
inline bool has_tile(const TracedHits& hits, size_t tile) {
  return !hits.team || hits.owner[tile] == hits.team->rank();
}

/// An element lies inside a solid, under a floor or behind a wall (transport::is_hidden).
inline bool is_hidden(const TracedHits& hits, size_t element) {
  return transport::is_hidden(
      transport::BackFaces{.rays = hits.counted[element], .one_sided = hits.met_back[element]});
}
/// The backs that an element's rays met.
inline transport::BackFaces back_faces(const TracedHits& hits, size_t element) {
  return {hits.counted[element], hits.met_back[element], hits.met_double_sided_back[element]};
}

/// An element's rays follow the guide.
inline bool is_guided(const TracedHits& hits, size_t element) { return hits.guided[element] != 0; }
/// Rays of an element per sample.
float rays_per_sample(const TracedHits& hits, size_t element);

/// Forgets what an element's rays have brought, but for what their ends tell: the next round begins
/// anew, and follows the guide at a level.
void begin_guided(TracedHits& hits, size_t element, int level);

/// Nothing traced yet. `layers`: how many there are; 0: light is not told apart. What rays brought
/// lies in `memory` where there is one, if that has room.
TracedHits no_hits(size_t elements, size_t layers = 0,
                   std::shared_ptr<MappedMemory> memory = nullptr);

}  // namespace luxel::gather
