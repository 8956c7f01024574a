#include "luxel/pipeline/bake/lit_pictures.h"

#include <algorithm>
#include <cmath>

#include "luxel/atlas/pages.h"
#include "luxel/base/parallel.h"
#include "luxel/base/process_memory.h"
#include "luxel/display/draw.h"
#include "luxel/display/tone_map.h"
#include "luxel/image/white_level.h"
#include "luxel/post/dilate.h"
#include "luxel/transport/irradiance_field.h"

namespace luxel::pipeline {
namespace {

/// Points along a pixel's side where a texture is averaged.
constexpr int kPointsAcross = 4;
/// The part of the textured area whose textures keep their pixels.
constexpr double kSharpPart = 0.9;
/// Memory of a pixel while its picture is made: texel and number in the map, colour and alpha of
/// the texel, four floats of each in the page, and the 8-bit picture.
constexpr uint64_t kBytesPerPixel = 24 + 4 + 24 + 32 + 8;

/// Pixels of a texture per texel of the lightmap, along a side; 0 where there is none.
double fineness(const scene::Scene& scene, const scene::Mesh& mesh, uint32_t triangle,
                const scene::TextureRef& ref, double texels) {
  const std::vector<Vec2>& uv = ref.uv_set == 1 ? mesh.uv1 : mesh.uv0;
  if (ref.texture == scene::kNone || uv.empty() || !(texels > 0)) return 0;
  const scene::Texture& texture = scene.textures[ref.texture];
  const auto& t = mesh.triangles[triangle];
  const auto at = [&](size_t c) { return scene::transformed_uv(ref, uv[t[c]]); };
  const Vec2 a = at(0);
  const double area = 0.5 * std::abs(double(cross(at(1) - a, at(2) - a)));
  return std::sqrt(area * texture.width * texture.height / texels);
}

double fineness(const scene::Scene& scene, const atlas::Atlas& atlas, uint32_t instance,
                uint32_t triangle) {
  const scene::Mesh& mesh = scene.meshes[scene.instances[instance].mesh];
  const scene::Material& m = scene.materials[mesh.triangle_material[triangle]];
  if (m.unlit) return 0;
  const auto& c = atlas.corners[atlas.triangle_number(instance, triangle)];
  const double texels = 0.5 * std::abs(double(cross(c[1] - c[0], c[2] - c[0])));
  double finest = fineness(scene, mesh, triangle, m.base_color_texture, texels);
  if (max_component(m.emission) > 0)
    finest = std::max(finest, fineness(scene, mesh, triangle, m.emission_texture, texels));
  return finest;
}

atlas::Atlas magnified(const atlas::Atlas& atlas, int scale) {
  atlas::Atlas out = atlas;
  out.resolution *= scale;
  for (auto& triangle : out.corners)
    for (Vec2& corner : triangle) corner = corner * float(scale);
  for (atlas::Page& page : out.pages) page.x *= scale, page.y *= scale, page.side *= scale;
  return out;
}

/// Light and opacity seen at a surface point.
struct Seen {
  Rgb radiance{};
  float alpha = 1;
};

Seen seen_at(const Bake& bake, const scene::SurfacePoint& p) {
  const transport::TexelField field{&bake.atlas, &bake.map, bake.light.irradiance};
  const auto irradiance = [&](const scene::SurfacePoint& q) {
    return transport::irradiance_at(field, q);
  };
  const scene::Material& m = scene::material_at(bake.scene, p);
  const float alpha = m.alpha_mode == scene::AlphaMode::mask
                          ? scene::base_color_at(bake.scene, p)[3]
                          : scene::passage_at(bake.scene, p).coverage;
  return {display::seen_radiance(bake.scene, p, irradiance), alpha};
}

/// A point of a triangle's plane, moved into the triangle.
Barycentric inside(Barycentric b) {
  const float u = std::max(b.u, 0.0f), v = std::max(b.v, 0.0f);
  const float sum = std::max(u + v, 1.0f);
  return {u / sum, v / sum};
}

/// The mean over a pixel, where textures vary within.
Seen seen_in_pixel(const Bake& bake, const atlas::Atlas& atlas, const atlas::Texel& pixel) {
  const auto& corners = atlas.corners[pixel.triangle_number];
  if (fineness(bake.scene, atlas, pixel.sample.instance, pixel.sample.triangle) == 0)
    return seen_at(bake, pixel.sample);
  Seen mean{{}, 0};
  scene::SurfacePoint p = pixel.sample;
  for (int i = 0; i < kPointsAcross * kPointsAcross; ++i) {
    const Vec2 at{float(pixel.x) + (float(i % kPointsAcross) + 0.5f) / kPointsAcross,
                  float(pixel.y) + (float(i / kPointsAcross) + 0.5f) / kPointsAcross};
    p.at = inside(atlas::barycentric_in(corners, at));
    const Seen seen = seen_at(bake, p);
    mean.radiance += seen.radiance / float(kPointsAcross * kPointsAcross);
    mean.alpha += seen.alpha / float(kPointsAcross * kPointsAcross);
  }
  return mean;
}

/// The largest side that memory allows, too.
int largest_side(const BakeSettings& settings, const atlas::Atlas& atlas) {
  const uint64_t held = resident_bytes();
  const uint64_t free = settings.max_memory_bytes > held ? settings.max_memory_bytes - held
                        : settings.max_memory_bytes > 0  ? 0
                                                         : available_bytes() / 5 * 4;
  int side = 0;
  for (const atlas::Page& page : atlas::pages_of(atlas)) side = std::max(side, page.side);
  const double scale =
      std::sqrt(double(free) / double(kBytesPerPixel)) / double(std::max(atlas.resolution, 1));
  return std::min(kLargestPicture, int(scale * side));
}

bool has_alpha(const scene::Scene& scene) {
  return std::ranges::any_of(scene.materials, [](const scene::Material& m) {
    return !m.unlit && (m.alpha_mode != scene::AlphaMode::opaque || m.transmission > 0);
  });
}

/// The pictures of pages in linear light; their fourth channel is alpha.
std::vector<image::Image> pages_of_seen(const atlas::Atlas& atlas, const atlas::TexelMap& map,
                                        const std::vector<Rgb>& radiance,
                                        const std::vector<Rgb>& alpha, int rings) {
  std::vector<image::Image> pages = post::lightmap_pages(atlas, map, radiance);
  std::vector<image::Image> alphas;
  if (!alpha.empty()) alphas = post::lightmap_pages(atlas, map, alpha);
  parallel_for(pages.size(), 1, [&](size_t p, size_t) {
    post::dilate(pages[p], rings);
    if (!alphas.empty()) post::dilate(alphas[p], rings);
    for (size_t i = 3; i < pages[p].data.size(); i += 4)
      pages[p].data[i] = alphas.empty() ? 1.0f : alphas[p].data[i - 3];
  });
  return pages;
}

/// 8 bits of `picture`, of which `channels` stay.
image::Image8 encoded(const image::Image& picture, export_::Attach attach, float factor,
                      int channels) {
  image::Image out(picture.width, picture.height, channels);
  parallel_for(size_t(picture.height), 16, [&](size_t begin, size_t end) {
    for (int y = int(begin); y < int(end); ++y)
      for (int x = 0; x < picture.width; ++x) {
        const Rgb exposed = picture.rgb(x, y) * factor;
        out.set_rgb(x, y,
                    attach == export_::Attach::combined ? display::compress(exposed) : exposed);
        if (channels == 4) out.at(x, y)[3] = picture.at(x, y)[3];
      }
  });
  return image::to_srgb8(out);
}

}  // namespace

int picture_scale(const scene::Scene& scene, const atlas::Atlas& atlas, int largest) {
  std::vector<std::pair<double, double>> parts;  // fineness and area
  double whole = 0;
  for (uint32_t i = 0; i < scene.instances.size(); ++i)
    for (uint32_t n = atlas.first_triangle[i]; n < atlas.first_triangle[i + 1]; ++n) {
      const uint32_t t = n - atlas.first_triangle[i];
      const double fine = fineness(scene, atlas, i, t);
      if (fine == 0) continue;
      parts.emplace_back(fine, double(scene::area_m2(scene::world_triangle(scene, i, t))));
      whole += parts.back().second;
    }
  std::ranges::sort(parts);
  double wanted = 1, below = 0;
  for (const auto& [fine, area] : parts) {
    if (below >= kSharpPart * whole) break;
    below += area, wanted = fine;
  }
  int side = 1, scale = 1;
  for (const atlas::Page& page : atlas::pages_of(atlas)) side = std::max(side, page.side);
  while (scale < wanted && 2 * scale * side <= largest &&
         2 * scale * atlas.resolution <= atlas::kMaxMapSide)
    scale *= 2;
  return scale;
}

Result<export_::LitPictures> lit_pictures(const BakeSettings& settings, const Bake& bake,
                                          Progress& progress) {
  const int scale = picture_scale(bake.scene, bake.atlas, largest_side(settings, bake.atlas));
  const atlas::Atlas atlas = magnified(bake.atlas, scale);
  const atlas::TexelMap map =
      scale == 1 ? atlas::map_of(atlas, bake.map.texels) : atlas::rasterise(bake.scene, atlas);
  std::vector<Rgb> radiance(map.texels.size());
  std::vector<Rgb> alpha(has_alpha(bake.scene) ? radiance.size() : 0);
  parallel_for(radiance.size(), 256, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end && !progress.cancelled(); ++i) {
      const Seen seen = seen_in_pixel(bake, atlas, map.texels[i]);
      radiance[i] = seen.radiance;
      if (!alpha.empty()) alpha[i] = {seen.alpha, seen.alpha, seen.alpha};
    }
  });
  LUXEL_TRY_STATUS(stopped(progress));
  const std::vector<image::Image> pages =
      pages_of_seen(atlas, map, radiance, alpha, post::kDilationRings * scale);
  export_::LitPictures out;
  out.attach = settings.attach, out.scale = scale, out.exposure = bake.view.exposure;
  const bool combined = settings.attach == export_::Attach::combined;
  if (!combined)
    out.strength = std::clamp(out.exposure * image::white_level(radiance), 1.0f, kMostStrength);
  for (const image::Image& page : pages)
    out.pages.push_back(encoded(page, settings.attach, out.exposure / out.strength,
                                combined && !alpha.empty() ? 4 : 3));
  return out;
}

}  // namespace luxel::pipeline
