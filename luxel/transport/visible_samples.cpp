#include "luxel/transport/visible_samples.h"

#include <algorithm>
#include <numeric>

#include "luxel/base/parallel.h"
#include "luxel/base/share_out.h"
#include "luxel/base/warp.h"
#include "luxel/scene/drawn_triangle.h"
#include "luxel/scene/facet.h"
#include "luxel/scene/off_surface.h"
#include "luxel/transport/clear_runs.h"
#include "luxel/transport/open_places.h"
#include "luxel/transport/texel_width.h"

namespace luxel::transport {
namespace {

constexpr int kFeelers = 6;            ///< short rays around a sample
constexpr float kReach = 1.5f;         ///< their length in texels
constexpr float kFeelerSlope = 0.34f;  ///< the sine of the angle at which they rise: 20 degrees
/// Charts of no more texels are looked at texel by texel: they fall between those of a lattice.
constexpr uint32_t kSmallChart = 32;

/// Looks around samples.
struct Probe : PlaceSearch {
  /// Short rays around the sample, twenty degrees above the surface.
  void add_feelers(const atlas::Texel& texel, std::vector<trace::Ray>& rays) const {
    const FlatPoint at = flat_point(scene, texel.sample);
    const Vec3 from = just_above(at);
    const float reach =
        kReach * texel_width_m(scene, atlas, texel.sample.instance, texel.sample.triangle);
    const auto frame = frame_around(at.normal);
    for (int k = 0; k < kFeelers; ++k) {
      const float turn = 2 * kPi * float(k) / kFeelers;
      const Vec3 d{0.94f * std::cos(turn), 0.94f * std::sin(turn), kFeelerSlope};
      rays.push_back({from, 0, frame.to_world(d), reach});
    }
  }

