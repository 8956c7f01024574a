#include "luxel/view/hierarchical/workshop.h"

#include <deque>
#include <mutex>
#include <variant>

#include "luxel/base/clock.h"
#include "luxel/base/parallel.h"
#include "luxel/base/worker.h"
#include "luxel/pipeline/bake/bake_scene.h"
#include "luxel/pipeline/render/overlays.h"
#include "luxel/solve/hierarchical/represent.h"

namespace luxel::view {
namespace {

namespace h = luxel::hierarchical;

/// So many exact pixels are computed at a time; twice as many when that takes less than kRound_s.
constexpr size_t kFirstPixels = 256;
constexpr double kRound_s = 0.15;
/// So many rounds and steps at most, as solve() and represent() have it.
constexpr int kMostSteps = 24, kMostRounds = 8;

bool is_same_mesh(const h::MeshParams& a, const h::MeshParams& b) {
  const h::DiscontinuityParams &c = a.discontinuity, &d = b.discontinuity;
  return a.discontinuities == b.discontinuities && c.ranking == d.ranking &&
         c.least_weight == d.least_weight && c.max_per_leaf == d.max_per_leaf;
}

bool is_same_view(const std::optional<ExactView>& a, const std::optional<ExactView>& b) {
  return a.has_value() == b.has_value() && (!a || is_same(*a, *b));
}

/// Kinds of work for the thread.
enum class Task : uint8_t { nothing, step, whole, cut, discontinuities, error, exact };

struct Asked {
  Ask what;
  pipeline::HierarchicalSettings settings;
};

class WorkshopThread : public Workshop {
 public:
  explicit WorkshopThread(const pipeline::BakeSettings& settings)
      : settings_(settings), worker_([this](Next, const auto&, Progress& progress) {
          do_next(progress);
          return Status();
        }) {
    const auto& own = settings.own.of<pipeline::HierarchicalSettings>();
    mesh_ = own.mesh;
    ask(Ask::begin, own);
  }

  WorkshopNews take() override {
    const std::scoped_lock lock(mutex_);
    return std::exchange(news_, {});
  }
  void ask(Ask what, const pipeline::HierarchicalSettings& settings) override {
    const std::scoped_lock lock(mutex_);
    if (has_failed_) return;
    asked_.push_back({what, settings});
    if (now_ != Task::step) end_task();
    worker_.ask_next({});
  }
  void interrupt() override {
    const std::scoped_lock lock(mutex_);
    if (!piece_) return;  // without the first there is nothing to see
    asked_.clear();
    if (now_ == Task::step) end_task();
  }
  void want(const Wanted& wanted, const h::MeshParams& mesh) override {
    const std::scoped_lock lock(mutex_);
    const bool is_another_mesh = !is_same_mesh(mesh, mesh_);
    const bool is_another_view = !is_same_view(wanted.exact, wanted_.exact);
    wanted_ = wanted;
    if (is_another_mesh) {
      mesh_ = mesh;
      if (piece_) drop_meshes();
    }
    if (is_another_view) exact_.reset();
    if (is_another_mesh || is_another_view) gives_up_ = false;
    if ((is_another_mesh && now_ != Task::step) || (is_another_view && now_ == Task::exact) ||
        !is_wanted(now_))
      end_task();
    worker_.ask_next({});
  }
  WorkshopState state() const override {
    const std::scoped_lock lock(mutex_);
    if (news_.read || news_.piece || news_.exact || news_.said) return WorkshopState::at_work;
    if (has_failed_) return WorkshopState::failed;
    return now_ != Task::nothing || next() != Task::nothing ? WorkshopState::at_work
                                                            : WorkshopState::at_rest;
  }
  bool is_solving() const override {
    const std::scoped_lock lock(mutex_);
    return now_ == Task::step || !asked_.empty();
  }
  Progress::Snapshot snapshot() const override { return worker_.snapshot(); }

 private:
  // Used by both threads, under the mutex.

