#include "luxel/light/light_layers.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "luxel/base/check.h"

namespace luxel::light {
namespace {

/// Characters: file names may have 255 in most systems, and get words before and after.
constexpr size_t kLongestName = 64;

bool is_digit(char c) { return c >= '0' && c <= '9'; }

bool is_safe(char c) {
  return is_digit(c) || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '.' || c == '_' ||
         c == '-';
}

/// The name in a form that files can have on every system: cut, and with '_' for other characters.
std::string safe_name(std::string_view name) {
  std::string out(name.substr(0, kLongestName));
  for (char& c : out)
    if (!is_safe(c)) c = '_';
  return out;
}

/// Some systems take "Lamp" and "lamp" for one file.
std::string lower_case(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
  return text;
}

void make_names_unique(std::vector<LightLayer>& layers) {
  std::set<std::string> taken;
  for (LightLayer& layer : layers) {
    const std::string wanted = layer.name;
    for (int k = 2; !taken.insert(lower_case(layer.name)).second; ++k)
      layer.name = fmt::format("{}-{}", wanted, k);
  }
}

/// Layers under construction. Lights of one key share a layer.
struct Book {
  LightLayers out;
  std::map<std::string, size_t> known;

  size_t layer_of(const std::string& key, std::string_view name, const std::string& light) {
    const auto [at, is_new] = known.try_emplace(key, out.layers.size());
    if (is_new) out.layers.push_back({safe_name(name), {}});
    std::vector<std::string>& lights = out.layers[at->second].lights;
    if (std::ranges::find(lights, light) == lights.end()) lights.push_back(light);
    return at->second;
  }
};

std::string name_or_number(const std::string& name, size_t index) {
  return name.empty() ? fmt::format("light {}", index + 1) : name;
}

void add_punctual(const Lights& lights, LayerMode mode, Book& book,
                  std::vector<size_t>& of_punctual) {
  for (size_t i = 0; i < lights.punctual.size(); ++i) {
    const scene::PunctualLight& light = lights.punctual[i];
    of_punctual.push_back(0);
    if (max_component(light.intensity) <= 0) continue;
    const std::string name = name_or_number(light.name, i);
    of_punctual.back() = mode == LayerMode::groups
                             ? book.layer_of(fmt::format("group {}", without_number(name)),
                                             without_number(name), name)
                             : book.layer_of(fmt::format("lamp {}", i), name, name);
  }
}

/// In the order of instances: the triangles themselves lie in that of their hierarchy.
void add_triangles(const scene::Scene& scene, const Lights& lights, LayerMode mode, Book& book,
                   std::vector<size_t>& of_triangle) {
  std::vector<uint32_t> order(lights.triangles.size());
  for (uint32_t k = 0; k < order.size(); ++k) order[k] = k;
  std::ranges::sort(order, {}, [&](uint32_t k) {
    const TriangleLight& light = lights.triangles[k];
    return std::pair(light.instance, light.triangle);
  });
  of_triangle.resize(order.size());
  for (const uint32_t k : order) {
    const TriangleLight& light = lights.triangles[k];
    const std::string instance =
        name_or_number(scene.instances[light.instance].name, light.instance);
    const scene::Material& material =
        scene::material_at(scene, {light.instance, light.triangle, {}});
    const std::string_view shared =
        without_number(material.name.empty() ? instance : material.name);
    of_triangle[k] =
        mode == LayerMode::groups
            ? book.layer_of(fmt::format("group {}", shared), shared, instance)
            : book.layer_of(fmt::format("instance {}", light.instance), instance, instance);
  }
}

std::vector<uint8_t> as_bytes(const std::vector<size_t>& layers) {
  return {layers.begin(), layers.end()};
}

struct Found {
  Book book;
  std::vector<size_t> of_triangle, of_punctual;
  std::optional<size_t> of_surroundings;
};

Found find_layers(const scene::Scene& scene, const Lights& lights, LayerMode mode) {
  Found found;
  add_punctual(lights, mode, found.book, found.of_punctual);
  add_triangles(scene, lights, mode, found.book, found.of_triangle);
  if (max_component(scene.background) > 0 || !scene.environment.empty())
    found.of_surroundings = found.book.layer_of("surroundings", "sky", "sky");
  return found;
}

}  // namespace

std::string_view without_number(std::string_view name) {
  size_t end = name.size();
  while (end > 0 && is_digit(name[end - 1])) --end;
  if (end == name.size()) return name;
  while (end > 0 && (name[end - 1] == '.' || name[end - 1] == '_' || name[end - 1] == '-' ||
                     name[end - 1] == ' '))
    --end;
  return end == 0 ? name : name.substr(0, end);
}

Rgb share_out(Rgb whole, std::span<Rgb> by_layer) {
  Rgb sum{};
  for (const Rgb& e : by_layer) sum += e;
  // A sum of next to nothing says nothing about shares, and the quotient might not be finite.
  const auto factor = [](float all, float found) {
    return found > 1e-6f * all ? all / found : 1.0f;
  };
  const Rgb share{factor(whole.x, sum.x), factor(whole.y, sum.y), factor(whole.z, sum.z)};
  for (Rgb& e : by_layer) e = e * share;
  return whole - sum;
}

Result<LightLayers> light_layers(const scene::Scene& scene, const Lights& lights, LayerMode mode) {
  LUXEL_CHECK(mode != LayerMode::none);
  Found found = find_layers(scene, lights, mode);
  LightLayers out = std::move(found.book.out);
  if (out.size() > kMaxLayers) {
    const bool each = mode == LayerMode::per_light;
    return fail(ErrorCode::bad_setting,
                "--layers {} makes {} layers of this scene's lights, more than the {} that a bake "
                "can have; {}",
                each ? "per-light" : "groups", out.size(), kMaxLayers,
                each ? fmt::format("--layers groups makes {}",
                                   find_layers(scene, lights, LayerMode::groups).book.out.size())
                     : "give lights that belong together one name");
  }
  make_names_unique(out.layers);
  out.of_triangle = as_bytes(found.of_triangle), out.of_punctual = as_bytes(found.of_punctual);
  if (found.of_surroundings) out.of_surroundings = uint8_t(*found.of_surroundings);
  return out;
}

}  // namespace luxel::light
