// --device: a graphics device that takes part in a command's work.
#pragma once

#include <memory>
#include <string>

#include "apps/cli/cli.h"
#include "luxel/gpu/device.h"
#include "luxel/pipeline/texels/solve_input.h"

namespace luxel::cli {

/// An open device and what it does for solvers.
struct OpenDevice {
  std::unique_ptr<gpu::Device> device;
  std::unique_ptr<gather::RayDevice> rays;
  std::unique_ptr<hemicube::LookDevice> look;
  std::unique_ptr<reference::PathDevice> paths;
  pipeline::BakeDevice for_pipeline;

  OpenDevice();
  ~OpenDevice();
};

/// Opens the device that --device asks for, read by gpu::parse_device(); null: the processor. If a
/// device is optional and missing, a warning says why. Errors: no such device.
Result<std::unique_ptr<OpenDevice>> open_device(const std::string& text, const Common& common);

/// Adds --device. `does`: what the device does; the help goes on with how it is chosen.
CLI::Option* add_device(CLI::App& app, std::string& text, const std::string& does);

}  // namespace luxel::cli
