#include "luxel/view/hierarchical/selection.h"

#include <algorithm>

namespace luxel::view {
namespace {

namespace h = luxel::hierarchical;

/// A place in space points at things within this part of the scene's diagonal.
constexpr double kPlaceReach = 0.03;

trace::CameraRays camera_of(const Walk& walk) {
  return {walk.shown.camera, walk.width, walk.height};
}

std::optional<h::FacePoint> point_of(const ToolPlace& at, const Walk& walk,
                                     const Examined& examined) {
  if (const auto* pixel = std::get_if<Vec2>(&at))
    return face_point_seen(examined.view, camera_of(walk), *pixel);
  const h::FacePoint out = h::nearest_face_point(
      examined.view.solution.faces, std::get<DVec3>(at) - examined.view.scene.origin, std::nullopt);
  return out.face == h::kNone ? std::nullopt : std::optional(out);
}

Nearness nearness_of(const ToolPlace& at, const Walk& walk, const Examined& examined) {
  if (const auto* pixel = std::get_if<Vec2>(&at)) return near_pixel(camera_of(walk), *pixel);
  return near_place(std::get<DVec3>(at) - examined.view.scene.origin,
                    kPlaceReach * double(examined.view.solution.diagonal_m));
}

void select_element(const h::FacePoint& at, const Examined& examined, SelectionDesk& desk) {
  desk.selected = {};
  desk.selected.at = at, desk.selected.path = path_to(examined.view, at);
  desk.selected.level = desk.selected.path.size() - 1;
}

void select_triangle(const h::FacePoint& at, const Examined& examined, SelectionDesk& desk) {
  const auto triangle = triangle_at(examined.view, at);
  if (!triangle) {
    desk.said = "what is shown has no triangles: choose a mode that interpolates";
    return;
  }
  desk.selected = {};
  desk.selected.at = at, desk.selected.triangle = triangle;
}

/// The ids whose links light the selected element: its own and those of all that hold it.
std::span<const uint32_t> lit_by(const Selection& selected) {
  return std::span(selected.path).first(selected.level + 1);
}

void set_link(const LinkNumber& link, const Examined& examined, Selection& selected) {
  selected.link = link;
  selected.link_source = examined.view.solution.links.of[link.receiver][link.number].source;
}

/// A link of the selected element; without one the element at the place is selected.
void select_link(const ToolPlace& at, const Walk& walk, const Examined& examined,
                 SelectionDesk& desk) {
  if (desk.selected.has_element()) {
    const auto link =
        link_near(examined.view, lit_by(desk.selected), nearness_of(at, walk, examined));
    if (link) {
      set_link(*link, examined, desk.selected);
      return;
    }
  }
  const auto point = point_of(at, walk, examined);
  if (point) select_element(*point, examined, desk);
  desk.said = "no link is near: the element there is selected, and its links can be";
}

void ask_for_discontinuity(const h::FacePoint& at, const Nearness& nearness,
                           const Examined& examined, SelectionDesk& desk) {
  desk.asked.discontinuity = {at, nearness};
  desk.probers.discontinuity->ask([=](Progress&) -> Result<DiscontinuityFacts> {
    const SolutionView& view = examined.view;
    h::DiscontinuityParams params = view.discontinuity;
    params.least_weight = 0;
    const std::vector<h::Discontinuity> lines =
        h::find_discontinuities(view.solution, view.scene, view.tracer, at.face, params.ranking,
                                h::limits_of(view.solution, params));
    std::vector<double> weight;
    for (const h::Discontinuity& line : lines)
      weight.push_back(h::weight_of(line, view.solution, view.scene));
    const auto found = discontinuity_near(lines, weight, nearness);
    if (!found)
      return fail(ErrorCode::bad_input, "none of the {} discontinuities of {} is near",
                  lines.size(), name_of_face(view, at.face));
    return facts_of(view, at.face, lines[*found]);
  });
}

void ask_for_light(const h::FacePoint& at, const Examined& examined, SelectionDesk& desk) {
  desk.asked.light = at;
  desk.probers.light->ask(
      [=](Progress& progress) { return probe_light(examined.view, at, examined.shown, progress); });
}

void ask_for_sources(const h::FacePoint& at, const Examined& examined, SelectionDesk& desk) {
  constexpr size_t kMostSources = 4;
  desk.asked.sources = at;
  desk.probers.sources->ask(
      [=](Progress& progress) { return probe_sources(examined.view, at, kMostSources, progress); });
}

/// The polygon that a graph in space stands on: of the selected element or triangle.
h::Polygon selected_polygon(const Examined& examined, const Selection& selected) {
  if (selected.triangle) {
    const auto corner = triangle_facts(examined.view, *selected.triangle).corner;
    return {corner.begin(), corner.end()};
  }
  const h::Tree& tree = examined.view.solution.tree;
  if (!selected.has_element() || tree.is_cluster(selected.path[selected.level])) return {};
  const h::PolygonView p = tree.element(selected.path[selected.level]).polygon();
  return {p.begin(), p.end()};
}

void ask_for_graph(const CurveLine& line, const h::Polygon& over, const Examined& examined,
                   SelectionDesk& desk) {
  constexpr size_t kCells = 16;
  desk.asked.graph = line, desk.asked.is_across = !over.empty();
  desk.probers.graph->ask([=](Progress& progress) -> Result<Graph> {
    Graph out;
    LUXEL_TRY(out.curve, curve_along(examined.view, line, examined.shown, {}, progress));
    if (!over.empty()) {
      LUXEL_TRY(out.surface, surface_over(examined.view, over, line.face, kCells, examined.shown,
                                          {.tolerance = 1e-4}, progress));
    }
    return out;
  });
}

/// The line across what is selected; none where nothing is.
std::optional<CurveLine> line_of(const Examined& examined, const Selection& selected) {
  constexpr double kReach = 0.05;  // to both sides of a discontinuity, over the diagonal
  if (selected.discontinuity)
    return line_across(examined.view, selected.discontinuity->receiver,
                       selected.discontinuity->line,
                       kReach * double(examined.view.solution.diagonal_m));
  const h::Polygon polygon = selected_polygon(examined, selected);
  if (polygon.empty()) return std::nullopt;
  return line_across(polygon, selected.at->face);
}

void graph_across(const Examined& examined, SelectionDesk& desk) {
  const auto line = line_of(examined, desk.selected);
  if (line)
    ask_for_graph(*line, selected_polygon(examined, desk.selected), examined, desk);
  else
    desk.said = "a graph needs a selected element, triangle or discontinuity, or a dragged line";
}

void graph_along(const ToolUsed& used, const Walk& walk, const Examined& examined,
                 SelectionDesk& desk) {
  const auto from = point_of(*used.at, walk, examined);
  const auto to = used.to ? point_of(*used.to, walk, examined) : std::nullopt;
  const auto line = from && to ? clipped(examined.view, {from->face, from->position, to->position})
                               : std::nullopt;
  if (line)
    ask_for_graph(*line, {}, examined, desk);
  else
    desk.said = "a graph needs two places of one surface: drag from one to the other";
}

/// The next link by what it brings, of those that light the selected element; after the weakest the
/// strongest. None where there is none.
std::optional<LinkNumber> next_link(const Examined& examined, const Selection& selected) {
  const h::Solution& s = examined.view.solution;
  const h::Exchange x = s.exchange(examined.view.tracer);
  std::vector<std::pair<float, LinkNumber>> links;
  for (const uint32_t id : lit_by(selected))
    for (uint32_t k = 0; k < s.links.of[id].size(); ++k)
      links.push_back({luminance(h::irradiance_of(s.links.of[id][k], x, s.light)), {id, k}});
  if (links.empty()) return std::nullopt;
  std::stable_sort(links.begin(), links.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  const auto is_it = [&](const auto& l) { return selected.link == l.second; };
  const auto now = std::find_if(links.begin(), links.end(), is_it);
  const bool is_last = now == links.end() || now + 1 == links.end();
  return is_last ? links.front().second : (now + 1)->second;
}

/// A link of the same two of another solution; none where it has been divided.
std::optional<LinkNumber> same_link(const LinkNumber& link, uint32_t source,
                                    const h::Links& links) {
  if (link.receiver >= links.of.size()) return std::nullopt;
  const auto& of = links.of[link.receiver];
  const auto same = std::find_if(of.begin(), of.end(),
                                 [&](const h::Link& other) { return other.source == source; });
  if (same == of.end()) return std::nullopt;
  return LinkNumber{link.receiver, uint32_t(same - of.begin())};
}

/// Place, node and link in another solution, as far as it has them.
Selection carried_over(const Selection& from, const Examined& examined) {
  const h::Solution& s = examined.view.solution;
  Selection out;
  if (from.at && from.at->face < s.faces.size()) {
    out.at = from.at;
    if (from.triangle) out.triangle = triangle_at(examined.view, *from.at);
    if (from.has_element()) {
      out.path = path_to(examined.view, *from.at);
      out.level = std::min(from.level, out.path.size() - 1);
      if (from.link) out.link = same_link(*from.link, from.link_source, s.links);
    }
  }
  const auto& d = from.discontinuity;
  if (d && d->receiver < s.faces.size())
    out.discontinuity = facts_of(examined.view, d->receiver, d->line);
  return out;
}

template <class Found>
std::unique_ptr<Prober<Found>> begin_prober() {
  return std::make_unique<Prober<Found>>(
      [](const auto& probe, const auto& hand, Progress& progress) -> Status {
        LUXEL_TRY(Found found, probe(progress));
        hand(std::move(found));
        return {};
      });
}

void forget(Probers& probers) {
  probers.discontinuity->forget(), probers.light->forget();
  probers.sources->forget(), probers.graph->forget();
}

/// Calls keep(found) with what a prober has found. True: there is something to be told.
template <class Found, class Keep>
bool take_from(Prober<Found>& prober, std::string& said, const Keep& keep) {
  std::vector<Result<Found>> come = prober.take();
  for (Result<Found>& found : come) {
    if (found)
      keep(std::move(*found));
    else
      said = found.error().message;
  }
  return !come.empty();
}

bool take_found(SelectionDesk& desk) {
  const Probers& from = desk.probers;
  const bool line = take_from(*from.discontinuity, desk.said, [&](DiscontinuityFacts facts) {
    desk.selected = {}, desk.selected.discontinuity = std::move(facts);
  });
  if (line) desk.asked.discontinuity.reset();
  const bool light = take_from(*from.light, desk.said,
                               [&](LightProbe found) { desk.probed.light = std::move(found); });
  const bool sources = take_from(*from.sources, desk.said, [&](BackprojectionProbe found) {
    desk.probed.sources = std::move(found);
  });
  const bool graph =
      take_from(*from.graph, desk.said, [&](Graph found) { desk.probed.graph = std::move(found); });
  return line || light || sources || graph;
}

}  // namespace

Probers begin_probing() {
  return {begin_prober<DiscontinuityFacts>(), begin_prober<LightProbe>(),
          begin_prober<BackprojectionProbe>(), begin_prober<Graph>()};
}

bool is_busy(const Probers& probers) {
  return probers.discontinuity->is_busy() || probers.light->is_busy() ||
         probers.sources->is_busy() || probers.graph->is_busy();
}

void step_selection(SelectionStep step, const Examined& examined, SelectionDesk& desk) {
  follow(examined, desk);
  Selection& selected = desk.selected;
  ++desk.changes;
  desk.said.clear();
  if (!selected.has_element()) {
    desk.said = "select an element first";
    return;
  }
  if (step != SelectionStep::next) {
    selected.link.reset();
    if (step == SelectionStep::up && selected.level > 0) --selected.level;
    if (step == SelectionStep::down && selected.level + 1 < selected.path.size()) ++selected.level;
    return;
  }
  if (const auto link = next_link(examined, selected))
    set_link(*link, examined, selected);
  else
    desk.said = "no link lights this element";
}

void select_nothing(SelectionDesk& desk) {
  forget(desk.probers);
  desk.selected = {}, desk.probed = {}, desk.asked = {};
  desk.said.clear();
}

void use_tool(const ToolUsed& used, const Walk& walk, const Examined& examined,
              SelectionDesk& desk) {
  follow(examined, desk);
  ++desk.changes;
  desk.said.clear();
  if (used.tool == InsideTool::none) return select_nothing(desk);
  if (used.tool == InsideTool::graph)
    return used.at ? graph_along(used, walk, examined, desk) : graph_across(examined, desk);
  if (used.tool == InsideTool::link) return select_link(*used.at, walk, examined, desk);
  const auto at = point_of(*used.at, walk, examined);
  if (!at) {
    desk.said = "there is no surface";
    return;
  }
  if (used.tool == InsideTool::element) select_element(*at, examined, desk);
  if (used.tool == InsideTool::triangle) select_triangle(*at, examined, desk);
  if (used.tool == InsideTool::discontinuity)
    ask_for_discontinuity(*at, nearness_of(*used.at, walk, examined), examined, desk);
  if (used.tool == InsideTool::irradiance) ask_for_light(*at, examined, desk);
  if (used.tool == InsideTool::backprojection) ask_for_sources(*at, examined, desk);
}

bool follow(const Examined& examined, SelectionDesk& desk) {
  bool has_news = desk.solution != examined.number;
  if (has_news) {
    forget(desk.probers);
    desk.solution = examined.number;
    desk.selected = carried_over(desk.selected, examined);
    const Inquiries asked = desk.asked;
    if (asked.discontinuity)
      ask_for_discontinuity(asked.discontinuity->first, asked.discontinuity->second, examined,
                            desk);
    if (asked.light) ask_for_light(*asked.light, examined, desk);
    if (asked.sources) ask_for_sources(*asked.sources, examined, desk);
    if (asked.graph)
      ask_for_graph(*asked.graph,
                    asked.is_across ? selected_polygon(examined, desk.selected) : h::Polygon{},
                    examined, desk);
  }
  has_news |= take_found(desk);
  desk.changes += has_news;
  return has_news;
}

}  // namespace luxel::view
