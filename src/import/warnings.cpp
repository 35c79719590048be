#include "import/warnings.h"

#include "import/limits.h"

namespace throng::gltf {

void Warnings::add_line(const std::string& text) {
    if (lines_.size() >= kWarningLimit) {
        ++dropped_count_;
        return;
    }
    std::string line = file_name_ + ": " + text;
    if (seen_.insert(line).second) lines_.push_back(std::move(line));
}

std::vector<std::string> Warnings::take() {
    if (dropped_count_ > 0) lines_.push_back(joined(file_name_, ": and ", dropped_count_, " more warnings"));
    return std::move(lines_);
}

}  // namespace throng::gltf
