// Item buffer: what each pixel of an element's hemicube sees. [Cohen85; Rodriguez06, section 5.6]
#pragma once

#include "luxel/solve/hemicube/look.h"

namespace luxel::hemicube {

/// Kinds of things that a pixel sees. Backs of one-sided surfaces are black, and so is all that
/// lies below the element's own triangle.
enum class SeenKind : uint8_t { surface, back, surroundings, below };

struct Item {
  SeenKind kind = SeenKind::below;
  MeshPoint at;              ///< of a surface or a back
  bool from_behind = false;  ///< the back of a two-sided surface
};

struct ItemBuffer {
  int resolution = 0;
  std::vector<Item> items;      ///< pixels in the order of viewfactor::Hemicube
  std::vector<Vec3> direction;  ///< unit, in the world, of each pixel's centre
  std::vector<double> factor;   ///< the form factor of each pixel; they sum to 1
};

/// The frame of a hemicube over a surface with this unit normal, turned about it by an angle
/// without a simple tangent. Rows of pixels that run along the edges of a room would see all of an
/// edge or nothing of it.
Frame frame_of_cube(Vec3 normal);

/// The items that look() counts, pixel by pixel. Errors: cancelled.
Result<ItemBuffer> item_buffer(const Senders& senders, const Viewpoint& from, int resolution,
                               Progress& progress);

}  // namespace luxel::hemicube
