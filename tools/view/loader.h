// Reads files beside the frames, so that the window stays alive.
#pragma once

#include "tools/view/scene.h"

#include <future>

namespace throng::view {

class Loader {
public:
    // In place of what is being read, which is waited for.
    void start(std::vector<std::string> files, const CompileSettings& settings);
    bool is_busy() const { return future_.valid(); }

    // What has been read, once; nothing where it goes on, unless `waits`. Throws a CommandError where a file is wrong.
    std::optional<std::vector<Character>> take(bool waits);

private:
    std::future<std::vector<Character>> future_;
};

}  // namespace throng::view
