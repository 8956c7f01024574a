// Fireflies: single texels that one rare ray has made far brighter than all around them.
#pragma once

#include <span>

#include "luxel/post/neighbours.h"

namespace luxel::post {

/// Finds texels with variance that are more than kFirefly times as bright as the third brightest
/// (at borders the second) of those within kFireflyRadius on the same surface. They are lowered to
/// that neighbour, and what they lose is shared out evenly among all within kShareRadius that have
/// variance: the sum over texels stays. A firefly is light of a path that few of the texels found
/// though all have it, so that its energy belongs to all of them. Texels without variance, such as
/// those whose direct light is exact, are neither lowered nor changed. Returns how many were
/// lowered.
size_t share_out_fireflies(const Neighbourhood& n, std::span<const float> variance,
                           std::span<Rgb> values);
inline constexpr float kFirefly = 2, kFireflyRadius = 2.6f, kShareRadius = 6;

}  // namespace luxel::post
