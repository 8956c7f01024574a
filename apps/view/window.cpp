#include "apps/view/window.h"

#include <volk.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <array>
#include <chrono>
#include <cmath>
#include <span>
#include <vector>

#include "apps/view/looking.h"
#include "apps/view/ui.h"
#include "luxel/base/file.h"
#include "luxel/gpu/swapchain.h"
#include "luxel/image/codec.h"
#include "luxel/trace/ray_tracer.h"
#include "luxel/view/draw/painter.h"
#include "luxel/view/model/walk.h"

namespace luxel::view_window {
namespace {

constexpr const char* kWithoutWindow =
    "draw without a window by --offscreen, or make a page of it by `luxel bake --html`";

/// GLFW itself and one window.
class Window {
 public:
  static Result<std::unique_ptr<Window>> open(const WindowParams& params) {
    std::unique_ptr<Window> out(new Window);
    if (!glfwInit())
      return fail(ErrorCode::no_device, "there is no display to open a window on; {}",
                  kWithoutWindow);
    out->is_open_ = true;
    if (!glfwVulkanSupported())
      return fail(ErrorCode::no_device, "there is no Vulkan on this machine; {}", kWithoutWindow);
    glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
    glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);
    out->window_ =
        glfwCreateWindow(params.width, params.height, params.title.c_str(), nullptr, nullptr);
    if (!out->window_)
      return fail(ErrorCode::no_device, "a window cannot be opened on this display; {}",
                  kWithoutWindow);
    out->listen();
    return out;
  }
  ~Window() {
    if (window_) glfwDestroyWindow(window_);
    if (is_open_) glfwTerminate();
  }
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  GLFWwindow* get() const { return window_; }
  /// What the user did since the last call.
  std::vector<view::Event> taken() { return std::exchange(events_, {}); }
  /// Whether something has happened since the last call that may change the picture.
  bool has_changed() { return std::exchange(has_changed_, false) || !events_.empty(); }
  bool asks_for_keys() { return std::exchange(asks_for_keys_, false); }
  bool asks_for_screenshot() { return std::exchange(asks_for_screenshot_, false); }
  std::array<int, 2> pixels() const {
    std::array<int, 2> size{};
    glfwGetFramebufferSize(window_, &size[0], &size[1]);
    return size;
  }
  static std::vector<std::string> extensions() {
    uint32_t count = 0;
    const char** names = glfwGetRequiredInstanceExtensions(&count);
    return names ? std::vector<std::string>(names, names + count) : std::vector<std::string>();
  }

 private:
  Window() = default;

  static Window& of(GLFWwindow* window) {
    return *static_cast<Window*>(glfwGetWindowUserPointer(window));
  }
  /// Before ImGui's own callbacks, which call these.
  void listen() {
    glfwSetWindowUserPointer(window_, this);
    glfwSetWindowRefreshCallback(window_, [](GLFWwindow* w) { of(w).has_changed_ = true; });
    glfwSetCursorPosCallback(window_, [](GLFWwindow* w, double x, double y) {
      int width = 1, height = 1;  // in the display's units, which may be several pixels
      glfwGetWindowSize(w, &width, &height);
      const auto pixels = of(w).pixels();
      of(w).events_.push_back(view::PointerMoved{
          {float(x * pixels[0] / std::max(width, 1)), float(y * pixels[1] / std::max(height, 1))}});
    });
    glfwSetMouseButtonCallback(window_, [](GLFWwindow* w, int button, int action, int) {
      if (button > GLFW_MOUSE_BUTTON_MIDDLE) return;
      const view::Button which = button == GLFW_MOUSE_BUTTON_LEFT    ? view::Button::left
                                 : button == GLFW_MOUSE_BUTTON_RIGHT ? view::Button::right
                                                                     : view::Button::middle;
      of(w).events_.push_back(view::ButtonChanged{which, action == GLFW_PRESS});
    });
    glfwSetScrollCallback(window_, [](GLFWwindow* w, double, double y) {
      of(w).events_.push_back(view::Scrolled{float(y)});
    });
    glfwSetKeyCallback(window_, [](GLFWwindow* w, int key, int code, int action, int) {
      if (action == GLFW_REPEAT) return;
      of(w).has_changed_ = true;
      if (key == GLFW_KEY_F1 && action == GLFW_PRESS) of(w).asks_for_keys_ = true;
      if (key == GLFW_KEY_F12 && action == GLFW_PRESS) of(w).asks_for_screenshot_ = true;
      if (const std::string name = name_of(key, code); !name.empty())
        of(w).events_.push_back(view::KeyChanged{name, action == GLFW_PRESS});
    });
  }
  /// As view::kKeys has it: letters as the keyboard's language prints them.
  static std::string name_of(int key, int code) {
    switch (key) {
      case GLFW_KEY_LEFT_SHIFT:
      case GLFW_KEY_RIGHT_SHIFT:
        return "shift";
      case GLFW_KEY_HOME:
        return "home";
      case GLFW_KEY_KP_ADD:
      case GLFW_KEY_EQUAL:
        return "+";
      case GLFW_KEY_KP_SUBTRACT:
        return "-";
      default:
        break;
    }
    const char* printed = glfwGetKeyName(key, code);
    return printed ? printed : "";
  }

