// An element's hemicube, unfolded, and its row of form factors, as pictures.
#pragma once

#include "luxel/display/tone_map.h"
#include "luxel/image/codec.h"
#include "luxel/view/hemicube/vertex_report.h"

namespace luxel::view {

/// Content of the faces.
enum class Faces : uint8_t {
  items,  ///< the triangles of the mesh, each in its colour (item_color)
  lit,    ///< the light that arrives from them
};
inline constexpr std::array<const char*, 2> kFaces{"items", "lit"};

/// Where a pixel of a hemicube lies in the cross of its five faces, which is 2 resolution wide and
/// high: the top in the middle, each side where it hangs together with it. The number of the pixel
/// is that of viewfactor::Hemicube.
struct CrossPlace {
  int x = 0, y = 0;
};
CrossPlace place_in_cross(int resolution, size_t pixel);

/// Settings of a picture of the faces.
struct FacesLook {
  Faces faces = Faces::items;
  float exposure = 1;
  display::ToneMap curve = display::ToneMap::shoulder;
};
/// The cross, one pixel for each of the hemicube: 4 channels, transparent around it. Backs of
/// one-sided surfaces and what is below the element are black; the surroundings are light grey
/// among items.
image::Image8 faces_picture(const LightMesh& mesh, const VertexReport& report,
                            const FacesLook& look);

/// The cross in a square of so many pixels, under it the row's numbers and its histogram, for which
/// the picture may be wider. `unit`: of E. 4 channels.
image::Image8 report_picture(const LightMesh& mesh, const VertexReport& report,
                             const FacesLook& look, int side, const std::string& unit);

/// A report in words: lines of up to 40 letters.
std::vector<std::string> lines_of(const VertexReport& report, const std::string& unit);

}  // namespace luxel::view
