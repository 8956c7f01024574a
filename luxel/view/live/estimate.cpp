#include "luxel/view/live/estimate.h"

#include <algorithm>
#include <cmath>

#include "luxel/base/parallel.h"
#include "luxel/light/direct_light.h"
#include "luxel/view/edit/pick.h"
#include "luxel/view/live/lamp_light.h"
#include "luxel/view/live/spread_texels.h"

namespace luxel::view {
namespace {

constexpr size_t kEstimateGrain = 4096;

/// Estimates change what is known by a factor. Where it differs from place to place by more than
/// kNoise, its relative standard deviation, edges of shadows that were there would stay behind: the
/// estimate takes the place of what is known, in part, and above kEdit as a whole.
constexpr float kNoise = 0.03f, kEdit = 0.15f;
/// So does it where light grows by more than the first, and as a whole above kMostFactor: what was
/// dark by then had other reasons.
constexpr float kGrows = 1.5f;

Box3 box_of(const scene::Scene& scene, uint32_t instance) {
  const scene::Instance& placed = scene.instances[instance];
  return placed_bounds(scene.meshes[placed.mesh], placed.world_from_object);
}

bool shines(const scene::Scene& scene, const scene::Mesh& mesh) {
  return std::ranges::any_of(mesh.triangle_material, [&](uint32_t m) {
    return max_component(scene.materials[m].emission) > 0;
  });
}

bool is_same_lamp(const scene::PunctualLight& a, const scene::PunctualLight& b) {
  return a.kind == b.kind && a.intensity == b.intensity && a.position == b.position &&
         a.direction == b.direction && a.range_m == b.range_m &&
         a.inner_cone_rad == b.inner_cone_rad && a.outer_cone_rad == b.outer_cone_rad &&
         a.angular_radius_rad == b.angular_radius_rad && a.profile == b.profile && a.side == b.side;
}

/// Instances and places that an edit changes.
struct Changes {
  std::vector<uint8_t> moved;  ///< per instance
  std::vector<Box3> boxes;     ///< where something was or is; none: all that is lit changes
};

/// Puts what was edited into the scene as it was laid out.
Changes put_edits_into(const scene::Scene& edited, std::span<const uint32_t> material_as_read,
                       scene::Scene& scene) {
  Changes out;
  bool is_everywhere = false;
  out.moved.resize(scene.instances.size());
  for (uint32_t i = 0; i < scene.instances.size(); ++i) {
    const Mat34& to = edited.instances[i].world_from_object;
    if (scene.instances[i].world_from_object == to) continue;
    out.moved[i] = 1;
    out.boxes.push_back(box_of(scene, i));
    scene.instances[i].world_from_object = to;
    out.boxes.push_back(box_of(scene, i));
    is_everywhere = is_everywhere || shines(scene, scene.meshes[scene.instances[i].mesh]);
  }
  for (size_t m = 0; m < scene.materials.size(); ++m) {
    const scene::Material& to = edited.materials[material_as_read[m]];
    scene::Material& material = scene.materials[m];
    is_everywhere = is_everywhere || material.base_color != to.base_color ||
                    material.emission != to.emission || material.metallic != to.metallic;
    material.base_color = to.base_color, material.emission = to.emission;
    material.metallic = to.metallic;
  }
  for (size_t k = 0; k < std::max(scene.lights.size(), edited.lights.size()); ++k) {
    const bool was = k < scene.lights.size(), is = k < edited.lights.size();
    if (was && is && is_same_lamp(scene.lights[k], edited.lights[k])) continue;
    for (const bool before : {true, false}) {
      if (before ? !was : !is) continue;
      const scene::PunctualLight& light = before ? scene.lights[k] : edited.lights[k];
      is_everywhere = is_everywhere || light.kind == scene::PunctualLight::Kind::directional;
      out.boxes.push_back({light.position, light.position});
    }
  }
  scene.lights = edited.lights;
  is_everywhere = is_everywhere || scene.environment.radiance != edited.environment.radiance;
  scene.environment = edited.environment;
  if (is_everywhere) out.boxes.clear();
  return out;
}

/// 0 at `begin`, 1 at `end`, linear between them and constant beyond.
float part_of_way(float x, float begin, float end) {
  return std::clamp((x - begin) / (end - begin), 0.0f, 1.0f);
}

/// A kind of light in a cell.
struct CellChange {
  Rgb was, is;
  float factor = -1;  ///< of luminance; < 0: it is dark and was
  bool differs = false;
};
CellChange cell_change(Rgb was, Rgb is) {
  const float before = luminance(was), after = luminance(is);
  // Infinite where it was dark.
  const float factor = std::min(after / before, 2 * kMostFactor);
  return {was, is, before + after > 0 ? factor : -1.0f, was != is};
}
struct CellLight {
  CellChange direct, area, reflected;
  bool hidden_before = false, hidden_after = false;
};
std::vector<CellLight> light_of_cells(const Estimates& e) {
  std::vector<CellLight> out(e.direct_before.size());
  for (size_t c = 0; c < out.size(); ++c)
    out[c] = {cell_change(e.direct_before[c], e.direct_after[c]),
              cell_change(e.area_before[c], e.area_after[c]),
              cell_change(e.reflected_before[c], e.reflected_after[c]), e.hidden_before[c] != 0,
              e.hidden_after[c] != 0};
  return out;
}

/// A kind of light where a texel is, by the cells around it.
struct Change {
  Rgb before, after;
  float weight_before = 0, weight_after = 0;
  float weight = 0, factor = 0, factor2 = 0;  ///< of factors: sums
  float all = 0;
  Rgb beside;  ///< of cells within solids
  float weight_beside = 0;
  bool is_one = false;  ///< there is any