  GLFWwindow* window_ = nullptr;
  bool is_open_ = false, has_changed_ = true;
  bool asks_for_keys_ = false, asks_for_screenshot_ = false;
  std::vector<view::Event> events_;
};

/// All that draws in the window. What is made later ends first.
struct Screen {
  std::unique_ptr<gpu::Device> device;
  std::optional<gpu::Surface> surface;
  std::optional<gpu::Commands> commands;
  view::DeviceScene scene;
  view::Shaders shaders;
  gpu::Swapchain swapchain;
  view::Painter painter;  ///< of the window's size
  std::unique_ptr<Ui> ui;
  Looking looking;

  view::Canvas canvas() const {
    return {shaders, painter, scene, looking.overlay ? &*looking.overlay : nullptr};
  }
};

/// The window's pictures and what is drawn into them, of the window's size. False while it has
/// none.
Result<bool> fit_window(const Window& window, Screen& screen) {
  const auto [width, height] = window.pixels();
  if (width == 0 || height == 0) return false;
  const gpu::Device& device = *screen.device;
  device.vk.vkDeviceWaitIdle(device.device);
  LUXEL_TRY(gpu::Swapchain swapchain,
            gpu::make_swapchain(device, *screen.surface, uint32_t(width), uint32_t(height),
                                screen.swapchain.images.empty() ? nullptr : &screen.swapchain));
  screen.swapchain = std::move(swapchain);
  LUXEL_TRY(screen.painter, view::make_painter(device, screen.shaders, screen.scene,
                                               screen.swapchain.width, screen.swapchain.height));
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
  return true;
}

/// Not every display says so when the window has got another size.
bool has_size_of(const Window& window, const gpu::Swapchain& swapchain) {
  const auto [width, height] = window.pixels();
  return uint32_t(width) == swapchain.width && uint32_t(height) == swapchain.height;
}

Result<Screen> open_screen(const Window& window, const view::OpenedBake& bake,
                           const WindowParams& params) {
  Screen out;
  gpu::DeviceParams device_params;
  device_params.name = params.device;
  device_params.window_extensions = Window::extensions();
  LUXEL_TRY(out.device, gpu::Device::open(device_params));
  VkSurfaceKHR handle = VK_NULL_HANDLE;
  LUXEL_TRY_STATUS(
      gpu::check(glfwCreateWindowSurface(out.device->instance, window.get(), nullptr, &handle),
                 "the window cannot be drawn into"));
  LUXEL_TRY(gpu::Surface surface, gpu::Surface::adopt(*out.device, handle));
  out.surface.emplace(std::move(surface));
  LUXEL_TRY(gpu::Commands commands, gpu::Commands::make(*out.device));
  out.commands.emplace(std::move(commands));
  view::DeviceSceneParams scene_params;
  scene_params.light_changes = bake.has_layers;
  LUXEL_TRY(out.scene,
            view::put_on_device(*out.commands, bake.scene, bake.lightmaps, scene_params));
  LUXEL_TRY(out.shaders, view::make_shaders(*out.device));
  return out;
}

/// Draws a frame into the window. False when the window has changed.
Result<bool> draw(const view::Frame& frame, Screen& screen) {
  const gpu::Device& device = *screen.device;
  LUXEL_TRY(const std::optional<gpu::NextPicture> next,
            gpu::next_picture(device, screen.swapchain));
  if (!next) return false;
  LUXEL_TRY(const uint64_t number,
            screen.commands->submit(
                [&](VkCommandBuffer commands) {
                  view::paint(device, commands, screen.canvas(), frame);
                  const gpu::Picture& shown = screen.painter.shown.picture;
                  gpu::copy_to_window(device, commands, shown.image.get(), shown.params.width,
                                      shown.params.height, screen.swapchain, next->number);
                  screen.ui->record(commands, next->number);
                },
                next->semaphores));
  LUXEL_TRY(const bool is_current, gpu::show(device, screen.swapchain, next->number));
  LUXEL_TRY_STATUS(screen.commands->wait(number));
  return is_current;
}

std::vector<KeyLine> key_lines() {
  std::vector<KeyLine> out{
      {"left button", "turn"}, {"other buttons", "move the picture"}, {"wheel", "nearer, farther"}};
  for (const view::KeyHelp& key : view::kKeys) out.push_back({key.key, key.does});
  return out;
}

/// The surface under the pointer; none under the panel.
std::optional<scene::SurfacePoint> pointed_surface(const Ui& ui, const view::OpenedBake& bake,
                                                   const trace::RayTracer& tracer,
                                                   const view::Walk& walk) {
  if (ui.has_pointer() || !view::looks_into_bake(walk.shown.show)) return std::nullopt;
  return view::surface_seen(bake.scene, tracer, walk.shown, walk.pointer, walk.width, walk.height);
}

/// What the panel changes of a walk, and the walk of the panel.
void exchange(Ui& ui, const view::OpenedBake& bake, const trace::RayTracer& tracer,
              const Looking& looking, Panel& panel, view::Walk& walk) {
  panel.show = int(walk.shown.show);
  panel.stops = std::log2(walk.shown.exposure / walk.first.exposure);
  fill_panel(walk.shown, bake, looking, pointed_surface(ui, bake, tracer, walk), panel.look);
  const Panel before = panel;
  ui.lay_out(panel);
  if (panel.show != before.show) walk.shown.show = view::Show(panel.show);
  take_panel(panel.look, before.look, walk.shown);
  if (panel.stops != before.stops)
    walk.shown.exposure = walk.first.exposure * std::exp2(panel.stops);
  if (const int view = std::exchange(panel.view, -1); view >= 0)
    walk.shown.camera = bake.scene.cameras[size_t(view)];
}

/// Writes what is shown, without the panel, into the first file of this name that is not there.
Status write_screenshot(const view::Frame& frame, Screen& screen, std::string& message) {
  LUXEL_TRY(const image::Image8 picture, view::painted(*screen.commands, screen.canvas(), frame));
  std::filesystem::path file;
  std::error_code ignored;
  for (int number = 1; file.empty() || std::filesystem::exists(file, ignored); ++number)
    file = fmt::format("luxel-view-{}.png", number);
  const Status written = write_file_atomically(file, image::encode_png(picture));
  message = written ? "wrote " + file.string() : written.error().message;
  return {};
}

/// Events of the user, but for those that are the panel's.
void take_events(Window& window, const Ui& ui, const view::PlaceSeen& place_seen,
                 view::Walk& walk) {
  for (const view::Event& event : window.taken()) {
    const bool is_key = std::holds_alternative<view::KeyChanged>(event);
    const auto* button = std::get_if<view::ButtonChanged>(&event);
    const bool is_end = button && !button->is_down;  // a drag ends wherever it does
    if (!is_end && !std::holds_alternative<view::PointerMoved>(event) &&
        (is_key ? ui.has_keys() : ui.has_pointer()))
      continue;
    view::handle(event, place_seen, walk);
  }
}

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point then) {
  return std::chrono::duration<double>(Clock::now() - then).count();
}

