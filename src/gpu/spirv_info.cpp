#include "gpu/spirv_info.h"

#include "base/failure.h"

#include <algorithm>
#include <map>

namespace throng {
namespace {

// Numbers from the SPIR-V specification, version 1.6, section 3.
enum Op : uint32_t {
    kOpExecutionMode = 16,
    kOpTypeInt = 21,
    kOpTypeFloat = 22,
    kOpTypeVector = 23,
    kOpTypeImage = 25,
    kOpTypeSampledImage = 27,
    kOpTypeArray = 28,
    kOpTypeStruct = 30,
    kOpTypePointer = 32,
    kOpConstant = 43,
    kOpVariable = 59,
    kOpDecorate = 71,
    kOpMemberDecorate = 72,
    kOpExecutionModeId = 331
};
constexpr uint32_t kSpirvMagic = 0x07230203, kHeaderWords = 5;
constexpr uint32_t kModeLocalSize = 17, kModeLocalSizeId = 38;
constexpr uint32_t kDecorationSpecId = 1, kDecorationArrayStride = 6, kDecorationBinding = 33, kDecorationSet = 34,
                   kDecorationOffset = 35;
constexpr uint32_t kStorageUniformConstant = 0, kStorageUniform = 2, kStoragePushConstant = 9, kStorageBuffer = 12;
constexpr uint32_t kDimBuffer = 5;

struct Id {
    uint32_t set = 0, binding = 0, spec_id = UINT32_MAX, constant = 0, pointee = 0, size_bytes = 0;
    uint32_t last_offset = UINT32_MAX, array_stride = 0;
    bool is_texels = false;
};

}  // namespace

SpirvInfo read_spirv(std::span<const uint32_t> words) {
    const auto refuse = [](const char* why) { return Failure(ErrorCode::kInvalidArgument, "SPIR-V", why); };
    if (words.size() < kHeaderWords || words[0] != kSpirvMagic) throw refuse("not a SPIR-V module");
    SpirvInfo info;
    std::map<uint32_t, Id> ids;
    uint32_t local_size_id = 0;
    for (size_t at = kHeaderWords; at < words.size();) {
        const uint32_t op = words[at] & 0xFFFF, count = words[at] >> 16;
        if (count == 0 || at + count > words.size()) throw refuse("an instruction runs past the end");
        const auto arg = words.subspan(at + 1, count - 1);
        at += count;
        switch (op) {
            case kOpExecutionMode:
                if (arg[1] == kModeLocalSize) info.local_size_x = arg[2];
                break;
            case kOpExecutionModeId:
                if (arg[1] == kModeLocalSizeId) local_size_id = arg[2];
                break;
            case kOpDecorate:
                if (arg[1] == kDecorationSpecId) ids[arg[0]].spec_id = arg[2];
                if (arg[1] == kDecorationBinding) ids[arg[0]].binding = arg[2];
                if (arg[1] == kDecorationSet) ids[arg[0]].set = arg[2];
                if (arg[1] == kDecorationArrayStride) ids[arg[0]].array_stride = arg[2];
                break;
            case kOpMemberDecorate:
                if (arg[2] == kDecorationOffset) ids[arg[0]].last_offset = arg[3];  // members come in order
                break;
            case kOpTypeInt:
            case kOpTypeFloat: ids[arg[0]].size_bytes = arg[1] / 8; break;
            case kOpTypeVector: ids[arg[0]].size_bytes = ids[arg[1]].size_bytes * arg[2]; break;
            case kOpTypeImage: ids[arg[0]].is_texels = arg[2] == kDimBuffer; break;
            case kOpTypeSampledImage: ids[arg[0]].is_texels = ids[arg[1]].is_texels; break;
            case kOpTypeArray: ids[arg[0]].size_bytes = ids[arg[0]].array_stride * ids[arg[2]].constant; break;
            case kOpTypeStruct:
                if (arg.size() > 1 && ids[arg[0]].last_offset != UINT32_MAX)
                    ids[arg[0]].size_bytes = ids[arg[0]].last_offset + ids[arg.back()].size_bytes;
                break;
            case kOpTypePointer: ids[arg[0]].pointee = arg[2]; break;
            case kOpConstant: ids[arg[1]].constant = arg[2]; break;
            case kOpVariable: {
                const Id &variable = ids[arg[1]], &type = ids[ids[arg[0]].pointee];
                const auto add = [&](BindingKind kind) {
                    info.bindings.push_back({variable.binding, kind, variable.set});
                };
                if (arg[2] == kStorageBuffer) add(BindingKind::kStorage);
                if (arg[2] == kStorageUniform) add(BindingKind::kUniform);
                if (arg[2] == kStorageUniformConstant) add(type.is_texels ? BindingKind::kTexels : BindingKind::kImage);
                if (arg[2] == kStoragePushConstant) info.push_constant_bytes = type.size_bytes;
                break;
            }
            default: break;
        }
    }
    if (local_size_id != 0) {
        const Id& size = ids[local_size_id];
        info.local_size_is_specialized = size.spec_id == 0;
        if (size.spec_id == UINT32_MAX) info.local_size_x = size.constant;
    }
    const auto place_of = [](const BindingInfo& binding) { return std::pair(binding.set, binding.binding); };
    std::ranges::sort(info.bindings, {}, place_of);
    // One buffer may be declared with several types.
    const auto repeated = std::ranges::unique(info.bindings, {}, place_of);
    info.bindings.erase(repeated.begin(), repeated.end());
    return info;
}

}  // namespace throng
