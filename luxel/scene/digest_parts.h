// Digests of the parts of a scene, and what to call them: what digest.h and change.h share.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "luxel/base/digest.h"
#include "luxel/scene/scene.h"

namespace luxel::scene {

inline void add(Digest& d, const Vec3& v) { d.add(std::span<const Vec3>(&v, 1)); }
inline void add(Digest& d, const Mat34& m) { d.add(std::span<const Mat34>(&m, 1)); }
template <class T>
void add(Digest& d, const std::vector<T>& values) {
  d.add(std::span<const T>(values));
}

/// Where a material looks in a texture and how, whichever texture that is.
void add_lookup(Digest& d, const TextureRef& ref);

uint64_t digest(const Mesh& mesh);
/// With the number of its profile, not what that holds.
uint64_t digest(const PunctualLight& light);
uint64_t digest(const LightProfile& profile);
uint64_t digest(const Environment& environment);

/// "mesh 'chair'"; without a name, "mesh number 3" for the index 2.
std::string called(std::string_view kind, std::string_view name, size_t index);

}  // namespace luxel::scene
