// A square of the atlas with what lies around it, channel by channel: loops look at eight texels of
// a row at once.
#pragma once

#include <array>
#include <cstring>
#include <vector>

#include "luxel/base/share_out.h"
#include "luxel/base/vectorize.h"
#include "luxel/post/neighbours.h"

namespace luxel::post {

inline constexpr int kTileSide = 64;
/// Lanes of a vector.
inline constexpr int kLanes = 8;

/// Reused from tile to tile. Cells without a texel have no spacing.
struct TexelTile {
  int first_x = 0, first_y = 0;  ///< of the texel in the first cell; below 0 at the atlas's border
  int side = 0;                  ///< in cells, with what lies around
  size_t stride = 0;             ///< of rows: vectors that begin in a row end in it
  std::array<std::vector<float>, 3> position, normal;
  std::vector<float> spacing;
  std::vector<int32_t> region;

  size_t cell(int x, int y) const { return size_t(y - first_y) * stride + size_t(x - first_x); }
};

/// Tiles in a row of the atlas.
inline int tiles_across(const Neighbourhood& n) {
  return (n.map->resolution + kTileSide - 1) / kTileSide;
}
inline size_t tile_count(const Neighbourhood& n) {
  return size_t(tiles_across(n)) * size_t(tiles_across(n));
}
/// The texel in a cell of the atlas; kNone: there is none, or the atlas has no such cell.
inline uint32_t texel_at(const atlas::TexelMap& map, int x, int y) {
  const int side = map.resolution;
  if (x < 0 || y < 0 || x >= side || y >= side) return atlas::kNone;
  return map.texel_at[size_t(y) * size_t(side) + size_t(x)];
}

/// Fills a tile with the number-th square of the atlas and `halo` cells around it, and calls
/// take(cell, texel) for each cell with a texel. Calls clear(cells) first.
template <class Clear, class Take>
void fill_tile(const Neighbourhood& n, size_t number, int halo, const Clear& clear,
               const Take& take, TexelTile& out) {
  const size_t across = size_t(tiles_across(n));
  out.first_x = int(number % across) * kTileSide - halo;
  out.first_y = int(number / across) * kTileSide - halo;
  out.side = kTileSide + 2 * halo, out.stride = size_t(out.side + kLanes);
  const size_t cells = out.stride * size_t(out.side);
  for (auto& channel : out.position) channel.resize(cells);
  for (auto& channel : out.normal) channel.resize(cells);
  out.spacing.assign(cells, 0.0f), out.region.resize(cells);
  clear(cells);
  for (int y = out.first_y; y < out.first_y + out.side; ++y)
    for (int x = out.first_x; x < out.first_x + out.side; ++x) {
      const uint32_t j = texel_at(*n.map, x, y);
      if (j == atlas::kNone) continue;
      const SurfaceSample& place = n.place[j];
      const size_t cell = out.cell(x, y);
      for (int c = 0; c < 3; ++c) {
        out.position[size_t(c)][cell] = place.position[c];
        out.normal[size_t(c)][cell] = place.normal[c];
      }
      out.spacing[cell] = place.spacing, out.region[cell] = int32_t(place.region);
      take(cell, j);
    }
}
/// Calls visit(texel) for all texels of the number-th square of the atlas.
template <class Visit>
void for_texels_of_square(const Neighbourhood& n, size_t number, const Visit& visit) {
  const size_t across = size_t(tiles_across(n));
  const int x0 = int(number % across) * kTileSide, y0 = int(number / across) * kTileSide;
  for (int y = y0; y < y0 + kTileSide; ++y)
    for (int x = x0; x < x0 + kTileSide; ++x)
      if (const uint32_t i = texel_at(*n.map, x, y); i != atlas::kNone) visit(i);
}

/// Gives all members of a team what each has set of `values`, one per texel, for the texels of its
/// `own` squares. Nothing happens without a team. Errors: those of exchange().
template <class T>
Status give_squares(Team* team, std::span<const uint32_t> own, const Neighbourhood& n,
                    Progress& progress, std::span<T> values) {
  return exchange(team, own,
                  {tile_count(n),
                   [&](size_t number, ByteWriter& out) {
                     for_texels_of_square(n, number, [&](uint32_t i) { out.put_value(values[i]); });
                   },
                   [&](size_t number, uint32_t, ByteReader& in) {
                     for_texels_of_square(n, number,
                                          [&](uint32_t i) { values[i] = in.get_value<T>(); });
                     return in.ok;
                   }},
                  progress);
}

/// Calls visit(texel, cell) for all texels of the tile's square.
template <class Visit>
void for_texels_of(const Neighbourhood& n, const TexelTile& tile, int halo, const Visit& visit) {
  for (int y = tile.first_y + halo; y < tile.first_y + halo + kTileSide; ++y)
    for (int x = tile.first_x + halo; x < tile.first_x + halo + kTileSide; ++x) {
      const uint32_t i = texel_at(*n.map, x, y);
      if (i != atlas::kNone) visit(i, tile.cell(x, y));
    }
}

/// The neighbours in eight cells.
struct NeighbourLanes {
  Float8 u, v;
  Float8 weight;  ///< 0 on another surface
};

/// neighbour() of eight cells that follow each other.
[[gnu::always_inline]] inline void neighbours_in(const TexelTile& tile, const Around& a,
                                                 size_t cell, NeighbourLanes& out) {
  Float8 x, y, z, nx, ny, nz, spacing;
  load8(&tile.position[0][cell], x), load8(&tile.position[1][cell], y);
  load8(&tile.position[2][cell], z);
  load8(&tile.normal[0][cell], nx), load8(&tile.normal[1][cell], ny);
  load8(&tile.normal[2][cell], nz), load8(&tile.spacing[cell], spacing);
  Int32x8 region;
  std::memcpy(&region, &tile.region[cell], sizeof region);
  const Vec3 p = a.own.position, n = a.own.normal, t = a.frame.tangent, b = a.frame.bitangent;
  x -= p.x, y -= p.y, z -= p.z;
  const Float8 zero{}, d2 = x * x + y * y + z * z;
  const Float8 near = 1 - d2 * a.per_reach2;
  const Float8 facing = nx * n.x + ny * n.y + nz * n.z - a.min_cosine;
  const Float8 below = x * n.x + y * n.y + z * n.z, above = x * nx + y * ny + z * nz;
  const Float8 off_own = below < zero ? -below : below, off_other = above < zero ? -above : above;
  const Float8 off = (off_own > off_other ? off_own : off_other) - 0.25f * a.own.spacing;
  const Float8 beyond = off > zero ? off : zero;
  const Int32x8 counts = (near > zero) & (facing > zero) & (spacing > zero) &
                         (beyond * beyond <= d2 * 0.04f) & (region == int32_t(a.own.region));
  // Infinities elsewhere are kept out of sums.
  out.u = counts ? (x * t.x + y * t.y + z * t.z) * a.texels_per_metre : zero;
  out.v = counts ? (x * b.x + y * b.y + z * b.z) * a.texels_per_metre : zero;
  out.weight = counts ? near * facing * a.per_facing : zero;
}

/// 1 in the lanes of a vector that begins `first` cells into a row of `count`, 0 beyond its end.
[[gnu::always_inline]] inline void lanes_within(int first, int count, Float8& out) {
  for (int k = 0; k < kLanes; ++k) out[k] = first + k < count ? 1.0f : 0.0f;
}

}  // namespace luxel::post
