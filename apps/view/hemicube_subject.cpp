// Hemicube radiosity while it is made, and techniques of local illumination to hold it against.
#include <algorithm>
#include <cmath>

#include "apps/view/subject.h"
#include "luxel/display/normals_view.h"
#include "luxel/view/hemicube/hemicube_desk.h"

namespace luxel::view_window {
namespace {

/// The faces of a hemicube take this part of a picture's height, and no more than so many pixels.
constexpr double kFacesPart = 0.4;
constexpr int kLeastSide = 96, kMostSide = 320;
/// Lines of normals [pixels].
constexpr float kLineWidth = 1.5f;

constexpr auto kTechniqueWords = [] {
  std::array<const char*, view::kTechniques.size()> out{};
  for (size_t i = 0; i < out.size(); ++i) out[i] = view::kTechniques[i].words;
  return out;
}();

class HemicubeSubject : public Subject {
 public:
  HemicubeSubject(std::unique_ptr<view::LiveHemicube> live, view::ShownScene shown)
      : live_(std::move(live)), reports_(view::begin_reports()), shown_(std::move(shown)) {}

  view::ShownScene& shown() override { return shown_; }
  const view::Additions* additions() const override { return &additions_; }

  std::vector<KeyLine> keys() const override {
    std::vector<KeyLine> out{{"click on a surface", "what its nearest vertex sees"}};
    for (size_t i = 0; i < 9; ++i)
      out.push_back({view::kTechniques[i].key, view::kTechniques[i].words});
    for (const view::KeyHelp& key : view::kHemicubeKeys) out.push_back({key.key, key.does});
    return out;
  }
  Status check(const view::Play& play, const std::string& name) const override {
    LUXEL_TRY_STATUS(view::check_hemicube(play, name));
    if (const auto pause = view::first_pause(play)) live_->pause_at(*pause);
    return {};
  }

  Result<Followed> follow(gpu::Commands& commands, std::string& message) override {
    view::HemicubeNews news = live_->take();
    Followed out;
    out.has_news = news.read || news.mesh || !news.irradiance.empty() || news.said;
    if (news.said) message = *news.said;
    if (news.read) {
      LUXEL_TRY_STATUS(take_scene(std::move(news.read), commands));
      out.is_another = true;
    }
    LUXEL_TRY_STATUS(take_light(std::move(news), commands));
    for (Result<view::ReportOfMesh>& come : reports_->take()) {
      if (!come) message = come.error().message;
      if (come && come->mesh == mesh_) take_report(std::move(come->report));
      out.has_news = true;
    }
    return out;
  }

  Work work() const override {
    const view::HemicubeState state = live_->state();
    if (state == view::HemicubeState::failed) return Work::failed;
    const bool is_to_come = state == view::HemicubeState::solving || is_to_ask();
    return is_to_come || reports_->is_busy() ? Work::at_work : Work::at_rest;
  }

  bool take(const view::Event& event, const view::Walk& walk) override {
    const double before = desk_.pause_at;
    const bool is_taken = view::handle_hemicube(event, walk, mesh_.get(), desk_);
    if (desk_.pause_at != before) live_->pause_at(desk_.pause_at);
    ask();
    return is_taken;
  }
  void obey(view::Command command) override {
    if (command == view::Command::stop_or_go_on)
      live_->pause(live_->state() == view::HemicubeState::solving);
  }

  void fill(Panel& panel) const override;
  void take(const Panel& panel, const view::Walk*) override;

  Status prepare(gpu::Commands& commands, const view::Walk& walk, view::Frame& frame) override {
    frame.show = view::Show::light_and_colour;
    frame.technique =
        mesh_ || !view::needs_mesh(desk_.technique) ? desk_.technique : view::Technique::c;
    // Colours are shown as they are, but for the stops that the user has chosen.
    frame.exposure = walk.shown.exposure;
    if (!view::is_light(*frame.technique)) frame.exposure /= walk.first.exposure;
    const auto mark = view::mark_of(desk_, mesh_.get(), walk);
    frame.marks.clear();
    if (mark && desk_.has_report) frame.marks.push_back(*mark);
    LUXEL_TRY_STATUS(prepare_normals(commands, frame));
    return prepare_inset(commands, walk, frame);
  }

