#include "luxel/pipeline/command/play.h"

#include <memory>
#include <optional>

#include "luxel/base/clock.h"
#include "luxel/base/file.h"
#include "luxel/base/output_folder.h"
#include "luxel/base/parallel.h"
#include "luxel/display/draw.h"
#include "luxel/display/lightmap_lookup.h"
#include "luxel/display/tone_map.h"
#include "luxel/image/codec.h"
#include "luxel/import/import.h"
#include "luxel/pipeline/bake/camera.h"
#include "luxel/pipeline/command/light_script.h"
#include "luxel/post/dilate.h"
#include "luxel/scene/off_surface.h"
#include "luxel/scene/origin.h"
#include "luxel/solve/matrix/live_light.h"
#include "luxel/solve/matrix/lxr.h"
#include "luxel/solve/matrix/relighter.h"

namespace luxel::pipeline {
namespace {

/// As many rays along a pixel's side as make edges smooth.
constexpr int kRaysPerAxis = 2;

/// The scene of the frames, and the camera that sees it.
struct View {
  scene::Scene scene;  ///< of the file; its materials glow as the script says
  std::optional<trace::RayTracer> tracer;
  scene::Camera camera;
};

/// The places of an .lxr file as something that can be looked up.
class PlaceLight {
 public:
  PlaceLight(const scene::Scene& scene, const matrix::Target& target)
      : scene_(scene), target_(target) {
    if (target.kind == matrix::Target::Kind::texels)
      map_ = image::Image(int(target.width), int(target.height), 4);
    for (const scene::Instance& instance : scene.instances) {
      first_.push_back(count_);
      count_ += scene.meshes[instance.mesh].positions.size();
    }
  }
  /// False: the file has another number of vertices than its scene.
  bool fits() const {
    return target_.kind != matrix::Target::Kind::vertices || target_.position.size() == count_;
  }
  void set(std::span<const Rgb> light) {
    light_ = light;
    if (target_.kind != matrix::Target::Kind::texels) return;
    std::fill(map_.data.begin(), map_.data.end(), 0.0f);
    for (size_t k = 0; k < target_.texel.size(); ++k) {
      if (is_hidden(k)) continue;
      float* pixel = map_.at(target_.texel[k][0], target_.texel[k][1]);
      pixel[0] = light[k].x, pixel[1] = light[k].y, pixel[2] = light[k].z, pixel[3] = 1;
    }
    post::dilate(map_, 2);
  }
  Rgb at(const scene::SurfacePoint& p) const {
    if (target_.kind == matrix::Target::Kind::texels) return display::lightmap_at(scene_, map_, p);
    const auto& t = scene_.meshes[scene_.instances[p.instance].mesh].triangles[p.triangle];
    const size_t first = first_[p.instance];
    return interpolate(light_[first + t[0]], light_[first + t[1]], light_[first + t[2]], p.at);
  }

 private:
  /// Inside a solid, or covered: no patch lights it, and what is seen beside it gets its
  /// neighbours' light.
  bool is_hidden(size_t place) const {
    const std::vector<uint32_t>& first = target_.transfer.first;
    return first[place] == first[place + 1];
  }

