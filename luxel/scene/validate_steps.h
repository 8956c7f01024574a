// The steps of validate(), for its own files only.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "luxel/base/result.h"
#include "luxel/scene/scene.h"

namespace luxel::scene {

struct Report {
  std::string file;
  std::vector<std::string> warnings;

  template <class... Args>
  void warn(fmt::format_string<Args...> text, Args&&... args) {
    warnings.push_back(file + ": " + fmt::format(text, std::forward<Args>(args)...));
  }
};

/// "mesh 3 (chair)": files number things from 0, people name them.
inline std::string label(const char* kind, size_t index, const std::string& name) {
  return name.empty() ? fmt::format("{} {}", kind, index)
                      : fmt::format("{} {} ({})", kind, index, name);
}

/// "a, b, c and 4 more"
std::string listed(const std::vector<std::string>& names);

/// Errors: an index that points nowhere, arrays that do not fit together.
Status check_references(const Scene& scene, const Report& report);

/// Errors: NaN or infinity where nothing sensible can stand in. Repairs texture coordinates, vertex
/// colours and factors out of their range.
Status check_numbers(Scene& scene, Report& report);

void drop_singular_instances(Scene& scene, Report& report);
void drop_zero_area_triangles(Scene& scene, Report& report);
void repair_normals(Scene& scene, Report& report);
void clamp_reflectance(Scene& scene, Report& report);

}  // namespace luxel::scene
