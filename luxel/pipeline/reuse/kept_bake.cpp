#include "luxel/pipeline/reuse/kept_bake.h"

#include <algorithm>
#include <type_traits>

#include "luxel/base/bytes.h"
#include "luxel/base/check.h"
#include "luxel/base/digest.h"
#include "luxel/base/parallel.h"

namespace luxel::pipeline {
namespace {

/// Writes what `walk` below visits.
struct Saver {
  ByteWriter out;

  template <class T>
  void operator()(const std::vector<T>& values) {
    out.put_value(uint64_t(values.size()));
    if constexpr (std::is_trivially_copyable_v<T>)
      out.put(std::span<const T>(values));
    else
      for (const T& value : values) (*this)(value);
  }
  void operator()(const std::string& text) {
    out.put_value(uint64_t(text.size()));
    out.put(std::span(text.data(), text.size()));
  }
  template <class T>
  requires std::is_trivially_copyable_v<T>
  void operator()(const T& value) { out.put_value(value); }
  template <class T>
  requires(!std::is_trivially_copyable_v<T>) void operator()(const T& value) { walk(*this, value); }
};

/// Reads it back.
struct Loader {
  ByteReader in;

  /// Reads the number of values that follow, each of `bytes_each` bytes at least; 0 where there are
  /// fewer.
  size_t count(size_t bytes_each) {
    const uint64_t n = in.get_value<uint64_t>();
    in.ok = in.ok && n <= in.bytes.size() / bytes_each;
    return in.ok ? size_t(n) : 0;
  }
  template <class T>
  void operator()(std::vector<T>& values) {
    if constexpr (std::is_trivially_copyable_v<T>) {
      values.resize(count(sizeof(T)));
      in.get(std::span<T>(values));
    } else {
      values.resize(count(sizeof(uint64_t)));
      for (T& value : values) (*this)(value);
    }
  }
  void operator()(std::string& text) {
    text.resize(count(1));
    in.get(std::span(text.data(), text.size()));
  }
  template <class T>
  requires std::is_trivially_copyable_v<T>
  void operator()(T& value) { value = in.get_value<T>(); }
  void operator()(bool& value) {
    const auto byte = in.get_value<uint8_t>();
    in.ok = in.ok && byte <= 1, value = byte == 1;
  }
  template <class T>
  requires(!std::is_trivially_copyable_v<T>) void operator()(T& value) { walk(*this, value); }
};

// Each function names what of its struct is kept; `visit` is a Saver or a Loader, and structs are
// const for the first. Structs of numbers visit themselves.

template <class Struct, class Kind>
concept Like = std::is_same_v<std::remove_const_t<Struct>, Kind>;

template <class Visit>
void walk(Visit& visit, Like<scene::Mesh> auto& m) {
  auto& [name, positions, normals, uv0, uv1, colors, alphas, triangles, material, other_side] = m;
  visit(name), visit(positions), visit(normals), visit(uv0), visit(uv1), visit(colors);
  visit(alphas), visit(triangles), visit(material), visit(other_side);
}

template <class Visit>
void walk(Visit& visit, Like<scene::SceneState::Instance> auto& i) {
  auto& [name, mesh, world_from_object, bounds, density] = i;
  visit(name), visit(mesh), visit(world_from_object), visit(bounds), visit(density);
}

template <class Visit>
void walk(Visit& visit, Like<scene::SceneState::Material> auto& m) {
  auto& [name, shape, colour, emission_shape, emission] = m;
  visit(name), visit(shape), visit(colour), visit(emission_shape), visit(emission);
}

template <class Visit>
void walk(Visit& visit, Like<scene::SceneState::Light> auto& l) {
  auto& [name, shape, intensity] = l;
  visit(name), visit(shape), visit(intensity);
}

template <class Visit>
void walk(Visit& visit, Like<scene::SceneState> auto& s) {
  auto& [meshes, mesh_names, instances, materials, lights, surroundings, mesh_materials] = s;
  visit(meshes), visit(mesh_names), visit(instances), visit(materials), visit(lights);
  visit(surroundings), visit(mesh_materials);
}

template <class Visit>
void walk(Visit& visit, Like<atlas::Atlas> auto& a) {
  auto& [resolution, first_triangle, corners, chart, chart_count, kept, pages, page] = a;
  visit(resolution), visit(first_triangle), visit(corners), visit(chart), visit(chart_count);
  visit(kept), visit(pages), visit(page);
}

/// One by one: what lies in the gaps between them is anything.
template <class Visit>
void walk(Visit& visit, Like<atlas::AtlasStats> auto& s) {
  auto& [charts, utilisation, mean_stretch_l2, texels_per_metre, without_texel, owning] = s;
  visit(charts), visit(utilisation), visit(mean_stretch_l2), visit(texels_per_metre);
  visit(without_texel), visit(owning);
}

template <class Visit>
void walk(Visit& visit, Like<LeakRepair> auto& r) {
  auto& [cuts, parted, overlapping, moved, refilled] = r;
  visit(cuts), visit(parted), visit(overlapping), visit(moved), visit(refilled);
}

template <class Visit>
void walk(Visit& visit, Like<KeptLayout> auto& l) {
  auto& [meshes, one_sided_of, mesh_of_instance, atlas, texels, stats, repair, near_back_faces,
         wrong_in_uv1, warnings] = l;
  visit(meshes), visit(one_sided_of), visit(mesh_of_instance), visit(atlas), visit(texels);
  walk(visit, stats), visit(repair), visit(near_back_faces), visit(wrong_in_uv1), visit(warnings);
}

template <class Visit>
void walk(Visit& visit, Like<LayersOfLights> auto& l) {
  auto& [of_punctual, of_instance, of_surroundings] = l;
  visit(of_punctual), visit(of_instance), visit(of_surroundings);
}

template <class Visit>
void walk(Visit& visit, Like<light::DirectLevels> auto& l) {
  auto& [level, averaged] = l;
  visit(level), visit(averaged);
}

template <class Visit>
void walk(Visit& visit, Like<light::LightLayer> auto& l) {
  auto& [name, lights] = l;
  visit(name), visit(lights);
}

/// Visits the members that gather fills in, but for layers.
template <class Visit>
void walk(Visit& visit, Like<TexelLight> auto& l) {
  visit(l.irradiance), visit(l.variance), visit(l.direct), visit(l.direct_variance);
  visit(l.errors), visit(l.error_p95), visit(l.samples), visit(l.rays),
      visit(l.supersampled_texels), visit(l.sweeps);
  visit(l.relative_error), visit(l.hidden), visit(l.suspicious_texels);
}

/// Parts of about the same size, so that threads share them out well.
template <class Visit>
void walk_part(Visit& visit, size_t part, Like<KeptBake> auto& k) {
  auto& [scene, seconds, layout, places, layer_names, layers, direct, levels, light] = k;
  // Parts of about the same size, which are read and written one at a time.
  switch (part) {
    case 0:
      visit(scene), visit(seconds), visit(layer_names), visit(layers), visit(levels);
      break;
    case 1:
      visit(layout);
      break;
    case 2:
      visit(places), visit(direct.irradiance), visit(direct.variance);
      break;
    case 3:
      visit(direct.split_variance), visit(direct.by_layer), visit(direct.rays);
      break;
    case 4:
      visit(light);
      break;
    case 5:
      visit(light.layers), visit(light.layer_irradiance);
      break;
    default:
      LUXEL_CHECK(part < kKeptParts);
  }
}

/// Every list per element, light or instance has as many entries as there are of these.
bool is_sound(const KeptBake& k) {
  const size_t n = k.layout.texels.size(), layers = k.layer_names.size();
  const size_t instances = k.scene.instances.size(), lights = k.scene.lights.size();
  const TexelLight& l = k.light;
  for (const size_t size : {k.places.size(), k.direct.irradiance.size(), k.direct.variance.size(),
                            k.direct.split_variance.size(), k.levels.level.size(),
                            k.levels.averaged.size(), l.irradiance.size(), l.variance.size(),
                            l.direct.size(), l.direct_variance.size(), l.hidden.size()})
    if (size != n) return false;
  for (const auto& layer : l.layer_irradiance)
    if (layer.size() != n) return false;
  const bool told_apart = layers > 0;
  return k.layout.mesh_of_instance.size() == instances && l.layers.size() == layers &&
         l.layer_irradiance.size() == layers && k.direct.by_layer.size() == n * layers &&
         k.layers.of_punctual.size() == (told_apart ? lights : 0) &&
         k.layers.of_instance.size() == (told_apart ? instances : 0);
}

/// All numbers refer to things that exist, since nobody checks them again.
bool refers_to_itself(const KeptBake& k) {
  const auto is_layer = [&](uint8_t layer) { return layer < k.layer_names.size(); };
  const auto is_layer_or_none = [&](uint8_t layer) {
    return layer == LayersOfLights::kNoLayer || is_layer(layer);
  };
  const atlas::Atlas& atlas = k.layout.atlas;
  const auto is_texel = [&](const atlas::Texel& t) {
    return int64_t(t.x) < atlas.resolution && int64_t(t.y) < atlas.resolution &&
           t.sample.instance < k.layout.mesh_of_instance.size() &&
           t.triangle_number < atlas.corners.size();
  };
  return is_layer_or_none(k.layers.of_surroundings) &&
         std::ranges::all_of(k.layers.of_punctual, is_layer_or_none) &&
         std::ranges::all_of(
             k.layers.of_instance,
             [&](const std::vector<uint8_t>& of) { return std::ranges::all_of(of, is_layer); }) &&
         std::ranges::all_of(k.layout.mesh_of_instance,
                             [&](uint32_t mesh) { return mesh < k.layout.meshes.size(); }) &&
         std::ranges::all_of(k.layout.near_back_faces,
                             [&](uint32_t texel) { return texel < k.layout.texels.size(); }) &&
         std::ranges::all_of(k.layout.texels, is_texel);
}

}  // namespace

std::vector<uint64_t> places_of(const transport::Elements& elements) {
  std::vector<uint64_t> out(elements.size());
  parallel_for(out.size(), 4096, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      Digest digest;
      for (const Vec3& v : {elements.position[i], elements.normal[i], elements.geometric_normal[i]})
        digest.add(std::span<const Vec3>(&v, 1));
      out[i] = digest.value();
    }
  });
  return out;
}