  /// True: the feelers of a run's samples meet nothing.
  bool has_clear_feelers(const atlas::TexelMap& map, TexelRun run) const {
    const scene::SurfacePoint& p = map.texels[run.first].sample;
    // No feeler of the run starts lower than this, twice.
    const float rounding_m =
        scene::rounding_m({}, scene::facet_of(scene, p.instance, p.triangle).size_m);
    return is_clear(scene, atlas, map, tracer, run,
                    {0.5f * rounding_m, 1.01f * kReach * kFeelerSlope, kReach, true});
  }
};

/// Findings about a texel.
enum class Found : uint8_t { nothing, back_near, enclosed, moved };

/// The run that begins at texels[k]: none of its texels is left out of `texels`, which ascend.
TexelRun run_at(const atlas::TexelMap& map, std::span<const uint32_t> texels, size_t k) {
  TexelRun run = run_from(map, texels[k], uint32_t(texels.size() - k));
  while (texels[k + run.count - 1] != texels[k] + run.count - 1) --run.count;
  return run;
}

/// Looks at some texels' samples, and sets what is found per texel of the map.
Status look_around(const Probe& probe, std::span<const uint32_t> texels, const atlas::TexelMap& map,
                   std::span<Found> found, Team* team, Progress& progress) {
  constexpr size_t kBlock = 2048;
  std::vector<Found> found_here(texels.size());
  const auto look = [&](size_t begin, size_t end) {
    const std::span<const uint32_t> block = texels.subspan(begin, end - begin);
    // Most runs have nothing near them: feelers look at the others.
    std::vector<size_t> looking;
    std::vector<trace::Ray> rays;
    for (size_t k = 0; k < block.size();) {
      const TexelRun run = run_at(map, block, k);
      const size_t first = k;
      k += run.count;
      if (probe.has_clear_feelers(map, run)) continue;
      for (uint32_t i = 0; i < run.count; ++i)
        looking.push_back(begin + first + i), probe.add_feelers(map.texels[run.first + i], rays);
    }
    std::vector<trace::Hit> hits(rays.size());
    probe.tracer.closest_hits(rays, hits);
    for (size_t k = 0; k < looking.size(); ++k) {
      const auto first = hits.begin() + long(k * kFeelers);
      if (std::none_of(first, first + kFeelers,
                       [](const trace::Hit& hit) { return hit.found() && hit.back_face; }))
        continue;
      const bool open = probe.in_the_open(map.texels[texels[looking[k]]].sample);
      found_here[looking[k]] = open ? Found::back_near : Found::enclosed;
    }
    progress.advance(end - begin);
  };
  LUXEL_TRY_STATUS(
      share_ranges(team, texels.size(), kBlock, progress, look, std::span(found_here)));
  for (size_t k = 0; k < texels.size(); ++k) found[texels[k]] = found_here[k];
  return {};
}

uint32_t texel_at(const atlas::TexelMap& map, int x, int y) {
  if (x < 0 || y < 0 || x >= map.resolution || y >= map.resolution) return atlas::kNone;
  return map.texel_at[size_t(y) * size_t(map.resolution) + size_t(x)];
}

/// Finds the borders of enclosed regions whose backs are farther away, such as the floor under a
/// shell without a bottom: between texels of a lattice of which one is enclosed and another is not
/// all are looked at.
Status look_for_regions(const Probe& probe, const atlas::TexelMap& map, std::span<Found> found,
                        Team* team, Progress& progress) {
  // Finds the texels of a lattice that are enclosed.
  constexpr int kStep = 4;
  const int across = (map.resolution + kStep - 1) / kStep;
  const auto on_lattice = [&](int u, int v) { return texel_at(map, u * kStep, v * kStep); };
  std::vector<uint8_t> enclosed(size_t(across) * size_t(across));
  const auto look_at_lattice = [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k)
      if (const uint32_t i = on_lattice(int(k) % across, int(k) / across); i != atlas::kNone)
        enclosed[k] = !probe.in_the_open(map.texels[i].sample);
  };
  LUXEL_TRY_STATUS(
      share_ranges(team, enclosed.size(), 64, progress, look_at_lattice, std::span(enclosed)));
  const auto is_enclosed_at = [&](int u, int v) {
    return u >= 0 && v >= 0 && u < across && v < across &&
           enclosed[size_t(v) * size_t(across) + size_t(u)];
  };
  const auto is_inner = [&](int u, int v) {
    for (int dv = -1; dv <= 1; ++dv)
      for (int du = -1; du <= 1; ++du)
        if (!is_enclosed_at(u + du, v + dv)) return false;
    return true;
  };
  // All texels around those that lie at a border of an enclosed region.
  std::vector<uint8_t> look(found.size());
  for (int v = 0; v < across; ++v)
    for (int u = 0; u < across; ++u) {
      if (!is_enclosed_at(u, v) || is_inner(u, v)) continue;
      for (int y = (v - 1) * kStep + 1; y < (v + 1) * kStep; ++y)
        for (int x = (u - 1) * kStep + 1; x < (u + 1) * kStep; ++x)
          if (const uint32_t i = texel_at(map, x, y); i != atlas::kNone) look[i] = 1;
    }
  const auto look_at_texels = [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      if (look[i] && found[i] == Found::nothing && !probe.in_the_open(map.texels[i].sample))
        found[i] = Found::enclosed;
  };
  return share_ranges(team, look.size(), 256, progress, look_at_texels, found);
}

/// Looks at the samples of small charts.
Status look_at_small_charts(const Probe& probe, const atlas::TexelMap& map, std::span<Found> found,
                            Team* team, Progress& progress) {
  std::vector<uint32_t> texels(probe.atlas.chart_count);
  const auto chart_of = [&](size_t i) { return probe.atlas.chart[map.texels[i].triangle_number]; };
  for (size_t i = 0; i < found.size(); ++i) ++texels[chart_of(i)];
  const auto look = [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      if (found[i] == Found::nothing && texels[chart_of(i)] <= kSmallChart &&
          !probe.in_the_open(map.texels[i].sample))
        found[i] = Found::enclosed;
  };
  return share_ranges(team, found.size(), 256, progress, look, found);
}

/// Those that are enclosed and their neighbours in the map.
std::vector<uint32_t> at_the_edge(const atlas::TexelMap& map, std::span<const Found> found) {
  std::vector<uint8_t> is_at_edge(found.size());
  for (uint32_t i = 0; i < found.size(); ++i) {
    if (found[i] != Found::enclosed) continue;
    const int x = int(map.texels[i].x), y = int(map.texels[i].y);
    for (int v = y - 1; v <= y + 1; ++v)
      for (int u = x - 1; u <= x + 1; ++u)
        if (const uint32_t j = texel_at(map, u, v); j != atlas::kNone) is_at_edge[j] = 1;
  }
  std::vector<uint32_t> out;
  for (uint32_t i = 0; i < is_at_edge.size(); ++i)
    if (is_at_edge[i]) out.push_back(i);
  return out;
}

void move_to(const atlas::Atlas& atlas, const ChartPlace& place, atlas::Texel& texel) {
  const auto [instance, triangle] = scene::drawn_triangle(atlas.first_triangle, place.triangle);
  texel.sample = {instance, triangle, place.at};
  texel.triangle_number = place.triangle & 0x7fffffffu;
}

/// Opens the samples of the map's texels, of which only some can have backs near them.
Result<MovedSamples> move_some(const Probe& probe, std::span<const uint32_t> texels,
                               atlas::TexelMap& map, Team* team, Progress& progress) {
  std::vector<Found> found(map.texels.size());
  progress.begin("samples", texels.size());
  LUXEL_TRY_STATUS(look_around(probe, texels, map, found, team, progress));
  MovedSamples out;
  for (uint32_t i = 0; i < found.size(); ++i)
    if (found[i] != Found::nothing) out.near_back_faces.push_back(i);
  LUXEL_TRY_STATUS(look_for_regions(probe, map, found, team, progress));
  LUXEL_TRY_STATUS(look_at_small_charts(probe, map, found, team, progress));
  const std::vector<uint32_t> edge = at_the_edge(map, found);
  const ChartTriangles charts = triangles_of_charts(probe.atlas);
  std::vector<atlas::Texel> moved(edge.size());
  std::vector<uint8_t> is_moved(edge.size());
  const auto move = [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) {
      const Found before = found[edge[k]];
      atlas::Texel& texel = moved[k] = map.texels[edge[k]];
      if (const auto place = open_place_of_grid(probe, texel, before != Found::enclosed)) {
        texel.sample = *place, is_moved[k] = 1;
      } else if (before == Found::enclosed) {
        if (const auto other = open_place_of_chart(probe, texel, charts))
          move_to(probe.atlas, *other, texel), is_moved[k] = 1;
      }
    }
  };
  LUXEL_TRY_STATUS(
      share_ranges(team, edge.size(), 64, progress, move, std::span(moved), std::span(is_moved)));
  for (size_t k = 0; k < edge.size(); ++k)
    if (is_moved[k]) map.texels[edge[k]] = moved[k], out.moved.push_back(edge[k]);
  return out;
}

