#include "transport/light_cut.h"

#include <algorithm>
#include <array>

#include "transport/point_form_factor.h"

namespace luxel::transport {
namespace {

/// power cos / d^2 with the cosine bounded over the node's bounding sphere, and the distance kept
/// from going below the sphere's own size. Zero only when the sphere is below the horizon.
float group_importance(const LightNode& node, Vec3 position, Vec3 normal) {
  const Vec3 to_centre = node.bounds.centre() - position;
  const float radius = 0.5f * node.bounds.diagonal();
  const float height = dot(to_centre, normal);
  if (height < -radius) return 0;
  const float distance2 = std::max(dot(to_centre, to_centre), radius * radius);
  const float cosine = std::min(1.0f, (height + radius) / std::sqrt(distance2));
  return node.power * cosine / distance2;
}

CutEntry entry_for(const Lights& lights, uint32_t index, Vec3 position, Vec3 normal) {
  const LightNode& node = lights.nodes[index];
  CutEntry entry{index, node.right_child == 0, 0, 0};
  if (!entry.exact) {
    entry.importance = group_importance(node, position, normal);
    return entry;
  }
  const TriangleLight& light = lights.triangles[node.first];
  entry.irradiance_per_radiance = irradiance_per_radiance(light, position, normal);
  entry.importance = entry.irradiance_per_radiance * luminance(light.mean_radiance);
  return entry;
}

}  // namespace

float irradiance_per_radiance(const TriangleLight& light, Vec3 position, Vec3 normal) {
  const float side = dot(position - light.a, light.normal);
  const float reach = length(position - light.a);
  // In the light's plane, or in ours, rounding would decide between nothing and a half space.
  constexpr float kPlaneTolerance = 1e-6f;
  if (std::abs(side) <= kPlaneTolerance * reach || (side < 0 && !light.two_sided)) return 0;
  const float highest = std::max({dot(light.a - position, normal), dot(light.b - position, normal),
                                  dot(light.c - position, normal)});
  if (highest <= 10 * kPlaneTolerance * reach) return 0;
  const std::array<Vec3, 3> corners{light.a, side > 0 ? light.b : light.c,
                                    side > 0 ? light.c : light.b};
  return kPi * float(point_to_polygon(position, normal, corners));
}

void light_cut(const Lights& lights, Vec3 position, Vec3 normal, size_t max_entries,
               std::vector<CutEntry>& cut) {
  cut.clear();
  if (lights.nodes.empty()) return;
  cut.push_back(entry_for(lights, 0, position, normal));
  // A group that brings less than a hundredth of the light is not worth refining; all single
  // triangles of a small set are.
  constexpr float kNegligible = 0.01f;
  const bool all_fit = lights.triangles.size() <= max_entries;
  float total = cut.front().importance;
  while (cut.size() < max_entries) {
    const auto widest =
        std::max_element(cut.begin(), cut.end(), [](const CutEntry& p, const CutEntry& q) {
          return (p.exact ? -1 : p.importance) < (q.exact ? -1 : q.importance);
        });
    if (widest->exact || widest->importance <= (all_fit ? 0 : kNegligible * total)) break;
    const uint32_t parent = widest->node;
    const CutEntry right = entry_for(lights, lights.nodes[parent].right_child, position, normal);
    total -= widest->importance;
    *widest = entry_for(lights, parent + 1, position, normal);
    total += widest->importance + right.importance;
    cut.push_back(right);
  }
  std::erase_if(cut, [](const CutEntry& entry) { return entry.importance <= 0; });
}

}  // namespace luxel::transport
