// Hemicube radiosity that is looked at while it goes from vertex to vertex: a thread solves, and
// hands over what it has by then. [Rodriguez06, sections 4.5.4 and 5.6]
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "luxel/base/worker.h"
#include "luxel/pipeline/settings/settings.h"
#include "luxel/solve/hemicube/exchange.h"
#include "luxel/solve/hemicube/hemicube.h"
#include "luxel/view/read_scene.h"

namespace luxel::view {

/// A mesh of the solver, and what is needed to look around from its elements.
struct LightMesh {
  std::shared_ptr<const ReadScene> in;  ///< the scene as it was laid out, which it was made of
  hemicube::Mesh mesh;
  hemicube::Receivers receivers;
  hemicube::Emission emission;
  hemicube::HemicubeParams params;
};

/// News since the last request for them.
struct HemicubeNews {
  /// First as it was read, then as it was laid out: charts are cut where walls stand on them.
  std::shared_ptr<const ReadScene> read{};
  std::shared_ptr<const LightMesh> mesh{};  ///< another one than before
  std::vector<Rgb> irradiance{};            ///< E of all its elements [W/m^2]; empty: nothing new
  float exposure = 0;                       ///< at which the first view is readable; 0: nothing new
  bool is_solved = false;
  std::optional<std::string> said{};  ///< why there is no light; a sentence
};
/// Newer news take the place of older ones.
void merge(HemicubeNews newer, HemicubeNews& news);

enum class HemicubeState : uint8_t { solving, paused, solved, failed };

/// Guards the thread. Its functions are called by one thread and do not wait for the solver, but
/// for the destructor, which ends it within about 0.2 s.
class LiveHemicube {
 public:
  /// Begins to read the models, one scene of all of them, each where its file places it. Settings
  /// are those of `luxel bake`, settings.scene the first model; the light ends as that of
  /// `luxel bake --solver hemicube`, bit by bit.
  LiveHemicube(std::vector<std::filesystem::path> models, const pipeline::BakeSettings& settings);

  HemicubeNews take();
  /// At its end once the last news are taken.
  HemicubeState state() const;
  Progress::Snapshot snapshot() const { return worker_.snapshot(); }
  void pause(bool is_paused);
  /// Stops once so large a share of a mesh's elements has looked around in a pass; > 1: never.
  void pause_at(double share) { pause_at_ = share; }

 private:
  std::atomic<double> pause_at_{2};
  bool is_solved_ = false;  ///< by the news that were taken
  Worker<std::vector<std::filesystem::path>, HemicubeNews> worker_;
};

}  // namespace luxel::view
