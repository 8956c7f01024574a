#include "luxel/view/live/spread_texels.h"

#include <algorithm>
#include <cmath>

#include "luxel/base/parallel.h"
#include "luxel/base/random.h"

namespace luxel::view {
namespace {

constexpr size_t kSpreadGrain = 4096;
/// Cubes have sides of an eighth of their distance from what was edited.
constexpr float kDistanceOverSide = 8;
constexpr int kMostLevel = 20;
constexpr uint32_t kNoCell = UINT32_MAX;
/// Cells over those that were asked for before larger ones are tried.
constexpr double kMoreThanAsked = 1.5;
/// Squared cosines below it have no share.
constexpr float kFacesAway = 1e-3f;

float distance_to(const Box3& box, Vec3 p) {
  return length(max(max(box.lower - p, p - box.upper), Vec3{}));
}

uint64_t key_of(int level, int axis, std::array<int, 3> at, uint32_t body) {
  const auto bits = [](int x) { return uint64_t(uint32_t(x)) & 0x1ffff; };
  const uint64_t key = bits(at[0]) | bits(at[1]) << 17 | bits(at[2]) << 34 | uint64_t(axis) << 51 |
                       uint64_t(level) << 54;
  return std::max<uint64_t>(hash64(key, body), 1);
}

std::array<int, 3> cube_of(Vec3 at) {
  return {int(std::floor(at.x)), int(std::floor(at.y)), int(std::floor(at.z))};
}

std::array<float, 3> array_of(Vec3 v) { return {v.x, v.y, v.z}; }

/// Towards +x, -x, +y, ...
int component_axis(int k, float component) { return 2 * k + (component < 0 ? 1 : 0); }

int main_axis(Vec3 normal) {
  const auto n = array_of(normal);
  int k = 0;
  for (int i = 1; i < 3; ++i)
    if (std::abs(n[size_t(i)]) > std::abs(n[size_t(k)])) k = i;
  return component_axis(k, n[size_t(k)]);
}

/// The finest side of cells by which there are about `most` of them: each texel is as large as the
/// mean of all, and fills a part of its cell.
float finest_for(const TexelPlaces& places, CellGrid grid, size_t most) {
  const size_t n = places.position.size(), step = std::max<size_t>(n / 8192, 1);
  for (int k = 0; k < 40; ++k) {
    double cells = 0;
    for (size_t i = 0; i < n; i += step) {
      const float side = grid.side_m(grid.level_at(places.position[i]));
      cells += double(step) * std::min(1.0, double(places.texel_m2) / double(side * side));
    }
    if (cells <= double(most)) break;
    grid.finest_m *= 1.15f;
  }
  return grid.finest_m;
}

}  // namespace

int CellGrid::level_at(Vec3 place) const {
  if (edited.empty()) return 0;
  float nearest = INFINITY;
  for (const Box3& box : edited) nearest = std::min(nearest, distance_to(box, place));
  const float sides = nearest / (kDistanceOverSide * finest_m);
  return sides < 2 ? 0 : std::min(std::ilogb(sides), kMostLevel);
}

SpreadTexels::SpreadTexels(const TexelPlaces& places, CellGrid grid, size_t most)
    : places_(places), grid_(std::move(grid)) {
  grid_.finest_m = finest_for(places_, grid_, most);
  const size_t n = places_.position.size();
  std::vector<uint64_t> keys(n);
  std::vector<float> off(n);
  level_.resize(n);
  for (int again = 0; again < 3; ++again) {
    parallel_for(n, kSpreadGrain, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        level_[i] = uint8_t(grid_.level_at(places_.position[i]));
        const Vec3 at = places_.position[i] / grid_.side_m(level_[i]);
        const std::array<int, 3> cube = cube_of(at);
        keys[i] = key_of(level_[i], main_axis(places_.normal[i]), cube, places_.body[i]);
        off[i] = length(at - Vec3{float(cube[0]), float(cube[1]), float(cube[2])} -
                        Vec3{0.5f, 0.5f, 0.5f});
      }
    });
    number_cells(keys, off);
    if (double(size()) <= kMoreThanAsked * double(most)) break;
    // Surfaces lie closer together than an even one would.
    grid_.finest_m *= std::sqrt(float(size()) / float(most));
  }
  find_around();
}

