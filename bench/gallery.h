// The page that shows what a first bake gives: docs/guide/gallery.md, written by `luxel bench
// gallery`.
#pragma once

#include "bench/validation.h"

namespace luxel::bench {

/// Every scene of `shared`/scenes, baked without any option: pictures at eye level, seconds, and
/// its first view path traced, with FLIP between both. `only`: the scene with this stem alone, the
/// other rows being those of the file `earlier`, a gallery.csv; empty: all, in most of an hour on
/// two cores. Errors: no scene is there, cancelled, what bakes say.
Result<Page> make_gallery(const std::filesystem::path& shared, std::string_view only,
                          const std::filesystem::path& earlier, Progress& progress);

}  // namespace luxel::bench
