#include "pipeline/render.h"

#include "base/file.h"
#include "display/draw.h"
#include "display/tone_map.h"
#include "image/codec.h"
#include "import/import.h"
#include "pipeline/bake.h"
#include "reference/path_tracer.h"
#include "scene/scene.h"
#include "trace/ray_tracer.h"

namespace luxel::pipeline {
namespace {

constexpr int kMaxPictureSide = 16384;
constexpr int kMaxPathSamples = 1 << 20;

/// Bilinear lookup of the lightmap at a point of baked.glb, whose TEXCOORD_1 are its places. The
/// gutter was dilated, so no weight needs to be renormalised.
Rgb lightmap_at(const scene::Scene& scene, const image::Image& lightmap,
                const scene::SurfacePoint& p) {
  const scene::Mesh& mesh = scene.meshes[scene.instances[p.instance].mesh];
  if (mesh.uv1.empty()) return {};
  const auto& t = mesh.triangles[p.triangle];
  const Vec2 uv = interpolate(mesh.uv1[t[0]], mesh.uv1[t[1]], mesh.uv1[t[2]], p.at);
  const float x = uv.x * float(lightmap.width) - 0.5f, y = uv.y * float(lightmap.height) - 0.5f;
  const int x0 = int(std::floor(x)), y0 = int(std::floor(y));
  const float fx = x - float(x0), fy = y - float(y0);
  Rgb sum{};
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 2; ++i)
      sum += lightmap.rgb(std::clamp(x0 + i, 0, lightmap.width - 1),
                          std::clamp(y0 + j, 0, lightmap.height - 1)) *
             ((i ? fx : 1 - fx) * (j ? fy : 1 - fy));
  return sum;
}

scene::Camera camera_at(Vec3 eye, Vec3 look_at, float fov_y_rad) {
  const Vec3 back = normalize(eye - look_at);
  const Vec3 up = std::abs(back.y) > 0.999f ? Vec3{0, 0, -1} : Vec3{0, 1, 0};
  const Vec3 right = normalize(cross(up, back));
  scene::Camera camera;
  camera.name = "eye";
  camera.world_from_camera = from_columns(right, cross(back, right), back, eye);
  camera.fov_y_rad = fov_y_rad;
  return camera;
}

Result<scene::Camera> choose_camera(const RenderSettings& s, const scene::Scene& scene,
                                    const trace::RayTracer& tracer) {
  if (s.eye) {
    if (*s.eye == s.look_at)
      return fail(ErrorCode::bad_setting, "--eye and --look-at are the same point");
    return camera_at(*s.eye, s.look_at, float(s.fov_deg) * kPi / 180);
  }
  std::string names;
  for (const scene::Camera& camera : scene.cameras) {
    if (s.camera.empty() || camera.name == s.camera) return camera;
    names += (names.empty() ? "" : ", ") + camera.name;
  }
  if (!s.camera.empty())
    return fail(ErrorCode::bad_setting, "--camera {} is not in {}; there is: {}", s.camera,
                s.scene.string(), names.empty() ? "none" : names);
  return display::fit_camera(scene, tracer, float(s.width) / float(s.height));
}

Status check(const RenderSettings& s) {
  if (s.width < 1 || s.height < 1 || s.width > kMaxPictureSide || s.height > kMaxPictureSide)
    return fail(ErrorCode::bad_setting, "--size {}x{} is outside 1x1 to {}x{}", s.width, s.height,
                kMaxPictureSide, kMaxPictureSide);
  const std::string extension = s.output.extension().string();
  if (extension != ".png" && extension != ".exr")
    return fail(ErrorCode::bad_setting, "--output {} is neither .png nor .exr", s.output.string());
  if (s.samples < 1 || s.samples > kMaxPathSamples)
    return fail(ErrorCode::bad_setting, "--samples {} is outside 1 to {}", s.samples,
                kMaxPathSamples);
  if (s.technique == "path" && !s.from.empty())
    return fail(ErrorCode::bad_setting,
                "--technique path computes the light itself; leave --from {} out", s.from.string());
  if (s.technique != "path" && s.from.empty())
    return fail(ErrorCode::bad_setting,
                "--technique {} draws a bake; name its folder with --from, or use --technique path",
                s.technique);
  std::error_code ignored;
  const std::filesystem::path folder = s.output.parent_path();
  if (!folder.empty() && !std::filesystem::is_directory(folder, ignored))
    return fail(ErrorCode::bad_setting, "--output {}: there is no folder {}; make it first",
                s.output.string(), folder.string());
  return {};
}

Result<image::Image> draw_bake(const RenderSettings& s, const scene::Scene& original,
                               Progress& progress) {
  LUXEL_TRY(import::Imported baked, import::import_scene(s.from / "baked.glb"));
  LUXEL_TRY(const std::vector<std::byte> bytes, read_file(s.from / "lightmap.exr"));
  LUXEL_TRY(const image::Image lightmap,
            image::decode_exr(bytes, (s.from / "lightmap.exr").string()));
  scene::Scene& scene = baked.scene;
  scene.background = original.background;
  scene.cameras = original.cameras;
  LUXEL_TRY(const trace::RayTracer tracer, trace::RayTracer::build(scene));
  LUXEL_TRY(const scene::Camera camera, choose_camera(s, scene, tracer));
  display::DrawParams params;
  params.width = s.width, params.height = s.height;
  const auto irradiance = [&](const scene::SurfacePoint& p) {
    return lightmap_at(scene, lightmap, p);
  };
  return display::draw(scene, tracer, camera, irradiance, params, progress);
}

Result<image::Image> draw_paths(const RenderSettings& s, const scene::Scene& scene, Rendered& out,
                                Progress& progress) {
  LUXEL_TRY(const trace::RayTracer tracer, trace::RayTracer::build(scene));
  LUXEL_TRY(const scene::Camera camera, choose_camera(s, scene, tracer));
  LUXEL_TRY(reference::Picture picture,
            reference::radiance_by_paths(scene, tracer, camera, s.width, s.height,
                                         {s.samples, s.bounces, s.seed}, progress));
  out.rays = picture.rays, out.relative_error = picture.relative_error;
  return std::move(picture.radiance);
}

}  // namespace

Result<Rendered> render(const RenderSettings& s, Progress& progress) {
  LUXEL_TRY_STATUS(check(s));
  progress.begin("import", 0);
  LUXEL_TRY(import::Imported original, import::import_scene(s.scene));
  Rendered out;
  out.width = s.width, out.height = s.height, out.warnings = std::move(original.warnings);
  const std::string dark = add_outside_light(s.outside, original.scene);
  const bool paths = s.technique == "path";
  if (paths && !dark.empty()) out.warnings.push_back(dark);
  LUXEL_TRY(const image::Image picture, paths ? draw_paths(s, original.scene, out, progress)
                                              : draw_bake(s, original.scene, progress));
  progress.begin(kWriteStage, 0);
  if (s.output.extension() == ".exr") {
    LUXEL_TRY(const std::vector<std::byte> exr, image::encode_exr(picture));
    LUXEL_TRY_STATUS(write_file_atomically(s.output, exr));
  } else {
    const image::Image8 shown = display::tone_map(picture, display::auto_exposure(picture));
    LUXEL_TRY_STATUS(write_file_atomically(s.output, image::encode_png(shown)));
  }
  return out;
}

}  // namespace luxel::pipeline
