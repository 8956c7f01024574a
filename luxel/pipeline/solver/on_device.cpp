#include "luxel/pipeline/solver/on_device.h"

namespace luxel::pipeline {

bool may_go_on_without(const BakeDevice& on, const Error& error) {
  return on.is_optional &&
         (error.code == ErrorCode::unsupported || error.code == ErrorCode::no_device ||
          error.code == ErrorCode::out_of_memory);
}

std::string warning_without(const BakeDevice& on, std::string_view why) {
  return fmt::format("computed on the processor, not on {}: {}", on.name, why);
}

}  // namespace luxel::pipeline
