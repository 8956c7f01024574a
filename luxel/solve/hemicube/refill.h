// Light for elements that have none of their own.
#pragma once

#include "luxel/solve/hemicube/receivers.h"

namespace luxel::hemicube {

/// In which order, and from which neighbours, elements inside solids get their light: those next to
/// visible ones first, ring by ring; covered ones likewise, because elements cannot tell the
/// light in a gap much narrower than themselves from that beside it.
struct RefillPlan {
  std::vector<uint32_t> element;
  std::vector<uint32_t> first;  ///< per entry of `element`, one extra at the end
  std::vector<uint32_t> from;   ///< the neighbours that have light by then
  std::vector<uint32_t> dark;   ///< covered ones that no visible element reaches: black
};

/// `enclosed`: 1 per element inside a solid. `covered`: 1 per element that something much closer
/// covers (transport::open_share). Enclosed ones that no visible element reaches keep their light.
RefillPlan plan_refill(const Neighbours& neighbours, std::span<const uint8_t> enclosed,
                       std::span<const uint8_t> covered);

/// Each becomes the mean of its neighbours with light, or black.
void refill(const RefillPlan& plan, std::span<Rgb> irradiance);

}  // namespace luxel::hemicube
