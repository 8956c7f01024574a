// What the rays of one element met, as counts, hits and light. docs/method/gather.md, docs/method/rebake.md
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "solve/gather/earlier_rays.h"
#include "solve/gather/element_rays.h"
#include "solve/gather/near_paths.h"
#include "solve/gather/trace_hits.h"

namespace luxel::gather {

/// What rays meet, and what they see beyond.
struct RayWorld {
  const scene::Scene& scene;
  const atlas::Atlas& atlas;
  const transport::Surroundings& around;
  const NearWorld* near = nullptr;  ///< null: rays are not followed on
  const transport::LightLayers* layers = nullptr;
  const RadiosityMap* sent = nullptr;  ///< see EarlierRays
  uint64_t seed = 1;
};

/// A path of a tile's elements that has been followed to its end.
struct FollowedPath {
  uint32_t element = 0;
  uint32_t ray = 0;  ///< of its batch
  float first_m = 0;
  FollowedRay brought;
  StoredHit hit;
};

/// What some rays see outside.
struct OutsideLook {
  std::vector<uint32_t> rays;  ///< of the batch
  std::vector<Vec3> directions;
  std::vector<Rgb> light;  ///< radiance
};

/// Everything a worker needs, reused from element to element.
struct RayWork {
  RayBatch batch;
  std::vector<trace::Hit> hits;  ///< of the batch's rays, where they were traced
  std::vector<Rgb> tint;         ///< of what rays have passed; empty where nothing has a colour
  NearWork near;                 ///< near.paths: those that wait to be followed on
  std::vector<FollowedPath> followed;  ///< of a tile's elements so far
  HitTile other_hits, followed_hits;   ///< of a tile: than those of rays followed on, and those
  std::vector<uint32_t> ends_of;  ///< per element of a tile: one past the last of RayTile::ends
  OutsideLook outside;
  /// Where rays of an earlier bake are known: those that may meet something else, which have a
  /// direction, and of them those that are traced again; ascending.
  std::vector<uint32_t> maybe, again;
  std::vector<uint8_t> marked;  ///< per ray, 1: traced again
};

/// An element's rays of an earlier bake.
struct EarlierElement {
  std::span<const RayEnd> ends;
  std::span<const StoredHit> hits;
  /// Light of those that escaped, as they would see it now; null: not known, and all rays of the
  /// batch need a direction when they are merged.
  const EscapedLight* escaped = nullptr;
  std::span<const FollowedRay> followed{};  ///< those of `ends`
  float near_m = 0;                         ///< RayTile::near_m
  bool follows_again = true;                ///< they may all bring something else
};

/// The place of the map at a point of the scene.
StoredHit store(const atlas::Atlas& atlas, const scene::SurfacePoint& p, StoredHit::Ray ray);

/// Notes radiance of a ray that has left the scene, of which the light of all layers knows already.
void add_sky(const RayWorld& world, Rgb radiance, size_t element, TracedHits& out);
/// A hit that an element's rays have won (1) or lost (-1), if that is wanted; not where something
/// is unknown, as all is looked up there.
void note_change(const RayWorld& world, StoredHit hit, float sign, size_t element, TracedHits& out);

/// Counts what the rays of the batch met, which have all been traced, and adds them to `tile`.
/// Those that are to be followed on are added to work.near.paths.
void sort_rays(const RayWorld& world, RayWork& work, size_t element, Samples samples,
               TracedHits& out, RayTile& tile);
/// The same where only work.again have been traced, and the others met what they met before.
void merge_rays(const RayWorld& world, RayWork& work, size_t element, Samples samples,
                const EarlierElement& before, TracedHits& out, RayTile& tile);

}  // namespace luxel::gather