void SpreadTexels::number_cells(std::span<const uint64_t> keys, std::span<const float> off) {
  texel_.clear(), cell_of_texel_.assign(keys.size(), kNoCell);
  keys_.assign(1 << 10, 0), cells_.assign(1 << 10, kNoCell);
  for (size_t i = 0; i < keys.size(); ++i) {
    // Texels mostly lie in the cell of the one before.
    uint32_t cell = i > 0 && keys[i] == keys[i - 1] ? cell_of_texel_[i - 1] : kNoCell;
    if (cell == kNoCell) {
      if (2 * texel_.size() > keys_.size()) grow();
      const size_t at = place_of(keys[i]);
      if (keys_[at] == 0) {
        keys_[at] = keys[i], cells_[at] = uint32_t(texel_.size());
        texel_.push_back(uint32_t(i));
      }
      cell = cells_[at];
    }
    cell_of_texel_[i] = cell;
    if (off[i] < off[texel_[cell]]) texel_[cell] = uint32_t(i);
  }
}

void SpreadTexels::grow() {
  const std::vector<uint64_t> keys = std::move(keys_);
  const std::vector<uint32_t> cells = std::move(cells_);
  keys_.assign(4 * keys.size(), 0), cells_.assign(4 * keys.size(), kNoCell);
  for (size_t k = 0; k < keys.size(); ++k) {
    if (keys[k] == 0) continue;
    const size_t at = place_of(keys[k]);
    keys_[at] = keys[k], cells_[at] = cells[k];
  }
}

size_t SpreadTexels::place_of(uint64_t key) const {
  size_t at = key & (keys_.size() - 1);
  while (keys_[at] != 0 && keys_[at] != key) at = (at + 1) & (keys_.size() - 1);
  return at;
}

uint32_t SpreadTexels::find(uint64_t key) const {
  const size_t at = place_of(key);
  return keys_[at] == 0 ? kNoCell : cells_[at];
}

void SpreadTexels::find_around() {
  around_.resize(size());
  parallel_for(size(), 256, [&](size_t begin, size_t end) {
    for (size_t cell = begin; cell < end; ++cell) {
      const uint32_t texel = texel_[cell];
      const std::array<int, 3> at = cube_of(places_.position[texel] / grid_.side_m(level_[texel]));
      const int axis = main_axis(places_.normal[texel]);
      for (int k = 0; k < 27; ++k)
        around_[cell][size_t(k)] = find(key_of(
            level_[texel], axis, {at[0] + k % 3 - 1, at[1] + k / 3 % 3 - 1, at[2] + k / 9 - 1},
            places_.body[texel]));
    }
  });
}

std::vector<CellsBeside> SpreadTexels::beside() const {
  std::vector<CellsBeside> out(size());
  for (size_t cell = 0; cell < size(); ++cell)
    for (const uint32_t other : around_[cell])
      if (other != kNoCell) out[cell].cells[out[cell].count++] = other;
  return out;
}

size_t SpreadTexels::shares_at(size_t texel, std::array<CellShare, kMostShares>& out) const {
  const auto normal = array_of(places_.normal[texel]);
  const Vec3 place = places_.position[texel] / grid_.side_m(level_[texel]);
  const Vec3 at = place - Vec3{0.5f, 0.5f, 0.5f};
  const std::array<int, 3> base = cube_of(at), own = cube_of(place);
  const CellsAround& around = around_[cell_of_texel_[texel]];
  const int main = main_axis(places_.normal[texel]);
  const std::array<float, 3> over{at.x - float(base[0]), at.y - float(base[1]),
                                  at.z - float(base[2])};
  size_t count = 0;
  for (int k = 0; k < 3; ++k) {
    const float facing = normal[size_t(k)] * normal[size_t(k)];
    if (facing < kFacesAway) continue;
    const int axis = component_axis(k, normal[size_t(k)]);
    for (int corner = 0; corner < 8; ++corner) {
      float weight = facing;
      std::array<int, 3> cube = base;
      for (size_t i = 0; i < 3; ++i) {
        const bool upper = corner >> i & 1;
        weight *= upper ? over[i] : 1 - over[i];
        cube[i] += upper;
      }
      if (weight <= 0) continue;
      const size_t beside =
          size_t(cube[0] - own[0] + 1 + 3 * (cube[1] - own[1] + 1) + 9 * (cube[2] - own[2] + 1));
      const uint32_t cell = axis == main
                                ? around[beside]
                                : find(key_of(level_[texel], axis, cube, places_.body[texel]));
      if (cell != kNoCell) out[count++] = {cell, weight};
    }
  }
  // None of many normals is the texel's own, or its own cell is as far away as can be.
  if (count == 0) out[count++] = {cell_of_texel_[texel], 1};
  return count;
}

}  // namespace luxel::view
