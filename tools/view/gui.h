// Dear ImGui in the window: its style, its input, and what it draws with.
#pragma once

#include "tools/view/context.h"
#include "tools/view/window.h"

#include <span>
#include <vector>

namespace throng::view {

// Only one can exist at a time, as Dear ImGui requires.
class Gui {
public:
    // `window` must outlive this.
    Gui(const Window& window, const Context& context, VkRenderPass render_pass);
    ~Gui();
    Gui(const Gui&) = delete;
    Gui& operator=(const Gui&) = delete;

    // Takes the window's input since the last call, for a canvas of this size; call ImGui::NewFrame() next. Pressed
    // keys are down for one frame, even if they have been released meanwhile.
    void take_input(VkExtent2D extent, std::span<const KeyPress> pressed);

private:
    void upload_fonts(const Context& context) const;

    const Window& window_;
    OwnedDescriptorPool pool_;
    std::vector<int> keys_to_release_;  // in the next frame
};

}  // namespace throng::view
