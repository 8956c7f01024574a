// Exact irradiance of the pixels of a picture, a part after the other.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "luxel/base/progress.h"
#include "luxel/view/hierarchical/piece.h"

namespace luxel::view {

/// A picture that exact light is asked for.
struct ExactView {
  scene::Camera camera;
  int width = 0, height = 0;
};
/// True where two views show the same.
bool is_same(const ExactView& a, const ExactView& b);

/// E at what the middle of each pixel shows, as far as it is known.
struct ExactPicture {
  /// E [W/m^2], and the face: its number's bits as a float. kNone where nothing is known or seen.
  struct Pixel {
    Rgb irradiance;
    uint32_t face = hierarchical::kNone;
  };
  ExactView view;
  uint64_t piece = 0;  ///< Piece::number
  std::vector<Pixel> pixels;
  size_t done = 0;  ///< of ordered pixels
};

/// Nothing is known of it yet.
ExactPicture begin_exact(const Piece& piece, const ExactView& view);
/// True once all of it is known.
bool is_whole(const ExactPicture& picture);
/// Computes about so many pixels more, those of coarse grids first. Errors: cancelled; what it knew
/// is then kept.
Status add_exact(const Piece& piece, const SolvedScene& scene, size_t count, ExactPicture& picture,
                 Progress& progress);

}  // namespace luxel::view