  /// Light within solids is none of the light beside them.
  void add(float w, const CellChange& c, bool hidden_before, bool hidden_after) {
    if (hidden_after) beside += c.is * w, weight_beside += w;
    if (hidden_before && hidden_after) return;
    all += w;
    is_one = is_one || c.differs || hidden_before != hidden_after;
    if (!hidden_before) before += c.was * w, weight_before += w;
    if (!hidden_after) after += c.is * w, weight_after += w;
    if (hidden_before || hidden_after || c.factor < 0) return;
    weight += w, factor += w * c.factor, factor2 += w * c.factor * c.factor;
  }
  /// Share of known light that the estimate replaces.
  float estimated() const {
    if (!is_one || weight_after <= 0) return 0;
    if (weight <= 0 || factor <= 0) return 1;
    const float mean = factor / weight;
    const float differ = std::sqrt(std::max(factor2 / weight - mean * mean, 0.0f)) / mean;
    return std::max({part_of_way(differ, kNoise, kEdit), part_of_way(mean, kGrows, kMostFactor),
                     1 - weight_before / all});
  }
  Rgb of(Rgb known) const {
    if (!is_one || weight_after <= 0) return known;
    const Rgb estimate = after / weight_after;
    const float part = estimated();
    if (part >= 1) return estimate;
    return scaled(known, before / weight_before, estimate) * (1 - part) + estimate * part;
  }
  /// Light of a texel that may have come out of the solid in which all of its cells still are.
  Rgb of_freed() const {
    if (weight_after > 0) return after / weight_after;
    return weight_beside > 0 ? beside / weight_beside : Rgb{};
  }
};
struct Around {
  Change direct, area, reflected;
};

Around around_texel(const SpreadTexels& spread, std::span<const CellLight> cells, bool has_area,
                    size_t texel) {
  std::array<CellShare, kMostShares> shares;
  const size_t count = spread.shares_at(texel, shares);
  Around out;
  for (size_t k = 0; k < count; ++k) {
    const float weight = shares[k].weight;
    const CellLight& c = cells[shares[k].cell];
    out.direct.add(weight, c.direct, c.hidden_before, c.hidden_after);
    if (has_area) out.area.add(weight, c.area, c.hidden_before, c.hidden_after);
    out.reflected.add(weight, c.reflected, c.hidden_before, c.hidden_after);
  }
  return out;
}

/// So many of the texels as may be whose direct light needs an estimate: those that need it most,
/// and of them those in the finest cells.
std::vector<uint32_t> to_sharpen(const SpreadTexels& spread, std::span<const uint8_t> estimated,
                                 size_t most) {
  constexpr size_t kLevels = 32;
  const auto rank = [&](size_t i) {
    return kLevels * size_t(255 - estimated[i]) + size_t(spread.level_of(i));
  };
  std::vector<size_t> of(kLevels * 256);
  for (size_t i = 0; i < estimated.size(); ++i) ++of[rank(i)];
  size_t end = 0;
  for (size_t sum = 0; end < kLevels * 255 && sum + of[end] <= most;) sum += of[end++];
  std::vector<uint32_t> out;
  for (uint32_t i = 0; i < estimated.size(); ++i)
    if (rank(i) < end) out.push_back(i);
  return out;
}

/// Direct light of texels of their own, in place of that of their cells.
Status sharpen(const KnownLight& known, const SceneState& state, std::span<const uint32_t> chosen,
               const EstimateParams& params, Draft& out) {
  if (chosen.empty()) return {};
  const transport::Elements elements =
      transport::elements_from_texels(state.scene, known.atlas, map_of_chosen(known.map, chosen));
  const auto direct_of = [&](const light::Lights& lights) {
    Progress own;
    return light::direct_light(
        state.scene, elements, lights, state.tracer,
        {.samples = params.sharp_samples, .seed = params.seed, .same_points = true}, own);
  };
  LUXEL_TRY(const light::DirectLight direct, direct_of(state.lights));
  light::DirectLight area;  // of all but lamps
  const light::Lights others = without_lamps(state.lights);
  if (!out.without_lamps.empty() && !is_dark(others)) {
    LUXEL_TRY(area, direct_of(others));
  }
  for (size_t k = 0; k < chosen.size(); ++k) {
    const uint32_t i = chosen[k];
    const Rgb reflected = max(out.irradiance[i] - out.direct[i], Rgb{});
    out.irradiance[i] = reflected + direct.irradiance[k];
    out.direct[i] = direct.irradiance[k];
    if (!out.without_lamps.empty())
      out.without_lamps[i] = reflected + (area.irradiance.empty() ? Rgb{} : area.irradiance[k]);
  }
  return {};
}

/// Texels of what moves stand for nothing else.
std::vector<uint32_t> bodies(const KnownLight& known, std::span<const uint8_t> moved) {
  std::vector<uint32_t> out(known.map.texels.size());
  for (size_t i = 0; i < out.size(); ++i) {
    const uint32_t instance = known.map.texels[i].sample.instance;
    out[i] = moved[instance] ? instance + 1 : 0;
  }
  return out;
}

/// True for a texel that was within a solid and may have come out: it lies near an edit.
bool is_freed(const KnownLight& known, std::span<const Box3> boxes, size_t i) {
  if (known.hidden.empty() ? max_component(known.irradiance[i]) > 0 : !known.hidden[i])
    return false;
  const Vec3 p = known.position[i];
  const float near_m = 2 * std::sqrt(known.texel_m2);
  return std::ranges::any_of(boxes, [&](const Box3& box) {
    return max_component(max(box.lower - p, p - box.upper)) < near_m;
  });
}

/// Light of all texels by that of their cells. Returns by which part of 255 an estimate takes the
/// place of what is known of their direct light.
std::vector<uint8_t> spread_light(const KnownLight& known, const SpreadTexels& spread,
                                  const Estimates& e, std::span<const Box3> boxes, Draft& out) {
  const std::vector<CellLight> cells = light_of_cells(e);
  std::vector<uint8_t> estimated(known.map.texels.size());
  out.irradiance.resize(estimated.size()), out.direct.resize(estimated.size());
  out.without_lamps.resize(known.of_lamps.size());
  parallel_for(estimated.size(), kEstimateGrain, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const Around at = around_texel(spread, cells, !known.of_lamps.empty(), i);
      // Repairs of leaks may have taken away direct light.
      const Rgb direct = min(known.direct[i], known.irradiance[i]);
      const Rgb reflected = known.irradiance[i] - direct;
      const bool freed = is_freed(known, boxes, i);
      out.direct[i] = freed ? at.direct.of_freed() : at.direct.of(direct);
      const Rgb now = freed ? at.reflected.of_freed() : at.reflected.of(reflected);
      out.irradiance[i] = out.direct[i] + now;
      if (!known.of_lamps.empty()) {
        const Rgb area = max(direct - known.of_lamps[i], Rgb{});
        out.without_lamps[i] = now + (freed ? at.area.of_freed() : at.area.of(area));
      }
      estimated[i] = freed ? 255 : uint8_t(std::ceil(255 * at.direct.estimated()));
    }
  });
  return estimated;
}

