// Dear ImGui in the window: its style, its input, and what it draws with.
#pragma once

#include "tools/view/context.h"

namespace throng::view {

// One at a time, as Dear ImGui has it.
class Gui {
public:
    Gui(const Window& window, const Context& context, VkRenderPass render_pass);
    ~Gui();
    Gui(const Gui&) = delete;
    Gui& operator=(const Gui&) = delete;

    // The window's input since the last call, for a canvas of this size; ImGui::NewFrame() comes next.
    void take_input(VkExtent2D extent) const;

private:
    void upload_fonts(const Context& context) const;

    OwnedDescriptorPool pool_;
};

}  // namespace throng::view
