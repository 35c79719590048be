// Accessors: typed, strided, bounds-checked views of the file's data.
#pragma once

#include "import/container.h"
#include "import/warnings.h"

#include <cstring>
#include <memory>

namespace throng::gltf {

enum class ComponentType : uint16_t { kInt8 = 5120, kUint8, kInt16, kUint16, kUint32 = 5125, kFloat = 5126 };

// Calls visit() with a zero of the type.
template <class Visit>
auto visit_component(ComponentType type, const Visit& visit) {
    switch (type) {
        case ComponentType::kInt8: return visit(int8_t{});
        case ComponentType::kUint8: return visit(uint8_t{});
        case ComponentType::kInt16: return visit(int16_t{});
        case ComponentType::kUint16: return visit(uint16_t{});
        case ComponentType::kUint32: return visit(uint32_t{});
        default: return visit(float{});
    }
}
inline uint32_t size_of(ComponentType type) {
    return visit_component(type, [](auto zero) { return uint32_t(sizeof(zero)); });
}

// What an accessor declares, without its data.
struct AccessorFormat {
    uint32_t index = 0;  // into the file's accessors
    std::string type;    // "SCALAR", "VEC2", …
    uint32_t component_count = 0;
    ComponentType component_type = ComponentType::kFloat;
    bool normalized = false;
    uint32_t count = 0;

    uint32_t element_bytes() const { return component_count * size_of(component_type); }
    bool is_float() const { return component_type == ComponentType::kFloat; }
    bool is_unsigned() const {
        return visit_component(component_type, [](auto zero) { return std::is_unsigned_v<decltype(zero)>; });
    }
    // "unsigned 8-bit integers"
    std::string component_text() const;
    // "VEC4 of floats"
    std::string text() const { return type + " of " + component_text(); }
};

// An accessor with its data; element and component are not checked again.
struct AccessorView {
    AccessorFormat format;
    const std::byte* data = nullptr;
    uint64_t stride_bytes = 0;
    std::shared_ptr<const std::vector<std::byte>> owner;  // set if the data are not in the buffer; holds their charge

    uint32_t count() const { return format.count; }
    // Normalised integers are mapped to [0, 1] or [-1, 1], others are converted.
    float number(uint32_t element, uint32_t component) const;
    // For unsigned component types.
    uint32_t integer(uint32_t element, uint32_t component) const;

private:
    template <class T>
    T load(uint32_t element, uint32_t component) const {
        T value;
        std::memcpy(&value, data + element * stride_bytes + component * sizeof(T), sizeof(T));
        return value;
    }
};

// What happens to elements that an accessor declares but that lie beyond its buffer view. Either way a warning gives
// their number. If they are more than a tenth of all, the accessor is refused.
enum class Missing : uint8_t { kAreZero, kAreLeftOut };

class Accessors {
public:
    Accessors(JsonView root, Buffers& buffers, Budget& budget, Warnings& warnings)
        : accessors_(root.optional_array("accessors")), buffers_(buffers), budget_(budget), warnings_(warnings) {}

    // The accessor whose index is `user`'s member `key`. Failures name `user.key` for an index out of range, and
    // otherwise the accessor or its buffer view.
    AccessorFormat format(const JsonView& user, std::string_view key) const;
    AccessorView open(const JsonView& user, std::string_view key, Missing missing = Missing::kAreZero) {
        return open(format(user, key), missing);
    }
    // The view can count fewer elements than `format` if those that are missing are left out.
    AccessorView open(const AccessorFormat& format, Missing missing = Missing::kAreZero);

private:
    AccessorView in_view(const JsonView& json, const AccessorFormat& format, Missing missing);
    // `count`: as declared; `base` may have fewer.
    std::shared_ptr<std::vector<std::byte>> with_sparse(const JsonView& json, const JsonView& sparse, uint64_t count,
                                                        const AccessorView& base);

    JsonView accessors_;
    Buffers& buffers_;
    Budget& budget_;
    Warnings& warnings_;
};

}  // namespace throng::gltf
