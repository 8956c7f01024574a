#include "luxel/pipeline/bake/preview.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <tuple>
#include <vector>

#include "luxel/display/draw.h"
#include "luxel/display/smooth_lookup.h"
#include "luxel/display/tone_map.h"
#include "luxel/pipeline/bake/camera.h"
#include "luxel/pipeline/bake/dark_surfaces.h"
#include "luxel/pipeline/bake/ground.h"
#include "luxel/pipeline/bake/page_light.h"
#include "luxel/trace/camera_rays.h"

namespace luxel::pipeline {
namespace {

constexpr int kPreviewHeight = 720;
/// Exposed; the curve of the screen leaves it as it is.
constexpr float kBacksShownAt = 0.35f;

/// True where no surface in a picture has light; not where the sky shows beside it.
bool is_dark(const image::Image& picture) {
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x)
      if (picture.at(x, y)[3] == 1 && max_component(picture.rgb(x, y)) > 0) return false;
  return true;
}

/// readable_exposure(), but what is dark is shown dark. `picture` shows each surface as it is,
/// `card` as if it reflected kCard: how bright the one is over the other tells what its bright part
/// reflects. That is shown at 0.6 from a reflectance of 0.4 on, and as it is up to 0.2. Where lamps
/// are all the light there is, the brightest hundredth of what they light counts, too.
constexpr float kCard = 0.6f, kShownAsItIs = 0.2f;
float shown_exposure(const scene::Scene& scene, const image::Image& picture,
                     const image::Image& card) {
  constexpr float kLampsShownAt = 8 / 0.6f;  // where auto_exposure() shows the percentile
  float exposure = display::readable_exposure(card);
  if (!is_dark(picture)) {
    const float reflects = kCard * display::auto_exposure(card) / display::auto_exposure(picture);
    const float shown_at = std::min(kCard, reflects + std::max(0.0f, reflects - kShownAsItIs));
    exposure = display::readable_exposure(picture) * shown_at / kCard;
  }
  return display::has_void(scene)
             ? std::min(exposure, kLampsShownAt * display::auto_exposure(card, 99))
             : exposure;
}

/// The surroundings, darker on the ground under an object; none: they are what they are.
Result<display::SeenBehind> behind_of(const scene::Scene& scene, const trace::RayTracer& tracer,
                                      const scene::Camera& camera, const Progress& progress) {
  LUXEL_TRY(std::optional<Ground> ground, ground_under(scene, tracer, camera, progress));
  if (!ground) return display::SeenBehind();
  return display::SeenBehind([&scene, ground = std::move(*ground)](const trace::Ray& ray) {
    return scene::smooth_surroundings_towards(scene, ray.direction) * light_on(ground, ray);
  });
}

/// Backs that a picture shows instead of fronts.
struct Backs {
  bool instead = false;   ///< of fronts, of which there are none, or black ones behind the backs
  uint32_t instance = 0;  ///< that shows most of them
  bool fronts_are_dark = false;
};
Backs backs_in(const scene::Scene& scene, const Outlook& outlook, const image::Image& picture) {
  constexpr double kFew = 0.05, kMost = 0.9;
  std::vector<uint32_t> seen(scene.instances.size());
  size_t backs = 0;
  for (const trace::Hit& hit : outlook.first)
    if (trace::is_unseen_back(scene, hit)) ++seen[hit.instance], ++backs;
  const auto surfaces = double(std::ranges::count_if(outlook.first, &trace::Hit::found));
  const auto fronts = double(std::ranges::count_if(outlook.seen, &trace::Hit::found));
  Backs out;
  out.fronts_are_dark = fronts >= kFew * surfaces;
  out.instead = backs > 0 && (fronts < kFew * surfaces ||
                              (double(backs) > kMost * surfaces && is_dark(picture)));
  out.instance = uint32_t(std::ranges::max_element(seen) - seen.begin());
  return out;
}

/// Backs as grey shapes under stripes of the picture.
display::SeenAt hatched(const scene::Scene& scene, const trace::CameraRays& rays, float exposure,
                        const display::SeenAt& fronts) {
  constexpr float kStripe = 6;  // pixels
  return [&scene, rays, exposure, fronts](const trace::Hit& hit) {
    if (!trace::is_unseen_back(scene, hit)) return fronts(hit);
    const Vec3 place = scene::world_position(scene, hit.point());
    const Vec2 pixel = rays.pixel_of(place);
    const Vec3 towards = rays.orthographic ? rays.forward : normalize(place - rays.eye);
    const float facing =
        std::abs(dot(towards, scene::front_normal(scene, hit.instance, hit.triangle)));
    const bool dark = int(std::floor((pixel.x + pixel.y) / kStripe)) % 2 != 0;
    const float grey = kBacksShownAt * (0.4f + 0.6f * facing) * (dark ? 0.5f : 1.0f) / exposure;
    return Rgb{grey, grey, grey};
  };
}

/// The one value that nearly all of a picture has: "white", "black", "one colour"; empty: not.
std::string plain_colour(const image::Image8& picture) {
  constexpr int kNoise = 4;
  constexpr double kNearlyAll = 0.995;
  std::array<uint8_t, 3> least{255, 255, 255}, most{};
  size_t white = 0, black = 0, count = 0;
  for (size_t i = 0; i + 2 < picture.data.size(); i += 3, ++count) {
    const uint8_t* c = picture.data.data() + i;
    for (size_t k = 0; k < 3; ++k)
      least[k] = std::min(least[k], c[k]), most[k] = std::max(most[k], c[k]);
    white += std::min({c[0], c[1], c[2]}) == 255, black += std::max({c[0], c[1], c[2]}) == 0;
  }
  if (double(white) > kNearlyAll * double(count)) return "white";
  if (double(black) > kNearlyAll * double(count)) return "black";
  for (size_t k = 0; k < 3; ++k)
    if (most[k] - least[k] > kNoise) return {};
  return "one colour";
}

std::string of_instance(const scene::Scene& scene, uint32_t i) {
  const std::string& name = scene.instances[i].name;
  return name.empty() ? fmt::format("instance {}", i) : fmt::format("'{}'", name);
}

/// A sentence on a picture that shows no scene in the light; empty: it shows one.
std::string about_preview(const Bake& bake, const Outlook& outlook, const Backs& backs,
                          const image::Image& picture) {
  const scene::Scene& scene = bake.scene;
  if (backs.instead)
    return fmt::format(
        "{} in preview.png, so it shows the backs hatched: are the faces of {} flipped?",
        backs.fronts_are_dark ? "all fronts of surfaces are black" : "no front of a surface is",
        of_instance(scene, backs.instance));
  if (std::ranges::none_of(outlook.first, &trace::Hit::found))
    return "preview.png shows no surface: none is in its view, or what is there is fully "
           "transparent";
  const std::string plain = plain_colour(bake.preview);
  if (plain.empty() || !about_dark_surfaces(bake).empty()) return {};
  return fmt::format("preview.png is {}: {}", plain,
                     is_dark(picture) ? "no light reaches what its view shows"
                     : plain == "white"
                         ? "what its view shows is far brighter than the rest"
                         : "its view shows one evenly lit surface; --view chooses another");
}

}  // namespace

