#include "import/kept_vertices.h"

#include "base/count.h"

#include <throng/asset.h>

#include <algorithm>

namespace throng::gltf {

void KeptVertices::keep_used(uint32_t file_count, std::span<uint32_t> indices, const std::string& place) {
    TemporaryCharge charge(budget_);
    charge.add(file_count, sizeof(uint32_t), place);
    std::vector<uint32_t> kept_index(file_count, kNone);
    for (const uint32_t index : indices) kept_index[index] = 0;
    count_ = file_count - static_cast<uint32_t>(std::ranges::count(kept_index, kNone));
    if (count_ == file_count) return;
    charge_.add(count_, sizeof(uint32_t), place);
    in_file_.reserve(count_);
    for (uint32_t v = 0; v < file_count; ++v) {
        budget_.poll_at(v);
        if (kept_index[v] == kNone) continue;
        kept_index[v] = count_of(in_file_);
        in_file_.push_back(v);
    }
    for (uint32_t& index : indices) index = kept_index[index];
}

}  // namespace throng::gltf
