// The table of techniques of `luxel render`: the only place that names one by string.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/image/codec.h"
#include "luxel/image/image.h"
#include "luxel/pipeline/render/render.h"
#include "luxel/pipeline/settings/light_unit.h"
#include "luxel/scene/scene.h"
#include "luxel/trace/ray_tracer.h"

namespace luxel::pipeline {

/// Scene and camera that every technique draws.
struct Subject {
  const scene::Scene& scene;  ///< with light from outside
  const trace::RayTracer& tracer;
  const scene::Camera& camera;
  LightUnit unit{};                    ///< of its irradiance
  const BakeDevice* device = nullptr;  ///< for techniques that leave something to one
};

/// One picture, 4 channels: radiance, or colours of a screen (linear, [0, 1]); A = share of the
/// pixel that shows a surface. May add to `out`.
using DrawFunction = Result<image::Image> (*)(const Subject&, const RenderSettings&, Rendered& out,
                                              Progress&);

struct Technique {
  std::string_view name, help;
  DrawFunction draw;
  bool is_light = true;         ///< radiance, which is exposed and tone mapped
  bool needs_bake = false;      ///< --from
  bool bakes_itself = false;    ///< makes a small bake when --from names none
  bool traces_paths = false;    ///< --samples, --seed
  bool counts_bounces = false;  ///< --bounces
  bool has_elements = false;    ///< --elements, --hemicube, ...
  bool has_links = false;       ///< --eps, --min-area, ...
  bool has_lights = false;      ///< --sun
  bool has_device = false;      ///< leaves something to a device: --device
  bool on_sheet = true;         ///< one of a contact sheet's pictures
  /// A screen's picture of what are values, not light nor colours; null: they are no values.
  image::Image8 (*show)(const Subject&, const image::Image&) = nullptr;
};

/// All of them, in the order of a contact sheet: that of the paper's plates, then what luxel adds.
std::span<const Technique> techniques();
/// nullptr when there is no such technique.
const Technique* find_technique(std::string_view name);
/// "c, ca, ..., all"
std::string technique_names();

}  // namespace luxel::pipeline
