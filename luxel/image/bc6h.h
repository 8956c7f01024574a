// Pictures of light in BC6H, which graphics cards look up as it is: one byte per pixel.
#pragma once

#include <cstddef>
#include <vector>

#include "luxel/image/half.h"

namespace luxel::image {

/// Blocks of 4 x 4 pixels, 16 bytes each, in rows from the top: BC6H_UFLOAT [DataFormat, section
/// 22]. The first three channels count; negative values become 0, and what a block has beyond an
/// edge repeats the edge. Pixels whose fourth channel is 0 and whose colour is black count for
/// nothing, for nobody looks at them.
///
/// The format has 14 kinds of blocks; these are the four without a partition. That fits light,
/// which is smooth nearly everywhere; where an edge of a shadow and a change of colour meet in a
/// block, a partition would do better.
std::vector<std::byte> encode_bc6h(const HalfImage& image);

/// A .ktx2 file [KTX2] of one level without compression besides, of blocks as encode_bc6h makes
/// them.
std::vector<std::byte> ktx2_of_bc6h(const HalfImage& image);

}  // namespace luxel::image
