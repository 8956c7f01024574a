#include "luxel/gpu/device.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>

#include "luxel/base/shown_text.h"

namespace luxel::gpu {

/// Called by the validation layer, from any thread.
VkBool32 VKAPI_CALL keep_message(VkDebugUtilsMessageSeverityFlagBitsEXT,
                                 VkDebugUtilsMessageTypeFlagsEXT,
                                 const VkDebugUtilsMessengerCallbackDataEXT* said, void* device) {
  auto& kept = *static_cast<Device*>(device);
  const std::lock_guard lock(kept.messages_mutex_);
  kept.messages_.push_back(said->pMessage);
  return VK_FALSE;
}

namespace {

constexpr const char* kValidation = "VK_LAYER_KHRONOS_validation";
constexpr const char* kNoDevice = "luxel works without one, on the processor";

/// Loads Vulkan once. volk's functions of an instance are the loader's own and serve every
/// instance, so that they may stay global; those of a device do not.
Status load_vulkan() {
  static const VkResult loaded = volkInitialize();
  if (loaded == VK_SUCCESS) return {};
  return fail(ErrorCode::no_device,
              "there is no Vulkan on this machine (libvulkan.so.1); install libvulkan1 and the "
              "driver of the graphics card (mesa-vulkan-drivers has one that needs no card)");
}

std::vector<VkLayerProperties> layers() {
  uint32_t count = 0;
  vkEnumerateInstanceLayerProperties(&count, nullptr);
  std::vector<VkLayerProperties> out(count);
  vkEnumerateInstanceLayerProperties(&count, out.data());
  out.resize(count);
  return out;
}

VkDebugUtilsMessengerCreateInfoEXT messenger_info(Device* device) {
  auto info = structure<VkDebugUtilsMessengerCreateInfoEXT>(
      VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT);
  info.messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT |
                         VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT;
  info.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT |
                     VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT;
  info.pfnUserCallback = keep_message;
  info.pUserData = device;
  return info;
}

/// An instance with these extensions; with the validation layer where `said_to` gets its messages.
Result<VkInstance> make_instance(const std::vector<std::string>& extensions, Device* said_to) {
  LUXEL_TRY_STATUS(load_vulkan());
  auto application = structure<VkApplicationInfo>(VK_STRUCTURE_TYPE_APPLICATION_INFO);
  application.pApplicationName = "luxel";
  application.apiVersion = VK_API_VERSION_1_2;
  std::vector<const char*> names;
  for (const std::string& extension : extensions) names.push_back(extension.c_str());
  auto info = structure<VkInstanceCreateInfo>(VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO);
  info.pApplicationInfo = &application;
  VkDebugUtilsMessengerCreateInfoEXT messenger{};
  if (said_to) {
    messenger = messenger_info(said_to);
    names.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
    info.enabledLayerCount = 1;
    info.ppEnabledLayerNames = &kValidation;
    info.pNext = &messenger;
  }
  info.enabledExtensionCount = uint32_t(names.size());
  info.ppEnabledExtensionNames = names.data();
  VkInstance instance = VK_NULL_HANDLE;
  LUXEL_TRY_STATUS(check(vkCreateInstance(&info, nullptr, &instance), "Vulkan cannot be opened"));
  volkLoadInstanceOnly(instance);
  return instance;
}

/// Features that luxel asks of every device, as the chain of structures that Vulkan wants.
struct Features {
  VkPhysicalDeviceFeatures2 base =
      structure<VkPhysicalDeviceFeatures2>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2);
  VkPhysicalDeviceVulkan12Features v12 = structure<VkPhysicalDeviceVulkan12Features>(
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES);
  VkPhysicalDeviceDynamicRenderingFeaturesKHR rendering =
      structure<VkPhysicalDeviceDynamicRenderingFeaturesKHR>(
          VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DYNAMIC_RENDERING_FEATURES_KHR);
  VkPhysicalDeviceSynchronization2FeaturesKHR synchronization =
      structure<VkPhysicalDeviceSynchronization2FeaturesKHR>(
          VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SYNCHRONIZATION_2_FEATURES_KHR);