 private:
  Status take_scene(std::shared_ptr<const view::ReadScene> read, gpu::Commands& commands) {
    LUXEL_TRY(shown_.device, view::colours_shown(commands, read->scene));
    LUXEL_TRY(additions_.techniques, view::put_techniques(commands.device(), read->scene));
    additions_.shapes.clear();
    mesh_.reset();
    shown_.read = std::move(read);
    return {};
  }
  Status take_light(view::HemicubeNews news, gpu::Commands& commands) {
    if (news.mesh) {
      mesh_ = std::move(news.mesh);
      desk_.element.reset();
      report_.reset(), sizes_.clear();
      LUXEL_TRY_STATUS(view::put_mesh(
          commands.device(), view::corners_of(mesh_->in->scene, mesh_->mesh, mesh_->receivers),
          mesh_->receivers.elements.reflectance, *additions_.techniques));
    }
    if (!news.irradiance.empty() && mesh_) {
      irradiance_ = std::move(news.irradiance);
      view::put_irradiance(irradiance_, *additions_.techniques);
      if (desk_.element && live_->state() == view::HemicubeState::solved) ++desk_.asked;
      ask();
    }
    if (news.exposure > 0) {
      const float before = shown_.has_light ? view::exposure(shown_.fade) : news.exposure;
      shown_.fade = {0, shown_.has_light ? 0.0f : 1.0f, before, news.exposure};
      shown_.has_light = true;
    }
    return {};
  }

  bool is_to_ask() const { return desk_.asked != asked_ && mesh_; }
  /// Asks for the report that is wanted, if it is not under way.
  void ask() {
    if (!is_to_ask()) return;
    asked_ = desk_.asked;
    if (!desk_.element) return report_.reset();
    if (irradiance_.size() == mesh_->receivers.size())
      reports_->ask({mesh_, irradiance_, *desk_.element, desk_.resolution});
  }
  void take_report(view::VertexReport report) {
    if (!report_ || report_->element != report.element) sizes_.clear();
    SizeLine line{report.resolution, 0, -1, luminance(report.irradiance)};
    if (report.exact) {
      line.sum_error = float(double(report.sum) - report.exact->sum);
      line.wrong = float(report.exact->wrong);
    }
    std::erase_if(sizes_, [&](const SizeLine& s) { return s.pixels == line.pixels; });
    sizes_.push_back(line);
    std::ranges::sort(sizes_, {}, &SizeLine::pixels);
    report_ = std::move(report);
    is_inset_old_ = true;
  }

  /// Lines of the sides that the camera sees, again where it has moved.
  Status prepare_normals(gpu::Commands& commands, const view::Frame& frame) {
    if (*frame.technique != view::Technique::normals) {
      additions_.shapes.clear();
      return {};
    }
    const Mat34& place = frame.camera.world_from_camera;
    if (!additions_.shapes.empty() && place.row == normals_from_.row) return {};
    normals_from_ = place;
    additions_.shapes.clear();
    view::Shapes shapes;
    view::add_lines(display::lines_of_normals(shown_.read->scene, frame.camera), 1, shapes);
    shapes.line_width = kLineWidth;
    if (shapes.empty()) return {};
    LUXEL_TRY(view::DeviceShapes lines, view::put_shapes(commands.device(), shapes));
    additions_.shapes.push_back(std::move(lines));
    return {};
  }
  Status prepare_inset(gpu::Commands& commands, const view::Walk& walk, const view::Frame& frame) {
    if (!report_ || !desk_.has_report) {
      additions_.inset.reset();
      return {};
    }
    const view::FacesLook look{desk_.faces, walk.shown.exposure, frame.curve};
    const int side = std::clamp(int(kFacesPart * walk.height), kLeastSide, kMostSide);
    const bool is_another = !additions_.inset || is_inset_old_ || side != side_ ||
                            look.faces != look_.faces || look.exposure != look_.exposure;
    if (!is_another) return {};
    look_ = look, side_ = side, is_inset_old_ = false;
    LUXEL_TRY(additions_.inset,
              view::put_inset(commands.device(), view::report_picture(*mesh_, *report_, look, side,
                                                                      shown_.read->light_unit)));
    return {};
  }

