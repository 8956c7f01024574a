// Queries of ray packets to Embree, and the answers of surfaces that let light through.
#pragma once

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <span>

#include "luxel/scene/scene.h"

namespace luxel::trace {

/// Rays of the largest packet.
inline constexpr unsigned kMostOfPacket = 16;

/// Geometries of the top level are attached under their instance's number, so that a hit's instance
/// is its geometry where it lies in the top level itself, and its innermost instance id elsewhere.
inline uint32_t instance_of(uint32_t instance_id, uint32_t geometry_id) {
  return instance_id != RTC_INVALID_GEOMETRY_ID ? instance_id : geometry_id;
}

/// Treatment of the light of a packet's rays that goes straight through surfaces.
enum class Through : uint8_t {
  chance,  ///< let the ray through or not
  none,    ///< stop it, unless nothing is there
  tint,    ///< let it through, and multiply its light by the tint
  share    ///< the same with (1 - coverage) tint; where nothing is left, it is blocked
};

/// Embree hands the context of a query to filter functions: ours has more behind it. It tells them
/// the scene, too: geometries are shared between tracers, each of which has a scene of its own.
struct Query {
  Query(const scene::Scene& in, const RTCIntersectContext& rays, Through which = Through::chance)
      : context(rays), scene(in), through(which) {}

  RTCIntersectContext context;
  const scene::Scene& scene;
  Through through;
  std::span<Rgb> light;  ///< of each ray in the packet, where it is asked for
  /// Places that a ray has passed: Embree may ask about one several times, because spatial splits
  /// put a triangle into several boxes. So many are remembered.
  static constexpr size_t kRemembered = 16;
  std::array<std::array<uint64_t, kRemembered>, kMostOfPacket> passed;
  std::array<uint32_t, kMostOfPacket> passed_count{};

  /// A packet of rays with such light.
  void begin(std::span<Rgb> of_rays) { light = of_rays, passed_count.fill(0); }

  bool is_new(unsigned lane, uint64_t place) {
    const size_t known = std::min<size_t>(passed_count[lane], kRemembered);
    const auto end = passed[lane].begin() + std::ptrdiff_t(known);
    if (std::find(passed[lane].begin(), end, place) != end) return false;
    passed[lane][passed_count[lane]++ % kRemembered] = place;
    return true;
  }
};

/// Embree's filter: lets rays through the holes of masks and through what is not opaque, for
/// packets of any size. The context is that of a Query.
void let_through(const RTCFilterFunctionNArguments* args);

}  // namespace luxel::trace
