#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "luxel/base/share_out.h"
#include "luxel/viewfactor/factor_matrix.h"
#include "luxel/viewfactor/polygon_tree.h"
#include "luxel/viewfactor/visible_form_factor.h"

namespace luxel::viewfactor {
namespace {

/// All polygons of all surfaces, each a blocker for the others.
struct Room {
  std::vector<Polygon> polygons;
  std::vector<Blocker> blockers;
  std::vector<uint32_t> surface;  ///< of each polygon
  PolygonTree tree;
  double slack = 0;
};

Room room_of(const Surfaces& surfaces) {
  Room room;
  room.slack = surfaces.slack_m;
  for (uint32_t s = 0; s < surfaces.surfaces.size(); ++s)
    for (const Polygon& polygon : surfaces.surfaces[s].polygons) {
      room.polygons.push_back(polygon);
      room.blockers.push_back(make_blocker(polygon));
      room.surface.push_back(s);
    }
  room.tree = build_polygon_tree(room.polygons);
  return room;
}

/// False where one lies behind the other or in its plane: nothing to compute.
bool face_each_other(const Room& room, uint32_t p, uint32_t q) {
  const auto reaches_above = [&](uint32_t polygon, uint32_t plane) {
    const auto above = [&](const DVec3& c) {
      return room.blockers[plane].plane.height(c) > room.slack;
    };
    return std::any_of(room.polygons[polygon].begin(), room.polygons[polygon].end(), above);
  };
  return reaches_above(q, p) && reaches_above(p, q);
}

VisibleExchange exchange_of(const Room& room, uint32_t p, uint32_t q, const VisibleParams& params) {
  const Shaft shaft = shaft_between(room.polygons[p], room.polygons[q], room.slack);
  std::vector<uint32_t> near;
  polygons_near(room.tree, shaft, near);
  std::vector<Blocker> between;
  for (const uint32_t index : near)
    if (index != p && index != q && !is_outside(shaft, room.polygons[index]))
      between.push_back(room.blockers[index]);
  return visible_exchange_area(room.polygons[p], room.polygons[q], between, params);
}

using Pair = std::pair<uint32_t, uint32_t>;

/// Pairs whose exchange is asked for, polygon p before q.
bool is_wanted(const Room& room, uint32_t p, uint32_t q, const FactorSelection& wanted) {
  const auto one_way = [&](uint32_t i, uint32_t j) {
    return (wanted.from == scene::kNone || wanted.from == i) &&
           (wanted.to == scene::kNone || wanted.to == j);
  };
  return one_way(room.surface[p], room.surface[q]) || one_way(room.surface[q], room.surface[p]);
}

/// Adds the exchange of a batch of pairs to the matrix of exchange areas, in the order of the
/// pairs, so that sums have the same bits for any number of threads. `rough` gets the pairs of
/// surfaces whose work ended early.
Status add_batch(const Room& room, const std::vector<Pair>& batch, const AnalyticParams& params,
                 FactorMatrix& exchange, std::set<Pair>& rough, Team* team, Progress& progress) {
  std::vector<VisibleExchange> found(batch.size());
  const auto find = [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end && !progress.cancelled(); ++k) {
      const auto [p, q] = batch[k];
      VisibleParams visible{.tolerance = params.tolerance, .slack_m = room.slack};
      visible.negligible_m2 = 1e-3 * std::min(room.blockers[p].area_m2, room.blockers[q].area_m2);
      visible.max_cells = params.max_cells;
      visible.progress = &progress;
      found[k] = exchange_of(room, p, q, visible);
      progress.advance(1);
    }
  };
  LUXEL_TRY_STATUS(share_ranges(team, batch.size(), 4, progress, find, std::span(found)));
  for (size_t k = 0; k < batch.size(); ++k) {
    const uint32_t i = room.surface[batch[k].first], j = room.surface[batch[k].second];
    if (found[k].gave_up) rough.insert(std::minmax(i, j));
    const size_t n = exchange.size();
    for (const size_t entry : {i * n + j, j * n + i}) {
      exchange.factor[entry] += found[k].value;
      exchange.error[entry] += found[k].error;
    }
  }
  return {};
}

void warn_of_rough_pairs(const std::set<Pair>& rough, const AnalyticParams& params,
                         FactorMatrix& matrix) {
  constexpr size_t kMostWarnings = 20;
  for (const auto& [i, j] : rough) {
    if (matrix.warnings.size() == kMostWarnings) {
      matrix.warnings.push_back(
          fmt::format("{} more pairs of surfaces have a larger error than --tolerance {} allows",
                      rough.size() - kMostWarnings, params.tolerance));
      return;
    }
    matrix.warnings.push_back(fmt::format(
        "the factor between '{}' and '{}' is {:.6g} with an estimated error of {:.1e}, more than "
        "--tolerance {} allows: the blockers between them are too intricate for {} pieces",
        matrix.names[i], matrix.names[j], matrix.at(i, j), matrix.error[i * matrix.size() + j],
        params.tolerance, params.max_cells));
  }
}

}  // namespace

Result<FactorMatrix> analytic_factors(const Surfaces& surfaces, const AnalyticParams& params,
                                      const FactorSelection& selection, Progress& progress,
                                      Team* team) {
  constexpr size_t kBatch = 4096;
  const Room room = room_of(surfaces);
  const uint64_t count = room.polygons.size();
  progress.begin("view factors", count * (count - 1) / 2);
  FactorMatrix matrix = empty_factor_matrix(surfaces);
  std::vector<Pair> batch;
  std::set<Pair> rough;
  const auto flush = [&]() -> Status {
    LUXEL_TRY_STATUS(add_batch(room, batch, params, matrix, rough, team, progress));
    batch.clear();
    return {};
  };
  for (uint32_t p = 0; p < count && !progress.cancelled(); ++p) {
    uint64_t nothing_to_do = 0;
    for (uint32_t q = p + 1; q < count; ++q) {
      if (!is_wanted(room, p, q, selection) || !face_each_other(room, p, q)) {
        ++nothing_to_do;
        continue;
      }
      batch.push_back({p, q});
      if (batch.size() == kBatch) LUXEL_TRY_STATUS(flush());
    }
    progress.advance(nothing_to_do);
  }
  LUXEL_TRY_STATUS(stopped(progress));
  LUXEL_TRY_STATUS(flush());
  // From exchange areas to factors; within one surface both directions fell on the same entry.
  for (size_t i = 0; i < matrix.size(); ++i)
    for (size_t j = 0; j < matrix.size(); ++j) {
      matrix.at(i, j) /= matrix.area_m2[i];
      matrix.error[i * matrix.size() + j] /= matrix.area_m2[i];
    }
  warn_of_rough_pairs(rough, params, matrix);
  return matrix;
}

}  // namespace luxel::viewfactor
