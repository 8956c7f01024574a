#include "apps/view/screen.h"

#include <volk.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <vector>

#include "luxel/base/file.h"
#include "luxel/image/codec.h"

namespace luxel::view_window {

namespace {

/// The window's pictures, and the panel over them.
Status fit_pictures(const Window& window, uint32_t width, uint32_t height, Screen& screen) {
  const gpu::Device& device = *screen.device;
  LUXEL_TRY(gpu::Swapchain swapchain,
            gpu::make_swapchain(device, *screen.surface, width, height,
                                screen.swapchain.images.empty() ? nullptr : &screen.swapchain));
  screen.swapchain = std::move(swapchain);
  if (!screen.ui) {
    screen.ui =
        Ui::make(window.get(), {device.instance, device.physical, device.device,
                                device.queue_family, device.queue, screen.swapchain.format});
  }
  std::vector<VkImageView> views;
  for (const auto& view : screen.swapchain.views) views.push_back(view.get());
  if (!screen.ui ||
      !screen.ui->set_pictures(views, screen.swapchain.width, screen.swapchain.height))
    return fail(ErrorCode::no_device, "{} cannot draw the panel", device.name);
  return {};
}

}  // namespace

Result<bool> fit_window(const Window& window, const view::DeviceScene& scene, Screen& screen) {
  const auto [width, height] = window.pixels();
  if (width == 0 || height == 0) return false;
  const gpu::Device& device = *screen.device;
  device.vk.vkDeviceWaitIdle(device.device);
  LUXEL_TRY_STATUS(fit_pictures(window, uint32_t(width), uint32_t(height), screen));
  LUXEL_TRY_STATUS(fit_scene(scene, screen));
  return true;
}

Status fit_scene(const view::DeviceScene& scene, Screen& screen) {
  LUXEL_TRY(screen.painter, view::make_painter(*screen.device, screen.shaders, scene,
                                               screen.swapchain.width, screen.swapchain.height));
  if (screen.beside) {
    LUXEL_TRY(screen.pair, view::make_pair(*screen.commands, screen.shaders, screen.painter,
                                           screen.beside->device));
  }
  return {};
}

bool has_size_of(const Window& window, const gpu::Swapchain& swapchain) {
  const auto [width, height] = window.pixels();
  return uint32_t(width) == swapchain.width && uint32_t(height) == swapchain.height;
}

Result<Screen> open_screen(const Window& window, const std::string& device_name) {
  Screen out;
  gpu::DeviceParams device_params;
  device_params.name = device_name;
  device_params.window_extensions = Window::extensions();
  LUXEL_TRY(out.device, gpu::Device::open(device_params));
  VkSurfaceKHR handle = VK_NULL_HANDLE;
  LUXEL_TRY_STATUS(
      gpu::check(glfwCreateWindowSurface(out.device->instance, window.get(), nullptr, &handle),
                 "cannot draw into the window"));
  LUXEL_TRY(gpu::Surface surface, gpu::Surface::adopt(*out.device, handle));
  out.surface.emplace(std::move(surface));
  LUXEL_TRY(gpu::Commands commands, gpu::Commands::make(*out.device));
  out.commands.emplace(std::move(commands));
  LUXEL_TRY(out.shaders, view::make_shaders(*out.device));
  return out;
}

namespace {

/// Records the drawing of a frame before the panel. In flip mode the two scenes are drawn already.
void record(const view::DeviceScene& scene, const view::Frame& frame, const Screen& screen,
            VkCommandBuffer commands) {
  const gpu::Device& device = *screen.device;
  const view::Canvas first = screen.canvas(scene);
  if (!screen.has_pair(frame)) return view::paint(device, commands, first, frame);
  if (frame.beside->mode != view::BesideMode::flip)
    view::paint_both(device, commands, first, screen.canvas_beside(), frame);
  view::put_together(device, commands, first, *screen.pair, frame);
}

}  // namespace

Result<bool> draw(const view::DeviceScene& scene, const view::Frame& frame, Screen& screen) {
  const gpu::Device& device = *screen.device;
  LUXEL_TRY(const std::optional<gpu::NextPicture> next,
            gpu::next_picture(device, screen.swapchain));
  if (!next) return false;
  const bool has_pair = screen.has_pair(frame);
  screen.flip = -1;
  if (has_pair && frame.beside->mode == view::BesideMode::flip) {
    LUXEL_TRY_STATUS(screen.commands->run([&](VkCommandBuffer commands) {
      view::paint_both(device, commands, screen.canvas(scene), screen.canvas_beside(), frame);
    }));
    LUXEL_TRY(screen.flip, view::compare(*screen.commands, screen.painter, *screen.pair));
  }
  LUXEL_TRY(const uint64_t number,
            screen.commands->submit(
                [&](VkCommandBuffer commands) {
                  record(scene, frame, screen, commands);
                  const gpu::Picture& shown =
                      (has_pair ? screen.pair->shown : screen.painter.shown).picture;
                  gpu::copy_to_window(device, commands, shown.image.get(), shown.params.width,
                                      shown.params.height, screen.swapchain, next->number);
                  screen.ui->record(commands, next->number);
                },
                next->semaphores));
  LUXEL_TRY(const bool is_current, gpu::show(device, screen.swapchain, next->number));
  LUXEL_TRY_STATUS(screen.commands->wait(number));
  return is_current;
}

Result<image::Image8> picture_of(const view::DeviceScene& scene, const view::Frame& frame,
                                 Screen& screen) {
  if (!screen.has_pair(frame)) return view::painted(*screen.commands, screen.canvas(scene), frame);
  return view::painted_together(*screen.commands, screen.canvas(scene), screen.canvas_beside(),
                                *screen.pair, frame);
}

Status write_screenshot(const view::DeviceScene& scene, const view::Frame& frame, Screen& screen,
                        std::string& message) {
  LUXEL_TRY(const image::Image8 picture, picture_of(scene, frame, screen));
  std::filesystem::path file;
  std::error_code ignored;
  for (int number = 1; file.empty() || std::filesystem::exists(file, ignored); ++number)
    file = fmt::format("luxel-view-{}.png", number);
  const Status written = write_file_atomically(file, image::encode_png(picture));
  message = written ? "wrote " + file.string() : written.error().message;
  return {};
}

}  // namespace luxel::view_window
