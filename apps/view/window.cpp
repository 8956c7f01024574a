#include "apps/view/window.h"

#include <volk.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>
#include <string_view>

namespace luxel::view_window {
namespace {

constexpr const char* kWithoutWindow =
    "draw without a window with --offscreen, or make a web page with `luxel bake --html`";

/// As view::kKeys has it: letters as the keyboard's language prints them.
std::string name_of(int key, int code) {
  switch (key) {
    case GLFW_KEY_LEFT_SHIFT:
    case GLFW_KEY_RIGHT_SHIFT:
      return "shift";
    case GLFW_KEY_LEFT_CONTROL:
    case GLFW_KEY_RIGHT_CONTROL:
      return "ctrl";
    case GLFW_KEY_ESCAPE:
      return "esc";
    case GLFW_KEY_DELETE:
      return "delete";
    case GLFW_KEY_SPACE:
      return "space";
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

/// Keys that are held with another one, as view::kKeys has it; those themselves are held with none.
const char* held_with(const std::string& name, int with) {
  if (name == "ctrl" || name == "shift") return "";
  if (with & GLFW_MOD_CONTROL) return with & GLFW_MOD_SHIFT ? "ctrl+shift+" : "ctrl+";
  return with & GLFW_MOD_ALT ? "alt+" : "";
}

}  // namespace

Result<std::unique_ptr<Window>> Window::open(const std::string& title, int width, int height) {
  std::unique_ptr<Window> out(new Window);
  if (!glfwInit())
    return fail(ErrorCode::no_device, "there is no display to open a window on; {}",
                kWithoutWindow);
  out->is_open_ = true;
  if (!glfwVulkanSupported())
    return fail(ErrorCode::no_device, "there is no Vulkan on this machine; {}", kWithoutWindow);
  glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
  glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);
  out->window_ = glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr);
  if (!out->window_)
    return fail(ErrorCode::no_device, "cannot open a window on this display; {}", kWithoutWindow);
  out->listen();
  return out;
}

Window::~Window() {
  if (window_) glfwDestroyWindow(window_);
  if (is_open_) glfwTerminate();
}

std::array<int, 2> Window::pixels() const {
  std::array<int, 2> size{};
  glfwGetFramebufferSize(window_, &size[0], &size[1]);
  return size;
}

float Window::scale() const {
  float out = 1;
  glfwGetWindowContentScale(window_, &out, nullptr);
  return out;
}

std::vector<std::string> Window::extensions() {
  uint32_t count = 0;
  const char** names = glfwGetRequiredInstanceExtensions(&count);
  return names ? std::vector<std::string>(names, names + count) : std::vector<std::string>();
}

Window& Window::of(GLFWwindow* window) {
  return *static_cast<Window*>(glfwGetWindowUserPointer(window));
}

/// Before ImGui's own callbacks, which call these.
void Window::listen() {
  glfwSetWindowUserPointer(window_, this);
  glfwSetWindowRefreshCallback(window_, [](GLFWwindow* w) { of(w).has_changed_ = true; });
  glfwSetWindowContentScaleCallback(window_,
                                    [](GLFWwindow* w, float, float) { of(w).has_changed_ = true; });
  glfwSetDropCallback(window_, [](GLFWwindow* w, int count, const char** paths) {
    of(w).has_changed_ = true;
    of(w).dropped_.assign(paths, paths + count);
  });
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
  glfwSetKeyCallback(window_, [](GLFWwindow* w, int key, int code, int action, int with) {
    if (action == GLFW_REPEAT) return;
    of(w).has_changed_ = true;
    if (key == GLFW_KEY_F1 && action == GLFW_PRESS) of(w).asks_for_keys_ = true;
    if (key == GLFW_KEY_F12 && action == GLFW_PRESS) of(w).asks_for_screenshot_ = true;
    const std::string name = name_of(key, code);
    if (name.empty()) return;
    const bool is_down = action == GLFW_PRESS;
    const char* held = held_with(name, with);
    // Either key may go up first.
    for (const char* before : {"", "ctrl+", "ctrl+shift+", "alt+"})
      if (!is_down || before == std::string_view(held))
        of(w).events_.push_back(view::KeyChanged{before + name, is_down});
  });
}

}  // namespace luxel::view_window
