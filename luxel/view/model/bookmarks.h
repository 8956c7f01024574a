// Views that are remembered under a number, to go back to.
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "luxel/view/frame.h"

namespace luxel::view {

/// The remembered part of a frame.
struct Bookmark {
  scene::Camera camera;
  float brightness = 1;  ///< exposure over that of the first frame, which grows with a bake
  Show show = Show::light_and_colour;
};
/// Those of the keys 1 to 9.
using Bookmarks = std::array<std::optional<Bookmark>, 9>;

/// A key for a bookmark: "ctrl+1" remembers the first one, "alt+1" goes there.
struct BookmarkKey {
  size_t number = 0;  ///< from 0 on
  bool remembers = false;
};
/// None where the key has nothing to do with bookmarks.
std::optional<BookmarkKey> bookmark_key(std::string_view key);

/// `first_exposure`: of the first frame; > 0.
Bookmark bookmark_of(const Frame& shown, float first_exposure);
/// Shows what is remembered; all else of the frame stays.
void go_to(const Bookmark& bookmark, float first_exposure, Frame& shown);

}  // namespace luxel::view
