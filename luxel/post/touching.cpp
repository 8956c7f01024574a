#include "luxel/post/touching.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <unordered_map>

#include "luxel/base/parallel.h"
#include "luxel/base/random.h"

namespace luxel::post {
namespace {

/// In the world.
struct Line {
  Vec3 from, along;  ///< along: unit
  float length = 0;
  Vec3 inward;  ///< unit, in the triangle's plane, away from the edge
  int size_class = 0;

  Vec3 at(float t) const { return from + along * t; }
};

/// Cells of a class are as wide as its longest edges: an edge lies in a few of them, and a cell
/// holds only edges of about its own size, however unlike the meshes of a scene are. No cell is
/// smaller than the tolerance by which an edge's box is grown: a splinter of a micrometre would
/// fill millions of them.
int class_of(float length, float tolerance) {
  return int(std::ceil(std::log2(std::max(length, tolerance))));
}

std::vector<Line> lines_of(const scene::Scene& scene, std::span<const OpenEdge> edges,
                           float tolerance) {
  std::vector<Line> lines(edges.size());
  parallel_for(edges.size(), 1024, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const auto [a, b, c] = scene::world_triangle(scene, edges[i].instance, edges[i].triangle);
      const Vec3 corners[3] = {a, b, c};
      const Vec3 from = corners[edges[i].corner], to = corners[(edges[i].corner + 1) % 3];
      const Vec3 apex = corners[(edges[i].corner + 2) % 3] - from;
      Line& line = lines[i];
      line.from = from, line.along = normalize(to - from), line.length = length(to - from);
      line.inward = normalize(apex - line.along * dot(apex, line.along));
      if (line.length > 0) line.size_class = class_of(line.length, tolerance);
    }
  });
  return lines;
}

/// Calls visit(key) for every cell of the class that the line's box touches.
template <class Visit>
void for_cells(const Line& line, int size_class, float tolerance, const Visit& visit) {
  const float cell = std::ldexp(1.0f, size_class);
  const Vec3 to = line.at(line.length), t{tolerance, tolerance, tolerance};
  const Vec3 low = (min(line.from, to) - t) / cell, high = (max(line.from, to) + t) / cell;
  const auto floor_of = [](float x) { return int64_t(std::floor(x)); };
  for (int64_t x = floor_of(low.x); x <= floor_of(high.x); ++x)
    for (int64_t y = floor_of(low.y); y <= floor_of(high.y); ++y)
      for (int64_t z = floor_of(low.z); z <= floor_of(high.z); ++z)
        visit(hash64(hash64(uint64_t(size_class), uint64_t(x)), hash64(uint64_t(y), uint64_t(z))));
}

/// A stretch over which two edges coincide.
struct Contact {
  uint32_t a = 0, b = 0;  ///< a < b
  float a0 = 0, a1 = 0;   ///< on a, metres from its start; a0 < a1
  float b0 = 0, b1 = 0;   ///< these places on b
};

/// The edges coincide over some length; `contact` gets the stretch.
bool touch(const std::vector<Line>& lines, uint32_t i, uint32_t j, float scene_tolerance,
           Contact& contact) {
  const Line &a = lines[i], &b = lines[j];
  const float tolerance = std::min(scene_tolerance, 0.01f * std::min(a.length, b.length));
  const float start = dot(b.from - a.from, a.along);
  const float slope = dot(b.along, a.along);  // of places on a over places on b
  if (std::abs(slope) < 0.99f) return false;
  const float end = start + slope * b.length;
  const float a0 = std::max(0.0f, std::min(start, end));
  const float a1 = std::min(a.length, std::max(start, end));
  if (a1 - a0 <= 4 * tolerance) return false;
  const auto on_b = [&](float t) { return std::clamp((t - start) / slope, 0.0f, b.length); };
  contact = {i, j, a0, a1, on_b(a0), on_b(a1)};
  return length(a.at(a0) - b.at(contact.b0)) <= tolerance &&
         length(a.at(a1) - b.at(contact.b1)) <= tolerance;
}

/// All pairs of edges that coincide over some length, each once, sorted.
std::vector<Contact> find_contacts(const std::vector<Line>& lines, float tolerance) {
  std::vector<std::pair<uint64_t, uint32_t>> entries;
  std::set<int> classes;
  for (uint32_t i = 0; i < lines.size(); ++i) {
    if (!(lines[i].length > 0)) continue;
    classes.insert(lines[i].size_class);
    for_cells(lines[i], lines[i].size_class, tolerance, [&](uint64_t key) {
      entries.push_back({key, i});
    });
  }
  std::sort(entries.begin(), entries.end());
  std::unordered_map<uint64_t, std::pair<size_t, size_t>> cells;
  for (size_t begin = 0, end = 0; begin < entries.size(); begin = end) {
    while (end < entries.size() && entries[end].first == entries[begin].first) ++end;
    cells[entries[begin].first] = {begin, end};
  }
  constexpr size_t kBlock = 1024;
  std::vector<std::vector<Contact>> found((lines.size() + kBlock - 1) / kBlock);
  parallel_for(lines.size(), kBlock, [&](size_t begin, size_t end) {
    std::vector<uint32_t> near;
    for (uint32_t i = uint32_t(begin); i < end; ++i) {
      if (!(lines[i].length > 0)) continue;
      near.clear();
      // Shorter edges look for longer ones; among edges of a class, the earlier for the later.
      for (auto c = classes.lower_bound(lines[i].size_class); c != classes.end(); ++c)
        for_cells(lines[i], *c, tolerance, [&](uint64_t key) {
          const auto cell = cells.find(key);
          if (cell == cells.end()) return;
          for (size_t k = cell->second.first; k < cell->second.second; ++k) {
            const uint32_t j = entries[k].second;
            if (*c > lines[i].size_class || j > i) near.push_back(j);
          }
        });
      std::sort(near.begin(), near.end());
      near.erase(std::unique(near.begin(), near.end()), near.end());
      Contact contact;
      for (const uint32_t j : near)
        if (touch(lines, std::min(i, j), std::max(i, j), tolerance, contact))
          found[begin / kBlock].push_back(contact);
    }
  });
  std::vector<Contact> all;
  for (const auto& block : found) all.insert(all.end(), block.begin(), block.end());
  std::sort(all.begin(), all.end(),
            [](const Contact& p, const Contact& q) { return p.a != q.a ? p.a < q.a : p.b < q.b; });
  // A cell of another class may share a key.
  all.erase(
      std::unique(all.begin(), all.end(),
                  [](const Contact& p, const Contact& q) { return p.a == q.a && p.b == q.b; }),
      all.end());
  return all;
}

