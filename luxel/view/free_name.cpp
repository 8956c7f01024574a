#include "luxel/view/free_name.h"

#include <fmt/format.h>

namespace luxel::view {

std::filesystem::path free_name(const std::filesystem::path& folder, const std::string& name,
                                const std::string& extension) {
  std::error_code ignored;
  std::filesystem::path out = folder / (name + extension);
  for (int number = 2; std::filesystem::exists(out, ignored); ++number)
    out = folder / fmt::format("{}-{}{}", name, number, extension);
  return out;
}

}  // namespace luxel::view
