#include "luxel/import/polygon.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "luxel/base/check.h"
#include "luxel/base/exact_predicates.h"

namespace luxel::import {
namespace {

/// The outline that is left, seen so that it turns left.
struct Outline {
  std::vector<DVec2> at;
  std::vector<uint32_t> prev, next;
};

/// All corners, by the square cell of the plane in which they lie.
struct Cells {
  DVec2 lower;
  double per_m = 0;  ///< cells per metre
  size_t across = 1, down = 1;
  std::vector<uint32_t> first;   ///< of each cell and one more, into `corner`
  std::vector<uint32_t> corner;  ///< by cell
};

/// Corners that may be cut off, the best first: ears whose new edge touches no other corner; ears;
/// corners on the line of their neighbours, which leave no triangle.
enum class Cut { clean, touching, flat };

/// Newell's normal, relative to the first corner: far coordinates lose nothing.
DVec3 normal_of(std::span<const DVec3> corners) {
  DVec3 sum;
  for (size_t k = 1; k + 1 < corners.size(); ++k)
    sum += cross(corners[k] - corners[0], corners[k + 1] - corners[0]);
  return sum;
}

/// True where any triangle of the fan from the first corner has area.
bool has_area(std::span<const DVec3> corners) {
  for (size_t k = 1; k + 1 < corners.size(); ++k) {
    const DVec3 n = cross(corners[k] - corners[0], corners[k + 1] - corners[0]);
    if (n != DVec3{}) return true;
  }
  return false;
}

/// The corners without the coordinate along which the normal is longest: no other is rounded, so
/// the predicates decide exactly.
std::vector<DVec2> flattened(std::span<const DVec3> corners, DVec3 normal) {
  const double x = std::abs(normal.x), y = std::abs(normal.y), z = std::abs(normal.z);
  std::vector<DVec2> out;
  for (const DVec3& c : corners) {
    DVec2 p = x >= y && x >= z ? DVec2{c.y, c.z} : y >= z ? DVec2{c.z, c.x} : DVec2{c.x, c.y};
    const double along = x >= y && x >= z ? normal.x : y >= z ? normal.y : normal.z;
    if (along < 0) std::swap(p.x, p.y);
    out.push_back(p);
  }
  return out;
}

Outline outline_of(std::vector<DVec2> at) {
  const auto n = uint32_t(at.size());
  Outline out{std::move(at), std::vector<uint32_t>(n), std::vector<uint32_t>(n)};
  for (uint32_t k = 0; k < n; ++k) out.prev[k] = (k + n - 1) % n, out.next[k] = (k + 1) % n;
  return out;
}

size_t cell_along(double offset_m, const Cells& cells, size_t count) {
  return size_t(std::clamp(offset_m * cells.per_m, 0.0, double(count - 1)));
}

size_t cell_of(DVec2 p, const Cells& cells) {
  return cell_along(p.y - cells.lower.y, cells, cells.down) * cells.across +
         cell_along(p.x - cells.lower.x, cells, cells.across);
}

/// About one corner per cell.
Cells cells_of(const std::vector<DVec2>& at) {
  Cells out{at[0], 0, 1, 1, {}, {}};
  DVec2 upper = at[0];
  for (const DVec2 p : at) {
    out.lower = {std::min(out.lower.x, p.x), std::min(out.lower.y, p.y)};
    upper = {std::max(upper.x, p.x), std::max(upper.y, p.y)};
  }
  const DVec2 size = upper - out.lower;
  const auto n = double(at.size());
  out.per_m = std::min(std::sqrt(n / (size.x * size.y)), n / std::max(size.x, size.y));
  out.across = size_t(size.x * out.per_m) + 1, out.down = size_t(size.y * out.per_m) + 1;
  out.first.assign(out.across * out.down + 1, 0);
  for (const DVec2 p : at) ++out.first[cell_of(p, out) + 1];
  std::partial_sum(out.first.begin(), out.first.end(), out.first.begin());
  out.corner.resize(at.size());
  std::vector<uint32_t> end(out.first.begin(), out.first.end() - 1);
  for (uint32_t k = 0; k < at.size(); ++k) out.corner[end[cell_of(at[k], out)]++] = k;
  return out;
}

/// A triangle that turns left, and the box around it.
struct Ear {
  DVec2 a, b, c, lower, upper;
};

Ear ear_of(DVec2 a, DVec2 b, DVec2 c) {
  return {a,
          b,
          c,
          {std::min({a.x, b.x, c.x}), std::min({a.y, b.y, c.y})},
          {std::max({a.x, b.x, c.x}), std::max({a.y, b.y, c.y})}};
}

/// True where the edge from q to r meets the inside of the ear. It does not where a line parts
/// them: one along a side of the ear, or the edge's own (the separating axes of two convex shapes).
bool meets(const Ear& ear, DVec2 q, DVec2 r) {
  if (std::max(q.x, r.x) <= ear.lower.x || std::min(q.x, r.x) >= ear.upper.x ||
      std::max(q.y, r.y) <= ear.lower.y || std::min(q.y, r.y) >= ear.upper.y)
    return false;
  const auto parts = [&](DVec2 from, DVec2 to) {
    return orientation(from, to, q) <= 0 && orientation(from, to, r) <= 0;
  };
  if (parts(ear.a, ear.b) || parts(ear.b, ear.c) || parts(ear.c, ear.a)) return false;
  const int a = orientation(q, r, ear.a), b = orientation(q, r, ear.b),
            c = orientation(q, r, ear.c);
  return std::min({a, b, c}) < 0 && std::max({a, b, c}) > 0;
}

/// True where corner q keeps the ear from being cut off: it lies inside, or on the border with an
/// edge that goes inside, or, for a clean cut, on the new edge.
bool blocks(const Outline& outline, uint32_t q, const Ear& ear, Cut cut) {
  const DVec2 p = outline.at[q];
  if (p.x < ear.lower.x || p.x > ear.upper.x || p.y < ear.lower.y || p.y > ear.upper.y)
    return false;
  const int ab = orientation(ear.a, ear.b, p), bc = orientation(ear.b, ear.c, p),
            ca = orientation(ear.c, ear.a, p);
  if (ab < 0 || bc < 0 || ca < 0) return false;
  if (ab > 0 && bc > 0 && ca > 0) return true;
  if (cut == Cut::clean && ca == 0 && ab > 0 && bc > 0) return true;
  return meets(ear, p, outline.at[outline.next[q]]) || meets(ear, outline.at[outline.prev[q]], p);
}

bool is_left(const Outline& outline, uint32_t corner) {
  return outline.next[outline.prev[corner]] == corner;
}

bool any_blocks(const Outline& outline, const Cells& cells, const Ear& ear,
                std::array<uint32_t, 3> own, Cut cut) {
  const size_t left = cell_along(ear.lower.x - cells.lower.x, cells, cells.across),
               right = cell_along(ear.upper.x - cells.lower.x, cells, cells.across),
               bottom = cell_along(ear.lower.y - cells.lower.y, cells, cells.down),
               top = cell_along(ear.upper.y - cells.lower.y, cells, cells.down);
  for (size_t y = bottom; y <= top; ++y)
    for (uint32_t k = cells.first[y * cells.across + left];
         k < cells.first[y * cells.across + right + 1]; ++k) {
      const uint32_t q = cells.corner[k];
      if (is_left(outline, q) && q != own[0] && q != own[1] && q != own[2] &&
          blocks(outline, q, ear, cut))
        return true;
    }
  return false;
}

bool can_be_cut(const Outline& outline, const Cells& cells, uint32_t corner, Cut cut) {
  const uint32_t from = outline.prev[corner], to = outline.next[corner];
  const Ear ear = ear_of(outline.at[from], outline.at[corner], outline.at[to]);
  const int turn = orientation(ear.a, ear.b, ear.c);
  if (cut == Cut::flat) return turn == 0;
  if (turn <= 0) return false;
  if (meets(ear, outline.at[outline.prev[from]], ear.a) ||
      meets(ear, ear.c, outline.at[outline.next[to]]))
    return false;
  return !any_blocks(outline, cells, ear, {from, corner, to}, cut);
}

/// True where the outline turns back at a corner, or two corners are one: no area is lost without
/// it.
bool is_spike(const Outline& outline, uint32_t corner) {
  const DVec2 a = outline.at[outline.prev[corner]], b = outline.at[corner],
              c = outline.at[outline.next[corner]];
  return dot(a - b, c - b) >= 0 && orientation(a, b, c) == 0;
}

void take_out(Outline& outline, uint32_t corner) {
  outline.next[outline.prev[corner]] = outline.next[corner];
  outline.prev[outline.next[corner]] = outline.prev[corner];
}

/// The next corner to be cut off, and how; the outline's `left` corners are looked at from `first`
/// on. False: there is none.
bool find_cut(const Outline& outline, const Cells& cells, size_t left, uint32_t& first, Cut& cut) {
  for (const Cut kind : {Cut::clean, Cut::touching, Cut::flat})
    for (size_t k = 0; k < left; ++k, first = outline.next[first])
      if (can_be_cut(outline, cells, first, kind)) return cut = kind, true;
  return false;
}

/// Twice the area of a triangle.
double area_of(const Outline& outline, const std::array<uint32_t, 3>& t) {
  const DVec2 a = outline.at[t[0]];
  return cross(outline.at[t[1]] - a, outline.at[t[2]] - a);
}

bool is_convex_quad(const Outline& outline) {
  if (outline.at.size() != 4) return false;
  for (uint32_t k = 0; k < 4; ++k)
    if (orientation(outline.at[k], outline.at[(k + 1) % 4], outline.at[(k + 2) % 4]) <= 0)
      return false;
  return true;
}

/// Cuts corners off until none is left; false where none can be cut off. Spikes go first: an ear
/// beside one may lie outside.
bool cut_off_all(Outline& outline, const Cells& cells, std::vector<std::array<uint32_t, 3>>& out) {
  std::vector<uint32_t> may_be_spikes(outline.at.size());
  std::iota(may_be_spikes.rbegin(), may_be_spikes.rend(), 0u);
  uint32_t corner = 1;
  for (size_t left = outline.at.size(); left >= 3;) {
    uint32_t cut_off = corner;
    Cut cut = Cut::flat;
    if (!may_be_spikes.empty()) {
      cut_off = may_be_spikes.back();
      may_be_spikes.pop_back();
      if (!is_left(outline, cut_off) || !is_spike(outline, cut_off)) continue;
    } else if (find_cut(outline, cells, left, corner, cut)) {
      cut_off = corner;
    } else {
      return false;
    }
    const uint32_t from = outline.prev[cut_off], to = outline.next[cut_off];
    if (cut != Cut::flat) out.push_back({from, cut_off, to});
    take_out(outline, cut_off);
    may_be_spikes.insert(may_be_spikes.end(), {from, to});
    if (corner == cut_off) corner = to;
    --left;
  }
  return true;
}

}  // namespace

bool triangulate(std::span<const DVec3> corners, std::vector<std::array<uint32_t, 3>>& out) {
  LUXEL_CHECK(corners.size() >= 3 && corners.size() <= kMostCorners);
  const auto fan = [&] {
    for (uint32_t k = 1; k + 1 < corners.size(); ++k) out.push_back({0, k, k + 1});
  };
  const DVec3 normal = normal_of(corners);
  const double squared = dot(normal, normal);
  // Not finite: checks of the whole scene deal with its triangles.
  if (corners.size() == 3 || !std::isfinite(squared)) return fan(), true;
  if (squared == 0) return fan(), !has_area(corners);
  Outline outline = outline_of(flattened(corners, normal));
  if (is_convex_quad(outline)) return fan(), true;
  double whole = 0, sum = 0;
  for (uint32_t k = 1; k + 1 < corners.size(); ++k) whole += area_of(outline, {0, k, k + 1});
  const size_t before = out.size();
  if (!cut_off_all(outline, cells_of(outline.at), out)) return out.resize(before), fan(), false;
  for (size_t t = before; t < out.size(); ++t) sum += area_of(outline, out[t]);
  return std::abs(sum - whole) <= 1e-9 * std::abs(whole);
}

}  // namespace luxel::import
