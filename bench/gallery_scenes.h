// Scenes of the gallery, and where one stands in each.
#pragma once

#include <array>
#include <string_view>

#include "luxel/base/vec.h"

namespace luxel::bench {

/// A camera. Its angle is in degrees.
struct GalleryView {
  Vec3 eye, look_at;
  float fov_y_deg = 0;  ///< 0: there is no such view
  Vec3 up = {0, 1, 0};
};

struct GalleryScene {
  std::string_view file;    ///< in shared/scenes
  std::string_view credit;  ///< what it is, whose, and its licence
  std::array<GalleryView, 2> views;
  /// Paths need too long here to lose their noise: no path-traced picture.
  bool is_noisy = false;
};

/// Cameras are in the units of each file.
inline constexpr std::array kGallery{
    GalleryScene{"kaykit_city/kaykit_city.glb",
                 "Streets of KayKit City Builder Bits. By Kay Lousberg, CC0.",
                 {{GalleryView{{0.72f, 0.44f, 4.3f}, {-0.22f, 0.70f, -1}, 50},
                   GalleryView{{4.35f, 0.5f, 0.1f}, {-1, 0.62f, -0.1f}, 50}}}},
    GalleryScene{"living_room/living_room.glb",
                 "A living room that opens on a walled garden. By Godot Engine contributors, MIT.",
                 {{GalleryView{{1, 2.6f, -1.7f}, {-2.5f, 2.15f, 1.25f}, 60}}}},
    GalleryScene{"pandora/pandora.obj",
                 "pandora, a level of Sauerbraten (quadropolis.us/node/4125), CC BY. Its textures "
                 "are missing; colours stand for them.",
                 {{GalleryView{{172.3f, 334.4f, -269.4f}, {272.3f, 334.4f, -269.4f}, 52}}},
                 true},
    GalleryScene{"zdm2/zdm2.glb",
                 "zdm2, a level of Sauerbraten. By Chaseter, Suicizer, I.g( and friends (Godot "
                 "Engine demo projects), CC BY 4.0.",
                 {{GalleryView{{15.26f, 1.2f, -2.14f}, {5.26f, 1, 7.86f}, 58}}}},
    GalleryScene{"japanese_bridge_garden/japanese_bridge_garden.glb",
                 "\"Japanese Bridge Garden\" by kristenlee, CC BY 4.0, turned to "
                 "metallic-roughness materials. Its lanterns are the only light.",
                 {{GalleryView{{1.3f, 1.7f, 7.4f}, {-0.2f, 2, 0}, 48}}}},
    GalleryScene{"living_room/living_room_lit_uv1.glb",
                 "The living room from its garden, with a sun in the file and a lightmap layout of "
                 "its own. By Godot Engine contributors, MIT.",
                 {{GalleryView{{2.2f, 1.9f, 10}, {-0.6f, 2, 0}, 50}}}},
    GalleryScene{"suzanne_room/room.glb",
                 "A room with two doorways and smooth objects. By Godot Engine contributors, MIT.",
                 {{GalleryView{{1.2f, 1.7f, 4.7f}, {-0.8f, 1.8f, -5}, 58}}},
                 true},
    GalleryScene{"cornell_box/cornell_box.glb",
                 "The Cornell box. By this project, CC0.",
                 {{GalleryView{{0, 0.28f, 0.62f}, {0, 0.265f, 0}, 54}}}},
    GalleryScene{"tile_game_room/tile_game_room_lit_uv1.glb",
                 "A room of a tile game with a lamp and a lightmap layout of its own. By "
                 "Poimandres (react-three-lightmap), MIT.",
                 {{GalleryView{{-1.83f, -3.86f, 1.6f}, {-0.83f, -2.86f, 1.6f}, 55, {0, 0, 1}}}}},
    GalleryScene{
        "tile_game_room/tile_game_room6.glb",
        "The tile room from outside, under luxel's sky. By Poimandres (react-three-lightmap), MIT.",
        {{GalleryView{{9, -9, 6}, {0, 0, 2}, 40, {0, 0, 1}}}}},
    GalleryScene{"spot_teapot_bunny/spot.obj",
                 "Spot. By Keenan Crane, public domain.",
                 {{GalleryView{{1.5f, 0.7f, -2.2f}, {0, 0.1f, 0.15f}, 38}}}},
    GalleryScene{"spot_teapot_bunny/teapot.obj",
                 "The teapot. By Martin Newell.",
                 {{GalleryView{{2.5f, 4, 7.5f}, {0.2f, 1.4f, 0}, 34}}}},
    GalleryScene{"spot_teapot_bunny/stanford-bunny.obj",
                 "The bunny. By the Stanford Computer Graphics Laboratory.",
                 {{GalleryView{{0.1f, 0.16f, 0.28f}, {-0.02f, 0.105f, 0}, 38}}}},
};

}  // namespace luxel::bench
