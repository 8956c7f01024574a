// Solvers on a graphics device that may fail.
#pragma once

#include <string>

#include "luxel/base/result.h"
#include "luxel/pipeline/texels/solve_input.h"

namespace luxel::pipeline {

/// Whether the processor may do what the device has failed at: it is optional, and the error is one
/// that a device can have.
bool may_go_on_without(const BakeDevice& on, const Error& error);

/// The warning that says so.
std::string warning_without(const BakeDevice& on, const Error& error);

}  // namespace luxel::pipeline
