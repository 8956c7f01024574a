// The panel over the picture, by Dear ImGui. A shared library of its own: ImGui's code for Vulkan
// calls libvulkan's functions by their names, which luxel's room gpu finds when it runs.
#pragma once

#include <vulkan/vulkan_core.h>

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apps/view/bake_panel.h"
#include "apps/view/lamp_panel.h"
#include "apps/view/ui_look.h"

struct GLFWwindow;

namespace luxel::view_window {

/// What of the device the panel is drawn with.
struct UiDevice {
  VkInstance instance;
  VkPhysicalDevice physical;
  VkDevice device;
  uint32_t queue_family;
  VkQueue queue;
  VkFormat format;  ///< of the window's pictures
};

/// A key and what it does.
struct KeyLine {
  const char *key, *does;
};

/// What the panel shows, and what of it the user may change.
struct Panel {
  std::string title;       ///< of the scene
  std::string about;       ///< a line under it
  float milliseconds = 0;  ///< of a frame
  int show = 0;            ///< changed: light and colour, light, colour; > 2: look
  LookPanel look;          ///< into the bake
  float stops = 0;         ///< changed: exposure over the first
  bool keys_open = false;  ///< changed: the list of keys
  std::span<const KeyLine> keys;
  std::span<const std::string> views;     ///< of the scene's cameras
  int view = -1;                          ///< changed: the one that was asked for; -1: none
  std::array<bool, 9> has_bookmark{};     ///< remembered views
  int bookmark = -1;                      ///< changed: the one that was asked for; -1: none
  std::span<const std::string> warnings;  ///< of the bake that is shown
  std::span<const std::string> recent;    ///< what else was looked at
  bool is_light = false;                  ///< changed: dark letters on light ground
  std::optional<BakeLines> bake;
  std::optional<LampPanel> lamps;
  std::string message;  ///< what was done last
};

class Ui {
 public:
  /// Null where Vulkan refuses.
  static std::unique_ptr<Ui> make(GLFWwindow* window, const UiDevice& device);
  virtual ~Ui() = default;
  /// The window's pictures, again when they have changed. Nothing may still draw into the earlier.
  virtual bool set_pictures(std::span<const VkImageView> views, uint32_t width,
                            uint32_t height) = 0;
  /// Whether the pointer or the keyboard are the panel's.
  virtual bool has_pointer() const = 0;
  virtual bool has_keys() const = 0;
  /// Lays out a frame.
  virtual void lay_out(Panel& panel) = 0;
  /// Draws it over a picture that is COLOR_ATTACHMENT_OPTIMAL and is ready to be shown afterwards.
  virtual void record(VkCommandBuffer commands, uint32_t picture) = 0;
};

}  // namespace luxel::view_window
