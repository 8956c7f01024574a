// Picking lights for next-event estimation: emissive triangles by power, punctual lights by what
// they bring.
#pragma once

#include <cstdint>
#include <vector>

#include "luxel/base/random.h"
#include "luxel/reference/surfaces.h"
#include "luxel/scene/scene.h"

namespace luxel::reference {

/// An emissive triangle, corners in the order of the mesh.
struct Emitter {
  scene::Triangle3 corners;
  Vec3 front;
  uint32_t instance = 0, triangle = 0;
  float pdf_area = 0;  ///< chance to be picked / area [1/m^2]
  bool two_sided = false;
};

struct Emitters {
  std::vector<Emitter> triangles;
  std::vector<double> chance_below;  ///< sum of the chances before each triangle; one extra entry
  /// Per drawn triangle: the pdf_area of its emitter; 0 for all others.
  std::vector<float> pdf_area;
};

/// Every triangle with emission and an area gets a chance in proportion to its power: mean
/// luminance times area times sides. A textured one gets a hundredth of its untextured chance at
/// least, so that a spot which the mean has missed can be picked.
Emitters collect_emitters(const scene::Scene& scene, const Surfaces& surfaces);

/// A point on an emitter. pdf_area is that of the emitter.
struct EmitterPoint {
  const Emitter* emitter = nullptr;
  Barycentric at;
  Vec3 position;
};
EmitterPoint sample_emitters(const Emitters& emitters, RandomStream& random);
/// The point that (x, y) of [0, 1)^2 stands for: x picks the triangle, and what is left of it and y
/// the place. Parts of the square have the chance of their area.
EmitterPoint emitter_point(const Emitters& emitters, double x, double y);

/// The scene's environment by brightness: rows, then pixels of a row, each in proportion to what
/// they send. Independent of how solvers divide it.
struct SkySampler {
  std::vector<double> row_below;     ///< power of the rows before each; one extra entry
  std::vector<double> column_below;  ///< per row: width + 1 sums of luminance
  double power() const { return row_below.empty() ? 0 : row_below.back(); }
};
SkySampler sky_sampler(const scene::Environment& map);

/// A direction of the map with its density per steradian; u in [0, 1)^2.
struct SkyPoint {
  Vec3 direction;
  float pdf = 0;
};
SkyPoint sample_sky(const scene::Environment& map, const SkySampler& sampler, RandomStream& random);
/// The density with which sample_sky finds a direction [1/sr].
float sky_pdf(const scene::Environment& map, const SkySampler& sampler, Vec3 direction);

/// Light of one punctual light, as it would arrive unshadowed: one sample of it.
struct LightSample {
  Rgb irradiance;  ///< on a surface that faces `towards`, divided by the chance to be picked
                   ///< [W/m^2]
  Vec3 towards;    ///< unit
  float reach_m = INFINITY;  ///< of its shadow ray
};
/// Picks one of the scene's punctual lights in proportion to what it would bring unshadowed. A sun
/// with a disc is sampled uniformly over it. No light: irradiance is zero. `scratch` is a buffer.
LightSample sample_punctual_lights(const scene::Scene& scene, const Receiver& at,
                                   RandomStream& random, std::vector<float>& scratch);

}  // namespace luxel::reference
