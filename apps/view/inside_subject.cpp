// Hierarchical radiosity, looked into.
#include <algorithm>
#include <cmath>

#include "apps/view/selection_lines.h"
#include "apps/view/solver_lines.h"
#include "apps/view/subject.h"
#include "luxel/view/hierarchical/desk.h"
#include "luxel/view/relight/lamp_desk.h"

namespace luxel::view_window {
namespace {

class InsideSubject : public Subject {
 public:
  InsideSubject(std::unique_ptr<view::Workshop> workshop, view::HierarchicalDesk desk,
                view::ShownScene shown)
      : workshop_(std::move(workshop)), desk_(std::move(desk)), shown_(std::move(shown)) {}

  view::ShownScene& shown() override { return shown_; }
  const view::Additions* additions() const override { return &additions_; }

  std::vector<KeyLine> keys() const override {
    std::vector<KeyLine> out;
    for (size_t i = 0; i < view::kLightKinds.size(); ++i)
      out.push_back({view::kLightKindKeys[i], view::kLightKinds[i].words});
    add_selection_keys(out);
    return out;
  }
  Status check(const view::Play& play, const std::string& name) const override {
    LUXEL_TRY_STATUS(view::check_no_lamps(play, name));
    return view::check_desk(play, name);
  }

  Result<Followed> follow(gpu::Commands& commands, std::string& message) override {
    view::WorkshopNews news = workshop_->take();
    Followed out;
    out.has_news = news.read || news.piece || news.exact || news.said;
    if (news.said) message = *news.said;
    shown_.warnings.insert(shown_.warnings.end(), news.warnings.begin(), news.warnings.end());
    if (news.read) {
      view::LiveNews read;
      read.read = std::move(news.read);
      LUXEL_TRY(out.is_another, view::take_news(std::move(read), commands, shown_, message));
    }
    if (news.exposure > 0)
      shown_.fade = {0, 1, news.exposure, news.exposure}, shown_.has_light = true;
    if (news.piece) piece_ = std::move(news.piece);
    if (news.exact) exact_ = std::move(news.exact);
    out.has_news |= follow_selection();
    return out;
  }
  Work work() const override {
    const view::WorkshopState state = workshop_->state();
    if (state == view::WorkshopState::failed) return Work::failed;
    const bool is_at_work =
        state == view::WorkshopState::at_work || view::is_busy(selection_.desk.probers);
    return is_at_work ? Work::at_work : Work::at_rest;
  }

  Box3 selected() const override {
    const auto& examined = selection_.examined;
    return examined ? view::selected_box(*examined, selection_.desk) : Box3();
  }
  bool take(const view::Event& event, const view::Walk& walk) override {
    if (view::handle_desk(event, desk_)) {
      send();
      return true;
    }
    follow_selection();
    return take_selection(event, walk, selection_);
  }
  void obey(view::Command command) override {
    if (command == view::Command::stop_or_go_on) workshop_->interrupt();
  }
  void fill(Panel& panel) const override {
    panel.solver = solver_lines(*workshop_, piece_.get(), exact_.get(), desk_);
    panel.selection = selection_lines(selection_);
  }
  void take(const Panel& panel, const view::Walk* walk) override {
    take_solver_lines(*panel.solver, piece_.get(), desk_);
    if (walk) take_selection_lines(*panel.selection, *walk, selection_);
    send();
  }

  Status prepare(gpu::Commands& commands, const view::Walk& walk, view::Frame& frame) override {
    // Exact light is asked for when the camera has come to rest.
    const view::ExactView view{frame.camera, walk.width, walk.height};
    const bool is_still = last_view_ && view::is_same(*last_view_, view);
    last_view_ = view;
    view_ = is_still ? std::optional(view) : std::nullopt;
    send();
    if (!piece_) return {};
    if (desk_.shows(view::Over::reflectance)) frame.show = view::Show::colour;
    additions_.no_surfaces = desk_.shows(view::Over::no_faces);
    LUXEL_TRY_STATUS(put_light(commands.device()));
    LUXEL_TRY_STATUS(put_exact(commands.device(), view));
    return put_over(commands.device());
  }

