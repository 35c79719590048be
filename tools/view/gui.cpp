#include "tools/view/gui.h"

#include "tools/view/submission.h"

#include <imgui.h>

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_vulkan.h>

#include <filesystem>

namespace throng::view {
namespace {

constexpr float kFontSize = 15;  // pixels, at a content scale of 1
// Debian's package fonts-roboto-unhinted
constexpr const char* kFont = "/usr/share/fonts/truetype/roboto/unhinted/RobotoTTF/Roboto-Regular.ttf";

void choose_font(float scale) {
    ImGuiIO& io = ImGui::GetIO();
    ImFontConfig config;
    config.OversampleH = 3;
    config.OversampleV = 2;
    // Latin, punctuation (dashes, ellipsis, quotation marks) and the sign of multiplication.
    static constexpr ImWchar kCharacters[] = {0x20, 0xFF, 0x2010, 0x2027, 0};
    if (std::filesystem::exists(kFont))
        io.Fonts->AddFontFromFileTTF(kFont, kFontSize * scale, &config, kCharacters);
    else
        io.Fonts->AddFontDefault();
}

void choose_style(float scale) {
    ImGui::StyleColorsDark();
    ImGuiStyle& style = ImGui::GetStyle();
    style.WindowRounding = 8;
    style.ChildRounding = style.PopupRounding = 6;
    style.FrameRounding = style.GrabRounding = style.ScrollbarRounding = 4;
    style.WindowBorderSize = style.PopupBorderSize = 0;
    style.WindowPadding = {12, 10};
    style.FramePadding = {8, 3};
    style.ItemSpacing = {8, 5};
    style.ItemInnerSpacing = {6, 4};
    style.ScrollbarSize = 10;
    style.GrabMinSize = 12;
    style.IndentSpacing = 14;
    style.ScaleAllSizes(scale);

    const auto set = [&](std::initializer_list<ImGuiCol> of, ImVec4 color) {
        for (const ImGuiCol one : of) style.Colors[one] = color;
    };
    const ImVec4 accent{0.36f, 0.66f, 0.96f, 1}, raised{0.20f, 0.22f, 0.26f, 1}, hovered{0.27f, 0.30f, 0.36f, 1},
        pressed{0.30f, 0.46f, 0.64f, 1};
    set({ImGuiCol_WindowBg}, {0.085f, 0.094f, 0.112f, 0.90f});
    set({ImGuiCol_PopupBg}, {0.11f, 0.12f, 0.14f, 0.98f});
    set({ImGuiCol_Text}, {0.91f, 0.92f, 0.94f, 1});
    set({ImGuiCol_TextDisabled}, {0.58f, 0.61f, 0.66f, 1});
    set({ImGuiCol_FrameBg, ImGuiCol_Button}, raised);
    set({ImGuiCol_FrameBgHovered, ImGuiCol_ButtonHovered, ImGuiCol_HeaderHovered}, hovered);
    set({ImGuiCol_FrameBgActive, ImGuiCol_ButtonActive, ImGuiCol_HeaderActive}, pressed);
    set({ImGuiCol_Header}, {0.15f, 0.165f, 0.195f, 1});
    set({ImGuiCol_CheckMark}, accent);
    set({ImGuiCol_SliderGrab}, {0.20f, 0.38f, 0.58f, 1});     // values are written over it
    set({ImGuiCol_PlotHistogram}, {0.20f, 0.36f, 0.55f, 1});  // bars of progress
    set({ImGuiCol_SliderGrabActive}, {0.26f, 0.48f, 0.72f, 1});
    set({ImGuiCol_Separator}, {0.22f, 0.24f, 0.28f, 1});
    set({ImGuiCol_ScrollbarBg}, {0, 0, 0, 0});
}

}  // namespace

Gui::Gui(const Window& window, const Context& context, VkRenderPass render_pass) : window_(window) {
    constexpr uint32_t kSets = 4;  // only the font's is needed
    const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, kSets};
    const VkDescriptorPoolCreateInfo create{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                            .flags = VK_DESCRIPTOR_POOL_CREATE_FREE_DESCRIPTOR_SET_BIT,
                                            .maxSets = kSets,
                                            .poolSizeCount = 1,
                                            .pPoolSizes = &size};
    pool_ = {context.device(), vkCreateDescriptorPool, create, "vkCreateDescriptorPool"};

    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr;  // panels have fixed places, so there is nothing to save
    choose_font(window.content_scale());
    choose_style(window.content_scale());
    ImGui_ImplGlfw_InitForVulkan(window.handle(), true);
    constexpr uint32_t kFrames = 2;  // one may be shown while the next is recorded (display.h)
    ImGui_ImplVulkan_InitInfo info{.Instance = context.instance(),
                                   .PhysicalDevice = context.physical_device(),
                                   .Device = context.device(),
                                   .QueueFamily = context.queue_family(),
                                   .Queue = context.queue(),
                                   .DescriptorPool = pool_.get(),
                                   .MinImageCount = kFrames,
                                   .ImageCount = kFrames,
                                   .MSAASamples = VK_SAMPLE_COUNT_1_BIT,
                                   .CheckVkResultFn = [](VkResult result) { check(result, "Dear ImGui"); }};
    ImGui_ImplVulkan_Init(&info, render_pass);
    upload_fonts(context);
}

Gui::~Gui() {
    ImGui_ImplVulkan_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
}

void Gui::upload_fonts(const Context& context) const {
    Submission submission(context);
    ImGui_ImplVulkan_CreateFontsTexture(submission.begin());
    submission.submit(VK_NULL_HANDLE, VK_NULL_HANDLE);
    submission.wait();
    ImGui_ImplVulkan_DestroyFontUploadObjects();
}

void Gui::take_input(VkExtent2D extent, std::span<const KeyPress> pressed) {
    ImGui_ImplVulkan_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    ImGuiIO& io = ImGui::GetIO();
    for (const int key : std::exchange(keys_to_release_, {}))
        io.KeysDown[key] = glfwGetKey(window_.handle(), key) == GLFW_PRESS;
    for (const KeyPress& press : pressed) {
        if (press.key <= 0 || io.KeysDown[press.key]) continue;
        io.KeysDown[press.key] = true;
        keys_to_release_.push_back(press.key);
    }
    // The canvas may differ in size from the window if the window's size has just changed.
    if (io.DisplayFramebufferScale.x <= 0 || io.DisplayFramebufferScale.y <= 0) io.DisplayFramebufferScale = {1, 1};
    io.DisplaySize = {static_cast<float>(extent.width) / io.DisplayFramebufferScale.x,
                      static_cast<float>(extent.height) / io.DisplayFramebufferScale.y};
}

}  // namespace throng::view
