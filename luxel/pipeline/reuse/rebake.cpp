#include "luxel/pipeline/reuse/rebake.h"

#include <algorithm>

#include "luxel/base/free_memory.h"
#include "luxel/base/parallel.h"

namespace luxel::pipeline {
namespace {

constexpr uint8_t kNoLayer = LayersOfLights::kNoLayer;
const Rgb kAsBefore{1, 1, 1};

/// Equal up to the rounding of what lights dimmed alike were and are.
bool nearly_equal(Rgb a, Rgb b) {
  const float difference = max_component(max(a - b, b - a));
  return difference <= 1e-5f * max_component(max(a, b));
}

/// A light that was weaker than this beside what it is now was sampled too roughly: few shadow
/// rays, and no points across texels where nobody saw its shadows.
constexpr float kMostBrighter = 4;

/// Puts the scales of a layer's lights together.
struct Scales {
  std::vector<std::optional<Rgb>> scale;
  std::vector<uint8_t> known;  ///< some light of the layer has been seen

  explicit Scales(size_t layers) : scale(layers, kAsBefore), known(layers) {}
  void add(uint8_t layer, const std::optional<Rgb>& light) {
    std::optional<Rgb>& all = scale[layer];
    if (!known[layer])
      all = light;
    else if (!light || !all || !nearly_equal(*light, *all))
      all.reset();
    known[layer] = 1;
  }
};

bool emits(Rgb emission) { return max_component(emission) > 0; }

/// The factor on an instance's emission, per channel; nothing: no single factor says the change.
std::optional<Rgb> scale_of_instance(const KeptBake& kept, const scene::SceneChange& change,
                                     const scene::Scene& scene, uint32_t instance) {
  if (std::ranges::find(change.moved, instance) != change.moved.end()) return std::nullopt;
  Scales all(1);
  for (const uint32_t m : kept.scene.mesh_materials[kept.scene.instances[instance].mesh])
    if (emits(kept.scene.materials[m].emission) || emits(scene.materials[m].emission))
      all.add(0, change.emission_scale[m]);
  return all.scale[0];
}

/// Multiplies layers' light, adds it up, and scales variances as its luminance has changed.
void rescale(std::span<const std::optional<Rgb>> scale, light::DirectLight& direct) {
  const size_t layers = scale.size();
  parallel_for(direct.irradiance.size(), 4096, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      Rgb sum{};
      for (size_t l = 0; l < layers; ++l) {
        Rgb& e = direct.by_layer[i * layers + l];
        e = e * scale[l].value_or(Rgb{});
        sum += e;
      }
      const float before = luminance(direct.irradiance[i]);
      const float ratio = before > 0 ? luminance(sum) / before : 1;
      direct.irradiance[i] = sum;
      direct.variance[i] *= ratio * ratio, direct.split_variance[i] *= ratio * ratio;
    }
  });
}

bool as_before(std::span<const std::optional<Rgb>> scale) {
  return std::ranges::all_of(scale,
                             [](const std::optional<Rgb>& s) { return s && *s == kAsBefore; });
}

std::vector<Box3> with_margin(std::vector<Box3> boxes, float margin_m) {
  for (Box3& box : boxes) {
    box.lower = box.lower - Vec3{margin_m, margin_m, margin_m};
    box.upper = box.upper + Vec3{margin_m, margin_m, margin_m};
  }
  return boxes;
}

std::vector<uint8_t> moved_elements(std::span<const uint64_t> before,
                                    const transport::Elements& elements) {
  const std::vector<uint64_t> now = places_of(elements);
  std::vector<uint8_t> out(now.size());
  for (size_t i = 0; i < now.size(); ++i) out[i] = now[i] != before[i];
  return out;
}

light::Lights only(const light::Lights& lights, std::span<const uint32_t> punctual) {
  scene::Scene scene;
  scene.profiles = lights.profiles;
  for (const uint32_t k : punctual) scene.lights.push_back(lights.punctual[k]);
  return light::collect_lights(scene);
}

}  // namespace

