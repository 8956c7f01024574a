// Light of places as the picture that shaders look up.
#pragma once

#include <span>
#include <vector>

#include "luxel/image/image.h"
#include "luxel/solve/matrix/relight_data.h"

namespace luxel::view {

/// Where the places of an .lxr file lie in its map, and what its gutter is made of.
struct MapPlaces {
  int width = 0, height = 0;
  std::vector<uint32_t> place, pixel;  ///< those that some patch lights
  /// Pixels around them, each after all that it is the mean of.
  std::vector<uint32_t> gutter;
  std::vector<uint32_t> first, from;  ///< of each pixel of the gutter, one extra entry; pixels
  std::vector<uint32_t> ring_end;     ///< of the gutter: none of a ring is the mean of another
};

/// Places of a map, and pixels around them as post::dilate fills them. Texels that some patch
/// lights are covered; others are hidden, and get their neighbours' light. `target` holds texels.
MapPlaces map_places(const matrix::Target& target);

/// Light of places into a map of 4 channels, black at first. Other pixels stay; A does, too.
void put_light(const MapPlaces& places, std::span<const Rgb> of_place, image::Image& map);

}  // namespace luxel::view
