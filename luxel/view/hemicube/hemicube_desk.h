// The user's part in the workshop of hemicube radiosity: events in, technique and element out.
#pragma once

#include <optional>

#include "luxel/view/hemicube/faces_picture.h"
#include "luxel/view/model/walk.h"

namespace luxel::view {

struct HemicubeDesk {
  Technique technique = Technique::radiosity;
  std::optional<uint32_t> element;  ///< of the mesh: the one that is looked from
  int resolution = 64;              ///< of its hemicube: even, 2 to kMostPixels
  Faces faces = Faces::items;
  bool has_report = true;  ///< over the picture, where there is an element
  double pause_at = 2;     ///< LiveHemicube::pause_at
  uint64_t asked = 0;      ///< reports: it grows when another one is wanted

  std::optional<Vec2> pressed_at;  ///< the left button, and nothing was dragged yet
};

/// The largest hemicube that is looked through while a user waits.
inline constexpr int kMostPixels = 1024;

/// Acts on an event. True: it is no longer the walk's. A click, which is a press and a release at
/// the same place, chooses the element nearest to the surface point seen there, or none. `mesh` is
/// null where there is none yet.
bool handle_hemicube(const Event& event, const Walk& walk, const LightMesh* mesh,
                     HemicubeDesk& desk);

/// Errors: an event that is not for this workshop, a number out of range; `name` is the play's.
Status check_hemicube(const Play& play, const std::string& name);

/// LiveHemicube::pause_at() of a play from its beginning on; it may come before there is anything
/// to see.
std::optional<double> first_pause(const Play& play);

/// The mark of the element in the picture; none where it is behind the eye or there is none.
std::optional<Mark> mark_of(const HemicubeDesk& desk, const LightMesh* mesh, const Walk& walk);

/// The nearest size that a hemicube can have.
int hemicube_size(double pixels);

}  // namespace luxel::view
