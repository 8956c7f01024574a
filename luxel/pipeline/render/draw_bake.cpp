#include "luxel/pipeline/render/draw_bake.h"

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <span>

#include "luxel/base/check.h"
#include "luxel/base/file.h"
#include "luxel/display/draw.h"
#include "luxel/display/lightmap_lookup.h"
#include "luxel/display/smooth_lookup.h"
#include "luxel/image/codec.h"
#include "luxel/image/color.h"
#include "luxel/image/value_scale.h"
#include "luxel/pipeline/bake/bake_scene.h"
#include "luxel/pipeline/bake/baked_folder.h"
#include "luxel/scene/normal_map.h"

namespace luxel::pipeline {
namespace {

/// Settings of the small bake that is made where none is given. It takes seconds, not minutes.
constexpr int kQuickResolution = 256, kQuickSamples = 64, kQuickDirectSamples = 16;

display::DrawParams size_of(const RenderSettings& settings) {
  display::DrawParams params;
  params.width = settings.width, params.height = settings.height;
  return params;
}

/// baked.glb with the surroundings of what is drawn.
Result<scene::Scene> baked_scene(const Subject& subject, const RenderSettings& s) {
  LUXEL_TRY(scene::Scene baked, scene_of_bake(s.from, subject.scene.origin));
  baked.background = subject.scene.background;
  baked.environment = subject.scene.environment;
  return baked;
}

/// Beside each lightmap, what --directional left: one picture per page, `direction`, or three, `x`,
/// `y` and `z`; none when there are none.
Result<std::vector<LightmapPages>> read_directions(const std::filesystem::path& folder,
                                                   size_t materials) {
  const auto is_there = [&](const char* kind) {
    return std::filesystem::exists(folder / fmt::format("lightmap.{}.exr", kind)) ||
           std::filesystem::exists(folder / fmt::format("lightmap-0.{}.exr", kind));
  };
  std::vector<std::string> kinds;
  if (is_there("direction")) kinds = {"direction"};
  if (is_there("x")) kinds = {"x", "y", "z"};
  std::vector<LightmapPages> out;
  for (const std::string& kind : kinds) {
    LUXEL_TRY(LightmapPages pages,
              read_pages(folder, materials, [&](const std::filesystem::path& lightmap) {
                return read_lightmap(lightmap.parent_path() /
                                     (lightmap.stem().string() + "." + kind + ".exr"));
              }));
    out.push_back(std::move(pages));
  }
  return out;
}

/// E of a bent normal, `bend` away from the surface's own: docs/method/directional.md.
Rgb irradiance_of_bent(const scene::Scene& scene, std::span<const LightmapPages> directions,
                       const scene::SurfacePoint& p, Vec3 bend, Rgb e) {
  const auto read = [&](size_t k) {
    return display::lightmap_at(scene, directions[k].of(scene, p), p);
  };
  if (directions.size() == 1) return e * std::max(0.0f, 1 + dot(bend, read(0)));
  return max(Rgb{}, e + read(0) * bend.x + read(1) * bend.y + read(2) * bend.z);
}

/// A picture of each texel's own, beside the lightmap.
struct TexelKind {
  const char* name;    ///< texels.png beside lightmap.exr, texels-1.png beside lightmap-1.exr
  const char* option;  ///< of bake, that leaves it
  bool BakeSettings::*wanted;
  std::vector<image::Image8> Bake::*pictures;
};
constexpr TexelKind kTexels{"texels", "--texels", &BakeSettings::texels, &Bake::texel_pictures};
constexpr TexelKind kErrors{"error", "--error-map", &BakeSettings::error_map,
                            &Bake::error_pictures};

Result<image::Image> read_texel_picture(const std::filesystem::path& lightmap, TexelKind kind) {
  constexpr std::string_view kLightmap = "lightmap";
  const std::string number = lightmap.stem().string().substr(kLightmap.size());
  const std::filesystem::path file = lightmap.parent_path() / (kind.name + number + ".png");
  const Result<std::vector<std::byte>> bytes = read_file(file);
  if (!bytes)
    return fail(bytes.error().code, "{}; bake with {}, or draw without --from",
                bytes.error().message, kind.option);
  return image::decode_display(*bytes, file.string());
}

/// A bake's scene and the light in its pictures.
struct BakeToDraw {
  scene::Scene scene;
  LightmapPages lightmaps;
  std::vector<LightmapPages> directions;