  std::unique_ptr<view::LiveHemicube> live_;
  std::unique_ptr<view::ReportWorker> reports_;
  view::ShownScene shown_;
  view::Additions additions_;
  std::shared_ptr<const view::LightMesh> mesh_;  ///< that is shown; null: none yet
  std::vector<Rgb> irradiance_;                  ///< of its elements
  view::HemicubeDesk desk_;
  uint64_t asked_ = 0;  ///< HemicubeDesk::asked of what was asked for last
  std::optional<view::VertexReport> report_;
  std::vector<SizeLine> sizes_;  ///< of its element
  view::FacesLook look_;         ///< of the inset, and its width
  int side_ = 0;
  Mat34 normals_from_;  ///< the camera of the lines of normals
  bool is_inset_old_ = false;
};

void HemicubeSubject::fill(Panel& panel) const {
  HemicubePanel& out = panel.hemicube.emplace();
  const view::HemicubeState state = live_->state();
  const Progress::Snapshot now = live_->snapshot();
  const bool is_solved = state == view::HemicubeState::solved;
  out.share = is_solved ? 1 : now.total > 0 ? float(now.done) / float(now.total) : 0;
  out.state = is_solved ? "solved" : now.stage;
  if (now.total > 0 && !is_solved) out.state += fmt::format(" {} of {}", now.done, now.total);
  if (state == view::HemicubeState::paused) out.state += ", stopped";
  if (state == view::HemicubeState::failed) out.state = "failed";
  out.can_stop = state == view::HemicubeState::solving;
  out.can_go_on = state == view::HemicubeState::paused;
  out.techniques = kTechniqueWords;
  out.technique = int(desk_.technique);
  out.has_element = desk_.element.has_value();
  out.size = desk_.resolution, out.most_pixels = view::kMostPixels;
  out.faces = desk_.has_report ? int(desk_.faces) : 2;
  out.sizes = sizes_;
  if (shown_.read) out.unit = shown_.read->light_unit;
  if (!report_ || !desk_.element) return;
  out.lines = view::lines_of(*report_, out.unit);
  for (const uint32_t count : view::histogram_of_row(report_->row))
    out.histogram.push_back(float(count));
}

void HemicubeSubject::take(const Panel& panel, const view::Walk*) {
  const HemicubePanel& asked = *panel.hemicube;
  if (asked.asks_to_stop || asked.asks_to_go_on) obey(view::Command::stop_or_go_on);
  desk_.technique = view::Technique(asked.technique);
  desk_.has_report = asked.faces < 2;
  if (desk_.has_report) desk_.faces = view::Faces(asked.faces);
  if (asked.size != desk_.resolution) {
    desk_.resolution = view::hemicube_size(asked.size);
    ++desk_.asked;
  }
  ask();
}

}  // namespace

MakeSubject hemicube_subject(std::vector<std::filesystem::path> models,
                             const pipeline::BakeSettings& settings) {
  auto live = std::make_shared<std::unique_ptr<view::LiveHemicube>>(
      std::make_unique<view::LiveHemicube>(std::move(models), settings));
  return [live](gpu::Commands& commands) -> Result<std::unique_ptr<Subject>> {
    LUXEL_TRY(view::ShownScene shown, view::nothing_shown(commands));
    return std::make_unique<HemicubeSubject>(std::move(*live), std::move(shown));
  };
}

}  // namespace luxel::view_window