  bool is_wanted(Task task) const {
    switch (task) {
      case Task::whole:
        return wanted_.whole;
      case Task::cut:
        return wanted_.cut || wanted_.error;
      case Task::discontinuities:
        return wanted_.discontinuities;
      case Task::error:
        return wanted_.error;
      case Task::exact:
        return wanted_.exact.has_value();
      default:
        return true;
    }
  }
  Task next() const {
    if (!asked_.empty()) return Task::step;
    if (!piece_ || gives_up_) return Task::nothing;
    if (is_wanted(Task::whole) && !piece_->whole) return Task::whole;
    if (is_wanted(Task::cut) && !piece_->cut) return Task::cut;
    if (is_wanted(Task::error) && !piece_->error) return Task::error;
    if (is_wanted(Task::discontinuities) && !piece_->discontinuities) return Task::discontinuities;
    if (is_wanted(Task::exact) && !(exact_ && is_whole(*exact_))) return Task::exact;
    return Task::nothing;
  }
  /// Those that other settings would have made otherwise.
  void drop_meshes() {
    Piece piece = *piece_;
    piece.cut.reset(), piece.error.reset(), piece.discontinuities.reset();
    piece_ = news_.piece = std::make_shared<const Piece>(std::move(piece));
    drops_known_ = true;
  }

  /// Nothing ends that has not begun.
  void end_task() {
    if (now_ != Task::nothing) worker_.stop();
  }

  // The thread's own.

  /// Does what comes next, and asks for what comes after it.
  void do_next(Progress& progress) {
    const ThreadLimit threads(settings_.threads);
    Task task = Task::nothing;
    std::optional<Asked> asked;
    {
      const std::scoped_lock lock(mutex_);
      now_ = task = next();
      if (task == Task::nothing) return;
      if (task == Task::step) asked = asked_.front(), asked_.pop_front();
      from_ = piece_;
      params_ = mesh_;
      if (std::exchange(drops_known_, false)) known_.of_face.clear();
    }
    progress_ = &progress;
    const Status done = tried(task, asked);
    if (!done && done.error().code != ErrorCode::cancelled) has_error(task, done.error().message);
    const std::scoped_lock lock(mutex_);
    now_ = Task::nothing;
    worker_.ask_next({});
  }
  Status tried(Task task, const std::optional<Asked>& asked) try {
    return task == Task::step ? solve(*asked) : make(task);
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::out_of_memory, "out of memory");
  }
  void has_error(Task task, std::string sentence) {
    const std::scoped_lock lock(mutex_);
    news_.said = std::move(sentence);
    has_failed_ = !piece_;
    asked_.clear();
    if (task != Task::step) gives_up_ = true;
  }

  Status read() {
    std::vector<std::string> warnings;
    LUXEL_TRY(scene::Scene scene, pipeline::load_scene(settings_, warnings, *progress_));
    LUXEL_TRY(read_, read_scene(std::move(scene), settings_));
    const std::scoped_lock lock(mutex_);
    news_.read = read_;
    news_.warnings = std::move(warnings);
    return {};
  }
  SolvedScene scene() const { return {read_->scene, *read_->tracer}; }

  Status solve(const Asked& asked) {
    if (!read_) LUXEL_TRY_STATUS(read());
    const bool by_interpolants =
        asked.what == Ask::interpolants || asked.what == Ask::converge_interpolants;
    const SolverStep step = asked.what == Ask::begin ? SolverStep::begin
                            : by_interpolants        ? SolverStep::interpolants
                                                     : SolverStep::links;
    if (asked.what != Ask::converge_links && asked.what != Ask::converge_interpolants)
      return take_step(step, asked.settings).map([](bool) {});
    bool is_settled = false;
    for (int k = 0; !is_settled && k < (by_interpolants ? kMostRounds : kMostSteps); ++k) {
      LUXEL_TRY(is_settled, take_step(step, asked.settings));
    }
    return by_interpolants ? take_step(SolverStep::last, asked.settings).map([](bool) {})
                           : Status();
  }
  /// True: it found nothing to divide.
  Result<bool> take_step(SolverStep step, const pipeline::HierarchicalSettings& settings) {
    const Piece none;
    LUXEL_TRY(Piece made,
              stepped(from_ ? *from_ : none, step, scene(), settings, known_rounds_, *progress_));
    LUXEL_TRY_STATUS(stopped(*progress_));
    const bool is_settled = made.is_settled;
    const float exposure = from_ ? 0 : readable_exposure(made, *read_);
    // Rounds by interpolants keep the light there is.
    if (step != SolverStep::interpolants) known_ = {};
    auto piece = std::make_shared<const Piece>(std::move(made));
    const std::scoped_lock lock(mutex_);
    if (!piece_) {
      const std::vector<std::string>& more = piece->solution().warnings;
      news_.warnings.insert(news_.warnings.end(), more.begin(), more.end());
    }
    if (exposure > 0) news_.exposure = exposure;
    from_ = piece_ = news_.piece = std::move(piece);
    exact_.reset(), news_.exact.reset();
    gives_up_ = false;
    return is_settled;
  }

