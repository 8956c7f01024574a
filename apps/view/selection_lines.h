// Tools over a hierarchical solution: what the panel shows of them, and what lies on the device.
#pragma once

#include "apps/view/panel.h"
#include "apps/view/selection_panel.h"
#include "luxel/view/draw/shapes.h"
#include "luxel/view/hierarchical/piece.h"
#include "luxel/view/hierarchical/selection.h"

namespace luxel::view_window {

/// Tools while a window or a picture is made.
struct SelectionSession {
  view::SelectionDesk desk;
  /// The solution that they are used on; null: there is none yet.
  std::optional<view::Examined> examined;
  std::string unit;  ///< of E
  // Sources of `examined`.
  std::shared_ptr<const view::Piece> piece;
  const hierarchical::LightMesh* mesh = nullptr;
  view::LightKind kind = view::LightKind::flat;
  uint64_t number = 0;  ///< of `examined`
};

/// The solution as it is shown by now. True: something has changed.
bool follow_piece(const std::shared_ptr<const view::Piece>& piece,
                  const std::shared_ptr<const view::ReadScene>& read, view::LightKind kind,
                  const hierarchical::DiscontinuityParams& discontinuity,
                  SelectionSession& session);

/// True: the event is no longer the walk's.
bool take_selection(const view::Event& event, const view::Walk& walk, SelectionSession& session);
/// Keys and clicks, for F1.
void add_selection_keys(std::vector<KeyLine>& keys);

SelectionPanel selection_lines(const SelectionSession& session);
/// Applies the user's changes in the panel.
void take_selection_lines(const SelectionPanel& panel, const view::Walk& walk,
                          SelectionSession& session);

/// Shapes to be drawn: what stands before them makes them faint.
std::vector<view::Shapes> drawn_shapes(const SelectionSession& session);

}  // namespace luxel::view_window
