// Dear ImGui in the window: its style, its input, and what it draws with.
#pragma once

#include "tools/view/context.h"
#include "tools/view/window.h"

#include <span>
#include <vector>

namespace throng::view {

// One at a time, as Dear ImGui has it.
class Gui {
public:
    // Keeps the reference to the window.
    Gui(const Window& window, const Context& context, VkRenderPass render_pass);
    ~Gui();
    Gui(const Gui&) = delete;
    Gui& operator=(const Gui&) = delete;

    // The window's input since the last call, for a canvas of this size; ImGui::NewFrame() comes next. Keys that have
    // been pressed are down for a frame, also where they have been let go meanwhile.
    void take_input(VkExtent2D extent, std::span<const KeyPress> pressed);

private:
    void upload_fonts(const Context& context) const;

    const Window& window_;
    OwnedDescriptorPool pool_;
    std::vector<int> let_go_;  // keys, to be so with the next frame
};

}  // namespace throng::view
