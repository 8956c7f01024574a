// Light at one point: how much, how far interpolation is off, which source sends what, and what of
// each source is seen. [Hardt96, section 6.2 and appendices B.4.9 and B.4.10]
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "luxel/base/progress.h"
#include "luxel/base/vec2_double.h"
#include "luxel/view/hierarchical/pick.h"

namespace luxel::view {

/// E at a place of a face [W/m^2], as a picture shows it.
using ShownLight = std::function<Rgb(const hierarchical::FacePoint&)>;

/// Contribution of a face to the light at a point.
struct SourceShare {
  uint32_t face = 0;
  std::string name;        ///< of instance and material
  double form_factor = 0;  ///< of the part that is seen
  double visible = 0;      ///< that over the form factor of the whole
  Rgb irradiance;          ///< [W/m^2]
  double share = 0;        ///< of the luminance of all E
};

/// Light at a point of a face.
struct LightProbe {
  hierarchical::FacePoint at;
  std::string name;       ///< of instance and material
  Rgb exact;              ///< E [W/m^2]
  Rgb interpolated;       ///< E, as it is shown
  double difference = 0;  ///< of luminance, interpolated less exact, over exact; 0 in the dark
  Rgb from_no_face;       ///< the part of E from punctual lights and the background
  std::vector<SourceShare> sources;  ///< the brightest first
};
/// Errors: cancelled.
Result<LightProbe> probe_light(const SolutionView& view, const hierarchical::FacePoint& at,
                               const ShownLight& shown, Progress& progress);

/// A source as a point sees it.
struct SeenSource {
  SourceShare of;
  hierarchical::Polygon outline;               ///< all of the face [m]
  hierarchical::Polygon above;                 ///< what of it the point's horizon leaves
  std::vector<hierarchical::Polygon> visible;  ///< convex pieces of what is seen
  double visible_area = 0;                     ///< over the area of the whole face
  /// Those three in the face's plane [m], seen from the point's side: counter-clockwise.
  std::vector<DVec2> flat_outline, flat_above;
  std::vector<std::vector<DVec2>> flat_visible;
};

/// The backprojection of a point to its brightest sources.
struct BackprojectionProbe {
  hierarchical::FacePoint at;
  std::vector<SeenSource> sources;  ///< the brightest first
  size_t left_out = 0;              ///< others that send light
};
/// `most_sources`: how many are told apart. Errors: cancelled.
Result<BackprojectionProbe> probe_sources(const SolutionView& view,
                                          const hierarchical::FacePoint& at, size_t most_sources,
                                          Progress& progress);

/// Lines for a panel. `unit`: of E; `origin`: of the scene.
std::vector<std::string> lines_of(const LightProbe& probe, const std::string& unit, DVec3 origin);
std::vector<std::string> lines_of(const SeenSource& source, const std::string& unit);

/// The point of a face's front that a probe asks for: on an edge the limit from inside.
hierarchical::Receiver receiver_of(const SolutionView& view, const hierarchical::FacePoint& at);

}  // namespace luxel::view
