// Which vertices of its accessors a primitive keeps.
#pragma once

#include "import/limits.h"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace throng::gltf {

// All vertices, or only those that the triangles use, in the file's order. UniVRM, for example, writes one set of
// attributes for a whole mesh and indices for each of its primitives. Each primitive would otherwise keep the vertices
// of all others.
class KeptVertices {
public:
    explicit KeptVertices(Budget& budget) : budget_(budget), charge_(budget) {}

    void keep_all(uint32_t file_count) { count_ = file_count; }
    // Keeps those of `file_count` vertices that `indices` use, and changes `indices` to refer to the kept ones.
    void keep_used(uint32_t file_count, std::span<uint32_t> indices, const std::string& place);

    uint32_t count() const { return count_; }
    // The index in the file of the kept vertex `v`.
    uint32_t in_file(uint32_t v) const { return in_file_.empty() ? v : in_file_[v]; }

private:
    Budget& budget_;
    TemporaryCharge charge_;  // for in_file_
    uint32_t count_ = 0;
    std::vector<uint32_t> in_file_;  // ascending; empty where all are kept
};

}  // namespace throng::gltf
