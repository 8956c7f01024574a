#include "luxel/gpu/device_choice.h"

#include <algorithm>
#include <charconv>

#include "luxel/base/shown_text.h"

namespace luxel::gpu {
namespace {

/// Longer ones are names: "gpu:4090".
constexpr size_t kDigitsOfANumber = 2;

/// The number that all of the text is; none where it is a part of a name.
std::optional<uint32_t> number_of(std::string_view text) {
  if (text.size() > kDigitsOfANumber) return std::nullopt;
  uint32_t out = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), out);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return out;
}

/// True where the machine has a device other than software.
bool has_card() {
  const auto devices = list_devices();
  return devices && std::ranges::any_of(*devices, [](const DeviceInfo& d) {
           return d.type != VK_PHYSICAL_DEVICE_TYPE_CPU;
         });
}

}  // namespace

Result<DeviceChoice> parse_device(std::string_view text) {
  using Kind = DeviceChoice::Kind;
  constexpr std::string_view kNamed = "gpu:";
  if (text == "cpu") return DeviceChoice{};
  DeviceChoice out;
  out.params.may_be_software = false;
  out.kind = text == "auto" ? Kind::any : Kind::device;
  if (text == "auto" || text == "gpu") return out;
  if (!text.starts_with(kNamed) || text == kNamed)
    return fail(ErrorCode::bad_setting,
                "--device {} is not known; give cpu, gpu, auto, or gpu: and the number or part of "
                "the name of a device from luxel info --devices",
                short_message(std::string(text)));
  text.remove_prefix(kNamed.size());
  out.params.number = number_of(text);
  if (!out.params.number) out.params.name = text;
  return out;
}

Result<ChosenDevice> open_chosen(const DeviceChoice& choice) {
  if (choice.kind == DeviceChoice::Kind::processor) return ChosenDevice{};
  auto device = Device::open(choice.params);
  if (device) return ChosenDevice{std::move(*device), {}};
  if (choice.kind == DeviceChoice::Kind::device) return Failure{device.error()};
  return ChosenDevice{nullptr, has_card() ? device.error().message : std::string()};
}

}  // namespace luxel::gpu
