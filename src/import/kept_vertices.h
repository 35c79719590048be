// Which vertices of its accessors a primitive keeps.
#pragma once

#include "import/limits.h"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace throng::gltf {

// All of them, or those that its triangles name, in the file's order. UniVRM, for one, writes one set of attributes for
// a whole mesh and indices for each of its primitives, which would each keep the vertices of all others.
class KeptVertices {
public:
    explicit KeptVertices(Budget& budget) : budget_(budget), charge_(budget) {}

    void keep_all(uint32_t file_count) { count_ = file_count; }
    // Keeps those of `file_count` vertices that `indices` name, and makes these indices into what is kept.
    void keep_named(uint32_t file_count, std::span<uint32_t> indices, const std::string& place);

    uint32_t count() const { return count_; }
    // The number in the file of the kept vertex `v`.
    uint32_t in_file(uint32_t v) const { return in_file_.empty() ? v : in_file_[v]; }

private:
    Budget& budget_;
    TemporaryCharge charge_;  // for in_file_
    uint32_t count_ = 0;
    std::vector<uint32_t> in_file_;  // ascending; empty where all are kept
};

}  // namespace throng::gltf
