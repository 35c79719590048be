// What was ignored or mended while a file was read.
#pragma once

#include "base/text.h"

#include <cstdint>
#include <string>
#include <unordered_set>
#include <vector>

namespace throng::gltf {

// Keeps each line once, up to kWarningLimit of them, and counts the rest.
class Warnings {
public:
    explicit Warnings(std::string file_name) : file_name_(std::move(file_name)) {}

    template <class... Parts>
    void add(const std::string& place, const Parts&... message) {
        add_line(joined(place, place.empty() ? "" : ": ", message...));
    }
    std::vector<std::string> take();

private:
    void add_line(const std::string& text);

    std::string file_name_;
    std::vector<std::string> lines_;
    std::unordered_set<std::string> seen_;
    uint64_t dropped_count_ = 0;
};

}  // namespace throng::gltf
