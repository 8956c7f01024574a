// Parts of an earlier bake of the scene that gather builds on. docs/method/rebake.md
#pragma once

#include <cstdint>
#include <vector>

#include "luxel/light/direct_light.h"
#include "luxel/light/lights.h"
#include "luxel/light/supersample.h"
#include "luxel/solve/gather/reuse/earlier_rays.h"

namespace luxel::gather {

/// Parts of an earlier bake that serve one of the changed scene on the same map.
struct Earlier {
  EarlierRays rays;
  std::vector<std::vector<uint16_t>> rounds;  ///< samples per element after each, at least one
  /// Light straight from lights where nothing has come into its way, in place of that of all lights
  /// but those of `changed_lights`; empty: not known.
  light::DirectLight direct;
  light::DirectLevels levels;
  light::Lights changed_lights;  ///< that shine otherwise than then: they are looked at everywhere
  std::vector<Rgb> irradiance;   ///< a guess at the light after all bounces
  double relative_error = 0;     ///< of that light: Gather::relative_error
};

}  // namespace luxel::gather
