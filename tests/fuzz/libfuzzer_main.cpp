// luxel_fuzz --target=NAME [libFuzzer's own flags] [CORPUS ...]: clang's libFuzzer feeds one
// target.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "tests/fuzz/targets.h"

namespace {

const luxel::fuzz::Target* target = nullptr;

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  constexpr std::string_view kFlag = "--target=";
  for (int i = 1; i < *argc; ++i) {
    const std::string_view argument = (*argv)[i];
    if (argument.starts_with(kFlag))
      target = luxel::fuzz::find_target(argument.substr(kFlag.size()));
  }
  if (target != nullptr) return 0;
  std::fprintf(stderr, "luxel_fuzz: --target=NAME is one of:\n");
  for (const luxel::fuzz::Target& known : luxel::fuzz::targets())
    std::fprintf(stderr, "  %.*s\n", int(known.name.size()), known.name.data());
  std::exit(2);
}

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  target->run(std::as_bytes(std::span(data, size)));
  return 0;
}
