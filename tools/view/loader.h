// Reads files in the background, so that the window stays responsive.
#pragma once

#include "tools/view/scene.h"

#include <future>

namespace throng::view {

class Loader {
public:
    // Replaces what is being read, after waiting for it.
    void start(std::vector<std::string> files, const CompileSettings& settings);
    bool is_busy() const { return future_.valid(); }

    // Returns what has been read, once; nothing while reading goes on, unless `waits`. Throws a CommandError if a file
    // is wrong.
    std::optional<std::vector<Character>> take(bool waits);

private:
    std::future<std::vector<Character>> future_;
};

}  // namespace throng::view
