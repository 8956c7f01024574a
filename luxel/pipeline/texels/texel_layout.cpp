#include "luxel/pipeline/texels/texel_layout.h"

#include <algorithm>
#include <array>

#include "luxel/atlas/cut_charts.h"
#include "luxel/base/check.h"
#include "luxel/base/free_memory.h"
#include "luxel/base/output_folder.h"
#include "luxel/base/process_memory.h"
#include "luxel/base/share_out.h"
#include "luxel/pipeline/texels/finishing_memory.h"
#include "luxel/scene/drawn_triangle.h"
#include "luxel/scene/sides.h"
#include "luxel/transport/barriers.h"
#include "luxel/transport/visible_samples.h"

namespace luxel::pipeline {
namespace {

atlas::AtlasParams params_of(const BakeSettings& settings) {
  atlas::AtlasParams params;
  params.uv = settings.uv;
  params.resolution = settings.resolution.value_or(params.resolution);
  params.texels_per_metre = settings.texels_per_metre;
  params.page_mode = settings.pages.mode, params.pages = settings.pages.count;
  return params;
}

// The most memory of gather and the steps after it, in bytes per texel of the square, hits and the
// scene aside; and additions for some settings. Too large a bound makes a bake slower. Too small a
// one refuses a bake that could have gone on in files.
constexpr uint64_t kMost = 150, kMostOfRounds = 80, kMostKept = 130, kMostOfLayers = 600,
                   kMostScattering = 60;

uint64_t most_bytes_per_texel(const BakeSettings& settings, const scene::Scene& scene) {
  const bool has_layers =
      settings.layers != light::LayerMode::none || settings.light != LightPart::all;
  return kMost + (adds_rounds(settings) ? kMostOfRounds : 0) + (settings.keep ? kMostKept : 0) +
         (has_layers ? kMostOfLayers : 0) + (scene::scatters_light(scene) ? kMostScattering : 0) +
         (settings.denoise ? kDenoise : 0) +
         (settings.directional == Directional::none ? 0 : kDirection);
}

/// With bakes that need less, files would save too little.
constexpr uint64_t kLeastInFiles = uint64_t(1) << 30;

/// Where the arrays of so many texels lie that are gone over in order: on the heap, or in files
/// where a bake may need more memory than it may have.
std::shared_ptr<MappedMemory> memory_for(const BakeSettings& settings, const scene::Scene& scene,
                                         int resolution) {
  const uint64_t limit = settings.max_memory_bytes > 0
                             ? settings.max_memory_bytes
                             : resident_bytes() + available_bytes() / 5 * 4;
  const uint64_t needed =
      most_bytes_per_texel(settings, scene) * uint64_t(resolution) * uint64_t(resolution);
  if (needed < kLeastInFiles || resident_bytes() + needed <= limit) return nullptr;
  return std::make_shared<MappedMemory>(nearest_folder(settings.output),
                                        limit - std::min(limit, kMappedPagesBytes));
}

Result<TexelLayout> lay_out_once(const BakeSettings& settings, const atlas::AtlasParams& params,
                                 const scene::Scene& scene, Progress& progress, Team* team) {
  LUXEL_TRY(atlas::Atlas atlas, atlas::make_atlas(scene, params, progress));
  LUXEL_TRY(atlas::TexelMap map,
            atlas::rasterise_together(scene, atlas, team,
                                      memory_for(settings, scene, atlas.resolution), progress));
  progress.begin("build ray tracer", 0);
  LUXEL_TRY(trace::RayTracer tracer, trace::RayTracer::build(scene));
  return TexelLayout{std::move(atlas), std::move(map), {}, std::move(tracer), {}, {}, {}, {}};
}

/// Cuts the scene where its charts run under barriers. Cut charts are smaller and pack another way,
/// at another density, so that barriers lie between other texels than before: they are searched
/// again, and what is parted in the end is counted.
Status cut_at_barriers(const BakeSettings& settings, const atlas::AtlasParams& params,
                       scene::Scene& scene, TexelLayout& layout, Progress& progress, Team* team) {
  constexpr int kMostTimes = 2;
  atlas::AtlasParams grouped = params;
  uint32_t cuts = 0;
  for (int k = 0;; ++k) {
    LUXEL_TRY(
        const std::vector<atlas::PartedPoints> parted,
        transport::find_parted(scene, layout.atlas, layout.map, layout.tracer, progress, team));
    layout.repair.parted = parted.size(), layout.repair.cuts = cuts;
    if (layout.atlas.kept || k == kMostTimes || parted.size() < atlas::kFewestParted) return {};
    atlas::CutScene cut = atlas::cut_charts(scene, layout.atlas, parted, grouped.group);
    if (cut.cuts == 0) return {};
    cuts += cut.cuts;
    scene = std::move(cut.scene);
    grouped.group = std::move(cut.group);
    layout.atlas = {}, layout.map = {};  // a large one would not find place beside the next
    LUXEL_TRY(layout, lay_out_once(settings, grouped, scene, progress, team));
  }
}

/// The map of kept texels, which are not kept any more.
atlas::TexelMap kept_map(const BakeSettings& settings, const scene::Scene& scene,
                         KeptLayout& kept) {
  MappedVector<atlas::Texel> texels(
      kept.texels.begin(), kept.texels.end(),
      MappedAllocator<atlas::Texel>(memory_for(settings, scene, kept.atlas.resolution)));
  free_memory(kept.texels);
  return atlas::map_of(kept.atlas, std::move(texels));
}

Vec2 between(Vec2 a, Vec2 b, float s) { return a * (1 - s) + b * s; }

/// The place of a drawn triangle's plane half a texel from an edge, on its side of it.
transport::FlatPoint beside_edge(const scene::Scene& scene, const atlas::Atlas& atlas,
                                 uint32_t triangle, Vec2 on_edge, Vec2 along) {
  const auto drawn = scene::drawn_triangle(atlas.first_triangle, triangle);
  const auto& corners = atlas.corners[triangle];
  const Vec2 middle = (corners[0] + corners[1] + corners[2]) * (1.0f / 3);
  Vec2 inwards = Vec2{-along.y, along.x} * (0.5f / std::max(length(along), 1e-6f));
  if (dot(inwards, middle - on_edge) < 0) inwards = inwards * -1.0f;
  const Barycentric at = atlas::barycentric_in(corners, on_edge + inwards);
  return transport::flat_point(scene, {drawn.instance, drawn.triangle, at});
}

/// The stretches of one seam that are open, whole texels each.
void add_open(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::RayTracer& tracer,
              const post::Seam& seam, std::vector<post::Seam>& out) {
  const Vec2 a = seam.a1 - seam.a0, b = seam.b1 - seam.b0;
  const int count = std::max(1, int(std::ceil(std::max(length(a), length(b)))));
  const auto open_at = [&](float s) {
    const auto p = beside_edge(scene, atlas, seam.triangle_a, between(seam.a0, seam.a1, s), a);
    const auto q = beside_edge(scene, atlas, seam.triangle_b, between(seam.b0, seam.b1, s), b);
    return !transport::barrier_between(scene, atlas, tracer, atlas::kNone, p, q,
                                       length(q.position - p.position));
  };
  // A barrier may cross the seam within a texel.
  const auto open = [&](int k) {
    return std::ranges::all_of(std::array{0.5f, 0.05f, 0.95f}, [&](float part) {
      return open_at((float(k) + part) / float(count));
    });
  };
  for (int begin = 0, end = 0; begin < count; begin = end + 1) {
    for (end = begin; end < count && open(end);) ++end;
    if (end == begin) continue;
    post::Seam stretch = seam;
    const float s0 = float(begin) / float(count), s1 = float(end) / float(count);
    if (begin > 0)
      stretch.a0 = between(seam.a0, seam.a1, s0), stretch.b0 = between(seam.b0, seam.b1, s0);
    if (end < count)
      stretch.a1 = between(seam.a0, seam.a1, s1), stretch.b1 = between(seam.b0, seam.b1, s1);
    out.push_back(stretch);
  }
}

void take_moved(transport::MovedSamples opened, TexelLayout& layout) {
  layout.repair.moved = std::move(opened.moved);
  layout.near_back_faces = std::move(opened.near_back_faces);
}

}  // namespace

Result<TexelLayout> lay_out_texels(const BakeSettings& settings, scene::Scene& scene,
                                   Progress& progress, Team* team) {
  const atlas::AtlasParams params = params_of(settings);
  LUXEL_TRY(TexelLayout layout, lay_out_once(settings, params, scene, progress, team));
  if (settings.repair_leaks) {
    LUXEL_TRY_STATUS(cut_at_barriers(settings, params, scene, layout, progress, team));
    LUXEL_TRY(transport::MovedSamples opened,
              transport::move_samples_out_of_solids(scene, layout.atlas, layout.tracer, layout.map,
                                                    progress, team));
    take_moved(std::move(opened), layout);
  }
  layout.repair.overlapping = atlas::overlapping_texels(layout.atlas, layout.map);
  layout.stats = atlas::atlas_stats(scene, layout.atlas, layout.map);
  return layout;
}

KeptLayout keep_layout(const scene::Scene& scene, const TexelLayout& layout) {
  KeptLayout out;
  out.meshes = scene.meshes;
  for (const scene::Instance& instance : scene.instances)
    out.mesh_of_instance.push_back(instance.mesh);
  out.atlas = layout.atlas;
  out.texels.assign(layout.map.texels.begin(), layout.map.texels.end());
  out.stats = layout.stats, out.repair = layout.repair,
  out.near_back_faces = layout.near_back_faces;
  if (layout.wrong_in_uv1) out.wrong_in_uv1.push_back(*layout.wrong_in_uv1);
  out.warnings = layout.warnings;
  return out;
}

Result<TexelLayout> lay_out_again(const BakeSettings& settings, KeptLayout kept,
                                  std::span<const Box3> boxes, scene::Scene& scene,
                                  Progress& progress) {
  LUXEL_CHECK(kept.mesh_of_instance.size() == scene.instances.size());
  progress.begin("charts", 0);
  scene.meshes = std::move(kept.meshes);
  for (const uint32_t material : kept.one_sided_of) {
    scene.materials.push_back(scene::Material(scene.materials[material]));
    scene.materials.back().double_sided = false;
  }
  for (size_t i = 0; i < scene.instances.size(); ++i)
    scene.instances[i].mesh = kept.mesh_of_instance[i];
  const bool same_places = boxes.empty();
  // Samples that were moved out of solids begin at their own places again where things have moved.
  if (!same_places) free_memory(kept.texels);
  atlas::TexelMap map =
      same_places
          ? kept_map(settings, scene, kept)
          : atlas::rasterise(scene, kept.atlas, memory_for(settings, scene, kept.atlas.resolution));
  progress.begin("build ray tracer", 0);
  LUXEL_TRY(trace::RayTracer tracer, trace::RayTracer::build(scene));
  TexelLayout layout{std::move(kept.atlas),
                     std::move(map),
                     kept.stats,
                     std::move(tracer),
                     std::move(kept.repair),
                     std::move(kept.near_back_faces),
                     {},
                     std::move(kept.warnings)};
  if (!kept.wrong_in_uv1.empty()) layout.wrong_in_uv1 = kept.wrong_in_uv1.front();
  if (!same_places && settings.repair_leaks) {
    LUXEL_TRY(transport::MovedSamples opened,
              transport::move_samples_near_changes(scene, layout.atlas, layout.tracer, boxes,
                                                   layout.near_back_faces, layout.map, progress));
    take_moved(std::move(opened), layout);
  }
  return layout;
}

post::Parted parted_texels(const scene::Scene& scene, const atlas::Atlas& atlas,
                           const atlas::TexelMap& map, const trace::RayTracer& tracer) {
  return [&](uint32_t a, uint32_t b) {
    const atlas::Texel &s = map.texels[a], &t = map.texels[b];
    const auto p = transport::flat_point(scene, s.sample),
               q = transport::flat_point(scene, t.sample);
    const float steps = std::hypot(float(s.x) - float(t.x), float(s.y) - float(t.y));
    return transport::barrier_between(scene, atlas, tracer, atlas.chart[s.triangle_number], p, q,
                                      length(q.position - p.position) / steps)
        .has_value();
  };
}

Result<std::vector<post::Seam>> open_seams(const scene::Scene& scene, const atlas::Atlas& atlas,
                                           const trace::RayTracer& tracer,
                                           std::span<const post::Seam> seams, Progress& progress,
                                           Team* team) {
  constexpr size_t kBlock = 256;
  return share_lists<post::Seam>(team, seams.size(), kBlock, progress,
                                 [&](size_t begin, size_t end) {
                                   std::vector<post::Seam> open;
                                   for (size_t i = begin; i < end; ++i)
                                     add_open(scene, atlas, tracer, seams[i], open);
                                   return open;
                                 });
}

}  // namespace luxel::pipeline
