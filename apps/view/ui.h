// The panel over the picture, by Dear ImGui. A shared library of its own: ImGui's code for Vulkan
// calls libvulkan's functions by their names, which luxel's room gpu finds when it runs.
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstdint>
#include <memory>
#include <span>

#include "apps/view/panel.h"

struct GLFWwindow;

namespace luxel::view_window {

/// Vulkan objects that the panel is drawn with.
struct UiDevice {
  VkInstance instance;
  VkPhysicalDevice physical;
  VkDevice device;
  uint32_t queue_family;
  VkQueue queue;
  VkFormat format;  ///< of the window's pictures
};

class Ui {
 public:
  /// Null where Vulkan refuses.
  static std::unique_ptr<Ui> make(GLFWwindow* window, const UiDevice& device);
  virtual ~Ui() = default;
  /// The window's pictures, again when they have changed. Nothing may still draw into the earlier.
  virtual bool set_pictures(std::span<const VkImageView> views, uint32_t width,
                            uint32_t height) = 0;
  /// True while the panel has the pointer, or the keyboard.
  virtual bool has_pointer() const = 0;
  virtual bool has_keys() const = 0;
  /// Lays out a frame.
  virtual void lay_out(Panel& panel) = 0;
  /// Draws it over a picture that is COLOR_ATTACHMENT_OPTIMAL and is ready to be shown afterwards.
  virtual void record(VkCommandBuffer commands, uint32_t picture) = 0;
};

}  // namespace luxel::view_window