LayersOfLights layers_of_lights(const scene::Scene& scene, const light::Lights& lights,
                                const light::LightLayers& layers) {
  LayersOfLights out;
  out.of_instance.resize(scene.instances.size());
  for (size_t k = 0; k < lights.triangles.size(); ++k) {
    std::vector<uint8_t>& of = out.of_instance[lights.triangles[k].instance];
    const auto at = std::ranges::lower_bound(of, layers.of_triangle[k]);
    if (at == of.end() || *at != layers.of_triangle[k]) of.insert(at, layers.of_triangle[k]);
  }
  for (size_t k = 0; k < lights.punctual.size(); ++k)
    out.of_punctual.push_back(max_component(lights.punctual[k].intensity) > 0
                                  ? layers.of_punctual[k]
                                  : LayersOfLights::kNoLayer);
  if (layers.of_surroundings) out.of_surroundings = *layers.of_surroundings;
  return out;
}

std::vector<std::byte> bytes_of(const KeptBake& kept, size_t part) {
  Saver save;
  walk_part(save, part, kept);
  return std::move(save.out.bytes);
}

bool read_part(std::span<const std::byte> bytes, size_t part, KeptBake& kept) {
  Loader load{{bytes}};
  walk_part(load, part, kept);
  return load.in.ended_well();
}

bool is_whole(const KeptBake& kept) { return is_sound(kept) && refers_to_itself(kept); }

}  // namespace luxel::pipeline
