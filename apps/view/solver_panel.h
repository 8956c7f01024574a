// Panel of a solver that is looked into, and fields that the user may change. Dear ImGui draws it.
#pragma once

#include <string>
#include <vector>

namespace luxel::view_window {

/// A number with a slider.
struct NumberLine {
  std::string words;
  float value = 0;  ///< changed
  float low = 0, high = 1;
  bool is_logarithmic = false, is_whole = false;
};

/// Something that is on or off.
struct SwitchLine {
  std::string words;
  bool is_on = false;  ///< changed
};

struct SolverPanel {
  std::string state;  ///< what it does now
  float share = 0;    ///< of that
  bool is_solving = false;
  std::vector<std::string> lines;  ///< on the solution
  std::vector<std::string> asks;   ///< what it can be asked for
  int asked = -1;                  ///< changed: one of them; -1: none
  bool asks_to_stop = false;       ///< changed
  std::vector<std::string> kinds;  ///< of light
  int kind = 0;                    ///< changed
  std::string note;                ///< on what is shown
  std::vector<SwitchLine> over;    ///< surfaces
  std::vector<NumberLine> numbers;
};

/// Lays itself out in the window of ImGui that is open.
void lay_out_solver(SolverPanel& panel);

}  // namespace luxel::view_window
