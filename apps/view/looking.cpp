#include "apps/view/looking.h"

#include <algorithm>
#include <array>

#include "luxel/image/false_color.h"

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

std::array<uint32_t, 256> legend_colors() {
  std::array<uint32_t, 256> out{};
  for (size_t i = 0; i < out.size(); ++i) {
    const image::Color8 c = image::false_color(double(i) / 255);
    out[i] = uint32_t(c[0]) | uint32_t(c[1]) << 8 | uint32_t(c[2]) << 16;
  }
  return out;
}

/// A line on what is shown; empty where nothing needs to be said.
std::string note_on(const view::Frame& frame, const view::OpenedBake& bake,
                    const view::Look& look) {
  if (const auto missing = view::missing_for(frame.show, look, bake.folder.filename().string()))
    return *missing;
  switch (frame.show) {
    case view::Show::charts:
      return fmt::format("{} charts", look.chart_count);
    case view::Show::seams:
      return "orange: the lightmap is cut there";
    case view::Show::overlaps:
      return "red: several surfaces share these texels";
    case view::Show::texels:
      return "squares of 8 texels, borders of charts blue\n"
             "green: moved out of a solid; yellow: refilled\n"
             "black: inside a solid; magenta: shared\n"
             "red: the sides of a seam differ";
    case view::Show::checker:
      return "a square for each texel";
    default:
      return "";
  }
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

}  // namespace

void prepare_look(const view::OpenedBake& bake, gpu::Commands& commands,
                  const view::Shaders& shaders, const view::DeviceScene& scene, view::Frame& frame,
                  Looking& looking, std::string& message) {
  if (looking.overlay || !view::looks_into_bake(frame.show)) return;
  const auto prepared = [&]() -> Status {
    LUXEL_TRY(looking.look, view::look_into(bake.folder, bake.scene, bake.lightmaps));
    LUXEL_TRY(looking.overlay, view::make_overlay(commands, shaders.overlay, bake.scene,
                                                  bake.lightmaps, *looking.look, scene));
    return {};
  }();
  if (prepared) return;
  message = prepared.error().message;
  frame.show = view::Show::light_and_colour;
}

void prepare_layers(const view::OpenedBake& bake, gpu::Commands& commands, bool is_asked_for,
                    view::Frame& frame, view::DeviceScene& scene, Looking& looking,
                    std::string& message) {
  const auto prepared = [&]() -> Status {
    const bool is_other = frame.layers != looking.put;
    if ((is_other || is_asked_for) && !looking.layers) {
      LUXEL_TRY(looking.layers, view::read_layers(bake.folder, bake.lightmaps));
    }
    if (!is_other) return {};
    LUXEL_TRY(std::vector<image::Image> mixed,
              view::mixed_light(*looking.layers, frame.layers, bake.lightmaps));
    LUXEL_TRY_STATUS(view::put_layers(commands, *looking.layers, frame.layers, mixed, scene));
    looking.put = frame.layers;
    looking.mixed = {std::move(mixed), bake.lightmaps.of_material};
    return {};
  }();
  if (prepared) return;
  message = prepared.error().message;
  frame.layers = looking.put;
}

void fill_panel(const view::Frame& frame, const view::OpenedBake& bake, const Looking& looking,
                const std::optional<scene::SurfacePoint>& pointed, LookPanel& panel) {
  static constexpr std::array<uint32_t, 0> kNone{};
  static const std::array<uint32_t, 256> colors = legend_colors();
  panel = {};
  panel.kinds = kKindWords;
  panel.kind = view::looks_into_bake(frame.show) ? int(size_t(frame.show) - kFirstKind) : -1;
  panel.colors = kNone;
  panel.channel = int(frame.channel);
  panel.has_layers = bake.has_layers;
  if (looking.layers) panel.layers = lines_of(*looking.layers, frame);
  if (frame.show == view::Show::irradiance) panel.channels = view::kChannels;
  if (!looking.look || panel.kind < 0) return;
  panel.note = note_on(frame, bake, *looking.look);
  const std::optional<view::Legend> legend = view::legend_of(frame, *looking.look);
  panel.has_scale = legend.has_value();
  if (!legend) return;
  panel.colors = colors;
  panel.title = legend->title, panel.unit = legend->unit;
  panel.low = legend->scale.low, panel.high = legend->scale.high;
  panel.is_logarithmic = legend->scale.is_logarithmic;
  panel.can_scale = frame.show != view::Show::error;
  const auto& lightmaps = looking.mixed.pictures.empty() ? bake.lightmaps : looking.mixed;
  if (pointed) panel.pointed = view::value_at(frame, bake.scene, lightmaps, *pointed).value_or(-1);
}

void take_panel(const LookPanel& panel, const LookPanel& before, view::Frame& frame) {
  if (panel.kind != before.kind) frame.show = view::Show(kFirstKind + size_t(panel.kind));
  frame.channel = view::Channel(panel.channel);
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
