// Scenes of the gallery, and where one stands in each.
#pragma once

#include <array>
#include <string_view>

#include "luxel/base/vec.h"

namespace luxel::bench {

/// A camera [m, deg]. Its picture is upright.
struct GalleryView {
  Vec3 eye, look_at;
  float fov_y_deg = 0;  ///< 0: there is no such view
};

struct GalleryScene {
  std::string_view file;    ///< in shared/scenes
  std::string_view credit;  ///< what it is, whose, and its licence
  std::array<GalleryView, 2> views;
};

inline constexpr std::array kGallery{
    GalleryScene{"kaykit_city/kaykit_city.glb",
                 "Streets of KayKit City Builder Bits. By Kay Lousberg, CC0.",
                 {{{{0.72f, 0.44f, 4.3f}, {-0.22f, 0.70f, -1}, 50}}}},
};

}  // namespace luxel::bench
