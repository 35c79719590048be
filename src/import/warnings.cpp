#include "import/warnings.h"

#include "import/limits.h"

namespace throng::gltf {

void Warnings::add(const std::string& place, const std::string& message) {
    if (lines_.size() >= kWarningLimit) {
        ++dropped_count_;
        return;
    }
    std::string line = file_name_ + ": " + (place.empty() ? message : place + ": " + message);
    if (seen_.insert(line).second) lines_.push_back(std::move(line));
}

std::vector<std::string> Warnings::take() {
    if (dropped_count_ > 0) lines_.push_back(file_name_ + ": and " + std::to_string(dropped_count_) + " more");
    return std::move(lines_);
}

}  // namespace throng::gltf
