// What the outputs of a crowd hold.
#pragma once

#include "tests/kernel_runner.h"

#include <gtest/gtest.h>

#include <map>
#include <numeric>
#include <string>

namespace throng::test {

inline constexpr std::pair<const char*, BufferView OutputBlock::*> kOutputs[]{
    {"skin", &OutputBlock::skin},      {"previous skin", &OutputBlock::previous_skin},
    {"model", &OutputBlock::model},    {"placement", &OutputBlock::placement},
    {"socket", &OutputBlock::socket},  {"root", &OutputBlock::root},
    {"morph", &OutputBlock::morph},    {"look", &OutputBlock::look},
    {"skinned", &OutputBlock::skinned}};

// By the block's number and what it is, bytes: of what is drawn, where there are lists, and then not of skinned
// vertices, of which a level of detail has some only.
using Contents = std::map<std::string, std::string>;

inline Contents contents_of(std::span<const OutputBlock> blocks) {
    Contents all;
    for (const OutputBlock& block : blocks) {
        const std::string place = std::to_string(block.group) + ": ";
        std::vector<uint32_t> shown(block.instance_count);
        std::iota(shown.begin(), shown.end(), 0u);
        const bool is_listed = has_output(block, &OutputBlock::list);
        if (is_listed) {
            const auto list = output<uint32_t>(block, &OutputBlock::list, 5 + block.instance_count);
            shown.assign(list.begin() + 5, list.begin() + 5 + list[0]);
            for (const uint32_t instance : shown) all[place + "list"] += std::to_string(instance) + " ";
        }
        for (const auto& [name, member] : kOutputs) {
            if (!has_output(block, member) || (is_listed && member == &OutputBlock::skinned)) continue;
            const uint64_t stride_bytes = (block.*member).stride_bytes;
            for (const uint32_t instance : shown)
                for (const std::byte byte : download<std::byte>(
                         test_gpu(), output_range(block, member, instance * stride_bytes, stride_bytes)))
                    all[place + name] += static_cast<char>(byte);
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