LightUpdate light_update(const KeptBake& kept, const scene::SceneChange& change,
                         const scene::Scene& scene) {
  const size_t layers = kept.layer_names.size();
  LightUpdate out;
  const auto differs = [](const std::optional<Rgb>& s) { return !s || !(*s == kAsBefore); };
  if (layers == 0) {
    out.surfaces_changed = std::ranges::any_of(change.light_scale, differs) ||
                           std::ranges::any_of(change.emission_scale, differs) ||
                           change.surroundings || !change.moved.empty();
    return out;
  }
  Scales all(layers);
  std::vector<uint8_t> has_surface(layers);
  for (uint32_t k = 0; k < change.light_scale.size(); ++k) {
    const uint8_t layer = kept.layers.of_punctual[k];
    if (layer != kNoLayer)
      all.add(layer, change.light_scale[k]);
    else if (differs(change.light_scale[k]))
      out.changed_punctual.push_back(k);
  }
  for (uint32_t i = 0; i < scene.instances.size(); ++i) {
    const std::vector<uint8_t>& of = kept.layers.of_instance[i];
    const std::optional<Rgb> scale = scale_of_instance(kept, change, scene, i);
    for (const uint8_t layer : of) all.add(layer, scale), has_surface[layer] = 1;
    if (of.empty() && !scale && std::ranges::find(change.moved, i) == change.moved.end())
      out.surfaces_changed = true;
  }
  if (change.surroundings) out.surfaces_changed = true;
  out.scale = std::move(all.scale);
  for (std::optional<Rgb>& scale : out.scale)
    if (scale && max_component(*scale) > kMostBrighter) scale.reset();
  for (size_t l = 0; l < layers; ++l)
    if (!out.scale[l] && has_surface[l]) out.surfaces_changed = true;
  for (uint32_t k = 0; k < kept.layers.of_punctual.size(); ++k)
    if (const uint8_t l = kept.layers.of_punctual[k]; l != kNoLayer && !out.scale[l])
      out.changed_punctual.push_back(k);
  return out;
}

bool is_sum_of_layers(const LightUpdate& update, const scene::SceneChange& change) {
  return change.moved.empty() && change.boxes.empty() && change.recoloured.empty() &&
         !change.surroundings && !update.surfaces_changed && update.changed_punctual.empty() &&
         std::ranges::all_of(update.scale, [](const auto& s) { return s.has_value(); });
}

TexelLight sum_of_layers(KeptBake& kept, const LightUpdate& update) {
  TexelLight out = std::move(kept.light);
  out.rays_kept = out.rays, out.rays = 0, out.sweeps = 0;
  if (as_before(update.scale)) return out;
  rescale(update.scale, kept.direct);
  out.direct = std::move(kept.direct.irradiance);
  out.direct_variance = std::move(kept.direct.variance);
  parallel_for(out.irradiance.size(), 4096, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      Rgb sum{};
      for (size_t l = 0; l < update.scale.size(); ++l) {
        Rgb& e = out.layer_irradiance[l][i];
        e = e * *update.scale[l];
        sum += e;
      }
      const float before = luminance(out.irradiance[i]);
      const float ratio = before > 0 ? luminance(sum) / before : 1;
      out.irradiance[i] = sum, out.variance[i] *= ratio * ratio;
    }
  });
  return out;
}

std::optional<gather::Earlier> earlier_of(KeptBake& kept, const RecordFile& rays,
                                          const LightUpdate& update,
                                          const scene::SceneChange& change,
                                          const light::TexelScene& in,
                                          const light::LightLayers* layers) {
  const size_t n = in.elements.size();
  auto rounds = gather::earlier_rounds(rays, n);
  if (!rounds || kept.places.size() != n) return std::nullopt;
  gather::Earlier out;
  out.rounds = std::move(*rounds);
  // The rounding of float positions in a scene of this size.
  const float margin_m = 1e-4f * scene::world_bounds(in.scene).diagonal();
  // Surroundings, or surfaces that rays pass on their way out, may have had another colour.
  const bool seen_otherwise = change.surroundings || !change.reshaped.empty();
  out.rays.file = &rays;
  out.rays.boxes = with_margin(change.boxes, margin_m);
  out.rays.moved = moved_elements(kept.places, in.elements);
  out.rays.surroundings = seen_otherwise;
  out.rays.same_light = !update.surfaces_changed && update.changed_punctual.empty() &&
                        as_before(update.scale) && change.recoloured.empty() && !seen_otherwise;
  out.irradiance = std::move(kept.light.irradiance);
  out.relative_error = kept.light.relative_error;
  if (!update.scale.empty()) {
    std::ranges::fill(out.irradiance, Rgb{});
    for (size_t l = 0; l < update.scale.size(); ++l)
      for (size_t i = 0; i < n; ++i)
        out.irradiance[i] +=
            kept.light.layer_irradiance[l][i] * update.scale[l].value_or(kAsBefore);
  }
  const bool same_layers =
      !layers || (update.changed_punctual.empty() &&
                  layers_of_lights(in.scene, in.lights, *layers) == kept.layers);
  if (update.surfaces_changed || !same_layers) return out;
  out.direct = std::move(kept.direct), out.levels = std::move(kept.levels);
  if (!as_before(update.scale)) rescale(update.scale, out.direct);
  if (!layers) free_memory(out.direct.by_layer);
  out.changed_lights = only(in.lights, update.changed_punctual);
  return out;
}

}  // namespace luxel::pipeline
