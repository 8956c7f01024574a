// Lines on faces along which light or its slope jumps. [Heckbert92; Hardt96, chapter 5]
#pragma once

#include "luxel/solve/hierarchical/solve.h"

namespace luxel::hierarchical {

enum class DiscontinuityKind : uint8_t {
  ve,       ///< a vertex of a source past an edge of a blocker
  ev,       ///< an edge of a source past a vertex of a blocker
  horizon,  ///< where the plane of a source cuts the receiver
  contact   ///< where another face stands on the receiver or passes through it
};

struct Discontinuity {
  DVec3 a, b;  ///< on the receiver
  DiscontinuityKind kind = DiscontinuityKind::ve;
  uint32_t source =
      kNone;  ///< a face; kPunctualSource + the number of a punctual light; kNone for contacts
  uint32_t blocker = kNone;  ///< a face; kNone for horizons
  /// max(d_sb / d_br), how fast a source appears behind a blocker [Hardt96, section 5.3]; where
  /// slopes are ranked [Hardt96, section 8.2], the most that the form factor of the source can
  /// change per metre. Infinite for contacts.
  double geometric = 0;
};
/// Sources from here on are punctual lights.
inline constexpr uint32_t kPunctualSource = 1u << 31;

/// Measures that rank discontinuities: weight = geometric factor * radiosity of the source.
enum class Ranking : uint8_t {
  nearness,  ///< [W/m^2], [Hardt96, section 5.3]
  slope      ///< [W/m^2 per m], [Hardt96, section 8.2]
};

struct DiscontinuityParams {
  Ranking ranking = Ranking::slope;
  /// Lower weights are left out. Nothing: of nearness a twentieth of the brightest face's
  /// radiosity, of slope so much that light changes by a fiftieth of its mean over the scene's mean
  /// face.
  std::optional<double> least_weight;
  /// A source that brings less than this part of the scene's mean irradiance casts none.
  double least_light = 0.01;
  uint32_t max_per_leaf = 10;  ///< lines through a leaf, at most [Hardt96, maxLeafDSets]
};

/// The parameters' limits for one solution: computed once, for all its faces. Weights are in W/m^2
/// per m (slope) or W/m^2 (nearness).
struct DiscontinuityLimits {
  double weight = 0;  ///< the least
  double light = 0;   ///< the least that a source brings [W/m^2]
};
/// Limits from the parameters or, where those say nothing, from the light there is.
DiscontinuityLimits limits_of(const Solution& solution, const DiscontinuityParams& params);

/// All that fall on a face, each with its geometric factor, of those whose weight can be above the
/// least. VE and EV are clipped to where the ray over the blocker's edge sees the source.
std::vector<Discontinuity> find_discontinuities(const Solution& solution, const scene::Scene& scene,
                                                const trace::RayTracer& tracer, uint32_t receiver,
                                                Ranking ranking, const DiscontinuityLimits& limits);

/// geometric * what the source sends now: its mean radiosity, or a punctual light's irradiance at
/// the line's beginning; infinite for contacts. Units as Ranking says.
double weight_of(const Discontinuity& d, const Solution& solution, const scene::Scene& scene);

}  // namespace luxel::hierarchical
