// Sorts the rays of one element by what they met, into counts, hits and light.
// docs/method/gather.md, docs/method/rebake.md
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "luxel/solve/gather/reuse/retraced_rays.h"
#include "luxel/solve/gather/trace/near_paths.h"
#include "luxel/solve/gather/trace/trace_hits.h"
#include "luxel/transport/own_lookups.h"

namespace luxel::gather {

/// The scene that rays meet, and the surroundings that they see beyond.
struct RayScene {
  const scene::Scene& scene;
  const atlas::Atlas& atlas;
  const light::Surroundings& around;
  const NearScene* near = nullptr;  ///< null: rays are not followed on
  const light::LightLayers* layers = nullptr;
  const RadiosityMap* sent = nullptr;  ///< see EarlierRays
  uint64_t seed = 1;
  const transport::OwnSides* sides = nullptr;  ///< null: all four texels around a hit are read
};

/// A path of a tile's elements that has been followed to its end.
struct FollowedPath {
  uint32_t element = 0;
  uint32_t ray = 0;  ///< of its batch
  float first_m = 0;
  FollowedRay brought;
  StoredHit hit;
};

/// Light that some rays see outside.
struct OutsideLook {
  std::vector<uint32_t> rays;  ///< of the batch
  std::vector<Vec3> directions;
  std::vector<Rgb> light;  ///< radiance
};

/// Where the map is read for what rays of the batch have met.
struct PlacesMet {
  struct OfRay {
    transport::LookupPlace place;
    bool has_no_texel = false;  ///< a wall leaves none on the place's own side
  };
  std::vector<OfRay> of_ray;  ///< of those that have met something the map has an answer for
  // Beside walls they are looked up together.
  std::vector<uint32_t> beside_walls;  ///< of the batch
  std::vector<scene::SurfacePoint> points;
  std::vector<transport::LookupPlace> own;
  static constexpr size_t kKnownSpots = 4096;
  transport::LookupBuffers lookups;

  PlacesMet() { lookups.known.resize(kKnownSpots); }
};

/// Everything a worker needs, reused from element to element.
struct RayBuffers : RetraceBuffers {
  NearBuffers near;                    ///< near.paths: those that wait to be followed on
  std::vector<FollowedPath> followed;  ///< of a tile's elements so far
  HitTile other_hits, followed_hits;   ///< of a tile: than those of rays followed on, and those
  std::vector<uint32_t> ends_of;  ///< per element of a tile: one past the last of RayTile::ends
  OutsideLook outside;
  PlacesMet places;
};

/// True: the surface that a ray has met sends light towards it.
bool shows_light(const RayScene& in, const trace::Hit& hit);

/// Where light at a point of the scene is read from the map, on its own side of every wall.
StoredHit store(const RayScene& in, const scene::SurfacePoint& p, StoredHit::Ray ray,
                transport::MayBeInside inside = transport::MayBeInside::no);
StoredHit store(const transport::LookupPlace& place, StoredHit::Ray ray);

/// Notes radiance of a ray that has left the scene, of which the light of all layers knows already.
void add_sky(const light::LightLayers* layers, Rgb radiance, size_t element, TracedHits& out);
/// A hit that an element's rays have won (1) or lost (-1), if that is wanted; not where something
/// is unknown, as all is looked up there.
void note_change(const RayScene& in, StoredHit hit, float sign, size_t element, TracedHits& out);

/// Counts what the rays of the batch met, which have all been traced, unless they are guided, and
/// adds them to `tile`.
/// Those that are to be followed on are added to buffers.near.paths.
void sort_rays(const RayScene& in, RayBuffers& buffers, size_t element, Samples samples,
               TracedHits& out, RayTile& tile);
/// Counts what the rays of the batch met where only buffers.retraced have been traced, and the
/// others met what they met before; else as sort_rays().
void merge_rays(const RayScene& in, RayBuffers& buffers, size_t element, Samples samples,
                const EarlierElement& before, TracedHits& out, RayTile& tile);

}  // namespace luxel::gather
