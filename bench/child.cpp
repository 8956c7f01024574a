#include "bench/child.h"

#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "luxel/base/shown_text.h"
#include "luxel/pipeline/bake/bake.h"

namespace luxel::bench {

Result<ChildOutcome> run_in_child(const std::function<std::string()>& work) {
  int channel[2];
  if (::pipe(channel) != 0) return fail(ErrorCode::io, "cannot make a pipe");
  const pid_t child = ::fork();
  if (child < 0) {
    ::close(channel[0]), ::close(channel[1]);
    return fail(ErrorCode::io, "cannot start a process");
  }
  if (child == 0) {
    // Ctrl-C may end the parent while this works on.
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    ::close(channel[0]);
    const std::string text = work();
    const ssize_t written = ::write(channel[1], text.data(), text.size());
    ::_exit(written == ssize_t(text.size()) ? 0 : 1);
  }
  ::close(channel[1]);
  ChildOutcome out;
  char buffer[4096];
  for (ssize_t n; (n = ::read(channel[0], buffer, sizeof buffer)) > 0;)
    out.text.append(buffer, size_t(n));
  ::close(channel[0]);
  int status = 0;
  rusage usage{};
  if (::wait4(child, &status, 0, &usage) != child || status != 0)
    return fail(ErrorCode::io, "a measuring process ended early");
  out.peak_resident_bytes = uint64_t(usage.ru_maxrss) * 1024;
  return out;
}

Result<nlohmann::json> bake_in_child(const pipeline::BakeSettings& settings) {
  LUXEL_TRY(const ChildOutcome child, run_in_child([&] {
              Progress progress;
              const auto json = pipeline::bake(settings, progress);
              return json ? json_text(*json) : json_text(nlohmann::json(json.error().message));
            }));
  const auto json = nlohmann::json::parse(child.text, nullptr, false);
  if (!json.is_object())
    return fail(ErrorCode::bad_input, "the bake of {} failed: {}", settings.scene.string(),
                child.text);
  return json;
}

}  // namespace luxel::bench
