// A kernel's text as C++: CMake includes it into a class `Text` that derives from NativeText, and each invocation has
// its own Text object. This header is included by the sources that cmake/shaders.cmake makes, and by those of src/draw
// that compute with the text of shaders.
#pragma once

#include "gpu/glsl.h"
#include "gpu/native_kernel.h"

#include <atomic>
#include <cstring>

// As gpu/declare.glsl.
#define WORKGROUP(size) static constexpr uint kWorkgroupSize = size
// One invocation does the work of all, instead of one object for each of `size` invocations.
#define WORKGROUP_OF_STRIDE(size) static constexpr uint kWorkgroupSize = 1, kStride = 1
#define WORKGROUP_OF_CONSTANT static constexpr uint kWorkgroupSize = 0
#define CONSTANT(number, type, name, value) const type name = constant<type>(number, value)
#define PUSH(type)     \
    using Push = type; \
    const Push push = copied<Push>(dispatch.push)
#define BUFFER(number, type, name) type* const name = array<type>(number)
#define READONLY_BUFFER(number, type, name) const type* const name = array<type>(number)
#define WRITEONLY_BUFFER(number, type, name) BUFFER(number, type, name)
#define QUALIFIED_BUFFER(qualifier, number, type, name) BUFFER(number, type, name)
#define BUFFER_WITH_HEAD(number, head_type, head, type, name) \
    head_type& head = head_of<head_type>(number);             \
    type* const name = array<type>(number, sizeof(head_type))
#define precise
#define shared  // used only in workgroups whose first invocation does all the work

namespace throng::io {

inline constexpr uint kNone = 0xFFFFFFFFu;  // as throng::kNone

template <class T>
T copied(const void* bytes) {
    T item;
    std::memcpy(&item, bytes, sizeof item);
    return item;
}

struct NativeText {
    const NativeDispatch& dispatch;
    const uvec3 gl_WorkGroupID, gl_LocalInvocationID, gl_GlobalInvocationID;

    NativeText(const NativeDispatch& of, uint workgroup, uint workgroup_size, uint invocation)
        : dispatch(of),
          gl_WorkGroupID(workgroup, 0, 0),
          gl_LocalInvocationID(invocation, 0, 0),
          gl_GlobalInvocationID(workgroup * workgroup_size + invocation, 0, 0) {}

    template <class T>
    T constant(uint number, T otherwise) const {
        return number < dispatch.constants.size() ? static_cast<T>(dispatch.constants[number]) : otherwise;
    }
    template <class T>
    T* array(uint number, size_t first_byte = 0) const {
        std::byte* const bytes = dispatch.buffers[number];
        return bytes ? reinterpret_cast<T*>(bytes + first_byte) : nullptr;
    }
    // If there is no buffer, nothing uses the head.
    template <class T>
    T& head_of(uint number) const {
        static T none;
        T* const head = array<T>(number);
        return head ? *head : none;
    }
};

// Workgroups run on several threads at once.
inline uint atomicAdd(uint& word, uint by) { return std::atomic_ref(word).fetch_add(by, std::memory_order_relaxed); }
inline uint atomicExchange(uint& word, uint by) {
    return std::atomic_ref(word).exchange(by, std::memory_order_relaxed);
}
inline void atomicMax(uint& word, uint at_least) {
    uint known = std::atomic_ref(word).load(std::memory_order_relaxed);
    while (known < at_least &&
           !std::atomic_ref(word).compare_exchange_weak(known, at_least, std::memory_order_relaxed)) {}
}
// Returns what was there before.
inline uint atomicCompSwap(uint& word, uint expected, uint then) {
    std::atomic_ref(word).compare_exchange_strong(expected, then, std::memory_order_relaxed);
    return expected;
}

namespace {

// Texts may include these again, without effect. Included here, their constants belong to the namespace, and not to
// every Text object.
using Real = float;
#include "gpu/angles.glsl"
#include "gpu/stored.glsl"
#include "gpu/table.glsl"

}  // namespace

template <class Text>
constexpr NativeKernel native_kernel() {
    return {.workgroup_size = Text::kWorkgroupSize,
            .push_bytes = sizeof(typename Text::Push),
            .run = [](const NativeDispatch& dispatch, uint32_t first_workgroup, uint32_t end_workgroup) {
                const uint size = Text::kWorkgroupSize != 0 ? Text::kWorkgroupSize : dispatch.constants[0];
                for (uint workgroup = first_workgroup; workgroup < end_workgroup; ++workgroup)
                    for (uint invocation = 0; invocation < size; ++invocation)
                        Text(dispatch, workgroup, size, invocation).main();
            }};
}

}  // namespace throng::io