/// The place t metres along an edge.
scene::SurfacePoint place_on(const OpenEdge& edge, const Line& line, float t) {
  const float s = std::clamp(t / line.length, 0.0f, 1.0f);
  float weight[3] = {0, 0, 0};
  weight[edge.corner] = 1 - s, weight[(edge.corner + 1) % 3] = s;
  return {edge.instance, edge.triangle, {weight[1], weight[2]}};
}

/// One surface goes on where the other ends.
bool goes_on(const scene::Scene& scene, std::span<const OpenEdge> edges,
             const std::vector<Line>& lines, const Contact& c, float min_cosine) {
  if (dot(lines[c.a].inward, lines[c.b].inward) >= 0) return false;
  const auto agree = [&](float on_a, float on_b) {
    return dot(shading_normal(scene, place_on(edges[c.a], lines[c.a], on_a)),
               shading_normal(scene, place_on(edges[c.b], lines[c.b], on_b))) >= min_cosine;
  };
  return agree(c.a0, c.b0) && agree(c.a1, c.b1);
}

/// A triangle that rises from the surface by more than this (sine of the angle) cuts the light.
constexpr float kStanding = 0.3f;

/// Stretches of edges, per edge, on which some other triangle stands.
using Standing = std::unordered_map<uint32_t, std::vector<std::pair<float, float>>>;

Standing find_standing(const scene::Scene& scene, std::span<const OpenEdge> edges,
                       const std::vector<Line>& lines, const std::vector<Contact>& contacts) {
  Standing standing;
  const auto rises = [&](uint32_t base, uint32_t other) {
    const Vec3 n = scene::front_normal(scene, edges[base].instance, edges[base].triangle);
    return dot(lines[other].inward, n) > kStanding;
  };
  for (const Contact& c : contacts) {
    if (rises(c.a, c.b)) standing[c.a].push_back({c.a0, c.a1});
    if (rises(c.b, c.a)) standing[c.b].push_back({std::min(c.b0, c.b1), std::max(c.b0, c.b1)});
  }
  return standing;
}

bool stands_on(const Standing& standing, uint32_t edge, float t0, float t1) {
  const auto found = standing.find(edge);
  if (found == standing.end()) return false;
  if (t0 > t1) std::swap(t0, t1);
  return std::any_of(found->second.begin(), found->second.end(), [&](const auto& s) {
    return std::min(s.second, t1) - std::max(s.first, t0) > 0.1f * (t1 - t0);
  });
}

Seam seam_of(const atlas::Atlas& atlas, std::span<const OpenEdge> edges,
             const std::vector<Line>& lines, const Contact& c) {
  const auto number_of = [&](uint32_t edge) {
    return atlas.triangle_number(edges[edge].instance, edges[edge].triangle);
  };
  const auto in_atlas = [&](uint32_t edge, float t) {
    const OpenEdge& e = edges[edge];
    const auto& corners = atlas.corners[number_of(edge)];
    const float s = t / lines[edge].length;
    return corners[e.corner] * (1 - s) + corners[(e.corner + 1) % 3] * s;
  };
  return {in_atlas(c.a, c.a0), in_atlas(c.a, c.a1), in_atlas(c.b, c.b0),
          in_atlas(c.b, c.b1), number_of(c.a),      number_of(c.b)};
}

}  // namespace

std::vector<Seam> find_touching(const scene::Scene& scene, const atlas::Atlas& atlas,
                                std::span<const OpenEdge> edges, float min_cosine) {
  const float tolerance = kTouchTolerance * scene::world_bounds(scene).diagonal();
  const std::vector<Line> lines = lines_of(scene, edges, tolerance);
  const std::vector<Contact> contacts = find_contacts(lines, tolerance);
  const Standing standing = find_standing(scene, edges, lines, contacts);
  std::vector<Seam> seams;
  for (const Contact& c : contacts) {
    if (!goes_on(scene, edges, lines, c, min_cosine)) continue;
    if (stands_on(standing, c.a, c.a0, c.a1) || stands_on(standing, c.b, c.b0, c.b1)) continue;
    const Seam seam = seam_of(atlas, edges, lines, c);
    constexpr float kSamePlace = 1e-3f;  // texels
    if (length(seam.a0 - seam.b0) < kSamePlace && length(seam.a1 - seam.b1) < kSamePlace) continue;
    seams.push_back(seam);
  }
  return seams;
}

}  // namespace luxel::post
