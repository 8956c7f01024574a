// Rays that end nearby, or on the back of a surface, are followed on.
//
// The light in a texel of the map stands for all of the texel. A ray that ends nearer than a texel
// is wide asks for less: for the dark inside of a joint between two solids, whose texel lies for
// the most part in the sun, or for the bright edge of a sill. There the light of the place itself
// is worked out: what comes straight from lights, and one more ray, which ends farther away and
// reads the map there, or is followed on again. The map holds the light of fronts only, so the back
// of a double-sided surface is treated alike, however far it is. So is a place whose own side of a
// wall has no texel. docs/method/gather.md
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "luxel/atlas/atlas.h"
#include "luxel/light/shadow_rays.h"
#include "luxel/scene/scene.h"
#include "luxel/trace/ray_tracer.h"
#include "luxel/transport/own_side.h"

namespace luxel::gather {

/// transport::texel_width_m() per drawn triangle.
std::vector<float> texel_widths_m(const scene::Scene& scene, const atlas::Atlas& atlas);

/// A path that goes on from where an element's ray ended.
struct NearPath {
  uint32_t element = 0;
  uint32_t sample = 0;       ///< of its element: its random numbers are the same in any round
  uint32_t ray = 0;          ///< of its element's batch
  uint64_t seed = 0;         ///< of its element
  bool second_half = false;  ///< of its element's samples
  uint32_t doublings = 0;    ///< StoredHit::Ray
  Rgb throughput{1, 1, 1};   ///< of reflectances and glass, over the chances to go on
  Rgb light{};               ///< radiance that it has brought so far
  trace::Hit hit;            ///< where it is
  Vec3 direction;            ///< of its last ray; before the first step it has none
  /// The most that the start of its first step is away from the start of its element's own ray [m]:
  /// the ray's length plus the lift of the place where the surface bulges.
  float first_m = 0;
  bool is_plain = true;  ///< it met a front there, and has taken one step at most
};
/// The part of a sample that the path's ray is.
inline float weight_of(const NearPath& path) { return std::ldexp(1.0f, -int(path.doublings)); }

/// The scene that paths look at.
struct NearScene {
  const scene::Scene& scene;
  const atlas::Atlas& atlas;
  const light::Lights& lights;
  const trace::RayTracer& tracer;
  std::span<const float> texel_width_m;
  const light::LightLayers* layers = nullptr;  ///< null: light is not told apart
  const transport::OwnSides* sides = nullptr;  ///< null: every place has a texel of its own side
};

/// Buffers of one thread.
struct NearBuffers {
  std::vector<NearPath> paths, going_on;
  std::vector<light::Receiver> receivers;  ///< where the paths are
  std::vector<light::LightAt> light;
  std::vector<trace::Ray> rays;
  std::vector<trace::Hit> hits;
  std::vector<Rgb> tint;
  light::ShadowRayBatch batch;
  /// With layers: the radiance that paths bring, times their weights, is added to these, too, layer
  /// by layer for each element.
  std::span<Rgb> by_layer;
};

/// Takes each of buffers.paths from its near hit to where it ends, in order of their rays within
/// each length; `end` gets them one by one: `hit` is far away, on the back of a one-sided surface,
/// or nothing; throughput is that up to there. A path that has died comes with throughput 0.
/// Returns the number of rays.
template <class End>
uint64_t follow_near(const NearScene& in, NearBuffers& buffers, const End& end);

/// One step of all of buffers.paths: the light of where they are, and rays on. Paths that end there
/// come first in buffers.going_on, with throughput 0. `depth`: how many steps there have been.
uint64_t step_near(const NearScene& in, uint64_t depth, NearBuffers& buffers);

// The parts of a step of one path. Between receiver_of() and go_on() the caller adds the light that
// arrives there, times throughput over pi, to NearPath::light.
/// Takes on what the surface there reflects. False: nothing, and the path ends.
bool reflect(const NearScene& in, NearPath& path);
/// Where a path is lit, and its ray on starts. `depth`: how many steps there have been.
light::Receiver receiver_of(const NearScene& in, uint64_t depth, NearPath& path);
/// Draws its ray on, path.direction from at.position. False: it ends there, by chance, in
/// proportion to what it carries.
bool go_on(const light::Receiver& at, uint64_t depth, NearPath& path);

/// Existence of an answer in the map for a place that a path has met. where_own: there is one if
/// own_lookup() reads something there.
enum class MapAnswers : uint8_t { yes, no, where_own };
MapAnswers map_answers(const NearScene& in, const trace::Hit& hit);
/// The least length of a ray to a front at which the map has an answer [m].
float near_m(const NearScene& in, const trace::Hit& hit);
/// True: the map has no answer for the place that a path has met, and light comes along the path.
bool goes_on(const NearScene& in, const NearPath& path);

template <class End>
uint64_t follow_near(const NearScene& in, NearBuffers& buffers, const End& end) {
  uint64_t rays = 0;
  for (uint64_t depth = 0; !buffers.paths.empty(); ++depth) {
    rays += step_near(in, depth, buffers);
    buffers.paths.clear();
    for (const NearPath& path : buffers.going_on) {
      if (!goes_on(in, path)) {
        end(path);
        continue;
      }
      buffers.paths.push_back(path);
      buffers.paths.back().is_plain = false;
    }
  }
  return rays;
}

}  // namespace luxel::gather
