#include "apps/view/ui.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_vulkan.h>
#include <imgui.h>

#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "apps/view/ui_text.h"

namespace luxel::view_window {
namespace {

constexpr float kLettersHeight = 13;  ///< height of ImGui's own [points]

/// One attachment that is drawn over and shown afterwards.
VkRenderPass make_pass(const UiDevice& device) {
  VkAttachmentDescription attachment{};
  attachment.format = device.format;
  attachment.samples = VK_SAMPLE_COUNT_1_BIT;
  attachment.loadOp = VK_ATTACHMENT_LOAD_OP_LOAD;
  attachment.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
  attachment.stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE;
  attachment.stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
  attachment.initialLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
  attachment.finalLayout = VK_IMAGE_LAYOUT_PRESENT_SRC_KHR;
  const VkAttachmentReference reference{0, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
  VkSubpassDescription subpass{};
  subpass.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS;
  subpass.colorAttachmentCount = 1;
  subpass.pColorAttachments = &reference;
  VkRenderPassCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO;
  info.attachmentCount = 1, info.pAttachments = &attachment;
  info.subpassCount = 1, info.pSubpasses = &subpass;
  VkRenderPass pass = VK_NULL_HANDLE;
  vkCreateRenderPass(device.device, &info, nullptr, &pass);
  return pass;
}

VkDescriptorPool make_pool(const UiDevice& device) {
  const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 16};
  VkDescriptorPoolCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO;
  info.flags = VK_DESCRIPTOR_POOL_CREATE_FREE_DESCRIPTOR_SET_BIT;
  info.maxSets = 16;
  info.poolSizeCount = 1, info.pPoolSizes = &size;
  VkDescriptorPool pool = VK_NULL_HANDLE;
  vkCreateDescriptorPool(device.device, &info, nullptr, &pool);
  return pool;
}

class ImGuiUi : public Ui {
 public:
  explicit ImGuiUi(const UiDevice& device)
      : device_(device), pass_(make_pass(device)), pool_(make_pool(device)) {}

  bool open(GLFWwindow* window) {
    if (pass_ == VK_NULL_HANDLE || pool_ == VK_NULL_HANDLE) return false;
    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr;  // nothing is written where the program is run
    ImGui::GetIO().Fonts->Build();         // record() puts them on the device
    has_context_ = true;
    if (!ImGui_ImplGlfw_InitForVulkan(window, true)) return false;
    has_window_ = true;
    return open_device();
  }

  bool open_device() {
    ImGui_ImplVulkan_InitInfo info{};
    info.Instance = device_.instance, info.PhysicalDevice = device_.physical;
    info.Device = device_.device;
    info.QueueFamily = device_.queue_family, info.Queue = device_.queue;
    info.DescriptorPool = pool_;
    info.MinImageCount = info.ImageCount = 3;  // as many frames as may be under way
    info.MSAASamples = VK_SAMPLE_COUNT_1_BIT;
    has_device_ = ImGui_ImplVulkan_Init(&info, pass_);
    return has_device_;
  }

  ~ImGuiUi() override {
    vkDeviceWaitIdle(device_.device);
    if (has_device_) ImGui_ImplVulkan_Shutdown();
    if (has_window_) ImGui_ImplGlfw_Shutdown();
    if (has_context_) ImGui::DestroyContext();
    end_pictures();
    vkDestroyDescriptorPool(device_.device, pool_, nullptr);
    vkDestroyRenderPass(device_.device, pass_, nullptr);
  }

  bool set_pictures(std::span<const VkImageView> views, uint32_t width, uint32_t height) override {
    end_pictures();
    width_ = width, height_ = height;
    for (const VkImageView& view : views) {
      VkFramebufferCreateInfo info{};
      info.sType = VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO;
      info.renderPass = pass_;
      info.attachmentCount = 1, info.pAttachments = &view;
      info.width = width, info.height = height, info.layers = 1;
      VkFramebuffer picture = VK_NULL_HANDLE;
      if (vkCreateFramebuffer(device_.device, &info, nullptr, &picture) != VK_SUCCESS) return false;
      pictures_.push_back(picture);
    }
    return true;
  }

  bool has_pointer() const override { return ImGui::GetIO().WantCaptureMouse; }
  bool has_keys() const override { return ImGui::GetIO().WantTextInput; }

  void lay_out(Panel& panel) override {
    if (panel.scale != scale_) set_letters(panel.scale);
    if (panel.is_light != is_light_ || panel.scale != scale_) set_style(panel);
    ImGui_ImplVulkan_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    ImGui::NewFrame();
    const float right = lay_out_panel(panel);
    if (panel.selection) lay_out_selection(*panel.selection);
    if (panel.keys_open) lay_out_keys(right, panel);
    ImGui::Render();
  }

