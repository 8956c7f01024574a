// Another subject for a window that is open: a file that was dropped on it, or that has changed.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "apps/view/subject.h"
#include "luxel/view/model/file_watch.h"

namespace luxel::view_window {

/// A subject that is being opened. Until there is something of it to see, the one before is shown.
struct NextSubject {
  std::filesystem::path path;
  std::unique_ptr<Subject> subject;
};

/// Begins to open it. Errors: what `open` says; no memory on the device.
Result<NextSubject> begin_next(const std::filesystem::path& path, const OpenSubject& open,
                               gpu::Commands& commands);

/// The subject as soon as something of it can be seen; null: not yet. Errors: why nothing ever will
/// be.
Result<std::unique_ptr<Subject>> take_next(gpu::Commands& commands, NextSubject& next);

/// An absolute path without detours, as what is remembered is named.
std::string full_path(const std::filesystem::path& path);
/// Title of a window that shows this path.
std::string title_of(const std::filesystem::path& path);

}  // namespace luxel::view_window
