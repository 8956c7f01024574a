// Drawing in a window: the device, the window's pictures and what is drawn into them.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "apps/view/looking.h"
#include "apps/view/ui.h"
#include "apps/view/window.h"
#include "luxel/gpu/swapchain.h"
#include "luxel/view/draw/beside.h"
#include "luxel/view/draw/painter.h"

namespace luxel::view_window {

/// Members stand in the order in which they are made, so that later ones end first.
struct Screen {
  std::unique_ptr<gpu::Device> device;
  std::optional<gpu::Surface> surface;
  std::optional<gpu::Commands> commands;
  view::Shaders shaders;
  gpu::Swapchain swapchain;
  view::Painter painter;  ///< of the window's size
  std::unique_ptr<Ui> ui;
  Looking looking;
  const view::Additions* additions = nullptr;  ///< of the subject
  view::ShownScene* beside = nullptr;          ///< a second scene; null: there is none
  Looking looking_beside;
  std::optional<view::Pair> pair;  ///< of the window's size, where there is a second scene
  float flip = -1;                 ///< of what was drawn last; < 0: not known

  view::Canvas canvas(const view::DeviceScene& scene) const {
    return canvas_of(shaders, painter, scene, looking, additions);
  }
  view::Canvas canvas_beside() const {
    return canvas_of(shaders, pair->second, beside->device, looking_beside);
  }
  bool has_pair(const view::Frame& frame) const { return pair && frame.beside; }
};

/// `device_name`: gpu::DeviceParams::name. Errors (no_device): none that shows pictures in a
/// window.
Result<Screen> open_screen(const Window& window, const std::string& device_name);

/// The window's pictures and what a scene is drawn with, of the window's size. False while it has
/// none, as when it is hidden.
Result<bool> fit_window(const Window& window, const view::DeviceScene& scene, Screen& screen);

/// Prepares a window that is fitted to draw another scene. Nothing may still draw. Errors: no
/// memory on the device.
Status fit_scene(const view::DeviceScene& scene, Screen& screen);

/// Not every display says so when the window has got another size.
bool has_size_of(const Window& window, const gpu::Swapchain& swapchain);

/// Draws a frame into the window and returns when it is drawn. False when the window has changed.
Result<bool> draw(const view::DeviceScene& scene, const view::Frame& frame, Screen& screen);

/// A frame without the panel: 3 channels. Errors: the device is lost, no memory.
Result<image::Image8> picture_of(const view::DeviceScene& scene, const view::Frame& frame,
                                 Screen& screen);

/// Writes what is shown, without the panel, into the first file luxel-view-N.png that is not there;
/// `message` says where, or why it cannot. Errors: the device is lost.
Status write_screenshot(const view::DeviceScene& scene, const view::Frame& frame, Screen& screen,
                        std::string& message);

}  // namespace luxel::view_window
