// Selection in a hierarchical solution: takes events, and keeps what they select and the facts
// about it. [Hardt96, appendices B.4.6 to B.4.10]
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "luxel/base/worker.h"
#include "luxel/view/hierarchical/curve.h"
#include "luxel/view/hierarchical/selection_shapes.h"
#include "luxel/view/model/events.h"
#include "luxel/view/model/walk.h"

namespace luxel::view {

/// A solution that tools are used on, and how its light is shown.
struct Examined {
  SolutionView view;
  ShownLight shown;
  std::shared_ptr<const void> kept;  ///< lives as long as what the two look at is needed
  uint64_t number = 0;               ///< another one for each solution and way to show it
};

/// The selected element, link, triangle or discontinuity, by numbers of the solution.
struct Selection {
  std::optional<hierarchical::FacePoint> at;  ///< where the element or the triangle was picked
  std::vector<uint32_t> path;                 ///< path_to() that place, if an element is selected
  size_t level = 0;                           ///< in the path
  std::optional<LinkNumber> link;
  uint32_t link_source = 0;  ///< its Link::source
  std::optional<uint32_t> triangle;
  std::optional<DiscontinuityFacts> discontinuity;

  bool has_element() const { return !path.empty(); }
};

/// A graph of light: along a line, and over an element or a triangle where one is selected.
struct Graph {
  Curve curve;
  std::optional<LightSurface> surface;
};

/// Light that probes have found.
struct Probed {
  std::optional<LightProbe> light;
  std::optional<BackprojectionProbe> sources;
  std::optional<Graph> graph;
};

/// Questions to the present solution, to be asked again of the next one.
struct Inquiries {
  /// Until it is answered: a discontinuity of the face near this.
  std::optional<std::pair<hierarchical::FacePoint, Nearness>> discontinuity;
  std::optional<hierarchical::FacePoint> light, sources;
  std::optional<CurveLine> graph;
  bool is_across = false;  ///< the graph, what is selected
};

/// Computes what a request says; that holds all it looks at.
template <class Found>
using Prober = Worker<std::function<Result<Found>(Progress&)>, Found>;

/// The window does not wait for exact light.
struct Probers {
  std::unique_ptr<Prober<DiscontinuityFacts>> discontinuity;
  std::unique_ptr<Prober<LightProbe>> light;
  std::unique_ptr<Prober<BackprojectionProbe>> sources;
  std::unique_ptr<Prober<Graph>> graph;
};
Probers begin_probing();
bool is_busy(const Probers& probers);

/// All of it: tools, what they have found, and threads that compute.
struct SelectionDesk {
  InsideTool tool = InsideTool::none;
  Selection selected;
  Probed probed;
  Inquiries asked;
  std::string said;  ///< why nothing was found; a sentence
  std::array<bool, kGraphCurves.size()> graph_shows{true, true, true};
  float graph_height = 0.3f;    ///< of a graph's largest value in space, over the line's length
  uint64_t solution = 0;        ///< Examined::number that all this is about
  uint64_t changes = 0;         ///< counts up with whatever is to be drawn
  Vec2 pointer{};               ///< [pixels]
  std::optional<Vec2> pressed;  ///< where a button went down, while it is down
  bool drags_graph = false;
  Probers probers = begin_probing();
};

/// True: the event is no longer the walk's. A click uses the tool; with the right button it probes
/// irradiance, and with shift what is seen of sources.
bool handle_selection(const Event& event, const Walk& walk, const Examined& examined,
                      SelectionDesk& desk);
/// Uses a tool.
void use_tool(const ToolUsed& used, const Walk& walk, const Examined& examined,
              SelectionDesk& desk);
/// Selects an element above or below, or another link.
void step_selection(SelectionStep step, const Examined& examined, SelectionDesk& desk);
/// Selects nothing, and forgets what probes have told.
void select_nothing(SelectionDesk& desk);

/// Takes the answers that have come. Another solution is asked again what the last one was, and the
/// selection goes over to it. True: something has changed.
bool follow(const Examined& examined, SelectionDesk& desk);

/// The box around the element, link, triangle or discontinuity; empty: nothing is selected.
Box3 selected_box(const Examined& examined, const SelectionDesk& desk);
/// Lines and areas that show the selection and the results of the probes.
SelectionShapes shapes_of(const Examined& examined, const SelectionDesk& desk);

}  // namespace luxel::view
