// Bundles: rays of neighbouring texels of a chart that share their directions. An experiment:
// docs/method/gather.md says what came of it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "bench/bench.h"
#include "bench/parallel_rays.h"
#include "luxel/solve/gather/rays/element_rays.h"
#include "luxel/validate/prepared.h"

namespace luxel::bench {

/// Texel (x, y) has the directions of set (x mod 4, y mod 4).
inline constexpr uint32_t kSetSide = 4, kSets = kSetSide * kSetSide;

/// Texels of one chart and set in a square of 64 x 64 texels of the map.
struct Bundle {
  uint32_t first = 0, end = 0;  ///< in Bundles::element
  uint32_t set = 0;
  bool is_flat = false;  ///< they have one normal: their rays are parallel
};
/// All bundles of some texels.
struct Bundles {
  std::vector<uint32_t> element;  ///< those of a bundle follow each other, in Morton order
  std::vector<Bundle> bundles;

  double mean_size() const { return double(element.size()) / double(bundles.size()); }
};
Bundles make_bundles(const validate::Prepared& p, std::span<const uint32_t> texels);

/// The scene and its rays, ready to be traced.
struct BundleTrace {
  const validate::Prepared& p;
  uint32_t samples = 0;
  std::vector<std::vector<Vec3>> directions{};  ///< of each set, about +z, in the order of cells
  TriangleGroups triangles{};
};
BundleTrace bundle_trace(const validate::Prepared& p, uint32_t samples);

/// As gather traces the rays of some elements, each of which has directions of its own.
void trace_as_gather(const BundleTrace& in, std::span<const uint32_t> elements,
                     trace::Packets packets);

/// Method that traces the rays of a bundle.
enum class BundleTracer : uint8_t {
  embree,     ///< packets of rays of one direction
  projection  ///< parallel_hits() where bundles are flat and large enough; else Embree
};
void trace_bundles(const BundleTrace& in, const Bundles& bundles, BundleTracer by);
/// The share of projected rays that meet something elsewhere than Embree says, of one bundle in 16.
double share_that_differs(const BundleTrace& in, const Bundles& bundles);

/// Notes the noise of light when texels share directions: of texels, and of means over squares.
Status measure_shared_noise(const std::filesystem::path& file, const std::string& name,
                            Table& table);

}  // namespace luxel::bench
