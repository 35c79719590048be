// The macros with which a kernel's text declares its workgroup size, constants, push constants and buffers. In C++ the
// same macros declare members of a class (gpu/native_text.h).

#define WORKGROUP(size) layout(local_size_x = size) in
// For workgroups of which C++ runs one invocation alone. Where a loop is the same in both, each invocation takes every
// kStride-th element, starting at its own number.
#define WORKGROUP_OF_STRIDE(size)   \
    layout(local_size_x = size) in; \
    const uint kStride = size
#define WORKGROUP_OF_CONSTANT layout(local_size_x_id = 0) in  // of constant 0
#define CONSTANT(number, type, name, value) layout(constant_id = number) const type name = value
#define PUSH(type) \
    layout(push_constant) uniform Push { type push; }

// Arrays, by the numbers of docs/buffers.md; QUALIFIED_BUFFER is for methods that are compiled with different
// qualifiers.
#define QUALIFIED_BUFFER(qualifier, number, type, name) \
    layout(set = 0, binding = number, std430) qualifier buffer Block_##name { type name[]; }
#define BUFFER(number, type, name) \
    layout(set = 0, binding = number, std430) buffer Block_##name { type name[]; }
#define READONLY_BUFFER(number, type, name) QUALIFIED_BUFFER(readonly, number, type, name)
#define WRITEONLY_BUFFER(number, type, name) QUALIFIED_BUFFER(writeonly, number, type, name)
// A struct, followed by an array.
#define BUFFER_WITH_HEAD(number, head_type, head, type, name)       \
    layout(set = 0, binding = number, std430) buffer Block_##name { \
        head_type head;                                             \
        type name[];                                                \
    }
