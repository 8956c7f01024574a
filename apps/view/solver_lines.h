// The panel's lines about hierarchical radiosity.
#pragma once

#include "apps/view/solver_panel.h"
#include "luxel/view/hierarchical/desk.h"

namespace luxel::view_window {

/// `piece` is null before there is one, `exact` while no pixel is exact.
SolverPanel solver_lines(const view::Workshop& workshop, const view::Piece* piece,
                         const view::ExactPicture* exact, const view::HierarchicalDesk& desk);
/// Applies the user's changes in the panel.
void take_solver_lines(const SolverPanel& panel, const view::Piece* piece,
                       view::HierarchicalDesk& desk);

}  // namespace luxel::view_window
