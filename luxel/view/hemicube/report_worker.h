// Reports on elements, worked out by a thread while the window goes on.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "luxel/view/hemicube/vertex_report.h"

namespace luxel::view {

/// What is asked: an element, the size of its hemicube, and the light of the mesh by now.
struct ReportRequest {
  std::shared_ptr<const LightMesh> mesh;
  std::vector<Rgb> irradiance;
  uint32_t element = 0;
  int resolution = 64;
};

/// A report, and of which mesh it is; or why there is none.
struct ReportNews {
  std::shared_ptr<const LightMesh> mesh;
  std::optional<VertexReport> report;
  std::string said;
};

/// Guards the thread. Its functions are called by one thread, and none waits but the destructor,
/// which ends the work within about 0.2 s.
class ReportWorker {
 public:
  static std::unique_ptr<ReportWorker> begin();
  virtual ~ReportWorker() = default;
  /// In the place of what was asked before, whether it is done or not.
  virtual void ask(ReportRequest request) = 0;
  /// What has come since it was last called.
  virtual std::optional<ReportNews> take() = 0;
  /// Whether anything is still to come.
  virtual bool is_busy() const = 0;
};

}  // namespace luxel::view
