#include "apps/view/bake_lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace luxel::view_window {

BakeLines lines_of(const view::LiveBake& live, const view::ShownScene& shown) {
  BakeLines out;
  const view::LiveState state = live.state();
  const Progress::Snapshot at = live.snapshot();
  out.state = state == view::LiveState::baked    ? "baked"
              : state == view::LiveState::failed ? "no light"
              : state == view::LiveState::paused ? "stopped"
                                                 : at.stage;
  out.share = std::max(0.0f, float(at.share));
  if (state != view::LiveState::baking) out.share = state == view::LiveState::baked ? 1 : 0;
  out.can_stop = state == view::LiveState::baking, out.can_go_on = state == view::LiveState::paused;
  out.can_save = state == view::LiveState::baked;
  if (const std::vector<std::string> notes = live.notes(); !notes.empty()) out.note = notes.back();
  const view::LiveNumbers& known = shown.numbers;
  if (!shown.has_light) return out;
  if (known.kind == view::LiveKind::estimate) out.lines.push_back("shown: an estimate of the edit");
  if (known.kind == view::LiveKind::draft) out.lines.push_back("shown: a coarse draft");
  if (known.kind == view::LiveKind::direct_and_draft)
    out.lines.push_back("shown: direct light, bounces from the draft");
  if (known.kind == view::LiveKind::direct_and_even_rest)
    out.lines.push_back("shown: direct light, bounces spread evenly");
  if (known.kind == view::LiveKind::partly)
    out.lines.push_back(fmt::format("shown: {:.0f} % of the texels' own light", 100 * known.share));
  if (known.kind == view::LiveKind::bake && known.samples > 0)
    out.lines.push_back(fmt::format("{:.0f} rays per texel", known.samples));
  if (known.rays_per_s > 0)
    out.lines.push_back(fmt::format("{:.2f} million rays/s", 1e-6 * known.rays_per_s));
  if (known.error_p95 > 0)
    out.lines.push_back(
        fmt::format("95 % of texels err by less than {:.3g} %", 100 * double(known.error_p95)));
  if (known.error_rms > 0)
    out.lines.push_back(fmt::format("RMS error {:.3g} % of the mean light", 100 * known.error_rms));
  if (state == view::LiveState::baking && at.seconds_left >= 0)
    out.lines.push_back(fmt::format("{:.0f} s left", std::ceil(at.seconds_left)));
  return out;
}

}  // namespace luxel::view_window
