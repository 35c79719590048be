// What was ignored or mended while a file was read.
#pragma once

#include <cstdint>
#include <string>
#include <unordered_set>
#include <vector>

namespace throng::gltf {

// Each line is kept once, and the first kWarningLimit of them; the rest are counted.
class Warnings {
public:
    explicit Warnings(std::string file_name) : file_name_(std::move(file_name)) {}

    void add(const std::string& place, const std::string& message);
    std::vector<std::string> take();

private:
    std::string file_name_;
    std::vector<std::string> lines_;
    std::unordered_set<std::string> seen_;
    uint64_t dropped_count_ = 0;
};

}  // namespace throng::gltf