std::pair<int, int> preview_size(const scene::Camera& camera) {
  const float aspect = camera.aspect > 0 ? camera.aspect : kPreviewAspect;
  const int width = int(float(kPreviewHeight) * aspect + 0.5f);
  return {std::clamp(width, kPreviewHeight / 4, kPreviewHeight * 4), kPreviewHeight};
}

Status draw_preview(const BakeSettings& settings, const trace::RayTracer& tracer, Bake& bake,
                    Progress& progress) {
  progress.begin("draw", 0);  // a view is chosen for the picture's sake
  std::vector<Rgb> light = bake.light.irradiance;
  for (const Lent& lent : light_for_hidden(bake)) light[lent.texel] = light[lent.from];
  const transport::TexelField field{&bake.atlas, &bake.map, light};
  LUXEL_TRY(const scene::Camera camera,
            choose_camera({.view = settings.view, .aspect = kPreviewAspect}, bake.scene, tracer,
                          settings.scene.string(), &bake.warnings));
  display::DrawParams params;
  std::tie(params.width, params.height) = preview_size(camera);
  const auto irradiance_at = [&](const scene::SurfacePoint& p) {
    return display::smooth_irradiance_at(field, p);
  };
  const display::SeenAt seen_at = [&](const trace::Hit& hit) {
    return display::seen_radiance(bake.scene, hit.point(), irradiance_at);
  };
  const display::SeenAt card_at = [&](const trace::Hit& hit) {
    return scene::material_at(bake.scene, hit.point()).unlit
               ? seen_at(hit)
               : irradiance_at(hit.point()) * (kCard / kPi);
  };
  LUXEL_TRY(params.behind, behind_of(bake.scene, tracer, camera, progress));
  LUXEL_TRY(image::Image picture,
            display::draw_seen(bake.scene, tracer, camera, seen_at, params, progress));
  const display::DrawParams small{params.width / 4, params.height / 4, 1};
  LUXEL_TRY(const image::Image card,
            display::draw_seen(bake.scene, tracer, camera, card_at, small, progress));
  const float exposure = shown_exposure(bake.scene, picture, card);
  const Outlook outlook =
      outlook_of(bake.scene, tracer, camera, float(params.width) / float(params.height));
  const Backs backs = backs_in(bake.scene, outlook, picture);
  if (backs.instead) {
    params.backs = true;
    const trace::CameraRays rays(camera, params.width, params.height);
    LUXEL_TRY(picture,
              display::draw_seen(bake.scene, tracer, camera,
                                 hatched(bake.scene, rays, exposure, seen_at), params, progress));
  }
  bake.view = {camera, params.width, params.height, exposure};
  bake.preview = display::on_screen(bake.scene, picture, exposure);
  if (std::string text = about_preview(bake, outlook, backs, picture); !text.empty())
    bake.warnings.push_back(std::move(text));
  return {};
}

}  // namespace luxel::pipeline
