// Local illumination: surfaces under one light that knows no shadows and no other surface, to hold
// global illumination against. [Rodriguez06, sections 4.4, 5.3 and 5.4] docs/method/display.md
//
// Colours here are what a screen shows, linear in [0, 1], not radiance: the paper's materials and
// lights are colours between black and white, and sums are clipped at white.
#pragma once

#include <cstdint>

#include "luxel/display/draw.h"

namespace luxel::display {

/// The terms that are added: Colour, Ambient, Diffuse, Specular; computed at the corners of
/// triangles and interpolated, or (P) per pixel with interpolated vectors.
enum class LocalTechnique : uint8_t { c, ca, cad, cas, cads, cas_pixel, cads_pixel };

/// The paper's demo lights: a dark grey everywhere, and a light grey from far away.
struct LocalLights {
  Rgb ambient{0.1f, 0.1f, 0.1f};  ///< C_a
  Rgb light{0.8f, 0.8f, 0.8f};    ///< C_l
  Vec3 direction{0, -1, 0};       ///< unit, the way the light travels
};

/// The default colours, and the direction of the scene's first directional light. Without one the
/// light comes over the camera's left shoulder, so that every scene shows something.
LocalLights local_lights(const scene::Scene& scene, const scene::Camera& camera);

/// Where surfaces are looked at from.
struct Viewer {
  explicit Viewer(const scene::Camera& camera);
  /// The unit vector from a point of a surface to the viewer.
  Vec3 from(Vec3 position) const;

  Vec3 eye, back;  ///< back: unit, against the view, the way to an orthographic viewer
  bool orthographic = false;
};

/// Material of one point. N, L (towards the light) and V (towards the viewer) are unit vectors.
struct LocalSurface {
  Rgb material;         ///< C_m
  Rgb specular;         ///< C_s
  float sharpness = 1;  ///< n
};

/// The sum of the technique's terms at one point, clipped to [0, 1]:
/// C_m; C_a C_m; + C_l C_m (N.L); + C_l C_s (R.V)^n with R = 2 (N.L) N - L. Dot products below 0
/// count as 0. A surface turned away from the light has neither diffuse nor specular light.
Rgb local_color(LocalTechnique technique, const LocalSurface& surface, const LocalLights& lights,
                Vec3 normal, Vec3 to_viewer);

/// Colour of a surface by a technique. Per vertex: the colours at the three corners, interpolated;
/// the material's own colour, which may be textured, is that of the point in all three. Per pixel:
/// N and V are those of the corners interpolated and made unit again.
Rgb local_light_at(const scene::Scene& scene, const trace::Hit& hit, LocalTechnique technique,
                   const LocalLights& lights, const Viewer& viewer);

}  // namespace luxel::display
