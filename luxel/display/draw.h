// Pictures of surfaces: what a camera sees when a function says how each point looks, above all
// when surfaces are lit only by a solver's answer.
#pragma once

#include <functional>

#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/display/tone_map.h"
#include "luxel/image/image.h"
#include "luxel/scene/scene.h"
#include "luxel/trace/ray_tracer.h"

namespace luxel::display {

/// Radiance that a ray of the camera sees behind all surfaces.
using SeenBehind = std::function<Rgb(const trace::Ray&)>;

/// The size of a picture [pixels], and its rays.
struct DrawParams {
  int width = 960, height = 720;
  int samples_per_axis = 3;           ///< n x n rays per pixel that differs from a neighbour
  float brightest_behind = INFINITY;  ///< what is seen of the surroundings is cut off there
  bool backs = false;                 ///< of one-sided materials are seen, too
  SeenBehind behind = {};             ///< instead of the surroundings
};

/// Radiance or colour that the surface shows to the camera's ray. Many threads call it at once.
using SeenAt = std::function<Rgb(const trace::Hit&)>;

/// Draws the surfaces that a camera sees, 4 channels (A = share of the pixel that shows a surface).
/// Back faces of one-sided materials are invisible, as in a real-time engine, so a closed room can
/// be looked into from outside. Where no surface is seen: the surroundings.
Result<image::Image> draw_seen(const scene::Scene& scene, const trace::RayTracer& tracer,
                               const scene::Camera& camera, const SeenAt& seen_at,
                               const DrawParams& params, Progress& progress);

/// E [W/m^2] of the front side at a surface point.
using IrradianceAt = std::function<Rgb(const scene::SurfacePoint&)>;

/// Radiance that a surface sends to the eye: emitted light and that which it reflects or scatters
/// through, L + B / pi. An unlit surface sends the radiance of its colour, whatever falls on it.
Rgb seen_radiance(const scene::Scene& scene, const scene::SurfacePoint& p,
                  const IrradianceAt& irradiance_at);

/// draw_seen of seen_radiance.
Result<image::Image> draw(const scene::Scene& scene, const trace::RayTracer& tracer,
                          const scene::Camera& camera, const IrradianceAt& irradiance_at,
                          const DrawParams& params, Progress& progress);

/// True where there is nothing behind a scene's surfaces.
bool has_void(const scene::Scene& scene);

/// tone_map() of a picture of radiance; where has_void() there is kGreyOfNothing beside surfaces.
image::Image8 on_screen(const scene::Scene& scene, image::Image picture, float exposure,
                        ToneMap curve = ToneMap::shoulder);

}  // namespace luxel::display
