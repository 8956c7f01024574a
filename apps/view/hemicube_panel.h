// Panel of hemicube radiosity, with the fields that the user may change. Dear ImGui draws it.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

namespace luxel::view_window {

/// Results of a hemicube of one size at the element that is looked from.
struct SizeLine {
  int pixels = 0;
  float sum_error = 0,
        wrong = 0;  ///< of the row's sum; of factors to wrong triangles; < 0: unknown
  float irradiance = 0;
};

struct HemicubePanel {
  float share = 0;    ///< of the stage
  std::string state;  ///< the stage
  bool can_stop = false, can_go_on = false;
  bool asks_to_stop = false, asks_to_go_on = false;  ///< changed

  std::span<const char* const> techniques;
  int technique = 0;  ///< changed

  bool has_element = false;
  int size = 64;                   ///< changed, in powers of two: pixels along the hemicube's top
  int most_pixels = 1024;          ///< of it
  int faces = 0;                   ///< changed: items, lit, none
  std::vector<std::string> lines;  ///< what is said of the element
  std::vector<float> histogram;    ///< of its row
  std::string unit;                ///< of irradiance
  std::vector<SizeLine> sizes;     ///< by their pixels
};

/// Lays itself out in the window of ImGui that is open.
void lay_out_hemicube(HemicubePanel& panel);

}  // namespace luxel::view_window
