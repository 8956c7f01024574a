#include "luxel/light/points_of_texels.h"

#include <numeric>

#include "luxel/atlas/footprint.h"
#include "luxel/base/check.h"
#include "luxel/base/parallel.h"
#include "luxel/base/random.h"

namespace luxel::light {

Status visit_points(const TexelScene& in, std::span<const uint8_t> hidden, int count, uint64_t seed,
                    std::string_view stage, const AtPoints& visit, Progress& progress) {
  constexpr size_t kTexelsAtATime = 64;
  const size_t n = in.map.texels.size();
  LUXEL_CHECK(count >= 1 && hidden.size() == n);
  std::vector<uint32_t> all(n);
  std::iota(all.begin(), all.end(), 0u);
  const atlas::Cover cover = atlas::cover_of(in.atlas, in.map, all);
  const PointScene place = point_scene(in);
  progress.begin(stage, n);
  parallel_for(n, kTexelsAtATime, [&](size_t begin, size_t end) {
    std::vector<scene::SurfacePoint> spread;
    std::vector<uint8_t> on_side;
    std::vector<Receiver> points;
    for (size_t i = begin; i < end && !progress.cancelled(); ++i) {
      if (hidden[i]) continue;
      const Receiver own = own_receiver(in.elements, i);
      const bool near_backs = sees_backs(place, own);
      atlas::spread_points(in.atlas, in.map.texels[i], cover.of(i), count, seed, spread);
      find_on_side(in, i, spread, on_side);
      points.clear();
      for (size_t k = 0; k < spread.size(); ++k) {
        if (!on_side[k]) continue;
        const uint64_t own_seed = hash64(hash64(seed, points.size()), i);
        const Receiver r = receiver_at(transport::smooth_point(in.scene, spread[k]), own_seed);
        if (!near_backs || !is_enclosed(place, r)) points.push_back(r);
      }
      if (points.empty()) points.push_back(own);
      visit(i, points);
    }
    progress.advance(end - begin);
  });
  return stopped(progress);
}

}  // namespace luxel::light
