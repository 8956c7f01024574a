// Light that moves: an .lxr file's scene, relit as often as its lights change.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "luxel/base/result.h"
#include "luxel/scene/scene.h"
#include "luxel/solve/matrix/relight_data.h"

namespace luxel::matrix {

/// Light sources of a relit scene.
struct RelightLights {
  std::span<const scene::PunctualLight> punctual{};  ///< without profiles
  /// Radiance L of each material of RelightData::material_name [W/(sr m^2)]; empty: as baked. A
  /// material that glowed unevenly keeps its pattern, and L is its mean.
  std::span<const Rgb> emission{};
  Rgb background{};  ///< radiance of the surroundings
  /// Irradiance by `punctual` at each of RelightData::probe [W/m^2], from callers that have shadow
  /// maps. Empty: shadow rays are traced; of the first 16 lights, only for those that have changed.
  std::span<const Rgb> direct_at_probes{};
};

/// Light of an update, per patch, and per point of RelightData::target, a texel or a vertex.
struct Relit {
  uint64_t update = 0;                ///< how many there were before, and this one; 0: none yet
  std::vector<Rgb> direct;            ///< E straight from punctual lights [W/m^2]
  std::vector<Rgb> indirect;          ///< E from surfaces (glowing ones, too) and the background
  std::vector<Rgb> direct_at_points;  ///< empty unless asked for
  std::vector<Rgb> indirect_at_points;
};

/// Further results that a relighter computes.
struct RelighterParams {
  /// Direct light at points, too, by a shadow ray per point and light; for programs that do not
  /// draw direct light themselves.
  bool direct_at_points = false;
};

/// One thread updates while another reads: neither waits for the other, and neither allocates.
///
///     LUXEL_TRY(RelightData data, read_lxr("scene.lxr"));
///     LUXEL_TRY(Relighter relighter, Relighter::make(std::move(data), {}));
///     relighter.update({lights});                  // thread A, per frame
///     show(relighter.latest().indirect_at_points);  // thread B
class Relighter {
 public:
  /// Builds what shadow rays need and all room that updates need. Errors: triangles that cannot be
  /// traced.
  static Result<Relighter> make(RelightData data, const RelighterParams& params);
  Relighter(Relighter&&) noexcept;
  Relighter& operator=(Relighter&&) noexcept;
  ~Relighter();

  /// The data that make() was given. It does not change.
  const RelightData& data() const;

  /// E after all bounces of the lights, shadows by rays. One thread at a time.
  void update(const RelightLights& lights);

  /// The result of the last update that was complete when this was called. It does not change until
  /// the same thread calls latest() again. One thread at a time, maybe another than update()'s.
  const Relit& latest();

  /// Times of the last update() [s].
  struct Seconds {
    double direct = 0, bounces = 0, places = 0;
    /// All parts together [s].
    double total() const { return direct + bounces + places; }
  };
  /// Times of the last update(); to be called on its thread.
  Seconds seconds() const;

 private:
  struct Impl;
  explicit Relighter(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace luxel::matrix