  // Asked for where knows_ray_queries().
  VkPhysicalDeviceAccelerationStructureFeaturesKHR acceleration =
      structure<VkPhysicalDeviceAccelerationStructureFeaturesKHR>(
          VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_FEATURES_KHR);
  VkPhysicalDeviceRayQueryFeaturesKHR ray_query = structure<VkPhysicalDeviceRayQueryFeaturesKHR>(
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_QUERY_FEATURES_KHR);

  Features() { base.pNext = &v12, v12.pNext = &rendering, rendering.pNext = &synchronization; }
  void chain_ray_queries() {
    synchronization.pNext = &acceleration, acceleration.pNext = &ray_query;
  }
  Features(const Features&) = delete;
  Features& operator=(const Features&) = delete;
};

struct Need {
  const char* name;
  VkBool32& (*in)(Features&);
};
constexpr Need kNeeds[] = {
    {"buffer addresses", [](Features& f) -> VkBool32& { return f.v12.bufferDeviceAddress; }},
    {"scalar block layout", [](Features& f) -> VkBool32& { return f.v12.scalarBlockLayout; }},
    {"timeline semaphores", [](Features& f) -> VkBool32& { return f.v12.timelineSemaphore; }},
    {"dynamic rendering", [](Features& f) -> VkBool32& { return f.rendering.dynamicRendering; }},
    {"synchronization2",
     [](Features& f) -> VkBool32& { return f.synchronization.synchronization2; }},
};
constexpr const char* kExtensions[] = {VK_KHR_DYNAMIC_RENDERING_EXTENSION_NAME,
                                       VK_KHR_SYNCHRONIZATION_2_EXTENSION_NAME};

constexpr const char* kRayQueryExtensions[] = {VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME,
                                               VK_KHR_DEFERRED_HOST_OPERATIONS_EXTENSION_NAME,
                                               VK_KHR_RAY_QUERY_EXTENSION_NAME};

bool has_extension(VkPhysicalDevice device, const char* name) {
  uint32_t count = 0;
  vkEnumerateDeviceExtensionProperties(device, nullptr, &count, nullptr);
  std::vector<VkExtensionProperties> all(count);
  vkEnumerateDeviceExtensionProperties(device, nullptr, &count, all.data());
  return std::any_of(all.begin(), all.end(), [&](const VkExtensionProperties& e) {
    return std::strcmp(e.extensionName, name) == 0;
  });
}

/// The family of queues that draws and computes; none where none does.
std::optional<uint32_t> queue_family_of(VkPhysicalDevice device) {
  uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, families.data());
  constexpr VkQueueFlags kBoth = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
  for (uint32_t i = 0; i < count; ++i)
    if ((families[i].queueFlags & kBoth) == kBoth) return i;
  return std::nullopt;
}

std::string what_it_lacks(VkPhysicalDevice device, const VkPhysicalDeviceProperties& properties) {
  if (properties.apiVersion < VK_API_VERSION_1_2) return "Vulkan 1.2";
  for (const char* name : kExtensions)
    if (!has_extension(device, name)) return name;
  if (!queue_family_of(device)) return "a queue that draws and computes";
  Features features;
  vkGetPhysicalDeviceFeatures2(device, &features.base);
  for (const Need& need : kNeeds)
    if (!need.in(features)) return need.name;
  return {};
}

bool knows_ray_queries(VkPhysicalDevice device) {
  for (const char* name : kRayQueryExtensions)
    if (!has_extension(device, name)) return false;
  Features features;
  features.chain_ray_queries();
  vkGetPhysicalDeviceFeatures2(device, &features.base);
  return features.acceleration.accelerationStructure && features.ray_query.rayQuery;
}

struct Candidate {
  VkPhysicalDevice device;
  DeviceInfo info;
};

/// Lower is faster.
int rank(VkPhysicalDeviceType type) {
  switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
      return 0;
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
      return 1;
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
      return 2;
    case VK_PHYSICAL_DEVICE_TYPE_CPU:
      return 4;
    default:
      return 3;
  }
}

