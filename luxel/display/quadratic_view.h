// Triangles whose irradiance is a quadratic function, drawn fast: which triangle does a pixel see,
// where in it, and what is the function there. [Hardt96, section 3.4]
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "luxel/base/result.h"
#include "luxel/image/image.h"
#include "luxel/scene/scene.h"

namespace luxel::display {

/// Arrays of one length but `vertices`.
struct QuadraticMesh {
  std::vector<Vec3> vertices;
  std::vector<std::array<uint32_t, 3>> triangles;  ///< counter-clockwise from the front
  /// E = A s^2 + 2B s t + 2C s + D t^2 + 2E t + F as {A, 2B, 2C, D, 2E, F}; s and t are the weights
  /// of the second and the third corner. [Hardt96, eq. 3.1]
  std::vector<std::array<Rgb, 6>> irradiance;
  std::vector<Rgb> reflectance;  ///< one per triangle: textures are means here
  std::vector<Rgb> emission;     ///< radiance
  std::vector<uint8_t> two_sided;
  Rgb background{};  ///< radiance behind them, and the map of the surroundings
  scene::Environment environment;
};

class QuadraticView {
 public:
  /// Errors: no triangles.
  static Result<QuadraticView> make(QuadraticMesh mesh);
  QuadraticView(QuadraticView&&) noexcept;
  QuadraticView& operator=(QuadraticView&&) noexcept;
  ~QuadraticView();

  /// Radiance through the middle of each pixel, 4 channels (A = 1 where there is a surface).
  image::Image draw(const scene::Camera& camera, int width, int height) const;

 private:
  struct Impl;
  explicit QuadraticView(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace luxel::display