  void record(VkCommandBuffer commands, uint32_t picture) override {
    if (!has_font_) has_font_ = ImGui_ImplVulkan_CreateFontsTexture(commands);
    VkRenderPassBeginInfo info{};
    info.sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO;
    info.renderPass = pass_;
    info.framebuffer = pictures_[picture];
    info.renderArea.extent = {width_, height_};
    vkCmdBeginRenderPass(commands, &info, VK_SUBPASS_CONTENTS_INLINE);
    ImGui_ImplVulkan_RenderDrawData(ImGui::GetDrawData(), commands);
    vkCmdEndRenderPass(commands);
  }

 private:
  /// Letters are drawn for their size, not made larger. ImGui puts them on the device once: it
  /// begins there anew.
  void set_letters(float scale) {
    vkDeviceWaitIdle(device_.device);
    ImGui_ImplVulkan_Shutdown();
    ImFontConfig letters;
    letters.SizePixels = std::round(kLettersHeight * scale);
    ImGui::GetIO().Fonts->Clear();
    ImGui::GetIO().Fonts->AddFontDefault(&letters);
    ImGui::GetIO().Fonts->Build();
    has_font_ = false;
    open_device();
  }
  /// Sizes are those of a monitor with one pixel per point, times its scale.
  void set_style(const Panel& panel) {
    ImGui::GetStyle() = ImGuiStyle();
    panel.is_light ? ImGui::StyleColorsLight() : ImGui::StyleColorsDark();
    ImGui::GetStyle().ScaleAllSizes(panel.scale);
    is_light_ = panel.is_light, scale_ = panel.scale;
  }

  /// ImGui keeps what is open under numbers, which are made of names.
  static void put_headers(const PanelLayout& layout) {
    for (const uint32_t id : layout.open) ImGui::GetStateStorage()->SetInt(id, 1);
    for (const uint32_t id : layout.closed) ImGui::GetStateStorage()->SetInt(id, 0);
  }
  static void take_layout(PanelLayout& layout) {
    layout = {};
    layout.place = {ImGui::GetWindowPos().x, ImGui::GetWindowPos().y};
    for (const auto& known : ImGui::GetStateStorage()->Data)
      (known.val_i != 0 ? layout.open : layout.closed).push_back(known.key);
  }

  /// A panel that would lie outside of a smaller window than the last lies in its corner.
  void put_panel(const PanelLayout& layout) const {
    const auto place = layout.place.value_or(std::array{10.0f, 10.0f});
    const bool is_seen = place[0] >= 0 && place[1] >= 0 && place[0] + 40 < float(width_) &&
                         place[1] + 40 < float(height_);
    ImGui::SetNextWindowPos(is_seen ? ImVec2(place[0], place[1]) : ImVec2(10, 10),
                            ImGuiCond_FirstUseEver);
  }

  /// Returns where its right edge is.
  float lay_out_panel(Panel& panel) {
    put_panel(panel.layout);
    ImGui::SetNextWindowSizeConstraints({0, 0}, {FLT_MAX, ImGui::GetIO().DisplaySize.y - 20});
    // The panel is the same whatever its title is.
    ImGui::Begin((panel.title + "###panel").c_str(), nullptr, ImGuiWindowFlags_AlwaysAutoResize);
    if (!std::exchange(has_layout_, true)) put_headers(panel.layout);
    take_layout(panel.layout);
    lay_out_text(panel.about);
    lay_out_again(panel);
    if (panel.is_empty) return lay_out_empty(panel);
    if (panel.bake) lay_out_bake(*panel.bake);
    if (panel.relight) lay_out_relight(*panel.relight);
    if (panel.solver) lay_out_solver(*panel.solver);
    if (panel.hemicube) {
      lay_out_hemicube(*panel.hemicube);
    } else {
      lay_out_shows(panel);
      lay_out_parts(panel.parts);
    }
    ImGui::SetNextItemWidth(ImGui::GetFontSize() * 10);
    ImGui::SliderFloat("exposure", &panel.stops, -8, 8, "%+.1f stops");
    ImGui::Checkbox("turn around (O)", &panel.turns);
    if (!panel.views.empty() && ImGui::CollapsingHeader("views of the file"))
      for (size_t i = 0; i < panel.views.size(); ++i) {
        ImGui::PushID(int(i));  // names need not differ
        if (lay_out_line_of_list(panel.views[i], false)) panel.view = int(i);
        ImGui::PopID();
      }
    lay_out_bookmarks(panel);
    lay_out_warnings(panel.warnings);
    if (panel.lamps) lay_out_lamps(*panel.lamps);
    if (panel.edit) lay_out_edit(*panel.edit);
    lay_out_recent(panel);
    ImGui::Text("%.1f ms per frame", double(panel.milliseconds));
    return end_panel(panel);
  }

  /// Lays out the last lines of every panel. Returns the place of its right edge.
  static float end_panel(Panel& panel) {
    if (!panel.message.empty()) lay_out_wrapped(panel.message);
    if (ImGui::Button("keys (F1)")) panel.keys_open = !panel.keys_open;
    ImGui::SameLine();
    ImGui::Checkbox("light theme", &panel.is_light);
    const float right = ImGui::GetWindowPos().x + ImGui::GetWindowSize().x;
    ImGui::End();
    return right;
  }

