#include "apps/cli/device_option.h"

#include "luxel/gpu/device_choice.h"
#include "luxel/reference/device/device_path_tracer.h"
#include "luxel/solve/device/device_look.h"
#include "luxel/solve/device/gather_device.h"

namespace luxel::cli {

OpenDevice::OpenDevice() = default;
OpenDevice::~OpenDevice() = default;

Result<std::unique_ptr<OpenDevice>> open_device(const std::string& text, const Common& common) {
  LUXEL_TRY(const gpu::DeviceChoice choice, gpu::parse_device(text));
  LUXEL_TRY(gpu::ChosenDevice chosen, gpu::open_chosen(choice));
  if (!chosen.why_none.empty())
    print_warnings({"computed on the processor: " + chosen.why_none}, common);
  if (!chosen.device) return nullptr;
  auto out = std::make_unique<OpenDevice>();
  out->device = std::move(chosen.device);
  out->rays = device::gather_device(*out->device);
  out->look = device::look_device(*out->device);
  out->paths = reference::path_device(*out->device);
  out->for_pipeline = {.rays = out->rays.get(),
                       .look = out->look.get(),
                       .paths = out->paths.get(),
                       .name = out->device->name,
                       .is_optional = choice.kind == gpu::DeviceChoice::Kind::any};
  return out;
}

CLI::Option* add_device(CLI::App& app, std::string& text, const std::string& does) {
  return app
      .add_option("--device", text,
                  does +
                      ": cpu, gpu (a graphics card), gpu:N or gpu:TEXT (the device with this "
                      "number or with this text in its name, see luxel info --devices), or auto (a "
                      "graphics card if one can do it, else cpu)")
      ->type_name("cpu|gpu|gpu:NAME|auto")
      ->capture_default_str();
}

}  // namespace luxel::cli
