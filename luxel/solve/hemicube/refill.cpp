#include "luxel/solve/hemicube/refill.h"

namespace luxel::hemicube {

RefillPlan plan_refill(const Neighbours& neighbours, std::span<const uint8_t> enclosed,
                       std::span<const uint8_t> covered) {
  // Visible elements have light; the others wait.
  RefillPlan plan;
  std::vector<uint8_t> has_light(enclosed.size());
  std::vector<uint32_t> waiting;
  for (uint32_t i = 0; i < enclosed.size(); ++i) {
    has_light[i] = !enclosed[i] && !covered[i];
    if (!has_light[i]) waiting.push_back(i);
  }
  // Ring by ring: elements with a neighbour that has light by now.
  while (!waiting.empty()) {
    std::vector<uint32_t> ring, rest;
    for (const uint32_t i : waiting) {
      const size_t before = plan.from.size();
      for (const uint32_t j : neighbours.of(i))
        if (has_light[j]) plan.from.push_back(j);
      if (plan.from.size() == before) {
        rest.push_back(i);
        continue;
      }
      plan.element.push_back(i), plan.first.push_back(uint32_t(before));
      ring.push_back(i);
    }
    // The ring has light only when it is complete, so that its order does not count.
    if (ring.empty()) {
      for (const uint32_t i : waiting)
        if (covered[i]) plan.dark.push_back(i);
      break;
    }
    for (const uint32_t i : ring) has_light[i] = 1;
    waiting = std::move(rest);
  }
  plan.first.push_back(uint32_t(plan.from.size()));
  return plan;
}

void refill(const RefillPlan& plan, std::span<Rgb> irradiance) {
  for (size_t k = 0; k < plan.element.size(); ++k) {
    Rgb sum{};
    for (uint32_t j = plan.first[k]; j < plan.first[k + 1]; ++j) sum += irradiance[plan.from[j]];
    irradiance[plan.element[k]] = sum / float(plan.first[k + 1] - plan.first[k]);
  }
  for (const uint32_t i : plan.dark) irradiance[i] = {};
}

}  // namespace luxel::hemicube