  const scene::Scene& scene_;
  const matrix::Target& target_;
  std::vector<size_t> first_;  ///< per instance: its first vertex
  size_t count_ = 0;
  image::Image map_;
  std::span<const Rgb> light_;
};

Result<scene::Camera> camera_of(const LightScript& script, const scene::Scene& scene,
                                const trace::RayTracer& tracer, const std::string& file) {
  CameraChoice choice;
  choice.asked = "the script's camera";
  if (const auto* name = std::get_if<std::string>(&script.camera)) choice.name = *name;
  if (const auto* view = std::get_if<LightScript::View>(&script.camera))
    choice.eye = scene::in_world(scene, view->eye),
    choice.look_at = scene::in_world(scene, view->look_at), choice.fov_deg = view->fov_deg;
  choice.aspect = float(script.width) / float(script.height);
  return choose_camera(choice, scene, tracer, file);
}

Result<std::unique_ptr<View>> set_up(const PlaySettings& s, const matrix::RelightData& data,
                                     const LightScript& script, Played& out) {
  const std::string name = s.lxr.string();
  if (data.scene_glb.empty() || data.target.kind == matrix::Target::Kind::none)
    return fail(ErrorCode::bad_input,
                "{}: it was made without places to light, so there is nothing to draw; make it "
                "with --target texels or vertices",
                name);
  LUXEL_TRY(import::Imported imported,
            import::import_glb(data.scene_glb, name, {.origin = DVec3{}}));
  auto view = std::make_unique<View>();
  view->scene = std::move(imported.scene);
  view->scene.background = data.background, view->scene.origin = data.origin;
  LUXEL_TRY(view->tracer, trace::RayTracer::build(view->scene));
  LUXEL_TRY(view->camera, camera_of(script, view->scene, *view->tracer, name));
  out.width = script.width, out.height = script.height;
  return view;
}

/// Everything that shines in a frame.
struct FrameLights {
  std::vector<scene::PunctualLight> punctual;
  std::vector<Rgb> emission;  ///< per material of the .lxr file
  Rgb background{};
};

FrameLights lights_at(const LightScript& script, const matrix::RelightData& data,
                      const std::vector<Rgb>& baked_radiance, double time_s) {
  FrameLights out;
  out.punctual = lights_at(script, time_s);
  if (script.keep_lights)
    out.punctual.insert(out.punctual.end(), data.lights.begin(), data.lights.end());
  out.emission = baked_radiance;
  for (const LightScript::Glow& glow : script.glows)
    for (size_t m = 0; m < out.emission.size(); ++m)
      if (data.material_name[m] == glow.material) out.emission[m] = value_at(glow.radiance, time_s);
  out.background = script.background ? value_at(*script.background, time_s) : data.background;
  return out;
}

Status check_names(const LightScript& script, const matrix::RelightData& data,
                   const std::string& file) {
  for (const LightScript::Glow& glow : script.glows) {
    std::string names;
    bool found = false;
    for (const std::string& name : data.material_name)
      found = found || name == glow.material, names += (names.empty() ? "" : ", ") + name;
    if (!found)
      return fail(ErrorCode::bad_input, "{}: the scene has no material '{}'; it has: {}", file,
                  glow.material, names);
  }
  return {};
}

/// Sets the light of glowing surfaces and of the sky, as cameras see them.
void show_lights(const LightScript& script, const FrameLights& lights, double time_s, View& view) {
  view.scene.background = lights.background;
  for (const LightScript::Glow& glow : script.glows)
    for (size_t m = 0; m < view.scene.materials.size(); ++m)
      if (view.scene.materials[m].name == glow.material)
        view.scene.materials[m].emission = value_at(glow.radiance, time_s);
}

Result<image::Image> draw_frame(const View& view, const PlaceLight& indirect,
                                const FrameLights& lights, const LightScript& script,
                                Progress& progress) {
  const auto irradiance = [&](const scene::SurfacePoint& p) {
    const Vec3 normal = scene::shading_normal(view.scene, p);
    const Vec3 geometric = scene::front_normal(view.scene, p.instance, p.triangle);
    const Vec3 position = scene::off_surface(view.scene, p, geometric);
    return indirect.at(p) + matrix::live_light_at({{&position, 1}, {&normal, 1}, {&geometric, 1}},
                                                  0, lights.punctual, *view.tracer);
  };
  display::DrawParams params;
  params.width = script.width, params.height = script.height;
  params.samples_per_axis = kRaysPerAxis;
  return display::draw(view.scene, *view.tracer, view.camera, irradiance, params, progress);
}

std::string csv_of(const std::vector<FrameTimes>& frames) {
  std::string text = "frame,time_s,direct_ms,bounces_ms,places_ms,update_ms,draw_ms\n";
  for (size_t k = 0; k < frames.size(); ++k) {
    const FrameTimes& f = frames[k];
    text += fmt::format("{},{:.6g},{:.3f},{:.3f},{:.3f},{:.3f},{:.1f}\n", k, f.time_s, f.direct_ms,
                        f.bounces_ms, f.places_ms, f.update_ms(), f.draw_ms);
  }
  return text;
}

/// Updates, draws and times all frames.
Result<std::vector<OutputFile>> draw_frames(const PlaySettings& s, const LightScript& script,
                                            matrix::Relighter& relighter, View& view, Played& out,
                                            Progress& progress) {
  const matrix::RelightData& data = relighter.data();
  PlaceLight indirect(view.scene, data.target);
  if (!indirect.fits())
    return fail(ErrorCode::bad_input, "{}: its vertices are not those of its scene; make it again",
                s.lxr.string());
  std::vector<Rgb> baked_radiance = matrix::mean_emission_of(data);
  for (Rgb& emission : baked_radiance) emission = emission / kPi;
  std::vector<OutputFile> files;
  float exposure = 1;
  for (int k = 0; k < script.frames; ++k) {
    const double time_s = k / script.frames_per_second;
    const FrameLights lights = lights_at(script, data, baked_radiance, time_s);
    relighter.update({lights.punctual, lights.emission, lights.background});
    indirect.set(relighter.latest().indirect_at_points);
    show_lights(script, lights, time_s, view);
    const Clock::time_point start = Clock::now();
    LUXEL_TRY(const image::Image picture, draw_frame(view, indirect, lights, script, progress));
    view.scene.lights = lights.punctual;  // only to be named
    LUXEL_TRY_STATUS(check_picture(view.scene, *view.tracer, view.camera, picture));
    const matrix::Relighter::Seconds seconds = relighter.seconds();
    out.frames.push_back({time_s, 1e3 * seconds.direct, 1e3 * seconds.bounces, 1e3 * seconds.places,
                          1e3 * seconds_since(start)});
    if (k == 0) exposure = exposure_factor(script.exposure, picture);
    files.push_back({s.output / fmt::format("frame-{:04}.png", k),
                     image::encode_png(display::on_screen(view.scene, picture, exposure))});
  }
  return files;
}

}  // namespace

Result<Played> play(const PlaySettings& s, Progress& progress) {
  const ThreadLimit threads(s.threads);
  OutputFolder folder(s.output);
  LUXEL_TRY_STATUS(folder.try_out());
  LUXEL_TRY(const std::vector<std::byte> text, read_file(s.script));
  progress.begin("read", 0);
  LUXEL_TRY(matrix::RelightData data, matrix::read_lxr(s.lxr));
  LUXEL_TRY(const LightScript script,
            parse_light_script({reinterpret_cast<const char*>(text.data()), text.size()},
                               s.script.string(), data.origin));
  LUXEL_TRY_STATUS(check_names(script, data, s.script.string()));
  Played out;
  LUXEL_TRY(const std::unique_ptr<View> view, set_up(s, data, script, out));
  LUXEL_TRY(matrix::Relighter relighter, matrix::Relighter::make(std::move(data), {}));
  LUXEL_TRY(std::vector<OutputFile> files, draw_frames(s, script, relighter, *view, out, progress));
  progress.begin(kWriteStage, 0);
  files.push_back(text_file(s.output / "frames.csv", csv_of(out.frames)));
  LUXEL_TRY_STATUS(folder.make());
  LUXEL_TRY_STATUS(write_files_atomically(files));
  folder.keep();
  return out;
}

}  // namespace luxel::pipeline
