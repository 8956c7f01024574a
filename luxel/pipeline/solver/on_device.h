// Solvers on a graphics device that may fail.
#pragma once

#include <string>
#include <vector>

#include "luxel/base/result.h"
#include "luxel/pipeline/texels/solve_input.h"

namespace luxel::pipeline {

/// True: the processor may do the work that the device has failed at. The device is optional, and
/// the error is one that a device can have.
bool may_go_on_without(const BakeDevice& on, const Error& error);

/// The warning that the processor has done it, and why: a part of a sentence.
std::string warning_without(const BakeDevice& on, std::string_view why);

/// The device that took part in a bake, and the warnings about it.
struct TookPart {
  std::string device;  ///< empty: the processor alone
  std::vector<std::string> warnings;
};

/// run(on), a Result, where there is a device; run(nullptr), on the processor, where there is none,
/// or then where an optional one has failed. `part`: a TookPart, or what has its members.
template <class Run, class Part>
auto run_on_any(const BakeDevice* on, const Run& run, Part& part) {
  auto out = run(on);
  if (!on) return out;
  if (out) part.device = on->name;
  if (out || !may_go_on_without(*on, out.error())) return out;
  part.warnings.push_back(warning_without(*on, out.error().message));
  return run(static_cast<const BakeDevice*>(nullptr));
}

}  // namespace luxel::pipeline