/// The panel lays itself out anew for some frames after a change.
constexpr int kFramesToSettle = 3;

/// A window while it is open.
struct Session {
  Window& window;
  Screen& screen;
  const view::OpenedBake& bake;
  const trace::RayTracer& tracer;
  const WindowParams& params;
  std::vector<KeyLine> keys = key_lines();
  std::vector<std::string> views = {};  ///< names of the scene's cameras
  Panel panel = {};
  std::optional<view::Walk> walk = {};  ///< once the window has a size
  view::PlaceSeen place_seen = {};
  int still_frames = 0;  ///< since something changed
  bool fits = false;     ///< what is drawn into has the window's size
  int64_t frame = 0;     ///< of a play
  size_t next_event = 0;
  Clock::time_point last = Clock::now();
};

/// Fits what is drawn into to the window. False while the window has no size, as when it is hidden.
Result<bool> fit(Session& s) {
  if (s.fits && has_size_of(s.window, s.screen.swapchain)) return true;
  LUXEL_TRY(s.fits, fit_window(s.window, s.screen));
  if (!s.fits) return false;
  const auto width = int(s.screen.swapchain.width), height = int(s.screen.swapchain.height);
  s.place_seen = view::place_seen_in(s.bake.scene, s.tracer, width, height);
  if (!s.walk)
    s.walk = view::begin_walk(s.bake.first, scene::world_bounds(s.bake.scene), width, height,
                              s.place_seen);
  s.walk->width = width, s.walk->height = height;
  return true;
}

