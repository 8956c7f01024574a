// Looking at the scene from elements through a hemicube. [Cohen85; Rodriguez06, sections 4.5, 5.6]
#pragma once

#include <functional>
#include <span>

#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/base/team.h"
#include "luxel/light/surroundings.h"
#include "luxel/solve/hemicube/receivers.h"
#include "luxel/trace/ray_tracer.h"
#include "luxel/transport/back_faces.h"

namespace luxel::hemicube {

/// The mesh that elements look at, whose own elements send light.
struct Senders {
  const scene::Scene& scene;
  const trace::RayTracer& tracer;
  const Mesh& mesh;
  const Receivers& receivers;
  const light::Surroundings& around;  ///< their soft light is seen by pixels, too
  /// The light of emissive surfaces is taken from the pixels that see them. False when it is
  /// computed otherwise and would count twice.
  bool emission_by_pixels = false;
};

/// Where elements look from: a part of transport::Elements.
struct Viewpoint {
  Vec3 position, normal, geometric_normal;
};

/// The shares of one element's hemisphere, by what it sees there. With those below its own
/// triangle, which are black, they sum to 1.
struct View {
  /// Shares by the senders' elements, in the order of their numbers: a form factor each. Of what a
  /// pixel sees of a triangle with light per vertex, each vertex has its barycentric part, so a sum
  /// over these times the vertices' radiosity is the sum over pixels of the linear radiosity there.
  std::vector<uint32_t> element;
  std::vector<float> share;
  Rgb emitted{};             ///< irradiance from emissive surfaces and the sky [W/m^2]
  float back = 0;            ///< share of backs of one-sided surfaces, which are black
  float two_sided_back = 0;  ///< share of backs of two-sided surfaces, which shine like their front
};

inline transport::BackFaceShares back_faces(const View& v) { return {v.back, v.two_sided_back}; }
/// An element lies inside a solid (transport/back_faces.h).
inline bool is_hidden(const View& v) { return transport::is_hidden(back_faces(v)); }
inline bool is_enclosed(const View& v) { return transport::is_enclosed(back_faces(v)); }

/// CPU time spent, over all threads.
struct LookSeconds {
  double visibility = 0;  ///< tracing
  double summation = 0;   ///< everything else
};

/// Pixels of a hemicube: its top and four half sides.
inline uint64_t pixels_of(int resolution) {
  return 3 * uint64_t(resolution) * uint64_t(resolution);
}

class LookDevice;

struct LookParams {
  int resolution = 64;           ///< pixels along an edge of the hemicube's top, even
  LookDevice* device = nullptr;  ///< what looks; null: the processor
  Team* team = nullptr;          ///< whose members share groups out, without a device; null: none
};

struct Pixel {
  Vec3 direction;    ///< unit, about +z
  float factor = 0;  ///< F(point -> pixel)
};
/// All pixels of a hemicube, in tiles of 4 x 4 of a face: a packet of rays that stay together.
/// Errors: cancelled.
Result<std::vector<Pixel>> pixels_in_tiles(int resolution, Progress& progress);

/// Gets the number of a viewpoint, and what is seen from it, valid during the call.
using OnView = std::function<Status(size_t, const View&)>;

/// Viewpoints are looked from in groups of so many neighbours, in order, by one thread each.
inline constexpr size_t kTileElements = 16;

/// Calls done(i, view) for every viewpoint, from many threads; the view is only valid during the
/// call. With a team for those groups that are this member's. The stage "hemicubes". Errors:
/// cancelled, what done returns; those of params.device; another member of the team gives up.
Result<LookSeconds> look(const Senders& senders, std::span<const Viewpoint> from,
                         const LookParams& params, const OnView& done, Progress& progress);

/// One viewpoint per element, in their order.
std::vector<Viewpoint> viewpoints(const transport::Elements& elements);

}  // namespace luxel::hemicube
