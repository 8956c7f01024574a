// Hierarchical radiosity that is looked into while it works: a thread owns the solution, does what
// it is asked for, and hands over whole pieces. [Hardt96, appendix B.3.4]
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "luxel/base/progress.h"
#include "luxel/pipeline/settings/settings.h"
#include "luxel/view/hierarchical/exact_picture.h"
#include "luxel/view/hierarchical/piece.h"

namespace luxel::view {

/// Requests to the solver: a step, or steps until none finds anything to divide.
enum class Ask : uint8_t { links, interpolants, converge_links, converge_interpolants, begin };

/// Results to be made of the solution when the solver has nothing else to do.
struct Wanted {
  bool whole = false, cut = false, discontinuities = false, error = false;  ///< see Piece
  std::optional<ExactView> exact = {};  ///< exact light of the pixels of this view
};

/// News since the last take().
struct WorkshopNews {
  std::shared_ptr<const ReadScene> read;  ///< once, first
  float exposure = 0;                     ///< once, with the first piece: readable
  std::shared_ptr<const Piece> piece;     ///< the newest
  std::shared_ptr<const ExactPicture> exact;
  std::vector<std::string> warnings;  ///< of the scene and the first solution
  std::optional<std::string> said;    ///< a sentence
};

enum class WorkshopState : uint8_t { at_rest, at_work, failed };

/// Guards the thread. Its functions are called by one thread and do not wait for the solver, but
/// for the destructor, which ends it within about 0.2 s.
class Workshop {
 public:
  /// Reads settings.scene as `luxel bake` does and begins to solve.
  static std::unique_ptr<Workshop> begin(const pipeline::BakeSettings& settings);
  virtual ~Workshop() = default;

  virtual WorkshopNews take() = 0;
  /// Does this after all that was asked for before, by these settings.
  virtual void ask(Ask what, const pipeline::HierarchicalSettings& settings) = 0;
  /// Ends the step that is under way, as if it had not begun, and forgets what was asked for.
  virtual void interrupt() = 0;
  /// Meshes are made by the mesh settings; the same as before changes nothing.
  virtual void want(const Wanted& wanted, const hierarchical::MeshParams& mesh) = 0;
  /// At work while anything is asked for or wanted that is not done, or done and not taken.
  virtual WorkshopState state() const = 0;
  /// True while anything that was asked for is left to do; wanted results do not count.
  virtual bool is_solving() const = 0;
  virtual Progress::Snapshot snapshot() const = 0;
};

}  // namespace luxel::view
