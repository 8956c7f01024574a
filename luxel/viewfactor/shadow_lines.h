// Lines on a polygon along which what its points see of another one changes within a short way:
// where the shadows of blockers close to it end.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "luxel/viewfactor/point_visibility.h"

namespace luxel::viewfactor {

using Triangle = std::array<DVec3, 3>;

/// The line in which a plane through an edge of a blocker and a corner of the light meets the
/// receiver: an EV event of discontinuity meshing [Heckbert92]. Between the lines of one edge lies
/// its penumbra.
struct ShadowLine {
  DVec3 normal;  ///< unit, in the receiver's plane
  double offset = 0;
  DVec3 along;  ///< unit, in the receiver's plane
  /// The edge's shadow reaches from `begin` to `end`, measured by dot(along, p) [m].
  double begin = 0, end = 0;
  double low = 0;     ///< the edge's least height above the receiver [m]
  double spread = 0;  ///< the penumbra's width over the edge's height
};

/// The lines of all edges of each blocker that `chosen` names.
struct ShadowLines {
  std::vector<ShadowLine> lines;
  std::vector<uint32_t> ends;  ///< one past the last line of each blocker; others have none

  std::span<const ShadowLine> of(uint32_t blocker) const {
    const uint32_t begin = blocker == 0 ? 0 : ends[blocker - 1];
    return {lines.data() + begin, ends[blocker] - begin};
  }
};
/// `receiver` is the plane of the polygon on which the lines lie, `light` lies above it. Parts of
/// blockers below the receiver or behind the light cast no shadow. Edges closer to the receiver
/// than `slack` lie on it.
ShadowLines shadow_lines(const Plane& receiver, PolygonView light,
                         std::span<const Blocker> blockers, std::span<const uint32_t> chosen,
                         double slack);

/// True when the penumbra is narrow against a cell of this size [m]: the rule of the cell may step
/// over it.
bool is_sharp(const ShadowLine& line, double size_m);

/// The part of a shadow line within a triangle.
struct Chord {
  DVec3 from, to;
  double whole_m = 0;  ///< length of the line in the triangle, beyond the edge's shadow too
  bool is_empty = true;
};
/// Empty where the line does not part the triangle's corners by more than `slack`, or the edge's
/// shadow ends before.
Chord chord_of(const ShadowLine& line, const Triangle& triangle, double slack);

/// Width of the narrowest penumbra on a receiver, at most its edge's height, over the receiver's
/// radius: 0 where a blocker touches it, infinite where no line falls on it.
double narrowest_penumbra(const ShadowLines& lines, double radius_m);

}  // namespace luxel::viewfactor