bool meets_any(std::span<const Box3> boxes, const Box3& other, float within_m) {
  const Vec3 r{within_m, within_m, within_m};
  return std::ranges::any_of(boxes, [&](const Box3& box) {
    const Vec3 lower = max(box.lower - r, other.lower), upper = min(box.upper + r, other.upper);
    return lower.x <= upper.x && lower.y <= upper.y && lower.z <= upper.z;
  });
}

/// Per triangle of the atlas, how near to a box its samples' feelers meet it; < 0: it is too far
/// away for all of them.
std::vector<float> reaches_to(const Probe& probe, std::span<const Box3> boxes) {
  std::vector<float> out(probe.atlas.corners.size(), -1.0f);
  const float slack_m = 1e-4f * scene::world_bounds(probe.scene).diagonal();
  parallel_for(out.size(), 1024, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) {
      const auto [instance, triangle] =
          scene::drawn_triangle(probe.atlas.first_triangle, uint32_t(k));
      // Feelers start a little above their sample, which rounding may put beside the triangle.
      const float reach =
          kReach * texel_width_m(probe.scene, probe.atlas, instance, triangle) + slack_m;
      const scene::Triangle3 t = scene::world_triangle(probe.scene, instance, triangle);
      Box3 bounds;
      for (const Vec3& corner : {t.a, t.b, t.c}) bounds.extend(corner);
      if (meets_any(boxes, bounds, reach)) out[k] = reach;
    }
  });
  return out;
}

}  // namespace

Result<MovedSamples> move_samples_out_of_solids(const scene::Scene& scene,
                                                const atlas::Atlas& atlas,
                                                const trace::RayTracer& tracer,
                                                atlas::TexelMap& map, Progress& progress,
                                                Team* team) {
  std::vector<uint32_t> all(map.texels.size());
  std::iota(all.begin(), all.end(), 0);
  return move_some({{scene, atlas, tracer}}, all, map, team, progress);
}

Result<MovedSamples> move_samples_near_changes(const scene::Scene& scene, const atlas::Atlas& atlas,
                                               const trace::RayTracer& tracer,
                                               std::span<const Box3> boxes,
                                               std::span<const uint32_t> near_back_faces,
                                               atlas::TexelMap& map, Progress& progress) {
  const Probe probe{{scene, atlas, tracer}};
  const std::vector<float> reaches = reaches_to(probe, boxes);
  std::vector<uint8_t> look(map.texels.size());
  for (const uint32_t i : near_back_faces) look[i] = 1;
  parallel_for(look.size(), 4096, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const float reach = reaches[map.texels[i].triangle_number];
      if (look[i] || reach < 0) continue;
      const Vec3 at = scene::world_position(scene, map.texels[i].sample);
      if (meets_any(boxes, {at, at}, reach)) look[i] = 1;
    }
  });
  std::vector<uint32_t> texels;
  for (uint32_t i = 0; i < look.size(); ++i)
    if (look[i]) texels.push_back(i);
  return move_some(probe, texels, map, nullptr, progress);
}

}  // namespace luxel::transport