/// Seconds per ray, and what they are more for each doubling of the triangles: rays of the Cornell
/// box and of a city of 54,000 triangles took 0.3 and 0.54 us, with all that is done for them.
constexpr double kRay_s = 0.18e-6, kRayPerDoubling_s = 0.023e-6;
/// Seconds per texel whose light follows from that of its cells, and the least part of all seconds
/// that rays get.
constexpr double kTexel_s = 0.17e-6, kLeastPartForRays = 0.25;
/// Where many texels get direct light of their own, it takes a quarter of the time.
constexpr double kPartSharp = 0.25;

}  // namespace

EstimateParams params_within(double seconds, const scene::Scene& scene, size_t texels) {
  EstimateParams out;
  seconds = std::max(kLeastPartForRays * seconds, seconds - double(texels) * kTexel_s);
  const double triangles = double(scene::first_triangles(scene).back());
  const double rays = seconds / (kRay_s + kRayPerDoubling_s * std::log2(std::max(triangles, 1.0)));
  const double of_texel = 2.0 * double(out.samples + out.direct_samples);
  out.texels = size_t(rays * (1 - kPartSharp) / of_texel);
  out.sharp = size_t(rays * kPartSharp / double(out.sharp_samples));
  return out;
}

Result<std::unique_ptr<Draft>> estimate_light(const KnownLight& known, const scene::Scene& edited,
                                              const EstimateParams& params,
                                              const Progress& watched) {
  auto out = std::make_unique<Draft>();
  out->scene = known.scene, out->atlas = known.atlas, out->map = known.map;
  const Changes changes = put_edits_into(edited, known.material_as_read, out->scene);
  LUXEL_TRY(trace::RayTracer tracer,
            known.is_apart ? known.tracer->moved(out->scene) : trace::RayTracer::build(out->scene));
  out->tracer.emplace(std::move(tracer));
  const light::Lights lights_before = light::collect_lights(known.scene),
                      lights = light::collect_lights(out->scene);
  const SceneState before{known.scene, *known.tracer, lights_before},
      after{out->scene, *out->tracer, lights};
  const std::vector<uint32_t> body = bodies(known, changes.moved);
  const SpreadTexels spread({known.position, known.normal, body, known.texel_m2},
                            {std::sqrt(known.texel_m2), changes.boxes}, params.texels);
  LUXEL_TRY_STATUS(stopped(watched));
  LUXEL_TRY(const Estimates e, light_by_few_rays(known, before, after, spread, params, watched));
  const std::vector<uint8_t> estimated = spread_light(known, spread, e, changes.boxes, *out);
  LUXEL_TRY_STATUS(
      sharpen(known, after, to_sharpen(spread, estimated, params.sharp), params, *out));
  return out;
}

}  // namespace luxel::view
