// The steps of validate(), for its own files only.
#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "luxel/base/result.h"
#include "luxel/scene/scene.h"

namespace luxel::scene {

struct Report {
  std::string file;
  std::vector<std::string> warnings;
  std::vector<std::string> losses;  ///< those warnings that say why triangles are gone

  void warn_of_loss(std::string text) {
    warnings.push_back(file + ": " + text);
    losses.push_back(std::move(text));
  }

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

/// The lengths of a transform's axes and the volume that they span, in double: in float, products
/// of three lengths overflow long before the lengths do.
struct Scales {
  double x = 0, y = 0, z = 0;
  double volume = 0;  ///< negative where it mirrors

  double largest_product() const { return std::max({x * y, y * z, z * x}); }
  double smallest_product() const { return std::min({x * y, y * z, z * x}); }
};
Scales scales_of(const Mat34& m);

/// Errors: an index that points nowhere, arrays that do not fit together.
Status check_references(const Scene& scene, const Report& report);

/// Errors: NaN, infinity, or more than single precision holds (held_range.h), where nothing
/// sensible can stand in. Repairs texture coordinates, vertex colours and factors out of their
/// range.
Status check_numbers(Scene& scene, Report& report);

/// Drops instances that are squashed flat, or so small that their normals are lost.
void drop_singular_instances(Scene& scene, Report& report);
/// Drops triangles that have no normal, and says why.
void drop_zero_area_triangles(Scene& scene, Report& report);
/// Warns where most triangles are smaller than the steps by which rays start off them, and names
/// the mesh with the largest one.
void warn_of_steps(const Scene& scene, Report& report);
void repair_normals(Scene& scene, Report& report);
void clamp_reflectance(Scene& scene, Report& report);
/// Warns of materials that nobody can see because their alpha is 0.
void warn_of_transparent(const Scene& scene, Report& report);

}  // namespace luxel::scene
