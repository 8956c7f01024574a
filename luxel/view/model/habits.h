// Habits of the window, kept until it is opened again: a small file of JSON.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "luxel/base/result.h"
#include "luxel/view/model/bookmarks.h"

namespace luxel::view {

/// Where looking ended, and the view with which it had begun.
struct LastView {
  scene::Camera first, last;
};

/// Views and bookmarks of one scene, bake or .lxr file.
struct SubjectHabits {
  std::string path;  ///< absolute
  std::optional<LastView> view;
  Bookmarks bookmarks;
  DVec3 origin{};  ///< scene::Scene::origin that its cameras are relative to
};

/// Layout of the panel. ImGui's numbers stand for its headers.
struct PanelHabits {
  std::optional<std::array<float, 2>> place;  ///< of its corner [pixels]
  std::vector<uint32_t> open, closed;         ///< headers that were opened or closed
  friend bool operator==(const PanelHabits&, const PanelHabits&) = default;
};

struct Habits {
  bool is_light = false;  ///< dark letters on a light panel
  PanelHabits panel;
  std::optional<std::array<int, 2>> window;  ///< its width and height, on a monitor of scale 1
  std::vector<SubjectHabits> recent;         ///< the newest first; at most kMostRecent
};
inline constexpr size_t kMostRecent = 20;
/// Windows are no smaller and no larger when they are opened again [pixels].
inline constexpr int kSmallestWindow = 160, kLargestWindow = 16384;

/// The file, by the environment's XDG_STATE_HOME and HOME, which may be null; empty: neither says
/// where. [XDG Base Directory Specification 0.8]
std::filesystem::path habits_file(const char* xdg_state_home, const char* home);

/// Nothing where there is no such file. Errors: it cannot be read; it is no file of habits.
Result<Habits> read_habits(const std::filesystem::path& file);
/// Makes the folder, too. Errors: those of files.
Status write_habits(const Habits& habits, const std::filesystem::path& file);

/// Errors: something else than json_of() writes; `name` is the file's, for the sentence.
Result<Habits> parse_habits(std::string_view text, const std::string& name);
std::string json_of(const Habits& habits);

/// Those of a subject; without anything where it is new.
SubjectHabits subject_of(const Habits& habits, const std::string& path);
/// The subject becomes the newest.
void remember(SubjectHabits subject, Habits& habits);

/// Its cameras become relative to another origin.
SubjectHabits moved_to(DVec3 origin, SubjectHabits subject);

/// The camera to begin with: the last, if looking would begin with the same view as then. Another
/// first view is one that the user has asked for since.
scene::Camera camera_to_begin(const SubjectHabits& subject, const scene::Camera& first);

}  // namespace luxel::view
