// Light for elements that have none of their own.
#pragma once

#include "luxel/solve/hemicube/receivers.h"

namespace luxel::hemicube {

/// In which order, and from which neighbours, elements inside solids get their light: those next to
/// visible ones first, ring by ring.
struct RefillPlan {
  std::vector<uint32_t> element;
  std::vector<uint32_t> first;  ///< per entry of `element`, one extra at the end
  std::vector<uint32_t> from;   ///< the neighbours that have light by then
};

/// `hidden`: 1 per element inside a solid. Those that no visible element reaches are left out: they
/// stay black.
RefillPlan plan_refill(const Neighbours& neighbours, std::span<const uint8_t> hidden);

/// Each becomes the mean of its neighbours with light.
void refill(const RefillPlan& plan, std::span<Rgb> irradiance);

}  // namespace luxel::hemicube
