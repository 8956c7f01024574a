// Digests of a scene's contents. They tell that another scene is the same, or what differs.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "luxel/scene/scene.h"

namespace luxel::scene {

/// One thing of a scene.
struct ItemDigest {
  std::string kind;  ///< "mesh", "instance", ..., in the order of Scene
  std::string name;  ///< its own; may be empty
  uint64_t digest = 0;
  friend bool operator==(const ItemDigest&, const ItemDigest&) = default;
};

/// Everything in a scene, kind by kind in their order. Digests are of what light, lightmaps and
/// pictures depend on: of names none, of a texture its pixels, not the file that they came in.
std::vector<ItemDigest> digests_of(const Scene& scene);

/// The first difference, by kinds, in words: "mesh 'chair' has changed". Empty where there is none,
/// but for names.
std::string difference(std::span<const ItemDigest> before, std::span<const ItemDigest> now);

}  // namespace luxel::scene
