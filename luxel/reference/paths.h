// The estimator: many paths at once, one bounce after the other.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "luxel/base/random.h"
#include "luxel/base/vec2_double.h"
#include "luxel/reference/light_sampling.h"
#include "luxel/reference/surfaces.h"
#include "luxel/trace/ray_tracer.h"

namespace luxel::reference {

/// Everything that paths look at.
struct TracedScene {
  const scene::Scene& scene;
  const trace::RayTracer& tracer;
  Surfaces surfaces;
  Emitters emitters;
  SkySampler sky;
};
TracedScene traced_scene(const scene::Scene& scene, const trace::RayTracer& tracer);

enum class FirstHit : uint8_t { other, back, double_sided_back };

/// One of `count` parts of the unit square, all of one area. No count: the whole square.
struct Cell {
  uint32_t number = 0, count = 0;
};
/// A path's cells: of its k-th pair of random numbers. Each pair has an order of its own of all
/// cells, so that what two pairs bring together is as by chance.
struct Cells {
  Cell first{};
  uint64_t seed = 1;  ///< of the orders
  uint32_t drawn = 0;
};
Cell next_cell(Cells& cells);
/// The point of a cell that u of [0, 1)^2 stands for. Cells lie in columns, about as many as cells
/// in each.
DVec2 point_in(Cell cell, Vec2 u);

/// A path on its way. `value` is the light that it brings to its start: E / pi for a path that
/// started at a receiver with throughput 1.
struct Path {
  Receiver at;
  Rgb throughput{1, 1, 1};  ///< product of reflectances, over the chances to survive
  Rgb value{};
  RandomStream random;
  Cells cells{};                         ///< of its first directions and points on emitters
  FirstHit first_hit = FirstHit::other;  ///< what its first ray met
  bool shows_surface = false;            ///< of paths from the eye
};
Path path_from(const Receiver& at, RandomStream random);
/// A path from a camera's ray: its value is radiance, L + rho E / pi of the surface that the ray
/// met, or that of the surroundings.
Path path_from_eye(const TracedScene& world, Vec3 direction, const trace::Hit& hit,
                   RandomStream random);

/// A ray towards an emitter, and what its radiance is worth where it is seen.
struct EmitterRay {
  uint32_t path = 0;
  EmitterPoint point;
  Rgb factor;
};
struct LightAlongRay {
  uint32_t path = 0;
  Rgb light;
};

/// Buffers of one worker, reused from batch to batch.
struct PathBuffers {
  std::vector<uint32_t> active, next;
  std::vector<EmitterRay> emitter_rays;
  std::vector<LightAlongRay> along_shadow_rays;  ///< towards the sky, too
  std::vector<trace::Ray> rays, shadow_rays;
  std::vector<trace::Hit> hits;
  std::vector<Rgb> tint, arriving;  ///< of rays; share of shadow rays' light
  std::vector<float> punctual_weights;
};

/// Follows all paths that carry something to their ends, and adds what they gather to their values.
/// `bounces` < 0: no limit. Returns the number of rays.
uint64_t follow(const TracedScene& world, int bounces, std::span<Path> paths, PathBuffers& work);

}  // namespace luxel::reference
