// Where faces stand on others or pass through them.
#pragma once

#include <optional>

#include "luxel/solve/hierarchical/blockers.h"
#include "luxel/solve/hierarchical/segments.h"

namespace luxel::hierarchical {

/// Where `other` touches the front of `face`, or passes through it, within both. Nothing between
/// parallel faces, nor where it only reaches the plane.
std::optional<Segment> contact_of(const Faces& faces, uint32_t face, uint32_t other,
                                  double slack_m);

/// Each face in convex pieces, cut by the lines along which others stand on it, so that what is
/// covered and what is not are elements of their own. Otherwise the dark below a box would be
/// spread over the floor around it, which no link's error would tell of. Few lines: the longest,
/// none shorter than a fiftieth of the face's size, none along its border.
std::vector<std::vector<Polygon>> cut_at_contacts(const Faces& faces, const Blockers& blockers);

}  // namespace luxel::hierarchical
