#include "luxel/light/light_draw.h"

#include <algorithm>
#include <cmath>

#include "luxel/base/check.h"

namespace luxel::light {
namespace {

struct DrawReceiver {
  std::span<const LightNode> nodes;
  Vec3 position, normal;
  const LeafImportance& leaf;

  float importance(uint32_t index) const {
    const LightNode& node = nodes[index];
    return node.right_child == 0 ? leaf(node) : importance_at(node, position, normal);
  }
};

CutEntry entry_for(const DrawReceiver& at, uint32_t index) {
  const LightNode& node = at.nodes[index];
  CutEntry entry{index, at.importance(index), 0};
  if (node.right_child == 0) return entry;
  const Vec3 to = node.centre - at.position;
  const float r2 = node.radius_m * node.radius_m;
  entry.spread = entry.importance * r2 / std::max(dot(to, to), r2);
  return entry;
}

/// Splits the group whose members differ most, by importance times (radius / distance)^2, until
/// there are max_cut entries. They come in the order of the tree.
void find_cut(const DrawReceiver& at, size_t max_cut, std::vector<CutEntry>& cut) {
  const auto less = [](const CutEntry& p, const CutEntry& q) { return p.spread < q.spread; };
  cut.assign(1, entry_for(at, 0));
  while (!cut.empty() && cut.size() < max_cut && cut.front().spread > 0) {
    const uint32_t parent = cut.front().node;
    std::pop_heap(cut.begin(), cut.end(), less);
    cut.pop_back();
    for (const uint32_t child : {parent + 1, at.nodes[parent].right_child}) {
      const CutEntry entry = entry_for(at, child);
      if (entry.importance <= 0) continue;
      cut.push_back(entry);
      std::push_heap(cut.begin(), cut.end(), less);
    }
  }
  std::sort(cut.begin(), cut.end(),
            [](const CutEntry& p, const CutEntry& q) { return p.node < q.node; });
}

double sum_importance(std::span<const CutEntry> cut) {
  double sum = 0;
  for (const CutEntry& entry : cut) sum += double(entry.importance);
  return sum;
}

/// Draws from the node that lies on the line from `begin` on, `expected` long. In double: there may
/// be many lights of little importance on it.
void draw_below(const DrawReceiver& at, uint32_t index, double begin, double expected,
                std::vector<LightDraw>& draws) {
  const double count = std::floor(begin + expected) - std::floor(begin);
  if (count < 1) return;
  const LightNode& node = at.nodes[index];
  if (node.right_child == 0) {
    draws.push_back({node.first, uint32_t(count), float(std::min(1.0, expected))});
    return;
  }
  const double left = double(at.importance(index + 1));
  const double right = double(at.importance(node.right_child));
  if (!(left + right > 0)) return;
  const double half = expected * left / (left + right);
  draw_below(at, index + 1, begin, half, draws);
  draw_below(at, node.right_child, begin + half, expected - half, draws);
}

}  // namespace

void draw_lights(std::span<const LightNode> nodes, Vec3 position, Vec3 normal,
                 const LeafImportance& leaf, const DrawParams& params, LightDraws& out) {
  LUXEL_CHECK(!nodes.empty() && params.samples >= 1 && params.max_cut >= 1);
  const DrawReceiver at{nodes, position, normal, leaf};
  out.draws.clear();
  find_cut(at, params.max_cut, out.cut);
  const double per_ray = sum_importance(out.cut) / double(params.samples);
  if (!(per_ray > 0)) return;
  // Single lights that deserve a ray and more are off the line; it stays a whole number long, or
  // the number of rays on it would be a matter of chance.
  std::erase_if(out.cut, [&](const CutEntry& entry) {
    const LightNode& node = nodes[entry.node];
    const double deserved = double(entry.importance) / per_ray;
    if (node.right_child != 0 || deserved < 1) return false;
    out.draws.push_back({node.first, uint32_t(std::lround(deserved)), 1});
    return true;
  });
  const double rest = sum_importance(out.cut);
  if (!(rest > 0)) return;
  const double rays = std::max(1.0, std::round(rest / per_ray));
  double begin = double(params.start);
  for (const CutEntry& entry : out.cut) {
    const double expected = rays * double(entry.importance) / rest;
    draw_below(at, entry.node, begin, expected, out.draws);
    begin += expected;
  }
}

}  // namespace luxel::light
