// The texture atlas: which place of the lightmap belongs to which place of the scene.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "luxel/base/mapped_memory.h"
#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/base/team.h"
#include "luxel/scene/scene.h"

namespace luxel::atlas {

inline constexpr uint32_t kNone = UINT32_MAX;

/// A square part of the atlas that becomes a lightmap of its own, in texels. No chart lies on two.
struct Page {
  int x = 0, y = 0, side = 0;
};

/// A layout of every drawn triangle (numbered as scene::first_triangles does) on a square.
/// Coordinates are in texels: x to the right, y downwards, texel (i, j) covers [i, i+1) x [j, j+1).
/// As texture coordinates, u = x / resolution and v = y / resolution.
struct Atlas {
  int resolution = 0;                        ///< side in texels
  std::vector<uint32_t> first_triangle;      ///< per instance, one extra entry at the end
  std::vector<std::array<Vec2, 3>> corners;  ///< per drawn triangle, corner order of the mesh
  std::vector<uint32_t> chart;               ///< per drawn triangle
  uint32_t chart_count = 0;
  bool kept = false;           ///< laid out as TEXCOORD_1 says
  std::vector<Page> pages;     ///< empty: the whole square is the only one; see pages_of()
  std::vector<uint32_t> page;  ///< per drawn triangle; empty: all on the first

  /// The number of a drawn triangle: of an instance's mesh triangle among all instances.
  uint32_t triangle_number(uint32_t instance, uint32_t triangle) const {
    return first_triangle[instance] + triangle;
  }
};

/// One lightmap texel with a sample on a surface. The sample lies at the centroid of the part of
/// the texel that its triangle covers, so a triangle thinner than a texel has samples too. In 24
/// bytes: there are millions, all the time.
struct Texel {
  uint16_t x = 0, y = 0;  ///< of the square; its side is below 2^15
  scene::SurfacePoint sample;
  uint32_t triangle_number : 31 = 0;
  bool centre_covered : 1 = false;  ///< the texel's centre lies in a triangle
};
static_assert(sizeof(Texel) == 24);

/// All texels that any triangle touches, in rows from the top, left to right.
struct TexelMap {
  int resolution = 0;
  MappedVector<Texel> texels;
  std::vector<uint32_t> texel_at;  ///< resolution^2 entries: index into texels, or kNone
};

/// The use of TEXCOORD_1 for the lightmap: where it is a layout (why_no_layout), always, never.
enum class UvMode : uint8_t { automatic, keep, unwrap };
/// Number of pages: a given one; as many as it takes; one for each instance.
enum class PageMode : uint8_t { fixed, automatic, per_instance };

/// Settings for laying out a scene.
struct AtlasParams {
  UvMode uv = UvMode::automatic;  ///< automatic: keep when TEXCOORD_1 is valid, else unwrap
  /// Side of a page in texels, 1 .. 16384; per instance: of the largest. With a density only
  /// automatic pages read it.
  int resolution = 512;
  float texels_per_metre = 0;  ///< > 0: the density; the side is the smallest power of 2 that fits
  int gutter = 2;              ///< empty texels between charts
  float max_chart_angle_rad =
      0.8f;  ///< unwrap: largest angle between a triangle and its chart's axis
  /// Unwrap: per drawn triangle; charts never hold triangles of different groups. Empty: one group.
  std::vector<uint32_t> group{};
  PageMode page_mode = PageMode::fixed;
  int pages = 1;  ///< fixed: how many; more than one with a resolution only
};

/// Measures of a layout; printed by `luxel bench atlas` and `luxel info`.
struct AtlasStats {
  uint32_t charts = 0;
  double utilisation = 0;       ///< covered texels / all texels of all pages
  double mean_stretch_l2 = 0;   ///< area-weighted L2 stretch, 1 is perfect [Sander01, section 3]
  double texels_per_metre = 0;  ///< mean density
  uint32_t triangles_without_texel = 0;  ///< triangles that touch no texel of their own chart: 0
  double owning_triangles = 0;           ///< share of the triangles that own a texel themselves
};

/// Lays the scene out. Errors: --uv keep without or with invalid TEXCOORD_1 (names the triangles);
/// a resolution that is too small (states the smallest that works) or out of range. Several pages
/// are always laid out anew; more errors: a triangle longer than an automatic page, more pages than
/// kMaxPages, and more texels on them than the solvers can number.
Result<Atlas> make_atlas(const scene::Scene& scene, const AtlasParams& params, Progress& progress);

/// Clips every triangle against the texels it touches and gives each texel one owner: the triangle
/// that holds its centre, else the one that covers most of it (ties: the lower number). Texels lie
/// in `memory` where there is one, if they are many and it has room.
TexelMap rasterise(const scene::Scene& scene, const Atlas& atlas,
                   std::shared_ptr<MappedMemory> memory = nullptr);
/// rasterise() by the members of a team, some rows each. All get the whole map. Without a team this
/// process makes it. Errors: cancelled, another member gives up.
Result<TexelMap> rasterise_together(const scene::Scene& scene, const Atlas& atlas, Team* team,
                                    std::shared_ptr<MappedMemory> memory, Progress& progress);
/// The map of texels that lie on the atlas.
TexelMap map_of(const Atlas& atlas, MappedVector<Texel> texels);

/// A place of the atlas in the coordinates of a triangle of it; negative ones where it has no area.
inline Barycentric barycentric_in(const std::array<Vec2, 3>& corners, Vec2 p) {
  const Vec2 e1 = corners[1] - corners[0], e2 = corners[2] - corners[0], d = p - corners[0];
  const float area = cross(e1, e2);
  if (area == 0) return {-1, -1};
  return {cross(d, e2) / area, cross(e1, d) / area};
}

/// Measures a layout; `map` is the atlas's.
AtlasStats atlas_stats(const scene::Scene& scene, const Atlas& atlas, const TexelMap& map);

/// The texels that triangles of more than one chart touch: only a kept TEXCOORD_1 has any.
std::vector<uint32_t> overlapping_texels(const Atlas& atlas, const TexelMap& map);

/// The texels of one chart that bilinear look-ups on another one blend in: charts lie less than a
/// texel apart there. Only a kept TEXCOORD_1 has any.
std::vector<uint32_t> blended_texels(const Atlas& atlas, const TexelMap& map);

}  // namespace luxel::atlas
