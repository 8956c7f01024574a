#pragma once

namespace luxel::pipeline {
inline constexpr const char* kVersion = LUXEL_VERSION;
}
