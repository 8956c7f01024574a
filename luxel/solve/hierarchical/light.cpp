#include "luxel/solve/hierarchical/light.h"

#include <algorithm>

namespace luxel::hierarchical {
namespace {

/// Children come after their parents, clusters and elements alike.
void push(const Faces& faces, const Tree& tree, std::span<Cosines> from_above, Light& light) {
  // A child cluster gets the light as a function of direction, an element its value for its own
  // normal.
  const auto hand_down = [&](const Cosines& light_here, uint32_t id) {
    if (tree.is_cluster(id)) {
      from_above[id].add(light_here);
    } else {
      const Element& e = tree.element(id);
      const Vec3 normal = to_float(faces.faces[e.face].plane.normal);
      light.elements[id - tree.clusters.size()].arriving.fill(light_here.at(normal));
    }
  };
  // Down the clusters, which stand before their children.
  for (size_t e = 0; e < tree.first_root.back(); ++e) light.elements[e].arriving.fill({});
  for (size_t c = 0; c < tree.clusters.size(); ++c) {
    Cosines all = from_above[c];
    all.add(light.clusters[c].received);
    for (const uint32_t child : tree.clusters[c].child) hand_down(all, child);
  }
  // Down the elements: each corner takes over its part of the parent, and adds its own.
  for (size_t e = 0; e < tree.elements.size(); ++e) {
    ElementLight& l = light.elements[e];
    const uint32_t parent = tree.elements[e].parent;
    const uint32_t n = tree.elements[e].corners;
    if (parent != kNone)
      l.arriving = part_of(light.elements[parent].arriving, n,
                           uint32_t(e) - tree.elements[parent].child, tree.elements[parent].parts);
    for (uint32_t k = 0; k < n; ++k) l.arriving[k] += l.received[k];
  }
}

/// The integrals of products of the functions that are 1 at one corner and 0 at the others, over
/// the area: of a parallelogram, then of a triangle.
constexpr float kMass[2][4][4] = {{{4 / 36.0f, 2 / 36.0f, 1 / 36.0f, 2 / 36.0f},
                                   {2 / 36.0f, 4 / 36.0f, 2 / 36.0f, 1 / 36.0f},
                                   {1 / 36.0f, 2 / 36.0f, 4 / 36.0f, 2 / 36.0f},
                                   {2 / 36.0f, 1 / 36.0f, 2 / 36.0f, 4 / 36.0f}},
                                  {{2 / 12.0f, 1 / 12.0f, 1 / 12.0f},
                                   {1 / 12.0f, 2 / 12.0f, 1 / 12.0f},
                                   {1 / 12.0f, 1 / 12.0f, 2 / 12.0f}}};
constexpr float kInverseMass[2][4][4] = {
    {{16, -8, 4, -8}, {-8, 16, -8, 4}, {4, -8, 16, -8}, {-8, 4, -8, 16}},
    {{9, -3, -3}, {-3, 9, -3}, {-3, -3, 9}}};

/// The linear function over an element nearest to those over its parts.
std::array<Rgb, 4> whole_of(const Light& light, const Element& e) {
  const uint32_t n = e.corners;
  const auto& mass = kMass[n == 3];
  // Less what is the same everywhere, which rounding would spoil.
  const Rgb base = light.elements[e.child].shining[0];
  std::array<Rgb, 4> moment{};
  for (uint32_t k = 0; k < n; ++k) {
    std::array<float, 4> unit{};  // 1 at the corner k
    unit[k] = 1;
    for (uint32_t part = 0; part < 4; ++part) {
      const std::array<float, 4> there = part_of(unit, n, part, e.parts);
      const std::array<Rgb, 4>& value = light.elements[e.child + part].shining;
      for (uint32_t a = 0; a < n; ++a)
        for (uint32_t b = 0; b < n; ++b)
          moment[k] += (value[a] - base) * (0.25f * mass[a][b] * there[b]);
    }
  }
  std::array<Rgb, 4> out{};
  for (uint32_t a = 0; a < n; ++a) {
    out[a] = base;
    for (uint32_t b = 0; b < n; ++b) out[a] += moment[b] * kInverseMass[n == 3][a][b];
  }
  return out;
}

/// E at the corners of a leaf. What no link brings is negative where links brought too much when it
/// was measured (feedback.h). When they bring less later, nothing is left: a mean below 0 is 0, as
/// rays towards sources are spread over their power.
std::array<Rgb, 4> light_at_corners(const Element& element, const ElementLight& l) {
  std::array<Rgb, 4> e{};
  for (const auto channel : {&Rgb::x, &Rgb::y, &Rgb::z}) {
    float sum = 0;
    for (uint32_t k = 0; k < element.corners; ++k)
      e[k].*channel = l.unlinked[k].*channel + l.arriving[k].*channel, sum += e[k].*channel;
    if (sum < 0)
      for (Rgb& corner : e) corner.*channel = 0;
  }
  return e;
}

void pull_leaf(const Element& element, ElementLight& l) {
  l.irradiance = l.radiosity = {};
  l.rough = l.bend;
  const std::array<Rgb, 4> e = light_at_corners(element, l);
  for (uint32_t k = 0; k < element.corners; ++k) {
    l.shining[k] = l.emission + l.reflectance * e[k];
    l.irradiance += e[k] * (1 / float(element.corners));
    l.radiosity += l.shining[k] * (1 / float(element.corners));
  }
  l.most = max_component(l.radiosity);
}

/// Elements from their parts, the parts first: they come after the wholes.
void pull_elements(const Tree& tree, Light& light) {
  for (size_t e = tree.elements.size(); e-- > 0;) {
    const Element& element = tree.elements[e];
    ElementLight& l = light.elements[e];
    if (element.is_leaf()) {
      pull_leaf(element, l);
      continue;
    }
    // The linear function nearest to the parts, means by area, and how far parts are from linear.
    l.irradiance = l.radiosity = {};
    l.most = l.rough = 0;
    l.shining = whole_of(light, element);
    double area = 0;
    for (uint32_t part = 0; part < 4; ++part) {
      const ElementLight& below = light.elements[element.child + part];
      const double size = tree.elements[element.child + part].area_m2;
      l.irradiance += below.irradiance * float(size), l.radiosity += below.radiosity * float(size);
      area += size;
      l.most = std::max(l.most, below.most);
      const std::array<Rgb, 4> linear = part_of(l.shining, element.corners, part, element.parts);
      float off = 0;
      for (uint32_t k = 0; k < element.corners; ++k)
        off = std::max({off, max_component(below.shining[k] - linear[k]),
                        max_component(linear[k] - below.shining[k])});
      l.rough = std::max(l.rough, off + below.rough);
    }
    const float scale = area > 0 ? float(1 / area) : 0;
    l.irradiance = l.irradiance * scale, l.radiosity = l.radiosity * scale;
  }
}

void pull_clusters(const Faces& faces, const Tree& tree, Light& light) {
  for (size_t c = tree.clusters.size(); c-- > 0;) {
    ClusterLight& l = light.clusters[c];
    l.sent = {};
    l.most = 0;
    for (const uint32_t child : tree.clusters[c].child) {
      if (tree.is_cluster(child)) {
        l.sent.add(light.clusters[child].sent);
        l.most = std::max(l.most, light.clusters[child].most);
        continue;
      }
      const Element& e = tree.element(child);
      const ElementLight& part = light.elements[child - tree.clusters.size()];
      const Face& face = faces.faces[e.face];
      const Vec3 normal = to_float(face.plane.normal);
      const Rgb power = part.radiosity * float(e.area_m2);
      l.most = std::max(l.most, part.most);
      l.sent.add(normal, power);
      if (face.two_sided) l.sent.add(-normal, power);
    }
  }
}

}  // namespace

void drop_pieces(Light& light) {
  light.pieces.clear(), light.first_piece.clear();
  for (ElementLight& l : light.elements) l.bend = 0;
}

void push_pull(const Faces& faces, const Tree& tree, Light& light) {
  std::vector<Cosines> from_above(tree.clusters.size());
  push(faces, tree, from_above, light);
  pull_elements(tree, light);
  pull_clusters(faces, tree, light);
}

}  // namespace luxel::hierarchical
