#include "apps/view/parts.h"

#include <algorithm>

#include "luxel/view/shown/light_part.h"

namespace luxel::view_window {
namespace {

constexpr std::array<const char*, view::kParts.size()> words_of_parts() {
  std::array<const char*, view::kParts.size()> out{};
  for (size_t i = 0; i < out.size(); ++i) out[i] = view::kParts[i].words;
  return out;
}
constexpr std::array<const char*, view::kParts.size()> kPartWords = words_of_parts();

Status prepare_probes(const gpu::Device& device, view::ShownScene& shown, Looking& looking) {
  if (!shown.probes) {
    if (shown.folder.empty())
      return fail(ErrorCode::bad_input,
                  "there are no probes; give --probes 0.5 to get one every half metre when the "
                  "bake is done");
    LUXEL_TRY(view::ProbeBalls balls, view::read_probes(shown.folder, shown.drawn().origin));
    shown.probes = std::make_shared<const view::ProbeBalls>(std::move(balls));
  }
  if (looking.of_probes == shown.probes) return {};
  LUXEL_TRY(looking.probes, view::put_probes(device, *shown.probes));
  looking.of_probes = shown.probes;
  return {};
}

/// The pages that are shown, for the value under the pointer.
Status note_pages(const view::ShownScene& shown, Looking& looking) {
  looking.mixed = {};
  if (shown.part.is_all()) return {};
  LUXEL_TRY(looking.mixed.pictures, view::pages_shown(shown.part, shown));
  looking.mixed.of_material = shown.lightmaps.of_material;
  return {};
}

}  // namespace

Status prepare_parts(gpu::Commands& commands, view::Frame& frame, view::ShownScene& shown,
                     Looking& looking) {
  Status out;
  if (frame.light != shown.part) {
    out = view::show_part(frame.light, commands, shown);
    if (!out)
      frame.light = shown.part;
    else if (!shown.folder.empty())
      out = note_pages(shown, looking);
  }
  if (frame.shows_probes) {
    const Status probes = prepare_probes(commands.device(), shown, looking);
    if (!probes) frame.shows_probes = false, out = probes;
  }
  return out;
}

PartsPanel parts_panel(const view::Frame& frame, const view::ShownScene& shown) {
  PartsPanel out;
  out.has_parts = shown.bounced || !shown.folder.empty();
  out.has_probes = shown.probes || !shown.folder.empty();
  out.shows_probes = frame.shows_probes;
  out.parts = kPartWords;
  out.most_bounces = shown.bounced ? int(shown.bounced->after.size()) - 1 : int(view::kMostBounces);
  const auto* part = std::ranges::find_if(
      view::kParts, [&](const view::PartName& known) { return known.light == frame.light; });
  out.part = part == view::kParts.end() ? -1 : int(part - view::kParts.begin());
  out.bounces = frame.light.most ? int(*frame.light.most) : out.most_bounces;
  out.is_one = frame.light.most && frame.light.fewest == *frame.light.most && out.part < 0;
  out.words = "shown: " + view::words_of(frame.light);
  if (shown.bounced && shown.bounced->is_draft && !frame.light.is_all())
    out.words += "\nbounces are those of the draft";
  if (!frame.layers.empty() && !frame.light.is_all()) out.words += "\nlayers are as baked";
  return out;
}

void take_parts(const PartsPanel& panel, const PartsPanel& before, view::Frame& frame) {
  frame.shows_probes = panel.shows_probes;
  const bool is_changed =
      panel.part != before.part || panel.bounces != before.bounces || panel.is_one != before.is_one;
  if (!is_changed) return;
  const auto most = uint32_t(panel.bounces);
  frame.light = panel.part >= 0 ? view::kParts[size_t(panel.part)].light
                                : view::LightShown{panel.is_one ? most : 0, most};
}

}  // namespace luxel::view_window