  static float lay_out_empty(Panel& panel) {
    lay_out_wrapped("drop a scene, the folder of a bake or an .lxr file on this window");
    lay_out_recent(panel);
    return end_panel(panel);
  }

  static void lay_out_shows(Panel& panel) {
    ImGui::RadioButton("light and colour", &panel.show, 0);
    ImGui::RadioButton("light", &panel.show, 1);
    ImGui::RadioButton("colour", &panel.show, 2);
    lay_out_look(panel.look);
  }

  /// A button for each that there is.
  static void lay_out_bookmarks(Panel& panel) {
    bool is_first = true;
    for (size_t i = 0; i < panel.has_bookmark.size(); ++i) {
      if (!panel.has_bookmark[i]) continue;
      if (is_first) ImGui::TextUnformatted("bookmarks");
      is_first = false;
      ImGui::SameLine();
      const char name[] = {char('1' + i), 0};
      if (ImGui::SmallButton(name)) panel.bookmark = int(i);
    }
  }

  /// A click opens it.
  static void lay_out_recent(Panel& panel) {
    if (panel.is_empty) ImGui::SetNextItemOpen(true, ImGuiCond_Once);
    if (panel.recent.empty() || !ImGui::CollapsingHeader("recent")) return;
    for (size_t i = 0; i < panel.recent.size(); ++i) {
      ImGui::PushID(int(i));
      if (ImGui::Selectable("##path")) panel.opens = int(i);
      ImGui::SameLine(0, 0);
      lay_out_wrapped(panel.recent[i]);
      ImGui::PopID();
    }
  }

  static void lay_out_again(Panel& panel) {
    if (!panel.offers_again) return;
    ImGui::TextUnformatted("the file has changed on disk");
    ImGui::SameLine();
    panel.asks_again = ImGui::Button("open it again");
  }

  /// The header keeps its place in ImGui's memory however many there are.
  static void lay_out_warnings(std::span<const std::string> warnings) {
    const std::string header = "warnings (" + std::to_string(warnings.size()) + ")###warnings";
    if (warnings.empty() || !ImGui::CollapsingHeader(header.c_str())) return;
    for (const std::string& warning : warnings) {
      ImGui::Bullet();
      lay_out_wrapped(warning);
    }
  }

  static void lay_out_wrapped(const std::string& text) {
    ImGui::PushTextWrapPos(ImGui::GetFontSize() * 22);
    lay_out_text(text);
    ImGui::PopTextWrapPos();
  }

  static void lay_out_bake(BakeLines& bake) {
    lay_out_progress(bake.share, bake.state);
    for (const std::string& line : bake.lines) lay_out_text(line);
    if (!bake.note.empty()) lay_out_wrapped(bake.note);
    if (bake.can_stop) bake.asks_to_stop = ImGui::Button("stop");
    if (bake.can_go_on) bake.asks_to_go_on = ImGui::Button("go on");
    if (bake.can_save) bake.asks_to_save = ImGui::Button("save");
    ImGui::Separator();
  }

  static void lay_out_relight(RelightLines& relight) {
    if (!relight.stage.empty()) lay_out_progress(relight.share, relight.stage);
    if (!relight.left.empty()) lay_out_text(relight.left);
    relight.asks = ImGui::Button(relight.does.c_str());
    ImGui::Separator();
  }

  static void lay_out_keys(float left, Panel& panel) {
    ImGui::SetNextWindowPos({left, 10}, ImGuiCond_Appearing);
    ImGui::SetNextWindowSizeConstraints({0, 0}, {FLT_MAX, ImGui::GetIO().DisplaySize.y - 20});
    ImGui::Begin("keys", &panel.keys_open, ImGuiWindowFlags_AlwaysAutoResize);
    if (ImGui::BeginTable("keys", 2)) {
      for (const KeyLine& line : panel.keys) {
        ImGui::TableNextColumn();
        ImGui::TextUnformatted(line.key);
        ImGui::TableNextColumn();
        ImGui::TextUnformatted(line.does);
      }
      ImGui::EndTable();
    }
    ImGui::End();
  }

  void end_pictures() {
    for (const VkFramebuffer picture : pictures_)
      vkDestroyFramebuffer(device_.device, picture, nullptr);
    pictures_.clear();
  }

  UiDevice device_;
  VkRenderPass pass_;
  VkDescriptorPool pool_;
  std::vector<VkFramebuffer> pictures_;
  uint32_t width_ = 0, height_ = 0;
  bool has_context_ = false, has_window_ = false, has_device_ = false, has_font_ = false;
  bool is_light_ = false;  ///< the panel, as ImGui draws it now
  float scale_ = 1;
  bool has_layout_ = false;  ///< it lies as it did when it was last seen
};

}  // namespace

std::unique_ptr<Ui> Ui::make(GLFWwindow* window, const UiDevice& device) {
  auto out = std::make_unique<ImGuiUi>(device);
  if (!out->open(window)) return nullptr;
  return out;
}

}  // namespace luxel::view_window
