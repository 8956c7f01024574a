// A window of the display, and what the user does in it.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "luxel/base/result.h"
#include "luxel/view/model/events.h"

struct GLFWwindow;

namespace luxel::view_window {

/// GLFW itself and one window.
class Window {
 public:
  /// Errors (no_device): no display, no Vulkan.
  static Result<std::unique_ptr<Window>> open(const std::string& title, int width, int height);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  GLFWwindow* get() const { return window_; }
  /// The user's events since the last call.
  std::vector<view::Event> taken() { return std::exchange(events_, {}); }
  /// Something has happened since the last call that may change the picture.
  bool has_changed() { return std::exchange(has_changed_, false) || !events_.empty(); }
  /// Files that were dropped on the window since the last call.
  std::vector<std::filesystem::path> dropped() { return std::exchange(dropped_, {}); }
  bool asks_for_keys() { return std::exchange(asks_for_keys_, false); }
  bool asks_for_screenshot() { return std::exchange(asks_for_screenshot_, false); }
  std::array<int, 2> pixels() const;
  /// Pixels per point of the monitor that it is on.
  float scale() const;
  /// That Vulkan must have to draw into windows.
  static std::vector<std::string> extensions();

 private:
  Window() = default;
  static Window& of(GLFWwindow* window);
  void listen();

  GLFWwindow* window_ = nullptr;
  bool is_open_ = false, has_changed_ = true;
  bool asks_for_keys_ = false, asks_for_screenshot_ = false;
  std::vector<view::Event> events_;
  std::vector<std::filesystem::path> dropped_;
};

}  // namespace luxel::view_window
