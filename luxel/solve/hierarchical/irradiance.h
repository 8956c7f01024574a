// Irradiance at points: what each sees of every face, past every face in between, in closed form.
// [Hardt96, chapter 6]
#pragma once

#include "luxel/scene/off_surface.h"
#include "luxel/solve/hierarchical/solve.h"
#include "luxel/solve/hierarchical/unlinked_lights.h"

namespace luxel::hierarchical {

/// A point of the front side of a face.
struct Receiver {
  DVec3 position;
  DVec3 normal;            ///< for cosines, unit
  DVec3 geometric_normal;  ///< no light comes from below the plane it spans
  uint32_t face = kNone;   ///< does not block
  float size_m = 0;        ///< Face::size_m

  /// Where rays start.
  Vec3 start() const {
    return scene::off_surface(to_float(position), to_float(geometric_normal), size_m);
  }
};

struct PointParams {
  /// Sources are taken apart, or from afar, so that the light of each is off by less than this part
  /// of the scene's mean irradiance.
  double tolerance = 1e-4;
  /// True: sharp lights count, points and directions, whose shadows have no penumbra. Without them
  /// light is continuous but where faces touch.
  bool sharp_lights = true;
};

/// A face as a point sees it.
struct Seen {
  uint32_t face = 0;
  double visible = 0, whole = 0;  ///< form factors, past others and alone
  Rgb irradiance;                 ///< E that comes from it [W/m^2]
};

/// E at each receiver [W/m^2]: light of all faces by their radiosity, which is linear over the
/// solution's elements; of punctual lights; and of the background. Past blockers it is the sum
/// over what the point sees of each source, cut out of it by the shadows that blockers throw from
/// the point: the backprojection of [Hardt96, section 6.2], by clipping where the thesis
/// triangulates, so that nothing has to be classified by rays. Errors: cancelled.
Result<std::vector<Rgb>> irradiance_at(const Solution& solution, const scene::Scene& scene,
                                       const trace::RayTracer& tracer,
                                       std::span<const Receiver> receivers,
                                       const PointParams& params, Progress& progress);

/// E of sharp lights alone. Errors: cancelled.
Result<std::vector<Rgb>> sharp_irradiance_at(const scene::Scene& scene,
                                             const trace::RayTracer& tracer,
                                             std::span<const Receiver> receivers,
                                             Progress& progress);

/// The faces that a receiver sees at all, the brightest first. Punctual lights and background are
/// left out.
std::vector<Seen> sources_at(const Solution& solution, const trace::RayTracer& tracer,
                             const Receiver& receiver, const PointParams& params);

/// The backprojection of a receiver onto a face: the part of it above the receiver's horizon, and
/// what of that the receiver sees, as convex pieces, in the world.
struct Backprojection {
  Polygon source;
  std::vector<Polygon> visible;
};
/// The part of one face that the receiver sees past all others. [Hardt96, section 6.2]
Backprojection backproject(const Solution& solution, const Receiver& receiver, uint32_t face);

/// The receiver at a place of a face, where vertex normals say so on the smooth surface.
Receiver receiver_at(const Solution& solution, const scene::Scene& scene,
                     const trace::RayTracer& tracer, uint32_t face, DVec3 place);

}  // namespace luxel::hierarchical