  /// E of the front side, with the normal that the surface has there.
  Rgb irradiance_at(const scene::SurfacePoint& p) const {
    const Rgb e = display::smooth_lightmap_at(scene, lightmaps.of(scene, p), p);
    const bool flat = scene::material_at(scene, p).normal_texture.texture == scene::kNone;
    if (directions.empty() || flat) return e;
    const Vec3 bend = scene::bent_normal(scene, p) - scene::shading_normal(scene, p);
    return irradiance_of_bent(scene, directions, p, bend, e);
  }
};

Result<BakeToDraw> read_bake(const Subject& subject, const RenderSettings& s) {
  LUXEL_TRY_STATUS(check_has_colors(s.from));
  BakeToDraw out;
  LUXEL_TRY(out.scene, baked_scene(subject, s));
  LUXEL_TRY(out.lightmaps, read_pages(s.from, out.scene.materials.size(), read_lightmap));
  LUXEL_TRY(out.directions, read_directions(s.from, out.scene.materials.size()));
  return out;
}

Result<image::Image> draw_from_folder(const Subject& subject, const RenderSettings& s,
                                      Progress& progress) {
  LUXEL_TRY(const BakeToDraw bake, read_bake(subject, s));
  LUXEL_TRY(const trace::RayTracer tracer, trace::RayTracer::build(bake.scene));
  const auto irradiance = [&](const scene::SurfacePoint& p) { return bake.irradiance_at(p); };
  return display::draw(bake.scene, tracer, subject.camera, irradiance, size_of(s), progress);
}

Result<Bake> quick_bake(const RenderSettings& s, const TexelKind* kind, Progress& progress) {
  BakeSettings settings;
  settings.scene = s.scene, settings.reading = s.reading, settings.outside = s.outside;
  settings.output = s.output.parent_path().empty() ? "." : s.output.parent_path();
  settings.bounces = s.bounces.value_or(-1), settings.seed = s.seed.value_or(1);
  settings.resolution = kQuickResolution;
  if (kind) settings.*(kind->wanted) = true;
  settings.samples = kQuickSamples, settings.direct_samples = kQuickDirectSamples;
  return bake_scene(settings, progress);
}

Result<image::Image> draw_quick_bake(const Subject& subject, const RenderSettings& s,
                                     Progress& progress) {
  LUXEL_TRY(const Bake bake, quick_bake(s, nullptr, progress));
  LUXEL_TRY(const trace::RayTracer tracer, trace::RayTracer::build(bake.scene));
  const transport::TexelField field{&bake.atlas, &bake.map, bake.light.irradiance};
  const auto irradiance = [&](const scene::SurfacePoint& p) {
    return display::smooth_irradiance_at(field, p);
  };
  return display::draw(bake.scene, tracer, subject.camera, irradiance, size_of(s), progress);
}

/// The colour of a texel (linear).
Rgb texel_color(const image::Image& picture, Vec2 at) {
  const int x = std::clamp(int(at.x), 0, picture.width - 1);
  const int y = std::clamp(int(at.y), 0, picture.height - 1);
  const Rgb c = picture.rgb(x, y);
  return {image::linear_from_srgb(c.x), image::linear_from_srgb(c.y), image::linear_from_srgb(c.z)};
}

/// Surfaces in the colours of their texels, a little darker where they turn away from the eye.
Result<image::Image> draw_texel_colors(const scene::Scene& scene,
                                       const std::function<Rgb(const scene::SurfacePoint&)>& color,
                                       const Subject& subject, const RenderSettings& s,
                                       Progress& progress) {
  LUXEL_TRY(const trace::RayTracer tracer, trace::RayTracer::build(scene));
  const Vec3 forward = -normalize(column(subject.camera.world_from_camera, 2));
  const auto seen_at = [&](const trace::Hit& hit) {
    const Vec3 n = scene::front_normal(scene, hit.instance, hit.triangle);
    return color(hit.point()) * (0.7f + 0.3f * std::abs(dot(n, forward)));
  };
  display::DrawParams params = size_of(s);
  params.brightest_behind = 1;
  return display::draw_seen(scene, tracer, subject.camera, seen_at, params, progress);
}

Result<image::Image> draw_quick_texels(const Subject& subject, const RenderSettings& s,
                                       TexelKind kind, Progress& progress) {
  LUXEL_TRY(const Bake bake, quick_bake(s, &kind, progress));
  const std::vector<image::Image8>& pictures = bake.*(kind.pictures);
  LUXEL_CHECK(pictures.size() == 1);
  LUXEL_TRY(const image::Image picture,
            image::decode_display(image::encode_png(pictures[0]), kind.name));
  const auto color = [&](const scene::SurfacePoint& p) {
    const auto& c = bake.atlas.corners[bake.atlas.triangle_number(p.instance, p.triangle)];
    return texel_color(picture, interpolate(c[0], c[1], c[2], p.at));
  };
  return draw_texel_colors(bake.scene, color, subject, s, progress);
}

Result<image::Image> draw_texel_pictures(const Subject& subject, const RenderSettings& s,
                                         TexelKind kind, Progress& progress) {
  if (s.from.empty()) return draw_quick_texels(subject, s, kind, progress);
  LUXEL_TRY(const scene::Scene scene, baked_scene(subject, s));
  LUXEL_TRY(const LightmapPages pages,
            read_pages(s.from, scene.materials.size(), [&](const std::filesystem::path& lightmap) {
              return read_texel_picture(lightmap, kind);
            }));
  const auto color = [&](const scene::SurfacePoint& p) {
    const scene::Mesh& mesh = scene.meshes[scene.instances[p.instance].mesh];
    if (mesh.uv1.empty()) return Rgb{};
    const auto& t = mesh.triangles[p.triangle];
    const Vec2 uv = interpolate(mesh.uv1[t[0]], mesh.uv1[t[1]], mesh.uv1[t[2]], p.at);
    const image::Image& picture = pages.of(scene, p);
    return texel_color(picture, {uv.x * float(picture.width), uv.y * float(picture.height)});
  };
  return draw_texel_colors(scene, color, subject, s, progress);
}

}  // namespace

Result<image::Image> draw_texels_of_bake(const Subject& subject, const RenderSettings& s, Rendered&,
                                         Progress& progress) {
  return draw_texel_pictures(subject, s, kTexels, progress);
}

Result<image::Image> draw_errors_of_bake(const Subject& subject, const RenderSettings& s, Rendered&,
                                         Progress& progress) {
  return draw_texel_pictures(subject, s, kErrors, progress);
}

Result<image::Image> draw_irradiance_of_bake(const Subject& subject, const RenderSettings& s,
                                             Rendered&, Progress& progress) {
  LUXEL_TRY(const BakeToDraw bake, read_bake(subject, s));
  LUXEL_TRY(const trace::RayTracer tracer, trace::RayTracer::build(bake.scene));
  const auto seen_at = [&](const trace::Hit& hit) { return bake.irradiance_at(hit.point()); };
  display::DrawParams params = size_of(s);
  params.brightest_behind = 0;
  LUXEL_TRY(image::Image picture,
            display::draw_seen(bake.scene, tracer, subject.camera, seen_at, params, progress));
  // The mean over what shows a surface, so that E at its border is that of the surface.
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x)
      if (const float share = picture.at(x, y)[3]; share > 0)
        picture.set_rgb(x, y, picture.rgb(x, y) / share);
  return picture;
}

image::Image8 show_irradiance(const Subject& subject, const image::Image& picture) {
  std::vector<float> values;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x)
      values.push_back(picture.at(x, y)[3] >= 0.5f ? luminance(picture.rgb(x, y))
                                                   : std::numeric_limits<float>::quiet_NaN());
  const image::ValueScale scale = image::scale_for(values, subject.unit.symbol);
  image::Image8 shown = image::draw_values(values, picture.width, scale, {232, 232, 232});
  std::vector<std::array<int, 2>> taken;
  image::label_isolines(shown, values, scale, taken);
  return image::with_legend(shown, scale);
}

Result<image::Image> draw_lightmap(const Subject& subject, const RenderSettings& settings,
                                   Rendered&, Progress& progress) {
  return settings.from.empty() ? draw_quick_bake(subject, settings, progress)
                               : draw_from_folder(subject, settings, progress);
}

}  // namespace luxel::pipeline