  Status make(Task task) {
    if (task == Task::exact) return make_exact();
    const SolvedScene in = scene();
    const h::Solution& s = from_->solution();
    Piece made = *from_;
    if (task == Task::discontinuities) {
      LUXEL_TRY(auto found, pipeline::all_discontinuities(s, in.scene, in.tracer,
                                                          params_.discontinuity, *progress_));
      made.discontinuities =
          std::make_shared<const std::vector<h::Discontinuity>>(std::move(found));
    } else if (task == Task::error) {
      LUXEL_TRY(auto error,
                h::measure_error(s, in.scene, in.tracer, params_.point, *made.cut, *progress_));
      made.error = std::make_shared<const std::vector<float>>(std::move(error));
    } else {
      h::MeshParams params = params_;
      if (task == Task::whole) params.discontinuities = false;
      LUXEL_TRY(h::LightMesh mesh,
                h::make_light_mesh(s, in.scene, in.tracer, params, known_, *progress_));
      (task == Task::whole ? made.whole : made.cut) =
          std::make_shared<const h::LightMesh>(std::move(mesh));
    }
    auto piece = std::make_shared<const Piece>(std::move(made));
    const std::scoped_lock lock(mutex_);
    if (progress_->cancelled()) return {};  // by other settings
    piece_ = news_.piece = std::move(piece);
    return {};
  }
  /// A round of pixels.
  Status make_exact() {
    std::shared_ptr<const ExactPicture> known;
    ExactView view;
    {
      const std::scoped_lock lock(mutex_);
      if (!wanted_.exact) return {};
      known = exact_, view = *wanted_.exact;
    }
    ExactPicture picture = known ? *known : begin_exact(*from_, view);
    const Clock::time_point begun = Clock::now();
    LUXEL_TRY_STATUS(add_exact(*from_, scene(), pixels_, picture, *progress_));
    if (seconds_since(begun) < kRound_s) pixels_ *= 2;
    auto made = std::make_shared<const ExactPicture>(std::move(picture));
    const std::scoped_lock lock(mutex_);
    if (progress_->cancelled()) return {};
    exact_ = news_.exact = std::move(made);
    return {};
  }

  struct Next {};  ///< the task that next() tells

  const pipeline::BakeSettings settings_;
  mutable std::mutex mutex_;
  WorkshopNews news_;
  std::deque<Asked> asked_;
  Wanted wanted_;
  h::MeshParams mesh_;
  std::shared_ptr<const Piece> piece_;
  std::shared_ptr<const ExactPicture> exact_;
  Task now_ = Task::nothing;
  bool has_failed_ = false, gives_up_ = false, drops_known_ = false;

  Progress* progress_ = nullptr;  ///< of the task
  std::shared_ptr<const ReadScene> read_;
  std::shared_ptr<const Piece> from_;  ///< what the task begins with
  h::MeshParams params_;               ///< of the task
  h::Known known_;                     ///< by the light of piece_
  KnownRounds known_rounds_;           ///< coarser
  size_t pixels_ = kFirstPixels;
  Worker<Next, std::monostate> worker_;  ///< the last: its thread uses all of the others
};

}  // namespace

std::unique_ptr<Workshop> Workshop::begin(const pipeline::BakeSettings& settings) {
  return std::make_unique<WorkshopThread>(settings);
}

}  // namespace luxel::view
