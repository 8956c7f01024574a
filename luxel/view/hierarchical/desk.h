// The user's choices while looking into hierarchical radiosity: events in, wishes out. [Hardt96,
// appendix B.3.5, B.4]
#pragma once

#include <array>

#include "luxel/view/draw/shapes.h"
#include "luxel/view/hierarchical/workshop.h"
#include "luxel/view/model/events.h"

namespace luxel::view {

/// Overlays of surfaces, in the order of kOverlays; colours of lines are those of
/// luxel/pipeline/render/overlays.h.
enum class Over : uint8_t {
  mesh,  ///< edges of elements
  links,
  partial_links,  ///< those between which something stands
  discontinuities,
  triangulation,
  samples,
  error,
  reflectance,  ///< surfaces show that, no light
  no_faces,     ///< surfaces are left out
};

/// A name in plays, and words for it.
struct NamedWords {
  const char *name, *words;
};
/// In the order of LightKind.
inline constexpr std::array<NamedWords, 5> kLightKinds{{
    {"flat", "flat: a value per element"},
    {"gouraud", "Gouraud: linear between corners"},
    {"gouraud-disc", "Gouraud along discontinuities"},
    {"interpolant", "quadratic interpolants"},
    {"rayshade", "exact light of each pixel"},
}};
inline constexpr std::array<NamedWords, 9> kOverlays{{
    {"mesh", "element mesh"},
    {"links", "visible links"},
    {"partial-links", "partial links"},
    {"discontinuities", "discontinuities"},
    {"triangulation", "triangulation"},
    {"samples", "sample points"},
    {"error", "error"},
    {"reflectance", "reflectance"},
    {"no-faces", "no faces"},
}};
/// In the order of LightKind, for F1: keys that show it.
inline constexpr std::array<const char*, 5> kLightKindKeys{"4", "5", "6", "7", "8"};
/// In the order of Ask.
inline constexpr std::array<NamedWords, 5> kAsks{{
    {"iterate", "refine links"},
    {"iterate-interpolants", "refine interpolants"},
    {"converge", "all links"},
    {"converge-interpolants", "all interpolants"},
    {"begin", "start over"},
}};

/// A number that a user chooses.
struct NamedNumber {
  const char *name, *words;
  double low, high;
};
/// Numbers that can be set. 0 of the first two and of min-weight: as the solver chooses.
enum class Number : uint8_t {
  eps,
  min_area,
  max_leaf_lines,
  min_weight,
  mesh_depth,
  most_links,
  exposure  ///< instead of that of the first picture; the last, for the panel has its own
};
inline constexpr std::array<NamedNumber, 7> kNumbers{{
    {"eps", "max error [W/m^2]", 0, 1e9},
    {"min-area", "min area [m^2]", 0, 1e9},
    {"max-leaf-lines", "lines per leaf", 0, 1000},
    {"min-weight", "min weight", 0, 1e12},
    {"mesh-depth", "depth of the mesh", 0, 100},
    {"most-links", "links drawn", 0, double(kMostLinks)},
    {"exposure", "exposure [stops]", -40, 40},
}};

/// The user's choices.
struct HierarchicalDesk {
  LightKind kind = LightKind::flat;
  std::array<bool, kOverlays.size()> over{};
  pipeline::HierarchicalSettings settings;
  int mesh_depth = 100;
  size_t most_links = 150;
  std::optional<double> exposure_stops = {};  ///< none: what the first picture asks for
  std::vector<Ask> asked = {};                ///< whoever does it takes it out
  bool asks_to_stop = false;                  ///< and this, which comes first
  uint64_t changes = 0;                       ///< of what is drawn over surfaces

  bool shows(Over what) const { return over[size_t(what)]; }
};

double number_of(const HierarchicalDesk& desk, Number which);
void set_number(Number which, double to, HierarchicalDesk& desk);

/// Acts on an event. True: the event is for the desk.
bool handle_desk(const Event& event, HierarchicalDesk& desk);
/// Errors: events of a play that the desk does not know, numbers out of their range.
Status check_desk(const Play& play, const std::string& name);

/// All that must be made for the choices to be seen.
Wanted wanted_for(const HierarchicalDesk& desk, const std::optional<ExactView>& view);
/// The chosen overlays over the surfaces of a piece.
Shapes shapes_over(const Piece& piece, const HierarchicalDesk& desk);

}  // namespace luxel::view
