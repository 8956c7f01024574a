#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "apps/cli/cli.h"
#include "apps/cli/machine.h"
#include "apps/cli/print.h"
#include "luxel/base/parallel.h"
#include "luxel/base/process_memory.h"
#include "luxel/cluster/mpi.h"
#include "luxel/pipeline/bake/bake_scene.h"
#include "luxel/pipeline/settings/version.h"
#include "luxel/post/oidn.h"
#include "luxel/scene/procedural.h"
#include "luxel/trace/embree/embree_version.h"

namespace luxel::cli {
namespace {

namespace fs = std::filesystem;

/// Verdict on a part of the machine or of this build.
enum class State : uint8_t {
  good,
  lacking,  ///< luxel works without it
  bad       ///< luxel does not bake, or bakes wrongly
};

const char* name_of(State state) {
  switch (state) {
    case State::good:
      return "good";
    case State::lacking:
      return "lacking";
    case State::bad:
      return "bad";
  }
  return "";
}

struct Finding {
  State state = State::good;
  std::string about, text, advice;
};

double gigabytes(uint64_t bytes) { return double(bytes) * 1e-9; }

Finding look_at_processor() {
  const trace::EmbreeVersion embree = trace::embree_version();
  const std::string text =
      fmt::format("{}, {} threads; Embree {}", processor(), thread_count(), embree.number);
  if (embree.rays_in_a_packet == 0)
    return {State::bad, "processor", text, "Embree does not support this processor"};
  const std::string packets = fmt::format("{}, {} rays at a time", text, embree.rays_in_a_packet);
  if (embree.rays_in_a_packet >= 8) return {State::good, "processor", packets, ""};
  return {State::lacking, "processor", packets, "newer processors trace more at a time"};
}

Finding look_at_memory() {
  constexpr uint64_t kLittle = 1'000'000'000;
  const uint64_t free = available_bytes();
  const std::string text = fmt::format("{:.1f} GB free", gigabytes(free));
  if (free >= kLittle) return {State::good, "memory", text, ""};
  return {State::lacking, "memory", text, "keep --resolution low, or set --max-memory"};
}

/// The folder in which most people leave results.
Finding look_at_disk() {
  constexpr uint64_t kLittle = 1'000'000'000;
  std::error_code failed;
  const fs::path here = fs::current_path(failed);
  const fs::space_info space = failed ? fs::space_info{} : fs::space(here, failed);
  if (failed)
    return {State::lacking, "disk", "cannot tell how much space this folder has left",
            "work in another folder"};
  const std::string text =
      fmt::format("{:.1f} GB free in {}", gigabytes(space.available), here.string());
  if (space.available >= kLittle) return {State::good, "disk", text, ""};
  return {State::lacking, "disk", text, "choose an --output on another disk"};
}

Finding look_at_devices() {
  constexpr const char* kAbout = "graphics device";
  constexpr const char* kInstall =
      "install a Vulkan driver; on Debian, mesa-vulkan-drivers has most of them";
  const auto devices = gpu::list_devices();
  if (!devices) return {State::lacking, kAbout, "none: " + devices.error().message, kInstall};
  std::string unusable;
  for (const gpu::DeviceInfo& d : *devices) {
    const std::string text = fmt::format("{}, {}", d.name, kind_of(d.type));
    if (d.lacks.empty()) return {State::good, kAbout, text, ""};
    unusable += fmt::format("{}{} lacks {}", unusable.empty() ? "" : "; ", text, d.lacks);
  }
  return {State::lacking, kAbout, unusable, kInstall};
}

Finding look_at_window() {
  const auto is_set = [](const char* name) {
    const char* value = std::getenv(name);
    return value && *value;
  };
  if (is_set("DISPLAY") || is_set("WAYLAND_DISPLAY"))
    return {State::good, "window", "luxel-view can open one", ""};
  return {State::lacking, "window", "neither DISPLAY nor WAYLAND_DISPLAY is set",
          "luxel-view --offscreen draws to a file without a window; over ssh, try ssh -X"};
}

Finding look_at_cluster() {
  const std::string mpi = cluster::mpi_version();
  if (!mpi.empty()) return {State::good, "cluster", mpi, ""};
  return {State::lacking, "cluster", "built without MPI",
          "to bake on several machines, install libopenmpi-dev and openmpi-bin, and rebuild"};
}

Finding look_at_denoiser() {
  if (post::kHasOidn) return {State::good, "denoiser", "Open Image Denoise", ""};
  return {State::good, "denoiser", "luxel's own", ""};
}

/// A closed box whose walls radiate L and reflect rho: everywhere E = pi L / (1 - rho).
Finding bake_a_furnace() {
  constexpr const char* kAbout = "trial bake";
  constexpr float kReflectance = 0.5f, kMostOff = 0.02f;
  pipeline::BakeSettings settings;
  settings.resolution = 32, settings.samples = 64;
  Progress progress;
  const auto bake = pipeline::bake_scene(
      scene::furnace_box({kReflectance, kReflectance, kReflectance}, {1, 1, 1}), settings,
      progress);
  if (!bake) return {State::bad, kAbout, bake.error().message, "please report this"};
  double sum = 0;
  for (const Rgb e : bake->light.irradiance) sum += double(e.y);
  const double expected = double(kPi) / double(1 - kReflectance);
  const double share = sum / double(bake->light.irradiance.size()) / expected;
  const std::string text =
      fmt::format("a closed furnace gets {:.2f} % of its exact light", 100 * share);
  if (std::abs(share - 1) < double(kMostOff)) return {State::good, kAbout, text, ""};
  return {State::bad, kAbout, text, "please report this"};
}

std::vector<Finding> look_at_all() {
  return {{State::good, "program",
           fmt::format("luxel {}, compiled by {}", pipeline::kVersion, compiler()), ""},
          look_at_processor(),
          look_at_memory(),
          look_at_disk(),
          look_at_devices(),
          look_at_window(),
          look_at_cluster(),
          look_at_denoiser(),
          bake_a_furnace()};
}

int run_doctor(const Common& common) {
  const ThreadLimit limit(common.threads);
  const std::vector<Finding> findings = look_at_all();
  bool is_well = true;
  nlohmann::json json = nlohmann::json::array();
  for (const Finding& f : findings) {
    is_well = is_well && f.state != State::bad;
    json.push_back(
        {{"about", f.about}, {"state", name_of(f.state)}, {"text", f.text}, {"advice", f.advice}});
    if (!common.json)
      print_line(stdout, fmt::format("{:8} {:16} {}{}{}", name_of(f.state), f.about, f.text,
                                     f.advice.empty() ? "" : "; ", f.advice));
  }
  if (common.json) print_json(stdout, {{"findings", json}, {"bakes", is_well}});
  return is_well ? kDone : kBadInput;
}

}  // namespace

void register_doctor(CLI::App& app, Action& action) {
  CLI::App* doctor = app.add_subcommand(
      "doctor", "Check what this machine offers luxel and what it lacks, and try a small bake");
  auto common = std::make_shared<Common>();
  add_common(*doctor, *common);
  doctor->callback([common, &action] { action = [common] { return run_doctor(*common); }; });
}

}  // namespace luxel::cli
