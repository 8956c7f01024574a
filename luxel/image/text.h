// Text in pictures: one small bitmap font, so that a sheet of pictures can say which is which.
#pragma once

#include <cstdint>
#include <string_view>

#include "luxel/image/codec.h"
#include "luxel/image/false_color.h"

namespace luxel::image {

/// A letter's cell at scale 1: five columns and one between letters; seven rows over the baseline
/// and two under it.
inline constexpr int kGlyphAdvance = 6, kGlyphHeight = 9;

/// Width of a text [pixels], without the gap behind its last letter.
int text_width(std::string_view text, int scale);

/// Draws with the top left corner of the first cell at (x, y); what lies outside the picture is cut
/// off. Letters, digits and some signs; anything else is a box. `picture` has at least 3 channels,
/// of which a fourth is left alone.
void draw_text(Image8& picture, int x, int y, int scale, Color8 color, std::string_view text);

}  // namespace luxel::image
