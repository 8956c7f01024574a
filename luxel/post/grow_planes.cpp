#include "luxel/post/grow_planes.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "luxel/base/buffer_pool.h"
#include "luxel/post/texel_tile.h"

namespace luxel::post {
namespace {

/// Sums over a window: moments of weights and values, and of squared weights times variances.
struct Moments {
  float w = 0, u = 0, v = 0, uu = 0, uv = 0, vv = 0;
  Rgb y{}, yu{}, yv{};
  float s = 0, su = 0, sv = 0, suu = 0, suv = 0, svv = 0;

  void add(const Neighbour& at, float weight, Rgb value, float variance) {
    const float wu = weight * at.u, wv = weight * at.v;
    w += weight, u += wu, v += wv;
    uu += wu * at.u, uv += wu * at.v, vv += wv * at.v;
    y += value * weight, yu += value * wu, yv += value * wv;
    const float q = weight * weight * variance, qu = q * at.u, qv = q * at.v;
    s += q, su += qu, sv += qv;
    suu += qu * at.u, suv += qu * at.v, svv += qv * at.v;
  }
};

/// Slopes are drawn to zero where positions spread by less than this [texels^2]: a row of texels
/// has no slope across it.
constexpr float kRidge = 0.02f;

/// Weighted least squares. Both the value and the slopes are linear in the texels' values: the
/// value is sum_j w_j (alpha + beta . x_j) y_j, hence its variance.
Plane fit(const Moments& m) {
  const float inverse = 1 / m.w;
  const float u = m.u * inverse, v = m.v * inverse;
  const Rgb y = m.y * inverse;
  const float uu = m.uu * inverse - u * u + kRidge, vv = m.vv * inverse - v * v + kRidge;
  const float uv = m.uv * inverse - u * v;
  const float det = 1 / (uu * vv - uv * uv);
  // Inverse of the spread, (a b; b c).
  const float a = vv * det, b = -uv * det, c = uu * det;
  const Rgb cu = m.yu * inverse - y * u, cv = m.yv * inverse - y * v;
  Plane plane;
  plane.slope_u = cu * a + cv * b;
  plane.slope_v = cu * b + cv * c;
  plane.value = y - plane.slope_u * u - plane.slope_v * v;

  const float bu = -(a * u + b * v) * inverse, bv = -(b * u + c * v) * inverse;
  const float alpha = inverse - bu * u - bv * v;
  plane.variance = alpha * alpha * m.s + 2 * alpha * (bu * m.su + bv * m.sv) + bu * bu * m.suu +
                   2 * bu * bv * m.suv + bv * bv * m.svv;
  // Second moments of squared weights about the mean place.
  const float tuu = m.suu - 2 * u * m.su + u * u * m.s;
  const float tvv = m.svv - 2 * v * m.sv + v * v * m.s;
  const float tuv = m.suv - u * m.sv - v * m.su + u * v * m.s;
  plane.slope_variance = 0.5f * inverse * inverse *
                         ((a * a + b * b) * tuu + 2 * b * (a + c) * tuv + (b * b + c * c) * tvv);
  return plane;
}

/// A texel that looks at those around it.
struct Looker {
  Around around;
  Plane own;
  /// One over the largest squared difference over its variance that counts, times each channel's
  /// variance over that of luminance.
  Rgb per_limit;
};

Looker looker_of(const Neighbourhood& n, const NoiseLevel& noise, const GrowRound& round,
                 const Plane& own, uint32_t i) {
  constexpr float kTiny = 1e-30f;  // a channel without noise agrees with its like alone
  const auto per = [&](float channel) {
    return 1 / (round.max_deviations2 * std::max(channel, kTiny));
  };
  const Rgb c = noise.per_channel[i];
  return {around(n.place[i], round.radius, n.min_cosine), own, {per(c.x), per(c.y), per(c.z)}};
}

/// The agreement of a neighbour's light with the plane around a texel, 0 .. 1: by the squared
/// difference over its variance, in the channel where that is largest.
float agreement(const Looker& self, const Shown& other, const Neighbour& at) {
  const Plane& own = self.own;
  const Rgb d = own.value + own.slope_u * at.u + own.slope_v * at.v - other.estimate;
  const float expected =
      own.variance + (at.u * at.u + at.v * at.v) * own.slope_variance + other.estimate_variance;
  const float rest = 1 - max_component(d * d * self.per_limit) / expected;
  return rest > 0 ? rest * (2 - rest) : 0.0f;
}

/// A tile, and what its texels show.
struct ShownTile {
  TexelTile tile;
  std::array<std::vector<float>, 3> estimate, value;
  std::vector<float> estimate_variance, variance;

