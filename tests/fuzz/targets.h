// The fuzzers' targets: one function for each kind of file that luxel reads. Anything may come; a
// target returns, or the process ends and the input is a finding.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

namespace luxel::fuzz {

/// A kind of file.
struct Target {
  std::string_view name;
  void (*run)(std::span<const std::byte> input);
};

/// All of them, by name.
std::span<const Target> targets();
/// Null where there is none of that name.
const Target* find_target(std::string_view name);

}  // namespace luxel::fuzz
