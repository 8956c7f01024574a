#include "apps/view/looking.h"

#include <algorithm>
#include <array>

#include "apps/view/parts.h"

namespace luxel::view_window {
namespace {

constexpr auto kFirstKind = size_t(view::Show::irradiance);
constexpr size_t kKinds = view::kShows.size() - kFirstKind;

constexpr std::array<const char*, kKinds> words_of_kinds() {
  std::array<const char*, kKinds> out{};
  for (size_t i = 0; i < kKinds; ++i) out[i] = view::kShows[kFirstKind + i].words;
  return out;
}
constexpr std::array<const char*, kKinds> kKindWords = words_of_kinds();

/// A line on what is shown; empty where nothing needs to be said.
std::string note_on(const view::Frame& frame, const view::ShownScene& shown,
                    const view::Look& look) {
  if (const auto missing = view::missing_for(frame.show, look, shown.folder.filename().string()))
    return *missing;
  switch (frame.show) {
    case view::Show::charts:
      return fmt::format("{} charts", look.chart_count);
    case view::Show::seams:
      return "orange: the lightmap is cut there";
    case view::Show::overlaps:
      return "red: several surfaces share these texels";
    case view::Show::texels:
      return "squares of 8 texels, chart borders blue\ngreen: moved out of a solid; yellow: "
             "refilled\nblack: inside a solid; magenta: shared\nred: the sides of a seam differ";
    case view::Show::checker:
      return "one square per texel";
    default:
      return "";
  }
}

/// Luminance is in candela per square metre where E is in lux.
void fill_histogram(const view::Histogram& histogram, const std::string& unit, LookPanel& panel) {
  const char* of_radiance = unit == "lux" ? "cd/m^2" : "W/(sr m^2)";
  panel.histogram = histogram.shares;
  panel.white_place = float(-view::kDarkestStop) / float(view::kBrightestStop - view::kDarkestStop);
  panel.histogram_words =
      fmt::format("median {:.3g}, 95 % below {:.3g} {}\n{:.1f} % above white", histogram.median,
                  histogram.p95, of_radiance, 100 * histogram.over);
}

std::vector<LayerLine> lines_of(const view::Layers& layers, const view::Frame& frame) {
  std::vector<LayerLine> out;
  for (const view::LayerLight& layer : layers.layers) {
    LayerLine line{
        layer.name, fmt::format("{} ({:.0f} %)", layer.name, 100 * layer.share), 1, {1, 1, 1}};
    for (const view::LayerSetting& setting : frame.layers)
      if (setting.name == layer.name)
        line = {line.layer,
                line.words,
                setting.dimmer,
                {setting.color.x, setting.color.y, setting.color.z}};
    out.push_back(std::move(line));
  }
  return out;
}

Status make_overlay_of(gpu::Commands& commands, const gpu::Pipeline& shader,
                       const view::ShownScene& shown, Looking& looking) {
  LUXEL_TRY(looking.look, view::look_of(shown));
  LUXEL_TRY(looking.overlay, view::make_overlay(commands, shader, shown.drawn(), shown.lightmaps,
                                                *looking.look, shown.device));
  return {};
}

Status put_layers_of(gpu::Commands& commands, const view::Frame& frame, view::ShownScene& shown,
                     Looking& looking) {
  if (!looking.layers && shown.has_layers) {
    LUXEL_TRY(looking.layers, view::read_layers(shown.folder, shown.lightmaps));
  }
  // A part of the light has taken their place.
  const bool is_covered = frame.light.is_all() && !shown.part.is_all() && !frame.layers.empty();
  if (frame.layers == looking.put && !is_covered) return {};
  const view::Layers none;
  const view::Layers& layers = looking.layers ? *looking.layers : none;
  LUXEL_TRY(std::vector<image::Image> mixed,
            view::mixed_light(layers, frame.layers, shown.lightmaps));
  const uint32_t other = 1 - shown.fade.newest;
  LUXEL_TRY_STATUS(view::put_layers(commands, layers, frame.layers, mixed, other, shown.device));
  shown.fade.newest = other, shown.fade.share = 1;
  looking.put = frame.layers, shown.part = {};
  looking.mixed = {std::move(mixed), shown.lightmaps.of_material};
  return {};
}

}  // namespace

Status prepare_look(gpu::Commands& commands, const gpu::Pipeline& shader, bool needs_layers,
                    view::Frame& frame, view::ShownScene& shown, Looking& looking) {
  Status out;
  if (view::looks_into_bake(frame.show) && shown.has_light && !looking.overlay)
    if (out = make_overlay_of(commands, shader, shown, looking); !out)
      frame.show = view::Show::light_and_colour;
  if (needs_layers || !frame.layers.empty() || frame.layers != looking.put) {
    const Status put = put_layers_of(commands, frame, shown, looking);
    if (!put) frame.layers = looking.put, out = put;
  }
  const Status parts = prepare_parts(commands, frame, shown, looking);
  return out ? parts : out;
}

view::Canvas canvas_of(const view::Shaders& shaders, const view::Painter& painter,
                       const view::DeviceScene& scene, const Looking& looking,
                       const view::Additions* additions) {
  return {shaders,   painter,
          scene,     looking.overlay ? &*looking.overlay : nullptr,
          additions, looking.probes ? &*looking.probes : nullptr};
}

void fill_panel(const view::Frame& frame, const view::ShownScene& shown, const Looking& looking,
                const std::optional<scene::SurfacePoint>& pointed, LookPanel& panel) {
  static constexpr std::array<uint32_t, 0> kNone{};
  static const std::array<uint32_t, 256> colors = view::packed_false_colors();
  panel = {};
  // Light that is not in a lightmap cannot be looked into.
  if (!shown.has_light || !shown.lightmaps.pictures.empty()) panel.kinds = kKindWords;
  panel.kind = view::looks_into_bake(frame.show) ? int(size_t(frame.show) - kFirstKind) : -1;
  panel.colors = kNone;
  panel.channel = int(frame.channel);
  panel.has_layers = shown.has_layers;
  if (looking.layers) panel.layers = lines_of(*looking.layers, frame);
  if (frame.show == view::Show::irradiance) panel.channels = view::kChannels;
  if (frame.beside) {
    panel.beside_modes = view::kBesideModes;
    panel.beside_mode = int(frame.beside->mode);
  }
  if (looking.histogram) fill_histogram(*looking.histogram, shown.read->light_unit, panel);
  const view::Look nothing;
  const view::Look& look = looking.look ? *looking.look : nothing;
  if (looking.look && panel.kind >= 0) panel.note = note_on(frame, shown, look);
  const std::optional<view::Legend> legend = view::legend_of(frame, look);
  panel.has_scale = legend.has_value();
  if (!legend) return;
  panel.colors = colors;
  panel.title = legend->title, panel.unit = legend->unit;
  panel.low = legend->scale.low, panel.high = legend->scale.high;
  panel.is_logarithmic = legend->scale.is_logarithmic;
  const bool is_of_one = !frame.beside || frame.beside->mode == view::BesideMode::split;
  panel.can_scale = is_of_one && frame.show != view::Show::error;
  const auto& lightmaps = looking.mixed.pictures.empty() ? shown.lightmaps : looking.mixed;
  if (!pointed || !is_of_one) return;
  // A part of the light has only pictures while it is baked.
  if (!shown.lit)
    panel.pointed = view::value_at(frame, shown.drawn(), lightmaps, *pointed).value_or(-1);
  else if (shown.part.is_all())
    panel.pointed = view::value_at(frame, *shown.lit, shown.newest, *pointed).value_or(-1);
}

void take_panel(const LookPanel& panel, const LookPanel& before, view::Frame& frame) {
  if (panel.kind != before.kind) frame.show = view::Show(kFirstKind + size_t(panel.kind));
  frame.channel = view::Channel(panel.channel);
  if (frame.beside) frame.beside->mode = view::BesideMode(panel.beside_mode);
  view::ColorScale& scale = frame.show == view::Show::density ? frame.density : frame.irradiance;
  const bool is_changed = panel.low != before.low || panel.high != before.high ||
                          panel.is_logarithmic != before.is_logarithmic;
  if (is_changed) scale = {panel.low, panel.high, panel.is_logarithmic};
  if (panel.asks_for_own_scale) scale = {};
  for (size_t i = 0; i < panel.layers.size() && i < before.layers.size(); ++i) {
    const LayerLine &line = panel.layers[i], &earlier = before.layers[i];
    if (line.dimmer == earlier.dimmer && std::ranges::equal(line.color, earlier.color)) continue;
    view::set_layer({earlier.layer, line.dimmer, {line.color[0], line.color[1], line.color[2]}},
                    frame.layers);
  }
}

}  // namespace luxel::view_window