  void clear(size_t cells) {
    for (auto& channel : estimate) channel.assign(cells, 0.0f);
    for (auto& channel : value) channel.assign(cells, 0.0f);
    estimate_variance.assign(cells, 0.0f), variance.assign(cells, 0.0f);
  }
  void take(size_t cell, const Shown& shown) {
    for (int c = 0; c < 3; ++c) {
      estimate[size_t(c)][cell] = shown.estimate[c];
      value[size_t(c)][cell] = shown.value[c];
    }
    estimate_variance[cell] = shown.estimate_variance, variance[cell] = shown.variance;
  }
};

/// Moments in eight lanes.
struct MomentLanes {
  Float8 w{}, u{}, v{}, uu{}, uv{}, vv{};
  std::array<Float8, 3> y{}, yu{}, yv{};
  Float8 s{}, su{}, sv{}, suu{}, suv{}, svv{};
};

/// agreement() of eight cells.
[[gnu::always_inline]] inline void agreements_in(const ShownTile& shown, const Looker& self,
                                                 size_t cell, const NeighbourLanes& at,
                                                 Float8& out) {
  const Plane& own = self.own;
  Float8 worst{};
  for (int c = 0; c < 3; ++c) {
    Float8 estimate;
    load8(&shown.estimate[size_t(c)][cell], estimate);
    const Float8 d = at.u * own.slope_u[c] + at.v * own.slope_v[c] + own.value[c] - estimate;
    const Float8 square = d * d * self.per_limit[c];
    worst = square > worst ? square : worst;
  }
  constexpr float kTiny = 1e-30f;  // a texel without variance agrees with itself
  Float8 variance;
  load8(&shown.estimate_variance[cell], variance);
  const Float8 expected =
      (at.u * at.u + at.v * at.v) * own.slope_variance + variance + (own.variance + kTiny);
  const Float8 zero{}, rest = 1 - worst / expected;
  out = rest > zero ? rest * (2 - rest) : zero;
}

/// Moments::add() of eight cells.
[[gnu::always_inline]] inline void add_lanes(const ShownTile& shown, size_t cell,
                                             const NeighbourLanes& at, const Float8& weight,
                                             MomentLanes& m) {
  const Float8 wu = weight * at.u, wv = weight * at.v;
  m.w += weight, m.u += wu, m.v += wv;
  m.uu += wu * at.u, m.uv += wu * at.v, m.vv += wv * at.v;
  for (size_t c = 0; c < 3; ++c) {
    Float8 value;
    load8(&shown.value[c][cell], value);
    m.y[c] += value * weight, m.yu[c] += value * wu, m.yv[c] += value * wv;
  }
  Float8 variance;
  load8(&shown.variance[cell], variance);
  const Float8 q = weight * weight * variance, qu = q * at.u, qv = q * at.v;
  m.s += q, m.su += qu, m.sv += qv;
  m.suu += qu * at.u, m.suv += qu * at.v, m.svv += qv * at.v;
}

/// The window of the atlas around a cell, of so many cells to each side.
LUXEL_WIDE_VECTOR_CLONES
void add_window(const ShownTile& shown, const Looker& self, size_t middle, int reach,
                MomentLanes& out) {
  const int across = 2 * reach + 1;
  MomentLanes sums;
  for (int first = 0; first < across; first += kLanes) {
    Float8 within;
    lanes_within(first, across, within);
    size_t cell = middle - size_t(reach) * (shown.tile.stride + 1) + size_t(first);
    for (int row = 0; row < across; ++row, cell += shown.tile.stride) {
      NeighbourLanes at;
      neighbours_in(shown.tile, self.around, cell, at);
      Float8 agree;
      agreements_in(shown, self, cell, at, agree);
      const Float8 weight = at.weight * agree * within;
      add_lanes(shown, cell, at, weight, sums);
    }
  }
  out = sums;
}

float sum_of(const Float8& v) {
  return ((v[0] + v[4]) + (v[2] + v[6])) + ((v[1] + v[5]) + (v[3] + v[7]));
}
Rgb sum_of(const std::array<Float8, 3>& v) { return {sum_of(v[0]), sum_of(v[1]), sum_of(v[2])}; }

Moments moments_of(const MomentLanes& m) {
  return {sum_of(m.w),  sum_of(m.u),  sum_of(m.v),   sum_of(m.uu),  sum_of(m.uv),
          sum_of(m.vv), sum_of(m.y),  sum_of(m.yu),  sum_of(m.yv),  sum_of(m.s),
          sum_of(m.su), sum_of(m.sv), sum_of(m.suu), sum_of(m.suv), sum_of(m.svv)};
}

/// Gives all members of the team what texels of its own squares show. Errors: those of exchange().
Status give_shown(Team* team, const Neighbourhood& n, Planes& now, Progress& progress) {
  std::vector<Plane>& planes = now.planes;
  return exchange(team, *now.own_squares,
                  {tile_count(n),
                   [&](size_t number, ByteWriter& out) {
                     for_texels_of_square(n, number, [&](uint32_t i) {
                       out.put_value(planes[i].value), out.put_value(planes[i].variance);
                     });
                   },
                   [&](size_t number, uint32_t, ByteReader& in) {
                     for_texels_of_square(n, number, [&](uint32_t i) {
                       planes[i].value = in.get_value<Rgb>();
                       planes[i].variance = in.get_value<float>();
                     });
                     return in.ok;
                   }},
                  progress);
}

}  // namespace

Status grow(const Neighbourhood& n, const NoiseLevel& noise, std::span<const Rgb> values,
            const GrowRound& round, Planes& now, Team* team, Progress& progress) {
  std::vector<Plane>& planes = now.planes;
  std::vector<Shown>& shown = now.shown;
  for (size_t i = 0; i < planes.size(); ++i)
    shown[i] = {planes[i].value, planes[i].variance, values[i], noise.variance[i]};
  const int reach = std::min(int(round.radius), n.radius);
  BufferPool<ShownTile> pool;
  const auto grow_square = [&](size_t number) {
    ShownTile around = pool.take();
    fill_tile(
        n, number, reach, [&](size_t cells) { around.clear(cells); },
        [&](size_t cell, uint32_t j) { around.take(cell, shown[j]); }, around.tile);
    uint64_t done = 0;
    for_texels_of(n, around.tile, reach, [&](uint32_t i, size_t cell) {
      if (n.place[i].spacing <= 0 || noise.variance[i] <= 0) return;
      ++done;
      const Looker self = looker_of(n, noise, round, planes[i], i);
      MomentLanes lanes;
      add_window(around, self, cell, reach, lanes);
      Moments moments = moments_of(lanes);
      for_far_neighbours(n, i, self.around, [&](uint32_t j, const Neighbour& at) {
        const float agree = agreement(self, shown[j], at);
        if (agree > 0) moments.add(at, at.weight * agree, shown[j].value, shown[j].variance);
      });
      planes[i] = fit(moments);
    });
    pool.give(std::move(around));
    progress.advance(done * grow_units(round.radius));
  };
  if (now.own_squares) {
    LUXEL_TRY_STATUS(do_own(team, *now.own_squares, progress, grow_square));
  } else {
    LUXEL_TRY(now.own_squares, luxel::share_out(team, tile_count(n), progress, grow_square));
  }
  return give_shown(team, n, now, progress);
}

}  // namespace luxel::post
