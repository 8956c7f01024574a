#include "solve/hemicube/projection.h"

#include <algorithm>

#include "base/check.h"

namespace luxel::hemicube {
namespace {

/// A weight of the map, not yet sorted into rows.
struct Term {
  uint32_t sender = 0, element = 0;
  float weight = 0;
};

float area_m2(const Mesh& mesh, const Node& node) {
  return scene::area_m2(
      {mesh.points[node.point[0]], mesh.points[node.point[1]], mesh.points[node.point[2]]});
}

/// The leaves of the fine mesh below each sending one.
std::vector<std::vector<uint32_t>> leaves_below(const Receivers& sending, const Mesh& fine_mesh) {
  std::vector<std::vector<uint32_t>> below(sending.leaves.size());
  for (size_t s = 0; s < sending.leaves.size(); ++s) {
    std::vector<uint32_t> open{sending.leaves[s]};
    while (!open.empty()) {
      const uint32_t n = open.back();
      open.pop_back();
      const uint32_t child = fine_mesh.nodes[n].child;
      if (child == 0)
        below[s].push_back(n);
      else
        open.push_back(child), open.push_back(child + 1);
    }
  }
  return below;
}

/// Barycentric weights, in triangle `t`, of a place of the same scene triangle.
std::array<float, 3> weights_in(const Node& t, Barycentric at) {
  const auto uv = [](Barycentric b) { return Vec2{b.u, b.v}; };
  const Vec2 a = uv(t.at[0]), e1 = uv(t.at[1]) - a, e2 = uv(t.at[2]) - a, d = uv(at) - a;
  const float area = cross(e1, e2);
  const float u = cross(d, e2) / area, v = cross(e1, d) / area;
  return {1 - u - v, u, v};
}

/// The integral over a triangle of two linear functions, given at its corners, is
/// A / 12 (sum f_m g_m + sum f_m sum g_m). Here g is a sender's hat function and f that of corner
/// m.
void add_fine(const Node& sender, const Node& leaf, float area, float sign,
              std::vector<Term>& terms) {
  std::array<std::array<float, 3>, 3> hat{};  // hat[m][k]: of the sender's corner k, at corner m
  for (size_t m = 0; m < 3; ++m) hat[m] = weights_in(sender, leaf.at[m]);
  for (size_t k = 0; k < 3; ++k) {
    const float sum = hat[0][k] + hat[1][k] + hat[2][k];
    for (size_t m = 0; m < 3; ++m)
      terms.push_back({sender.vertex[k], leaf.vertex[m], sign * area / 12 * (hat[m][k] + sum)});
  }
}

std::vector<Term> terms_per_vertex(const Mesh& sending_mesh, const Receivers& sending,
                                   const Mesh& fine_mesh) {
  const auto below = leaves_below(sending, fine_mesh);
  std::vector<Term> terms;
  for (size_t s = 0; s < below.size(); ++s) {
    const Node& sender = sending_mesh.nodes[sending.leaves[s]];
    if (below[s].size() == 1 || is_flat(sending_mesh, sender)) continue;
    for (const uint32_t leaf : below[s])
      add_fine(sender, fine_mesh.nodes[leaf], area_m2(fine_mesh, fine_mesh.nodes[leaf]), 1, terms);
    add_fine(sender, sender, area_m2(sending_mesh, sender), -1, terms);
  }
  for (Term& t : terms) t.weight /= sending.area_m2[t.sender];  // the integral of its hat
  for (uint32_t v = 0; v < sending.size(); ++v) terms.push_back({v, v, 1});
  return terms;
}

std::vector<Term> terms_per_triangle(const Receivers& sending, const Mesh& fine_mesh,
                                     const Receivers& fine) {
  const auto below = leaves_below(sending, fine_mesh);
  std::vector<Term> terms;
  for (uint32_t s = 0; s < below.size(); ++s)
    for (const uint32_t leaf : below[s]) {
      const float whole = sending.area_m2[s];
      const float share = area_m2(fine_mesh, fine_mesh.nodes[leaf]) / whole;
      terms.push_back({s, fine.leaf_of_node[leaf], whole > 0 ? share : 1});
    }
  return terms;
}

}  // namespace

Projection project(const Mesh& sending_mesh, const Receivers& sending, const Mesh& fine_mesh,
                   const Receivers& fine) {
  LUXEL_CHECK(sending.kind == fine.kind);
  std::vector<Term> terms = sending.kind == ElementKind::vertex
                                ? terms_per_vertex(sending_mesh, sending, fine_mesh)
                                : terms_per_triangle(sending, fine_mesh, fine);
  std::stable_sort(terms.begin(), terms.end(), [](const Term& a, const Term& b) {
    return a.sender != b.sender ? a.sender < b.sender : a.element < b.element;
  });
  Projection out;
  out.first.assign(sending.size() + 1, 0);
  for (size_t i = 0; i < terms.size();) {
    const Term at = terms[i];
    float weight = 0;
    for (; i < terms.size() && terms[i].sender == at.sender && terms[i].element == at.element; ++i)
      weight += terms[i].weight;
    out.parts.push_back({at.element, weight});
    ++out.first[at.sender + 1];
  }
  for (size_t s = 0; s < sending.size(); ++s) out.first[s + 1] += out.first[s];
  return out;
}

std::vector<Rgb> sent(const Projection& projection, std::span<const Rgb> radiosity) {
  std::vector<Rgb> out(projection.first.size() - 1);
  for (size_t s = 0; s < out.size(); ++s) {
    Rgb sum{};
    for (uint32_t k = projection.first[s]; k < projection.first[s + 1]; ++k)
      sum += radiosity[projection.parts[k].element] * projection.parts[k].weight;
    // What the corners lose to their neighbours' share may leave a dark one below nothing.
    out[s] = max(sum, Rgb{});
  }
  return out;
}

}  // namespace luxel::hemicube
