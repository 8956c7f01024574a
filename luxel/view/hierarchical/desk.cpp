#include "luxel/view/hierarchical/desk.h"

#include <algorithm>
#include <optional>

namespace luxel::view {
namespace {

constexpr float kManyLines = 0.6f;  ///< opacity where lines are many
constexpr Rgb kBareLine{0.7f, 0.7f, 0.7f};

template <class Names>
std::optional<size_t> place_of(const std::string& name, const Names& names) {
  for (size_t i = 0; i < names.size(); ++i)
    if (name == names[i].name) return i;
  return std::nullopt;
}

template <class Names>
std::string all_of(const Names& names) {
  std::string out;
  for (const auto& known : names) out += (out.empty() ? "" : ", ") + std::string(known.name);
  return out;
}

template <class Names>
Status check_name(const std::string& given, const Names& names, const char* what,
                  const std::string& where) {
  if (place_of(given, names)) return {};
  return fail(ErrorCode::bad_input, "{}: {} '{}' is not known; choose from: {}", where, what, given,
              all_of(names));
}

Status check_setting(const SettingChanged& changed, const std::string& where) {
  LUXEL_TRY_STATUS(check_name(changed.name, kNumbers, "the number", where));
  const NamedNumber& known = kNumbers[*place_of(changed.name, kNumbers)];
  if (changed.to >= known.low && changed.to <= known.high) return {};
  return fail(ErrorCode::bad_input, "{}: {} is from {} to {}, not {}", where, known.name, known.low,
              known.high, changed.to);
}

bool press_desk(const std::string& key, HierarchicalDesk& desk) {
  for (size_t i = 0; i < kLightKindKeys.size(); ++i)
    if (key == kLightKindKeys[i]) return desk.kind = LightKind(i), true;
  return key == "9";  // a bake's, which there is not
}

/// Grey, as light as is seen over surfaces, or without them.
std::vector<display::Line> mesh_over(const hierarchical::Solution& s,
                                     const HierarchicalDesk& desk) {
  std::vector<display::Line> out = pipeline::mesh_lines(s, desk.mesh_depth);
  if (desk.shows(Over::no_faces))
    for (display::Line& line : out) line.color = kBareLine;
  return out;
}

/// The first links of a list.
std::vector<display::Line> first_links(const Piece& piece,
                                       const std::vector<pipeline::StrongLink>& links,
                                       size_t most) {
  return pipeline::link_lines(piece.solution(),
                              std::span(links).first(std::min(most, links.size())));
}

}  // namespace

double number_of(const HierarchicalDesk& desk, Number which) {
  const hierarchical::SolveParams& solve = desk.settings.solve;
  const hierarchical::DiscontinuityParams& lines = desk.settings.mesh.discontinuity;
  switch (which) {
    case Number::eps:
      return solve.eps.value_or(0);
    case Number::min_area:
      return solve.min_area_m2;
    case Number::max_leaf_lines:
      return double(lines.max_per_leaf);
    case Number::min_weight:
      return lines.least_weight.value_or(0);
    case Number::mesh_depth:
      return desk.mesh_depth;
    case Number::exposure:
      return desk.exposure_stops.value_or(0);
    case Number::most_links:
      break;
  }
  return double(desk.most_links);
}

void set_number(Number which, double to, HierarchicalDesk& desk) {
  hierarchical::SolveParams& solve = desk.settings.solve;
  hierarchical::DiscontinuityParams& lines = desk.settings.mesh.discontinuity;
  const std::optional<double> chosen = to > 0 ? std::optional(to) : std::nullopt;
  switch (which) {
    case Number::eps:
      solve.eps = chosen;
      break;
    case Number::min_area:
      solve.min_area_m2 = to;
      break;
    case Number::max_leaf_lines:
      lines.max_per_leaf = uint32_t(to);
      break;
    case Number::min_weight:
      lines.least_weight = chosen;
      break;
    case Number::mesh_depth:
      desk.mesh_depth = int(to);
      break;
    case Number::most_links:
      desk.most_links = size_t(to);
      break;
    case Number::exposure:
      desk.exposure_stops = to;
      break;
  }
  ++desk.changes;
}

bool handle_desk(const Event& event, HierarchicalDesk& desk) {
  if (const auto* shown = std::get_if<OwnShown>(&event)) {
    if (const auto kind = place_of(shown->name, kLightKinds)) desk.kind = LightKind(*kind);
    return true;
  }
  if (const auto* changed = std::get_if<OverlayChanged>(&event)) {
    if (const auto over = place_of(changed->name, kOverlays))
      desk.over[*over] = changed->is_on, ++desk.changes;
    return true;
  }
  if (const auto* changed = std::get_if<SettingChanged>(&event)) {
    if (const auto which = place_of(changed->name, kNumbers))
      set_number(Number(*which), changed->to, desk);
    return true;
  }
  if (const auto* asked = std::get_if<OwnAsked>(&event)) {
    if (asked->name == kStopAsk) desk.asks_to_stop = true, desk.asked.clear();
    if (const auto what = place_of(asked->name, kAsks)) desk.asked.push_back(Ask(*what));
    return true;
  }
  const auto* key = std::get_if<KeyChanged>(&event);
  return key && key->is_down && press_desk(key->key, desk);
}

Status check_desk(const Play& play, const std::string& name) {
  for (const TimedEvent& timed : play.events) {
    const std::string where = fmt::format("{}, at {} s", name, timed.at_s);
    if (const auto* shown = std::get_if<OwnShown>(&timed.event))
      LUXEL_TRY_STATUS(check_name(shown->name, kLightKinds, "what is shown,", where));
    if (const auto* changed = std::get_if<OverlayChanged>(&timed.event))
      LUXEL_TRY_STATUS(check_name(changed->name, kOverlays, "the overlay", where));
    if (const auto* changed = std::get_if<SettingChanged>(&timed.event))
      LUXEL_TRY_STATUS(check_setting(*changed, where));
    if (const auto* asked = std::get_if<OwnAsked>(&timed.event); asked && asked->name != kStopAsk)
      LUXEL_TRY_STATUS(check_name(asked->name, kAsks, "what is asked for,", where));
    if (const auto* shown = std::get_if<ShowChanged>(&timed.event);
        shown && looks_into_bake(shown->show))
      return fail(ErrorCode::bad_input, "{}: inside a solver there is no bake to look into", where);
  }
  return {};
}

Wanted wanted_for(const HierarchicalDesk& desk, const std::optional<ExactView>& view) {
  Wanted out;
  out.whole = desk.kind == LightKind::gouraud;
  out.cut = desk.kind > LightKind::gouraud || desk.shows(Over::triangulation) ||
            desk.shows(Over::samples) || desk.shows(Over::error);
  out.discontinuities = desk.shows(Over::discontinuities);
  out.error = desk.shows(Over::error);
  if (desk.kind == LightKind::exact) out.exact = view;
  return out;
}

Shapes shapes_over(const Piece& piece, const HierarchicalDesk& desk) {
  Shapes out;
  const hierarchical::Solution& s = piece.solution();
  if (desk.shows(Over::mesh)) add_lines(mesh_over(s, desk), 1, out);
  if (desk.shows(Over::discontinuities) && piece.discontinuities)
    add_lines(pipeline::discontinuity_lines(*piece.discontinuities), 1, out);
  if (piece.cut) {
    if (desk.shows(Over::triangulation))
      add_lines(pipeline::triangulation_lines(*piece.cut), 1, out);
    if (desk.shows(Over::samples)) add_lines(pipeline::sample_lines(s, *piece.cut), 1, out);
    if (desk.shows(Over::error) && piece.error)
      add_lines(pipeline::error_lines(s, *piece.cut, *piece.error), 1, out);
  }
  if (desk.shows(Over::links))
    add_lines(first_links(piece, *piece.whole_links, desk.most_links), kManyLines, out);
  if (desk.shows(Over::partial_links))
    add_lines(first_links(piece, *piece.partial_links, desk.most_links), kManyLines, out);
  return out;
}

}  // namespace luxel::view
