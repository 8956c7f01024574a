#include "luxel/view/model/bookmarks.h"

namespace luxel::view {

std::optional<BookmarkKey> bookmark_key(std::string_view key) {
  constexpr std::string_view kRemember = "ctrl+", kGo = "alt+";
  const bool remembers = key.starts_with(kRemember);
  if (!remembers && !key.starts_with(kGo)) return std::nullopt;
  key.remove_prefix((remembers ? kRemember : kGo).size());
  if (key.size() != 1 || key[0] < '1' || key[0] > '9') return std::nullopt;
  return BookmarkKey{size_t(key[0] - '1'), remembers};
}

Bookmark bookmark_of(const Frame& shown, float first_exposure) {
  return {shown.camera, shown.exposure / first_exposure, shown.show};
}

void go_to(const Bookmark& bookmark, float first_exposure, Frame& shown) {
  shown.camera = bookmark.camera;
  shown.exposure = bookmark.brightness * first_exposure;
  shown.show = bookmark.show;
}

}  // namespace luxel::view