 private:
  /// Sends the desk's requests to the workshop, and its exposure to the shown scene.
  void send() {
    if (desk_.exposure_stops && shown_.has_light) {
      const auto exposure = float(std::exp2(*desk_.exposure_stops));
      shown_.fade = {0, 1, exposure, exposure};
    }
    if (std::exchange(desk_.asks_to_stop, false)) workshop_->interrupt();
    for (const view::Ask what : std::exchange(desk_.asked, {}))
      workshop_->ask(what, desk_.settings);
    workshop_->want(view::wanted_for(desk_, view_), desk_.settings.mesh);
  }
  bool follow_selection() {
    return follow_piece(piece_, shown_.read, desk_.kind, desk_.settings.mesh.discontinuity,
                        selection_);
  }
  /// Surfaces by the kind that is chosen, or else flat until that is made.
  Status put_light(const gpu::Device& device) {
    const view::LightKind asked = std::min(desk_.kind, view::LightKind::interpolant);
    const hierarchical::LightMesh* mesh = view::mesh_of(*piece_, asked);
    const view::LightKind kind = mesh ? asked : view::LightKind::flat;
    if (!mesh) mesh = piece_->flat.get();
    if (mesh == put_mesh_ && kind == put_kind_) return {};
    const display::QuadraticMesh drawn = view::drawn_mesh(*piece_, *mesh, kind, shown_.read->scene);
    LUXEL_TRY(additions_.instead, view::put_quadratics(device, drawn, view::faces_of(*mesh)));
    put_mesh_ = mesh, put_kind_ = kind, put_piece_ = piece_;
    return {};
  }
  Status put_exact(const gpu::Device& device, const view::ExactView& view) {
    const bool is_it = desk_.kind == view::LightKind::exact && exact_ &&
                       exact_->piece == piece_->number && view::is_same(exact_->view, view);
    if (!is_it) {
      additions_.exact.reset(), put_exact_.reset();
      return {};
    }
    if (put_exact_ == exact_) return {};
    view::ExactPixels pixels;
    LUXEL_TRY(pixels.pixels,
              gpu::buffer_with(device, std::as_bytes(std::span(exact_->pixels)), "exact light"));
    pixels.width = uint32_t(view.width);
    additions_.exact = std::move(pixels), put_exact_ = exact_;
    return {};
  }
  Status put_over(const gpu::Device& device) {
    const uint64_t changes = desk_.changes + selection_.desk.changes;  // both only grow
    if (put_over_ == piece_ && put_changes_ == changes) return {};
    std::vector<view::Shapes> shapes = drawn_shapes(selection_);
    shapes.insert(shapes.begin(), view::shapes_over(*piece_, desk_));
    additions_.shapes.clear();
    for (const view::Shapes& drawn : shapes) {
      if (drawn.empty()) continue;
      LUXEL_TRY(view::DeviceShapes on_device, view::put_shapes(device, drawn));
      additions_.shapes.push_back(std::move(on_device));
    }
    put_over_ = piece_, put_changes_ = changes;
    return {};
  }

  std::unique_ptr<view::Workshop> workshop_;
  view::HierarchicalDesk desk_;
  SelectionSession selection_;
  view::ShownScene shown_;
  view::Additions additions_;
  std::shared_ptr<const view::Piece> piece_;         ///< null: there is none yet
  std::shared_ptr<const view::ExactPicture> exact_;  ///< the newest, of whatever view
  std::optional<view::ExactView> last_view_, view_;  ///< of the last frame; of a camera at rest
  // Sources of the data that the device has now.
  std::shared_ptr<const view::Piece> put_piece_, put_over_;
  const hierarchical::LightMesh* put_mesh_ = nullptr;  ///< of put_piece_
  view::LightKind put_kind_ = view::LightKind::flat;
  std::shared_ptr<const view::ExactPicture> put_exact_;
  uint64_t put_changes_ = 0;
};

}  // namespace

MakeSubject inside_subject(const pipeline::BakeSettings& settings) {
  auto workshop =
      std::make_shared<std::unique_ptr<view::Workshop>>(view::Workshop::begin(settings));
  view::HierarchicalDesk desk;
  desk.settings = settings.own.of<pipeline::HierarchicalSettings>();
  return [workshop, desk](gpu::Commands& commands) -> Result<std::unique_ptr<Subject>> {
    LUXEL_TRY(view::ShownScene shown, view::nothing_shown(commands));
    return std::make_unique<InsideSubject>(std::move(*workshop), desk, std::move(shown));
  };
}

}  // namespace luxel::view_window
