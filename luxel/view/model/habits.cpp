#include "luxel/view/model/habits.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "luxel/base/file.h"
#include "luxel/base/shown_text.h"
#include "luxel/scene/held_range.h"

namespace luxel::view {
namespace {

using nlohmann::json;

bool is_size(float x) { return x >= 0 && std::isfinite(x); }

/// True: pictures can be drawn from this camera.
bool is_camera(const scene::Camera& camera) {
  const Mat34& m = camera.world_from_camera;
  for (const auto& row : m.row)
    for (const float x : row)
      if (!std::isfinite(x)) return false;
  const float volume = dot(column(m, 0), cross(column(m, 1), column(m, 2)));
  return std::isfinite(volume) && volume != 0 && camera.fov_y_rad > 0 && camera.fov_y_rad < kPi &&
         is_size(camera.aspect) && is_size(camera.orthographic_height_m);
}

bool is_bookmark(const Bookmark& bookmark) {
  return is_camera(bookmark.camera) && bookmark.brightness > 0 &&
         std::isfinite(bookmark.brightness);
}

json json_of(const scene::Camera& camera) {
  return {{"world_from_camera", camera.world_from_camera.row},
          {"fov_y_rad", camera.fov_y_rad},
          {"aspect", camera.aspect},
          {"orthographic_height_m", camera.orthographic_height_m}};
}

/// Leaves out what cannot be read again.
json json_of(const SubjectHabits& subject) {
  json out{{"path", subject.path}, {"bookmarks", json::object()}};
  if (subject.view && is_camera(subject.view->first) && is_camera(subject.view->last))
    out["view"] = {{"first", json_of(subject.view->first)}, {"last", json_of(subject.view->last)}};
  const DVec3 o = subject.origin;
  if (o != DVec3{}) out["origin"] = {o.x, o.y, o.z};
  for (size_t i = 0; i < subject.bookmarks.size(); ++i) {
    const auto& bookmark = subject.bookmarks[i];
    if (bookmark && is_bookmark(*bookmark))
      out["bookmarks"][std::to_string(i + 1)] = {{"camera", json_of(bookmark->camera)},
                                                 {"brightness", bookmark->brightness},
                                                 {"show", kShows[size_t(bookmark->show)].name}};
  }
  return out;
}

// These readers may throw json::exception. None where a value makes no sense.

std::optional<scene::Camera> camera_of(const json& from) {
  scene::Camera out;
  out.world_from_camera.row = from.at("world_from_camera").get<decltype(Mat34::row)>();
  out.fov_y_rad = from.at("fov_y_rad").get<float>();
  out.aspect = from.at("aspect").get<float>();
  out.orthographic_height_m = from.at("orthographic_height_m").get<float>();
  return is_camera(out) ? std::optional(out) : std::nullopt;
}

std::optional<Bookmark> bookmark_of(const json& from) {
  const auto camera = camera_of(from.at("camera"));
  const auto name = from.at("show").get<std::string>();
  const auto show =
      std::ranges::find_if(kShows, [&](const ShowName& known) { return name == known.name; });
  if (!camera || show == kShows.end()) return std::nullopt;
  const Bookmark out{*camera, from.at("brightness").get<float>(), Show(show - kShows.begin())};
  return is_bookmark(out) ? std::optional(out) : std::nullopt;
}

std::optional<SubjectHabits> subject_of(const json& from) {
  SubjectHabits out;
  out.path = from.at("path").get<std::string>();
  if (from.contains("view")) {
    const auto first = camera_of(from["view"].at("first")),
               last = camera_of(from["view"].at("last"));
    if (!first || !last) return std::nullopt;
    out.view = LastView{*first, *last};
  }
  if (from.contains("origin")) {
    const auto o = from["origin"].get<std::array<double, 3>>();
    out.origin = {o[0], o[1], o[2]};
    if (!scene::is_held(to_float(out.origin))) return std::nullopt;
  }
  for (const auto& item : from.at("bookmarks").items()) {
    const auto number = bookmark_key("alt+" + item.key());
    const auto bookmark = bookmark_of(item.value());
    if (!number || !bookmark) return std::nullopt;
    out.bookmarks[number->number] = bookmark;
  }
  return out;
}

std::optional<PanelHabits> panel_of(const json& from) {
  PanelHabits out;
  if (from.contains("place")) {
    out.place = from["place"].get<std::array<float, 2>>();
    if (!std::isfinite((*out.place)[0]) || !std::isfinite((*out.place)[1])) return std::nullopt;
  }
  out.open = from.at("open").get<std::vector<uint32_t>>();
  out.closed = from.at("closed").get<std::vector<uint32_t>>();
  return out;
}

}  // namespace

std::filesystem::path habits_file(const char* xdg_state_home, const char* home) {
  std::filesystem::path folder;
  // Paths that are not absolute are to be ignored.
  if (xdg_state_home) folder = xdg_state_home;
  if (!folder.is_absolute() && home) folder = std::filesystem::path(home) / ".local" / "state";
  return folder.is_absolute() ? folder / "luxel" / "view.json" : std::filesystem::path();
}

Result<Habits> read_habits(const std::filesystem::path& file) {
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) return Habits{};
  LUXEL_TRY(const std::vector<std::byte> bytes, read_file(file));
  return parse_habits({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, file.string());
}

Status write_habits(const Habits& habits, const std::filesystem::path& file) {
  std::error_code error;
  std::filesystem::create_directories(file.parent_path(), error);
  if (error)
    return fail(ErrorCode::io, "{}: cannot create the folder: {}", file.parent_path().string(),
                error.message());
  const OutputFile text = text_file(file, json_of(habits));
  return write_file_atomically(text.path, text.bytes);
}

Result<Habits> parse_habits(std::string_view text, const std::string& name) {
  const auto no_habits = [&](const char* why) {
    return fail(ErrorCode::bad_input,
                "{}: {}; nothing is remembered until the file is repaired or removed", name,
                short_message(why, 400));
  };
  try {
    const json file = json::parse(text);
    Habits out;
    const auto theme = file.at("theme").get<std::string>();
    if (theme != "dark" && theme != "light")
      return no_habits("its theme is neither dark nor light");
    out.is_light = theme == "light";
    if (file.contains("panel")) {
      const auto panel = panel_of(file["panel"]);
      if (!panel) return no_habits("its panel lies nowhere");
      out.panel = *panel;
    }
    if (file.contains("window")) {
      const auto size = file["window"].get<std::array<int, 2>>();
      for (const int side : size)
        if (side < kSmallestWindow || side > kLargestWindow)
          return no_habits("its window has no size");
      out.window = size;
    }
    for (const json& from : file.at("recent")) {
      const auto subject = subject_of(from);
      if (!subject) return no_habits("one of its cameras or bookmarks is none");
      out.recent.push_back(*subject);
    }
    return out;
  } catch (const json::exception& e) {
    return no_habits(e.what());
  }
}

std::string json_of(const Habits& habits) {
  json out{{"theme", habits.is_light ? "light" : "dark"}, {"recent", json::array()}};
  out["panel"] = {{"open", habits.panel.open}, {"closed", habits.panel.closed}};
  if (habits.panel.place) out["panel"]["place"] = *habits.panel.place;
  if (habits.window) out["window"] = *habits.window;
  for (const SubjectHabits& subject : habits.recent) out["recent"].push_back(json_of(subject));
  // Names of files need not be UTF-8.
  return json_text(out, 1) + "\n";
}

SubjectHabits subject_of(const Habits& habits, const std::string& path) {
  for (const SubjectHabits& known : habits.recent)
    if (known.path == path) return known;
  SubjectHabits out;
  out.path = path;
  return out;
}

void remember(SubjectHabits subject, Habits& habits) {
  std::erase_if(habits.recent, [&](const auto& known) { return known.path == subject.path; });
  habits.recent.insert(habits.recent.begin(), std::move(subject));
  if (habits.recent.size() > kMostRecent) habits.recent.resize(kMostRecent);
}

SubjectHabits moved_to(DVec3 origin, SubjectHabits subject) {
  const DVec3 by = subject.origin - origin;
  const auto move = [&](scene::Camera& camera) {
    Mat34& m = camera.world_from_camera;
    const DVec3 at = to_double(column(m, 3)) + by;
    m.row[0][3] = float(at.x), m.row[1][3] = float(at.y), m.row[2][3] = float(at.z);
  };
  if (by == DVec3{}) return subject;
  if (subject.view) move(subject.view->first), move(subject.view->last);
  for (std::optional<Bookmark>& bookmark : subject.bookmarks)
    if (bookmark) move(bookmark->camera);
  subject.origin = origin;
  return subject;
}

scene::Camera camera_to_begin(const SubjectHabits& subject, const scene::Camera& first) {
  if (!subject.view) return first;
  const scene::Camera& then = subject.view->first;
  const bool is_same = then.world_from_camera == first.world_from_camera &&
                       then.fov_y_rad == first.fov_y_rad && then.aspect == first.aspect &&
                       then.orthographic_height_m == first.orthographic_height_m;
  return is_same ? subject.view->last : first;
}

}  // namespace luxel::view
