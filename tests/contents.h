// The contents of a crowd's outputs.
#pragma once

#include "tests/kernel_runner.h"

#include <gtest/gtest.h>

#include <map>
#include <numeric>
#include <string>

namespace throng::test {

struct Output {
    const char* name;
    BufferView OutputBlock::*member;
    bool is_in_slots = true;  // otherwise it is the same in all frame slots
};
inline constexpr Output kOutputs[]{{"skin", &OutputBlock::skin},
                                   {"previous skin", &OutputBlock::previous_skin},
                                   {"model", &OutputBlock::model},
                                   {"placement", &OutputBlock::placement},
                                   {"socket", &OutputBlock::socket},
                                   {"parameter", &OutputBlock::parameter, false},
                                   {"root", &OutputBlock::root},
                                   {"target", &OutputBlock::target, false},
                                   {"destination", &OutputBlock::destination, false},
                                   {"morph", &OutputBlock::morph},
                                   {"look", &OutputBlock::look},
                                   {"skinned", &OutputBlock::skinned}};

// Bytes, keyed by the block's number and the output's name. Where there are lists, only those of drawn instances.
using Contents = std::map<std::string, std::string>;

// The row of `skin` that each instance has. Empty where the row is the instance's own number.
inline std::vector<uint32_t> skin_rows_of(const OutputBlock& block) {
    if (!block.host.skin_row.empty()) return {block.host.skin_row.begin(), block.host.skin_row.end()};
    if (!block.skin_row) return {};
    return output<uint32_t>(block, &OutputBlock::skin_row, block.instance_count);
}

// With `is_newest` false, leaves out outputs that are the same in all frame slots.
inline Contents contents_of(std::span<const OutputBlock> blocks, bool is_newest = true) {
    Contents all;
    for (const OutputBlock& block : blocks) {
        const std::string place = std::to_string(block.group) + ": ";
        std::vector<uint32_t> shown(block.instance_count);
        std::iota(shown.begin(), shown.end(), 0u);
        size_t finest_count = shown.size();  // the finest level comes first, and has all vertices
        if (has_output(block, &OutputBlock::list)) {
            const auto list = output<uint32_t>(block, &OutputBlock::list, 5 + block.instance_count);
            shown.assign(list.begin() + 5, list.begin() + 5 + list[0]);
            finest_count = list[2];
            for (const uint32_t instance : shown) all[place + "list"] += std::to_string(instance) + " ";
        }
        if (block.draw)
            for (const uint32_t word :
                 output<uint32_t>(block, &OutputBlock::draw, block.draw.size_bytes / sizeof(uint32_t)))
                all[place + "draw"] += std::to_string(word) + " ";
        const std::vector<uint32_t> skin_rows = skin_rows_of(block);
        for (const uint32_t instance : skin_rows.empty() ? std::vector<uint32_t>() : shown)
            all[place + "skin row"] += std::to_string(skin_rows[instance]) + " ";
        for (const auto& [name, member, is_in_slots] : kOutputs) {
            if (!has_output(block, member) || (!is_newest && !is_in_slots)) continue;
            const auto& [buffer, offset_bytes, size_bytes, stride_bytes] = block.*member;
            const auto bytes = output<char>(block, member, size_bytes);
            const size_t count = member == &OutputBlock::skinned ? finest_count : shown.size();
            const bool in_rows = member == &OutputBlock::skin && !skin_rows.empty();
            for (const uint32_t instance : std::span(shown).first(count))
                all[place + name].append(bytes.data() + (in_rows ? skin_rows[instance] : instance) * stride_bytes,
                                         stride_bytes);
        }
    }
    return all;
}

inline void expect_same(const Contents& a, const Contents& b, const std::string& where) {
    ASSERT_EQ(a.size(), b.size()) << where;
    for (const auto& [name, bytes] : a) {
        const auto other = b.find(name);
        EXPECT_TRUE(other != b.end() && other->second == bytes) << name << ", " << where;
    }
}

}  // namespace throng::test