Result<std::vector<Candidate>> candidates(VkInstance instance) {
  uint32_t count = 0;
  vkEnumeratePhysicalDevices(instance, &count, nullptr);
  std::vector<VkPhysicalDevice> devices(count);
  vkEnumeratePhysicalDevices(instance, &count, devices.data());
  devices.resize(count);
  if (devices.empty())
    return fail(ErrorCode::no_device,
                "Vulkan finds no device on this machine; install the driver of the graphics card "
                "(mesa-vulkan-drivers has one that needs no card)");
  std::vector<Candidate> out;
  for (const VkPhysicalDevice device : devices) {
    VkPhysicalDeviceProperties properties{};
    vkGetPhysicalDeviceProperties(device, &properties);
    out.push_back({device,
                   {properties.deviceName, properties.deviceType, what_it_lacks(device, properties),
                    knows_ray_queries(device)}});
  }
  std::stable_sort(out.begin(), out.end(), [](const Candidate& a, const Candidate& b) {
    return rank(a.info.type) < rank(b.info.type);
  });
  return out;
}

std::string lower(std::string text) {
  for (char& c : text) c = char(std::tolower(uint8_t(c)));
  return text;
}

/// "A, B (lacks Vulkan 1.2)"
std::string names_of(const std::vector<Candidate>& all) {
  std::string out;
  for (const Candidate& c : all) {
    out += (out.empty() ? "" : ", ") + c.info.name;
    if (!c.info.lacks.empty()) out += fmt::format(" (lacks {})", c.info.lacks);
  }
  return out;
}

/// True: `params` asks for this device; `number` is its own.
bool is_wanted(const Candidate& candidate, uint32_t number, const DeviceParams& params) {
  if (!candidate.info.lacks.empty()) return false;
  if (params.number) return *params.number == number;
  if (params.name.empty())
    return params.may_be_software || candidate.info.type != VK_PHYSICAL_DEVICE_TYPE_CPU;
  return lower(candidate.info.name).find(lower(params.name)) != std::string::npos;
}

/// Why none of them is the one.
Failure no_such_device(const std::vector<Candidate>& all, const DeviceParams& params) {
  if (params.number)
    return fail(ErrorCode::no_device,
                "no usable device has the number {}; the devices from 0 on: {}", *params.number,
                names_of(all));
  if (!params.name.empty())
    return fail(ErrorCode::no_device, "no usable device has '{}' in its name; the devices: {}",
                short_message(params.name), names_of(all));
  if (!params.may_be_software)
    return fail(ErrorCode::no_device,
                "there is no usable graphics card, only: {}; give the name or number of a software "
                "device to use it",
                names_of(all));
  return fail(ErrorCode::no_device, "no graphics device of this machine is usable: {}; {}",
              names_of(all), kNoDevice);
}

}  // namespace

Status check(VkResult result, std::string_view what) {
  switch (result) {
    case VK_SUCCESS:
    case VK_SUBOPTIMAL_KHR:
      return {};
    case VK_ERROR_OUT_OF_DEVICE_MEMORY:
      return fail(ErrorCode::out_of_memory, "{}: the device has no memory left", what);
    case VK_ERROR_OUT_OF_HOST_MEMORY:
      return fail(ErrorCode::out_of_memory, "{}: out of memory", what);
    case VK_ERROR_DEVICE_LOST:
      return fail(ErrorCode::no_device, "{}: the device is lost; its driver has stopped", what);
    default:
      return fail(ErrorCode::no_device, "{}: Vulkan error {}", what, int(result));
  }
}

Result<std::vector<DeviceInfo>> list_devices() {
  LUXEL_TRY(const VkInstance instance, make_instance({}, nullptr));
  const auto all = candidates(instance);
  vkDestroyInstance(instance, nullptr);
  if (!all) return Failure{all.error()};
  std::vector<DeviceInfo> out;
  for (const Candidate& candidate : *all) out.push_back(candidate.info);
  return out;
}

