#include "luxel/solve/hierarchical/outlines.h"

#include <algorithm>
#include <cmath>

#include "luxel/base/random.h"

namespace luxel::hierarchical {
namespace {

/// Points are kept in the order of this direction, to which few edges of real scenes are square.
constexpr DVec3 kSkew{0.5377, 0.6631, 0.5207};
double key(DVec3 p) { return dot(p, kSkew); }

}  // namespace

void EdgePoints::sort() {
  std::sort(points_.begin(), points_.end(), [](const DVec3& p, const DVec3& q) {
    return std::array{key(p), p.x, p.y, p.z} < std::array{key(q), q.x, q.y, q.z};
  });
  std::vector<DVec3> kept;
  for (const DVec3& p : points_) {
    bool known = false;
    for (size_t k = kept.size(); k-- > 0 && key(p) - key(kept[k]) <= slack_m_ && !known;)
      known = length(p - kept[k]) <= slack_m_;
    if (!known) kept.push_back(p);
  }
  points_ = std::move(kept);
}

std::vector<DVec3> EdgePoints::along(DVec3 a, DVec3 b) const {
  const DVec3 d = b - a;
  const double size = length(d);
  std::vector<DVec3> out;
  if (!(size > 2 * slack_m_)) return out;
  const double low = std::min(key(a), key(b)) - slack_m_,
               high = std::max(key(a), key(b)) + slack_m_;
  const auto first = std::lower_bound(points_.begin(), points_.end(), low,
                                      [](const DVec3& p, double limit) { return key(p) < limit; });
  std::vector<std::pair<double, DVec3>> inside;
  for (auto p = first; p != points_.end() && key(*p) <= high; ++p) {
    const double t = dot(*p - a, d) / size;
    if (t > slack_m_ && t < size - slack_m_ && length(*p - (a + d * (t / size))) <= slack_m_)
      inside.emplace_back(t, *p);
  }
  std::sort(inside.begin(), inside.end(),
            [](const auto& p, const auto& q) { return p.first < q.first; });
  for (const auto& [t, p] : inside) out.push_back(p);
  return out;
}

uint32_t Welder::index_of(DVec3 p, std::vector<DVec3>& places) {
  const double cell_m = 4 * slack_m_;
  const auto cell = [&](double x) { return int64_t(std::floor(x / cell_m)); };
  const auto hash = [](int64_t x, int64_t y, int64_t z) {
    return hash64(hash64(uint64_t(x), uint64_t(y)), uint64_t(z));
  };
  const int64_t x = cell(p.x), y = cell(p.y), z = cell(p.z);
  for (int64_t i = x - 1; i <= x + 1; ++i)
    for (int64_t j = y - 1; j <= y + 1; ++j)
      for (int64_t k = z - 1; k <= z + 1; ++k)
        if (const auto found = cells_.find(hash(i, j, k)); found != cells_.end())
          for (const uint32_t index : found->second)
            if (length(places[index] - p) <= slack_m_) return index;
  const auto index = uint32_t(places.size());
  places.push_back(p);
  cells_[hash(x, y, z)].push_back(index);
  return index;
}

}  // namespace luxel::hierarchical
