#include "luxel/solve/matrix/probes.h"

#include "luxel/base/check.h"

namespace luxel::matrix {

Probes probes_of(const Patches& patches) {
  Probes out;
  for (size_t i = 0; i < patches.size(); ++i) {
    out.first.push_back(out.elements.size());
    for (size_t k = 0; k < patches.probes_of(i); ++k) {
      const PatchPoint& p = patches.probe(i, k);
      out.elements.position.push_back(p.position);
      out.elements.normal.push_back(p.normal);
      out.elements.geometric_normal.push_back(p.normal);
      out.elements.reflectance.push_back(patches.elements.reflectance[i]);
    }
  }
  out.first.push_back(out.elements.size());
  return out;
}

std::vector<Rgb> mean_at_patches(const Probes& probes, std::span<const Rgb> at_probes) {
  LUXEL_CHECK(at_probes.size() == probes.elements.size());
  std::vector<Rgb> out(probes.first.size() - 1);
  for (size_t i = 0; i < out.size(); ++i)
    for (size_t k = probes.first[i]; k < probes.first[i + 1]; ++k)
      out[i] += at_probes[k] / float(probes.first[i + 1] - probes.first[i]);
  return out;
}

}  // namespace luxel::matrix
