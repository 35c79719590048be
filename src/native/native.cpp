#include "native/native.h"

#include "base/default_floats.h"
#include "bind/skin_format.h"
#include "native/kernels.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace throng {
namespace {

constexpr uint32_t kMaxClasses = 8, kClassSize = 64;

const native::Kernel& kernel_of(NativeIsa isa) {
#if defined(__x86_64__)
    if (isa == NativeIsa::kAvx512) return native::kernel_avx512();
    if (isa == NativeIsa::kAvx2) return native::kernel_avx2();
    return native::kernel_sse2();
#elif defined(__aarch64__)
    (void)isa;
    return native::kernel_neon();
#else
    (void)isa;  // native_isas() has none
    static constexpr native::Kernel kNone{};
    return kNone;
#endif
}

std::vector<NativeIsa> find_isas() {
#if defined(__x86_64__)
    std::vector<NativeIsa> isas{NativeIsa::kSse2};
    __builtin_cpu_init();
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("f16c")) {
        isas.push_back(NativeIsa::kAvx2);
        if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
            __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl"))
            isas.push_back(NativeIsa::kAvx512);
    }
    return isas;
#elif defined(__aarch64__)
    return {NativeIsa::kNeon};
#else
    return {};
#endif
}

// How many different offsets in a cache line the matrices of instances begin at.
uint32_t class_count_of(uint32_t palette_count, SkinFormat skin_format) {
    return 64 / std::gcd(palette_count * skin_format_bytes(skin_format), 64u);
}

// The scratch memory of a thread's walks.
std::byte* scratch(size_t size) {
    thread_local native::AlignedBytes bytes;
    thread_local size_t has = 0;
    if (has < size) {
        bytes = native::aligned_bytes(size);
        has = size;
    }
    return bytes.get();
}

// Calls run(rig, update, instances, count) for all instances.
template <class Run>
void for_instances(const NativeRig& rig, const NativeUpdate& update, uint32_t first, uint32_t end,
                   const native::Kernel& kernel, const Run& run_kernel) {
    const DefaultFloats floats;  // updates also run outside jobs: joint samplers, poses made with a crowd
    const native::KernelRig& of = rig.kernel();
    native::KernelUpdate buffers{.cursors = update.cursors,
                                 .active_clips = update.active_clips,
                                 .active_clip_limit = update.active_clips ? update.active_clip_limit : 0,
                                 .masks = update.masks,
                                 .inertias = update.inertias,
                                 .inertia_states = update.inertia_states,
                                 .pose_overrides = update.pose_overrides,
                                 .set_poses = update.set_poses,
                                 .skin_format = static_cast<uint32_t>(update.skin_format),
                                 .skin = update.skin,
                                 .skin_rows = update.skin_rows,
                                 .model = reinterpret_cast<float*>(update.model),
                                 .sockets = reinterpret_cast<float*>(update.sockets)};
    buffers.scratch = scratch(kernel.scratch_bytes(of, buffers));
    // Groups instances whose matrices begin at the same offset in a cache line
    const uint32_t class_count = class_count_of(of.palette_count, update.skin_format);
    std::array<std::array<uint32_t, kClassSize>, kMaxClasses> classes;
    std::array<uint32_t, kMaxClasses> counts{};
    const auto run = [&](uint32_t c) {
        run_kernel(of, buffers, classes[c].data(), counts[c]);
        counts[c] = 0;
    };
    for (uint32_t i = first; i < end; ++i) {
        const uint32_t instance = update.listed ? update.listed[i] : i;
        const uint32_t c = (update.skin_rows ? update.skin_rows[instance] : instance) % class_count;
        classes[c][counts[c]++] = instance;
        if (counts[c] == kClassSize) run(c);
    }
    for (uint32_t c = 0; c < class_count; ++c)
        if (counts[c] > 0) run(c);
    kernel.fence();
}

}  // namespace

std::string_view name_of(NativeIsa isa) {
    constexpr std::array<std::string_view, 4> kNames{"SSE2", "AVX2", "AVX-512", "NEON"};
    return kNames[static_cast<size_t>(isa)];
}

std::span<const NativeIsa> native_isas() {
    static const std::vector<NativeIsa> isas = find_isas();
    return isas;
}

std::string native_unsupported_reason(const Character& character, SkinFormat skin_format) {
    if (native_isas().empty()) return "there is no native engine for this processor";
    return skin_format_unsupported_reason(skin_format, character);
}

void update(const NativeRig& rig, const NativeUpdate& update, uint32_t first, uint32_t end, NativeIsa isa) {
    for_instances(rig, update, first, end, kernel_of(isa), kernel_of(isa).update);
}

uint32_t min_part(const NativeRig& rig, SkinFormat skin_format) {
    return kernel_of(native_isas().back()).lane_count * class_count_of(rig.kernel().palette_count, skin_format);
}

void decode_only(const NativeRig& rig, const NativeUpdate& update, uint32_t first, uint32_t end, NativeIsa isa) {
    for_instances(rig, update, first, end, kernel_of(isa), kernel_of(isa).decode);
}

void stream_fill(std::span<std::byte> bytes, NativeIsa isa) {
    kernel_of(isa).fill(bytes.data(), bytes.size());
    kernel_of(isa).fence();
}

void update(const NativeRig& rig, const NativeUpdate& buffers, uint32_t first, uint32_t end) {
    update(rig, buffers, first, end, native_isas().back());
}

}  // namespace throng
