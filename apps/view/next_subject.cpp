#include "apps/view/next_subject.h"

#include <utility>

#include "luxel/base/shown_text.h"

namespace luxel::view_window {

Result<NextSubject> begin_next(const std::filesystem::path& path, const OpenSubject& open,
                               gpu::Commands& commands) {
  LUXEL_TRY(const MakeSubject make, open(path));
  NextSubject out;
  out.path = path;
  LUXEL_TRY(out.subject, make(commands));
  return out;
}

Result<std::unique_ptr<Subject>> take_next(gpu::Commands& commands, NextSubject& next) {
  std::string message;
  LUXEL_TRY_STATUS(next.subject->follow(commands, message).map([](Followed) {}));
  if (next.subject->shown().read) return std::move(next.subject);
  if (next.subject->work() == Work::failed) return fail(ErrorCode::bad_input, "{}", message);
  return nullptr;
}

std::string full_path(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::weakly_canonical(std::filesystem::absolute(path), ignored).string();
}

std::string title_of(const std::filesystem::path& path) {
  return short_message(std::filesystem::absolute(path).lexically_normal().filename().string());
}

}  // namespace luxel::view_window
