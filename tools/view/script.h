// Scripted input: events at given frames, for tests and pictures. They are handled like the window's own.
#pragma once

#include "tools/view/window.h"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace throng::view {

// A file of lines "FRAME EVENT ARGUMENTS…", in the order of their frames; # begins a comment.
//   move X Y          the mouse, pixels from the left and the top
//   press BUTTON      left, right or middle; held until "release BUTTON"
//   scroll Y
//   type TEXT         as the keyboard's layout would give it
//   hold KEY          tab, space, escape, f12, shift, ctrl or a small letter; held until "let KEY"
//   drop FILE…        on the window
//   resize WIDTH HEIGHT
//   shot FILE         what the window shows in this frame
class Script {
public:
    // Throws a CommandError that names the first line that is not understood.
    explicit Script(const std::string& path);

    // Call after Gui::take_input(). Returns the file of a shot.
    std::optional<std::string> play(uint64_t frame, Window& window);
    bool ends_by(uint64_t frame) const {
        return next_ == events_.size() && (events_.empty() || frame > events_.back().frame);
    }

private:
    struct Event {
        uint64_t frame = 0;
        std::string word;
        std::vector<std::string> arguments;
    };

    std::vector<Event> events_;
    size_t next_ = 0;
    std::array<float, 2> mouse_{-1, -1};  // outside
    std::array<bool, 3> buttons_{};
};

}  // namespace throng::view
