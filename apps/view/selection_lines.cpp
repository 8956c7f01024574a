#include "apps/view/selection_lines.h"

namespace luxel::view_window {
namespace {

constexpr float kFaint = 0.25f;

/// Light as it is drawn: flat until there is the mesh of the kind.
view::ShownLight shown_light(const view::SolutionView& view, view::LightKind kind) {
  if (!view.mesh || kind == view::LightKind::flat) return view::light_of_leaves(view);
  return kind == view::LightKind::interpolant || kind == view::LightKind::exact
             ? view::quadratic_light(view)
             : view::linear_light(view);
}

std::vector<std::string> selected_lines(const SelectionSession& s) {
  const view::Selection& selected = s.desk.selected;
  if (!s.examined) return {};
  const DVec3 origin = s.examined->view.scene.origin;
  if (selected.link) return lines_of(facts_of(s.examined->view, *selected.link), s.unit);
  if (selected.has_element())
    return lines_of(facts_of(s.examined->view, selected.path, selected.level), s.unit);
  if (selected.triangle)
    return lines_of(view::triangle_facts(s.examined->view, *selected.triangle), s.unit, origin);
  if (selected.discontinuity) return lines_of(*selected.discontinuity, s.unit, origin);
  return {};
}

CurvePlot plot_of(const view::Graph& graph, const std::string& unit) {
  CurvePlot out;
  out.at_m = graph.curve.at_m, out.unit = unit;
  for (const Rgb& e : graph.curve.exact) out.exact.push_back(luminance(e));
  for (const Rgb& e : graph.curve.shown) out.shown.push_back(luminance(e));
  out.lines = lines_of(graph.curve, unit);
  if (graph.surface)
    out.lines.push_back(fmt::format("overall: RMS {:.3g} {}, largest {:.3g}", graph.surface->rms,
                                    unit, graph.surface->most));
  return out;
}

FlatPolygon flat_of(const std::vector<DVec2>& polygon) {
  FlatPolygon out;
  for (const DVec2& p : polygon) out.push_back({float(p.x), float(p.y)});
  return out;
}

SourcePicture picture_of(const view::SeenSource& source, const std::string& unit) {
  SourcePicture out;
  out.outline = flat_of(source.flat_outline), out.above = flat_of(source.flat_above);
  for (const auto& part : source.flat_visible) out.visible.push_back(flat_of(part));
  out.lines = lines_of(source, unit);
  return out;
}

void add_shapes(const view::SelectionShapes& from, float opacity, view::Shapes& out) {
  for (const view::Area& area : from.areas)
    for (const Vec3& corner : area.corner)
      out.triangles.push_back({corner, area.color, opacity * area.opacity});
  view::add_lines(from.lines, opacity, out);
}

}  // namespace

bool follow_piece(const std::shared_ptr<const view::Piece>& piece,
                  const std::shared_ptr<const view::ReadScene>& read, view::LightKind kind,
                  const hierarchical::DiscontinuityParams& discontinuity, SelectionSession& s) {
  if (!piece || !read) return false;
  const hierarchical::LightMesh* mesh =
      view::mesh_of(*piece, std::min(kind, view::LightKind::interpolant));
  if (kind == view::LightKind::flat) mesh = piece->cut ? piece->cut.get() : piece->whole.get();
  if (s.piece != piece || s.mesh != mesh || s.kind != kind || !s.examined) {
    s.piece = piece, s.mesh = mesh, s.kind = kind, s.unit = read->light_unit;
    const view::SolutionView view{read->scene, *read->tracer, piece->solution(), mesh,
                                  discontinuity};
    s.examined.emplace(view::Examined{
        view, shown_light(view, kind),
        std::make_shared<std::pair<decltype(piece), decltype(read)>>(piece, read), ++s.number});
  }
  return view::follow(*s.examined, s.desk);
}

bool take_selection(const view::Event& event, const view::Walk& walk, SelectionSession& s) {
  if (s.examined) return view::handle_selection(event, walk, *s.examined, s.desk);
  if (!std::holds_alternative<view::ToolUsed>(event)) return false;
  s.desk.said = "there is no solution yet";
  return true;
}

void add_selection_keys(std::vector<KeyLine>& keys) {
  keys.push_back({"right click", "probe irradiance"});
  keys.push_back({"shift + right click", "probe which part of each source is seen"});
  for (const view::KeyHelp& key : view::kSelectionKeys) keys.push_back({key.key, key.does});
}

SelectionPanel selection_lines(const SelectionSession& s) {
  const view::SelectionDesk& desk = s.desk;
  SelectionPanel out;
  for (const view::InsideToolName& tool : view::kInsideTools) out.tools.push_back(tool.words);
  out.tool = int(desk.tool), out.graph_height = desk.graph_height;
  out.graph_shows = desk.graph_shows;
  out.selected = selected_lines(s), out.can_step = desk.selected.has_element();
  if (desk.probed.graph) out.curve = plot_of(*desk.probed.graph, s.unit);
  if (desk.probed.light)
    out.light = lines_of(*desk.probed.light, s.unit, s.examined->view.scene.origin);
  if (desk.probed.sources) {
    for (const view::SeenSource& source : desk.probed.sources->sources)
      out.sources.push_back(picture_of(source, s.unit));
    if (desk.probed.sources->left_out > 0)
      out.left_out = fmt::format("{} dimmer sources are left out", desk.probed.sources->left_out);
  }
  out.said = view::is_busy(desk.probers) ? "exact light is being computed" : desk.said;
  return out;
}

void take_selection_lines(const SelectionPanel& panel, const view::Walk& walk,
                          SelectionSession& s) {
  view::SelectionDesk& desk = s.desk;
  desk.tool = view::InsideTool(panel.tool);
  if (panel.graph_height != desk.graph_height || panel.graph_shows != desk.graph_shows)
    desk.graph_height = panel.graph_height, desk.graph_shows = panel.graph_shows, ++desk.changes;
  if (!s.examined) return;
  if (panel.asks_for_graph)
    view::use_tool({view::InsideTool::graph, std::nullopt, std::nullopt}, walk, *s.examined, desk);
  if (panel.asks_for_nothing)
    view::use_tool({view::InsideTool::none, std::nullopt, std::nullopt}, walk, *s.examined, desk);
  if (panel.step >= 0) view::step_selection(view::SelectionStep(panel.step), *s.examined, desk);
}

std::vector<view::Shapes> drawn_shapes(const SelectionSession& s) {
  std::vector<view::Shapes> out;
  if (!s.examined) return out;
  const view::SelectionShapes shapes = view::shapes_of(*s.examined, s.desk);
  for (const bool is_hidden : {false, true}) {
    view::Shapes drawn;
    drawn.is_hidden = is_hidden, drawn.line_width = is_hidden ? 1.5f : 1.2f;
    add_shapes(shapes, is_hidden ? 1 : kFaint, drawn);
    if (!drawn.empty()) out.push_back(std::move(drawn));
  }
  return out;
}

}  // namespace luxel::view_window
