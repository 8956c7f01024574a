#include "luxel/atlas/outline.h"

#include <algorithm>

#include "luxel/atlas/atlas.h"

namespace luxel::atlas {
namespace {

constexpr double kSoftAngle = 0.75;  ///< charts do not grow over sharper edges (charts.cpp)
constexpr int kPasses = 12;

/// The faces within `steps` edges of f, without f.
void faces_around(const Faces& faces, uint32_t f, int steps, std::vector<uint32_t>& around) {
  around.assign(1, f);
  for (size_t begin = 0; steps > 0; --steps) {
    const size_t end = around.size();
    for (; begin < end; ++begin)
      for (const uint32_t g : faces.across[around[begin]])
        if (g != kNone && std::find(around.begin(), around.end(), g) == around.end())
          around.push_back(g);
  }
  around.erase(around.begin());
}

bool on_outline(const Faces& faces, const std::vector<uint32_t>& chart, uint32_t f) {
  return std::any_of(faces.across[f].begin(), faces.across[f].end(),
                     [&](uint32_t g) { return g != kNone && chart[g] != chart[f]; });
}

bool alone_in_patch(const Faces& faces, const std::vector<uint32_t>& patch, uint32_t f) {
  return std::none_of(faces.across[f].begin(), faces.across[f].end(),
                      [&](uint32_t g) { return g != kNone && patch[g] == patch[f]; });
}

/// The chart across one of the face's soft edges that most faces around belong to; its own chart
/// when none has more.
uint32_t best_chart(const Faces& faces, const std::vector<uint32_t>& chart, uint32_t f,
                    const std::vector<uint32_t>& around, const std::vector<DVec3>& axis,
                    double cos_max) {
  const auto votes = [&](uint32_t c) {
    return std::count_if(around.begin(), around.end(), [&](uint32_t g) { return chart[g] == c; });
  };
  uint32_t best = chart[f];
  auto most = votes(best);
  for (const uint32_t g : faces.across[f]) {
    if (g == kNone || chart[g] == best || dot(faces.normal[f], axis[chart[g]]) < cos_max) continue;
    if (angle_between(faces.normal[f], faces.normal[g]) >= kSoftAngle) continue;
    const auto here = votes(chart[g]);
    if (here > most || (here == most && best != chart[f] && chart[g] < best))
      best = chart[g], most = here;
  }
  return best;
}

}  // namespace

void smooth_outlines(const Faces& faces, const std::vector<uint32_t>& patch, double max_angle,
                     std::vector<uint32_t>& chart) {
  std::vector<DVec3> axis(faces.size());  // charts are numbered by one of their patches
  for (uint32_t f = 0; f < faces.size(); ++f)
    axis[chart[f]] = axis[chart[f]] + faces.normal[f] * faces.area[f];
  for (DVec3& a : axis) a = normalize(a);
  // The axis of a chart moves a little with its faces: leave room for that.
  const double cos_max = std::cos(0.95 * max_angle);
  std::vector<uint32_t> movable;
  for (uint32_t f = 0; f < faces.size(); ++f)
    if (alone_in_patch(faces, patch, f)) movable.push_back(f);
  std::vector<uint32_t> around;
  for (int pass = 0; pass < kPasses; ++pass) {
    bool moved = false;
    for (const uint32_t f : movable) {
      if (!on_outline(faces, chart, f)) continue;
      faces_around(faces, f, 3, around);
      const uint32_t best = best_chart(faces, chart, f, around, axis, cos_max);
      moved = moved || best != chart[f];
      chart[f] = best;
    }
    if (!moved) break;
  }
}

}  // namespace luxel::atlas
