#include "pipeline/draw_bake.h"

#include <algorithm>
#include <functional>

#include "base/file.h"
#include "display/draw.h"
#include "display/lightmap_lookup.h"
#include "image/codec.h"
#include "image/color.h"
#include "import/import.h"
#include "pipeline/bake.h"
#include "transport/irradiance_field.h"

namespace luxel::pipeline {
namespace {

/// Of the bake that is made for a tile: seconds, not minutes.
constexpr int kQuickResolution = 256, kQuickSamples = 64, kQuickDirectSamples = 16;

display::DrawParams size_of(const RenderSettings& settings) {
  display::DrawParams params;
  params.width = settings.width, params.height = settings.height;
  return params;
}

/// baked.glb with the surroundings of what is drawn.
Result<scene::Scene> baked_scene(const Subject& subject, const RenderSettings& s) {
  LUXEL_TRY(import::Imported baked, import::import_scene(s.from / "baked.glb"));
  baked.scene.background = subject.scene.background;
  baked.scene.environment = subject.scene.environment;
  return std::move(baked.scene);
}

Result<image::Image> draw_from_folder(const Subject& subject, const RenderSettings& s,
                                      Progress& progress) {
  LUXEL_TRY(const scene::Scene scene, baked_scene(subject, s));
  LUXEL_TRY(const std::vector<std::byte> bytes, read_file(s.from / "lightmap.exr"));
  LUXEL_TRY(const image::Image lightmap,
            image::decode_exr(bytes, (s.from / "lightmap.exr").string()));
  LUXEL_TRY(const trace::RayTracer tracer, trace::RayTracer::build(scene));
  const auto irradiance = [&](const scene::SurfacePoint& p) {
    return display::lightmap_at(scene, lightmap, p);
  };
  return display::draw(scene, tracer, subject.camera, irradiance, size_of(s), progress);
}

Result<Bake> quick_bake(const RenderSettings& s, Progress& progress) {
  BakeSettings settings;
  settings.scene = s.scene, settings.outside = s.outside;
  settings.output = s.output.parent_path().empty() ? "." : s.output.parent_path();
  settings.bounces = s.bounces.value_or(-1), settings.seed = s.seed.value_or(1);
  settings.resolution = kQuickResolution;
  settings.samples = kQuickSamples, settings.direct_samples = kQuickDirectSamples;
  return bake_scene(settings, progress);
}

Result<image::Image> draw_quick_bake(const Subject& subject, const RenderSettings& s,
                                     Progress& progress) {
  LUXEL_TRY(const Bake bake, quick_bake(s, progress));
  LUXEL_TRY(const trace::RayTracer tracer, trace::RayTracer::build(bake.scene));
  const transport::TexelField field{&bake.atlas, &bake.map, bake.light.irradiance};
  const auto irradiance = [&](const scene::SurfacePoint& p) {
    return transport::irradiance_at(field, p);
  };
  return display::draw(bake.scene, tracer, subject.camera, irradiance, size_of(s), progress);
}

/// The pictures of texels.png on surfaces: a colour per texel, a little darker where surfaces turn
/// away from the eye.
Result<image::Image> draw_texel_colors(const scene::Scene& scene, const image::Image& colors,
                                       const std::function<Vec2(const scene::SurfacePoint&)>& place,
                                       const Subject& subject, const RenderSettings& s,
                                       Progress& progress) {
  LUXEL_TRY(const trace::RayTracer tracer, trace::RayTracer::build(scene));
  const Vec3 forward = -normalize(column(subject.camera.world_from_camera, 2));
  const auto seen_at = [&](const trace::Hit& hit) {
    const Vec2 at = place(hit.point());
    const int x = std::clamp(int(at.x), 0, colors.width - 1);
    const int y = std::clamp(int(at.y), 0, colors.height - 1);
    const Vec3 n = scene::front_normal(scene, hit.instance, hit.triangle);
    const Rgb c = colors.rgb(x, y);
    return Rgb{image::linear_from_srgb(c.x), image::linear_from_srgb(c.y),
               image::linear_from_srgb(c.z)} *
           (0.7f + 0.3f * std::abs(dot(n, forward)));
  };
  display::DrawParams params = size_of(s);
  params.brightest_behind = 1;
  return display::draw_seen(scene, tracer, subject.camera, seen_at, params, progress);
}

}  // namespace

Result<image::Image> draw_texels_of_bake(const Subject& subject, const RenderSettings& s, Rendered&,
                                         Progress& progress) {
  if (s.from.empty()) {
    LUXEL_TRY(const Bake bake, quick_bake(s, progress));
    const auto place = [&](const scene::SurfacePoint& p) {
      const auto& c = bake.atlas.corners[bake.atlas.triangle_number(p.instance, p.triangle)];
      return interpolate(c[0], c[1], c[2], p.at);
    };
    LUXEL_TRY(const image::Image colors,
              image::decode_display(image::encode_png(bake.texel_picture), "texels.png"));
    return draw_texel_colors(bake.scene, colors, place, subject, s, progress);
  }
  LUXEL_TRY(const scene::Scene scene, baked_scene(subject, s));
  const std::filesystem::path file = s.from / "texels.png";
  LUXEL_TRY(const std::vector<std::byte> bytes, read_file(file));
  LUXEL_TRY(const image::Image colors, image::decode_display(bytes, file.string()));
  const Vec2 size{float(colors.width), float(colors.height)};
  const auto place = [&](const scene::SurfacePoint& p) {
    const scene::Mesh& mesh = scene.meshes[scene.instances[p.instance].mesh];
    if (mesh.uv1.empty()) return Vec2{};
    const auto& t = mesh.triangles[p.triangle];
    const Vec2 uv = interpolate(mesh.uv1[t[0]], mesh.uv1[t[1]], mesh.uv1[t[2]], p.at);
    return Vec2{uv.x * size.x, uv.y * size.y};
  };
  return draw_texel_colors(scene, colors, place, subject, s, progress);
}

Result<image::Image> draw_lightmap(const Subject& subject, const RenderSettings& settings,
                                   Rendered&, Progress& progress) {
  return settings.from.empty() ? draw_quick_bake(subject, settings, progress)
                               : draw_from_folder(subject, settings, progress);
}

}  // namespace luxel::pipeline