/// One frame of the window. False when a play has come to its end.
Result<bool> go_on(Session& s) {
  // A window in which nothing moves is not drawn.
  const bool moves = s.params.play || (s.walk && !s.walk->keys.empty());
  moves ? glfwPollEvents() : glfwWaitEventsTimeout(0.1);
  const bool fitted = s.fits;
  LUXEL_TRY(const bool fits, fit(s));
  const double passed = seconds_since(std::exchange(s.last, Clock::now()));
  if (!fits) return true;
  s.still_frames = moves || !fitted || s.window.has_changed() ? 0 : s.still_frames + 1;
  if (s.still_frames > kFramesToSettle) return true;
  if (s.params.play) {
    view::handle_frame(*s.params.play, s.frame, s.place_seen, s.next_event, *s.walk);
  } else {
    take_events(s.window, *s.screen.ui, s.place_seen, *s.walk);
    view::pass(std::min(passed, 0.1), *s.walk);
  }
  if (s.window.asks_for_keys()) s.panel.keys_open = !s.panel.keys_open;
  prepare_look(s.bake, *s.screen.commands, s.screen.shaders, s.screen.scene, s.walk->shown,
               s.screen.looking, s.panel.message);
  prepare_layers(s.bake, *s.screen.commands, s.panel.look.asks_for_layers, s.walk->shown,
                 s.screen.scene, s.screen.looking, s.panel.message);
  exchange(*s.screen.ui, s.bake, s.tracer, s.screen.looking, s.panel, *s.walk);
  const auto begin = Clock::now();
  LUXEL_TRY(s.fits, draw(s.walk->shown, s.screen));
  s.panel.milliseconds = float(1000 * seconds_since(begin));
  if (s.window.asks_for_screenshot())
    LUXEL_TRY_STATUS(write_screenshot(s.walk->shown, s.screen, s.panel.message));
  if (!s.params.play) return true;
  if (double(s.frame) >= s.params.play->end_s * s.params.play->frames_per_s) return false;
  view::pass(1 / s.params.play->frames_per_s, *s.walk);
  ++s.frame;
  return true;
}

}  // namespace

Status show_in_window(const view::OpenedBake& bake, const WindowParams& params) {
  LUXEL_TRY(const std::unique_ptr<Window> window, Window::open(params));
  LUXEL_TRY(Screen screen, open_screen(*window, bake, params));
  LUXEL_TRY(const trace::RayTracer tracer, trace::RayTracer::build(bake.scene));
  Session session{*window, screen, bake, tracer, params};
  session.panel.title = params.title, session.panel.about = screen.device->name;
  session.panel.keys = session.keys;
  for (const scene::Camera& camera : bake.scene.cameras)
    session.views.push_back(camera.name.empty() ? "camera" : camera.name);
  session.panel.views = session.views;
  bool is_going_on = true;
  while (is_going_on && !glfwWindowShouldClose(window->get()))
    LUXEL_TRY_STATUS(go_on(session).map([&](bool more) { is_going_on = more; }));
  if (params.screenshot.empty() || !session.walk) return {};
  LUXEL_TRY(const image::Image8 picture,
            view::painted(*screen.commands, screen.canvas(), session.walk->shown));
  return write_file_atomically(params.screenshot, image::encode_png(picture));
}

}  // namespace luxel::view_window
