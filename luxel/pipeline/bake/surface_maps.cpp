#include "luxel/pipeline/bake/surface_maps.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "luxel/image/codec.h"
#include "luxel/light/visibility.h"
#include "luxel/pipeline/settings/comma_list.h"
#include "luxel/post/dilate.h"
#include "luxel/scene/light_kinds.h"

namespace luxel::pipeline {
namespace {

/// Rays of a texel that ask for what is near.
constexpr int kOcclusionRays = 256;

/// A light without a name is called by its number in the file.
std::string mask_name(const scene::Scene& scene, size_t light) {
  const std::string& name = scene.lights[light].name;
  return name.empty() ? fmt::format("light_{}", light) : name;
}

std::string all_names(const scene::Scene& scene) {
  std::string out;
  for (size_t i = 0; i < scene.lights.size(); ++i)
    out += (i == 0 ? "" : ", ") + mask_name(scene, i);
  return out;
}

/// A channel that no light has is 1: nothing stands before it.
Result<SurfaceMap> shadow_mask(const BakeSettings& settings, const light::TexelScene& in,
                               std::span<const uint32_t> masked, std::span<const uint8_t> hidden,
                               Progress& progress) {
  SurfaceMap out{.name = "shadow-mask", .channels = 4};
  out.lights.assign(masked.begin(), masked.end());
  const std::vector<Rgb> lit(in.map.texels.size(), Rgb{1, 1, 1});
  out.values.assign(masked.size() > 3 ? 2 : 1, lit);
  for (size_t c = 0; c < masked.size(); ++c) {
    LUXEL_TRY(const std::vector<float> share,
              light::visible_share(in, hidden, in.scene.lights[masked[c]],
                                   {.seed = hash64(settings.seed, c)}, progress));
    for (size_t i = 0; i < share.size(); ++i) {
      Rgb& values = out.values[c / 3][i];
      (c % 3 == 0 ? values.x : c % 3 == 1 ? values.y : values.z) = share[i];
    }
  }
  return out;
}

Result<SurfaceMap> ambient_occlusion(const BakeSettings& settings, const light::TexelScene& in,
                                     std::span<const uint8_t> hidden, Progress& progress) {
  SurfaceMap out{.name = "ambient-occlusion", .channels = 1};
  LUXEL_TRY(const std::vector<float> share,
            light::open_share(in, hidden,
                              {.distance_m = float(settings.occlusion_distance_m),
                               .rays = kOcclusionRays,
                               .seed = settings.seed},
                              progress));
  out.values.emplace_back();
  for (const float s : share) out.values[0].push_back({s, s, s});
  return out;
}

image::Image8 linear_bytes(const image::Image& image) {
  image::Image8 out{image.width, image.height, image.channels, {}};
  for (const float v : image.data)
    out.data.push_back(uint8_t(std::clamp(v, 0.0f, 1.0f) * 255 + 0.5f));
  return out;
}

}  // namespace

Result<std::vector<uint32_t>> masked_lights(const BakeSettings& settings,
                                            const scene::Scene& scene) {
  std::vector<uint32_t> out;
  if (settings.shadow_mask.empty()) return out;
  if (scene.lights.empty())
    return fail(ErrorCode::bad_setting,
                "--shadow-mask {}: the scene has no point, spot or directional light",
                settings.shadow_mask);
  if (settings.shadow_mask == "auto") {
    for (uint32_t i = 0; i < std::min(scene.lights.size(), kMaxMaskedLights); ++i) out.push_back(i);
    return out;
  }
  for (const std::string_view name : split_at_commas(settings.shadow_mask)) {
    uint32_t i = 0;
    while (i < scene.lights.size() && mask_name(scene, i) != name) ++i;
    if (i == scene.lights.size())
      return fail(
          ErrorCode::bad_setting,
          "--shadow-mask {}: there is no point, spot or directional light '{}'; choose from: {}",
          settings.shadow_mask, name, all_names(scene));
    out.push_back(i);
  }
  return out;
}

Result<std::vector<SurfaceMap>> surface_maps(const BakeSettings& settings,
                                             const light::TexelScene& in,
                                             std::span<const uint32_t> masked,
                                             std::span<const uint8_t> hidden, Progress& progress) {
  std::vector<SurfaceMap> out;
  if (!masked.empty()) {
    LUXEL_TRY(SurfaceMap mask, shadow_mask(settings, in, masked, hidden, progress));
    out.push_back(std::move(mask));
  }
  if (settings.occlusion_distance_m > 0) {
    LUXEL_TRY(SurfaceMap occlusion, ambient_occlusion(settings, in, hidden, progress));
    out.push_back(std::move(occlusion));
  }
  return out;
}

void make_pages(const atlas::Atlas& atlas, const atlas::TexelMap& map, int rings, SurfaceMap& out) {
  for (size_t k = 0; k < out.values.size(); ++k) {
    const std::vector<image::Image> pages = [&] {
      std::vector<image::Image> dilated = post::lightmap_pages(atlas, map, out.values[k]);
      for (image::Image& page : dilated) post::dilate(page, rings);
      return dilated;
    }();
    for (size_t p = 0; p < pages.size(); ++p) {
      if (k == 0) {
        out.pages.emplace_back(pages[p].width, pages[p].height, int(out.channels));
        std::ranges::fill(out.pages[p].data, 1.0f);
      }
      for (size_t i = 0; i < pages[p].data.size() / 4; ++i)
        for (size_t c = 3 * k; c < std::min(out.channels, 3 * k + 3); ++c)
          if (pages[p].data[4 * i + 3] > 0)
            out.pages[p].data[out.channels * i + c] =
                std::clamp(pages[p].data[4 * i + c - 3 * k], 0.0f, 1.0f);
    }
  }
}

Result<std::vector<OutputFile>> surface_map_files(std::span<const SurfaceMap> maps,
                                                  const BakeSettings& settings,
                                                  const scene::Scene& scene, nlohmann::json& json) {
  std::vector<OutputFile> out;
  for (const SurfaceMap& map : maps) {
    nlohmann::json about = nlohmann::json::object();
    for (size_t p = 0; p < map.pages.size(); ++p) {
      const std::string name = map.pages.size() == 1 ? map.name : fmt::format("{}-{}", map.name, p);
      LUXEL_TRY(std::vector<std::byte> exr, image::encode_exr(map.pages[p]));
      out.push_back({settings.output / (name + ".exr"), std::move(exr)});
      out.push_back(
          {settings.output / (name + ".png"), image::encode_png(linear_bytes(map.pages[p]))});
      about["files"].push_back(name + ".exr"), about["files"].push_back(name + ".png");
    }
    for (size_t c = 0; c < map.lights.size(); ++c)
      about["channels"].push_back({{"channel", std::string(1, "RGBA"[c])},
                                   {"light", mask_name(scene, map.lights[c])},
                                   {"kind", scene::name_of(scene.lights[map.lights[c]].kind)}});
    json[map.name == "shadow-mask" ? "shadow_mask" : "ambient_occlusion"] = std::move(about);
  }
  return out;
}

}  // namespace luxel::pipeline
