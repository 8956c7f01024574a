#include "apps/view/solver_lines.h"

#include <fmt/format.h>

#include <algorithm>

namespace luxel::view_window {
namespace {

namespace h = luxel::hierarchical;

/// So many numbers from the left end of a slider to its right one, by its logarithm.
constexpr double kLeastPart = 1e-4, kLeastAreaPart = 1.0 / (1 << 22), kWeightSpan = 100;
constexpr float kMostLines = 40;

double mean_of(const h::Solution& s) {
  return std::max(1e-9, double(max_component(h::totals_of(s).irradiance)));
}

/// A number of the desk as the panel shows it: where the solver chooses, what it has chosen.
NumberLine number_line(view::Number which, const view::Piece& piece,
                       const view::HierarchicalDesk& desk) {
  const h::Solution& s = piece.solution();
  NumberLine out;
  out.words = view::kNumbers[size_t(which)].words;
  double value = view::number_of(desk, which), low = 0, high = 1;
  switch (which) {
    case view::Number::eps:
      if (!(value > 0)) value = s.eps;
      low = kLeastPart * mean_of(s), high = mean_of(s), out.is_logarithmic = true;
      break;
    case view::Number::min_area:
      if (!(value > 0)) value = s.min_area_m2;
      low = kLeastAreaPart * h::totals_of(s).area_m2, high = 0.01 * h::totals_of(s).area_m2;
      out.is_logarithmic = true;
      break;
    case view::Number::max_leaf_lines:
      high = kMostLines, out.is_whole = true;
      break;
    case view::Number::min_weight: {
      h::DiscontinuityParams own = desk.settings.mesh.discontinuity;
      own.least_weight.reset();
      const double usual = std::max(1e-12, h::limits_of(s, own).weight);
      if (!(value > 0)) value = usual;
      low = usual / kWeightSpan, high = usual * kWeightSpan, out.is_logarithmic = true;
      break;
    }
    case view::Number::mesh_depth:
      high = view::depth_of(s.tree), out.is_whole = true;
      value = std::min(value, high);
      break;
    case view::Number::exposure:
      break;
    case view::Number::most_links:
      high = double(view::kMostLinks), out.is_whole = out.is_logarithmic = true;
      break;
  }
  out.value = float(value), out.low = float(low), out.high = float(high);
  return out;
}

void add_solution(const view::Piece& piece, SolverPanel& out) {
  const h::Solution& s = piece.solution();
  const auto leaves = std::ranges::count_if(s.tree.elements, &h::Element::is_leaf);
  out.lines.push_back(
      fmt::format("{} leaves, {} links, eps {:.3g} W/m^2", leaves, s.links.count, s.eps));
  const h::Totals totals = h::totals_of(s);
  out.lines.push_back(fmt::format("mean light {:.4g} W/m^2, {} iterations",
                                  luminance(totals.irradiance), s.iterations));
  if (piece.cut)
    out.lines.push_back(fmt::format("{} triangles, {} lines, {} samples",
                                    piece.cut->triangles.size(), piece.cut->lines,
                                    piece.cut->samples));
  if (piece.is_settled) out.lines.push_back("the last step had nothing to subdivide");
}

std::string note_on(const view::Piece& piece, const view::ExactPicture* exact,
                    const view::HierarchicalDesk& desk) {
  if (!view::mesh_of(piece, desk.kind)) return "flat until this is computed";
  if (desk.kind != view::LightKind::exact) return "";
  const double share = !exact || exact->piece != piece.number || exact->pixels.empty()
                           ? 0
                           : double(exact->done) / double(exact->pixels.size());
  return fmt::format("{:.0f} % of the pixels are exact", 100 * share);
}

}  // namespace

SolverPanel solver_lines(const view::Workshop& workshop, const view::Piece* piece,
                         const view::ExactPicture* exact, const view::HierarchicalDesk& desk) {
  SolverPanel out;
  const view::WorkshopState state = workshop.state();
  const Progress::Snapshot at = workshop.snapshot();
  out.is_solving = workshop.is_solving();
  out.state = state == view::WorkshopState::failed    ? "no light"
              : state == view::WorkshopState::at_rest ? "idle"
                                                      : at.stage;
  if (at.total > 0 && state == view::WorkshopState::at_work)
    out.share = float(double(at.done) / double(at.total));
  for (const view::NamedWords& ask : view::kAsks) out.asks.push_back(ask.words);
  for (const view::NamedWords& kind : view::kLightKinds) out.kinds.push_back(kind.words);
  out.kind = int(desk.kind);
  for (size_t i = 0; i < view::kOverlays.size(); ++i)
    out.over.push_back({view::kOverlays[i].words, desk.over[i]});
  if (!piece) return out;
  add_solution(*piece, out);
  out.note = note_on(*piece, exact, desk);
  for (size_t i = 0; i < size_t(view::Number::exposure); ++i)
    out.numbers.push_back(number_line(view::Number(i), *piece, desk));
  return out;
}

void take_solver_lines(const SolverPanel& panel, const view::Piece* piece,
                       view::HierarchicalDesk& desk) {
  if (panel.asked >= 0) desk.asked.push_back(view::Ask(panel.asked));
  if (panel.asks_to_stop) desk.asks_to_stop = true;
  desk.kind = view::LightKind(panel.kind);
  for (size_t i = 0; i < panel.over.size(); ++i)
    if (panel.over[i].is_on != desk.over[i]) desk.over[i] = panel.over[i].is_on, ++desk.changes;
  if (!piece) return;
  for (size_t i = 0; i < panel.numbers.size(); ++i) {
    const auto which = view::Number(i);
    if (panel.numbers[i].value != number_line(which, *piece, desk).value)
      view::set_number(which, double(panel.numbers[i].value), desk);
  }
}

}  // namespace luxel::view_window