Status Device::open_instance(const DeviceParams& params) {
  LUXEL_TRY_STATUS(load_vulkan());
  if (params.validate) {
    const auto known = layers();
    const bool is_there =
        std::any_of(known.begin(), known.end(), [](const VkLayerProperties& layer) {
          return std::strcmp(layer.layerName, kValidation) == 0;
        });
    if (!is_there)
      return fail(ErrorCode::no_device,
                  "Vulkan's validation layer is not installed (vulkan-validationlayers)");
  }
  LUXEL_TRY(instance, make_instance(params.window_extensions, params.validate ? this : nullptr));
  if (!params.validate) return {};
  const VkDebugUtilsMessengerCreateInfoEXT info = messenger_info(this);
  return check(vkCreateDebugUtilsMessengerEXT(instance, &info, nullptr, &messenger_),
               "the validation layer cannot be listened to");
}

Status Device::choose(const DeviceParams& params) {
  LUXEL_TRY(const std::vector<Candidate> all, candidates(instance));
  for (uint32_t i = 0; i < all.size(); ++i) {
    if (!is_wanted(all[i], i, params)) continue;
    physical = all[i].device, name = all[i].info.name;
    return {};
  }
  return no_such_device(all, params);
}

Status Device::open_device(const DeviceParams& params) {
  VkPhysicalDeviceProperties properties{};
  vkGetPhysicalDeviceProperties(physical, &properties);
  limits = properties.limits, type = properties.deviceType;
  vkGetPhysicalDeviceMemoryProperties(physical, &memory_);
  queue_family = *queue_family_of(physical);
  const float priority = 1;
  auto queue_info = structure<VkDeviceQueueCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO);
  queue_info.queueFamilyIndex = queue_family;
  queue_info.queueCount = 1;
  queue_info.pQueuePriorities = &priority;
  Features wanted;
  for (const Need& need : kNeeds) need.in(wanted) = VK_TRUE;
  VkPhysicalDeviceFeatures has{};
  vkGetPhysicalDeviceFeatures(physical, &has);
  has_doubles = has.shaderFloat64 == VK_TRUE;
  wanted.base.features.shaderFloat64 = has.shaderFloat64;
  std::vector<const char*> extensions(std::begin(kExtensions), std::end(kExtensions));
  if (!params.window_extensions.empty()) extensions.push_back(VK_KHR_SWAPCHAIN_EXTENSION_NAME);
  has_ray_queries = knows_ray_queries(physical);
  if (has_ray_queries) {
    for (const char* name_of_one : kRayQueryExtensions) extensions.push_back(name_of_one);
    wanted.chain_ray_queries();
    wanted.acceleration.accelerationStructure = wanted.ray_query.rayQuery = VK_TRUE;
  }
  auto info = structure<VkDeviceCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO);
  info.pNext = &wanted.base;
  info.queueCreateInfoCount = 1;
  info.pQueueCreateInfos = &queue_info;
  info.enabledExtensionCount = uint32_t(extensions.size());
  info.ppEnabledExtensionNames = extensions.data();
  LUXEL_TRY_STATUS(check(vkCreateDevice(physical, &info, nullptr, &device),
                         fmt::format("{} cannot be opened", name)));
  volkLoadDeviceTable(&vk, device);
  vk.vkGetDeviceQueue(device, queue_family, 0, &queue);
  return {};
}

Result<std::unique_ptr<Device>> Device::open(const DeviceParams& params) {
  std::unique_ptr<Device> out(new Device);
  LUXEL_TRY_STATUS(out->open_instance(params));
  LUXEL_TRY_STATUS(out->choose(params));
  LUXEL_TRY_STATUS(out->open_device(params));
  return out;
}

Device::~Device() {
  if (device != VK_NULL_HANDLE) vk.vkDestroyDevice(device, nullptr);
  if (messenger_ != VK_NULL_HANDLE) vkDestroyDebugUtilsMessengerEXT(instance, messenger_, nullptr);
  if (instance != VK_NULL_HANDLE) vkDestroyInstance(instance, nullptr);
}

uint32_t Device::memory_type(uint32_t type_bits, VkMemoryPropertyFlags wanted) const {
  for (uint32_t i = 0; i < memory_.memoryTypeCount; ++i)
    if ((type_bits & (1u << i)) && (memory_.memoryTypes[i].propertyFlags & wanted) == wanted)
      return i;
  return UINT32_MAX;
}

std::vector<std::string> Device::messages() const {
  const std::lock_guard lock(messages_mutex_);
  return messages_;
}

}  // namespace luxel::gpu
