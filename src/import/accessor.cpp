#include "import/accessor.h"

#include <algorithm>
#include <array>

namespace throng::gltf {
namespace {

struct TypeName {
    const char* name;
    uint32_t component_count;
};
constexpr TypeName kTypes[] = {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4},
                               {"MAT2", 4},   {"MAT3", 9}, {"MAT4", 16}};

constexpr std::array<std::byte, 64> kZeros{};  // as large as the largest element

ComponentType component_type_of(const JsonView& json) {
    switch (const uint64_t type = json.required_uint("componentType")) {
        case 5120:
        case 5121:
        case 5122:
        case 5123:
        case 5125:
        case 5126: return ComponentType(type);
        default: json.fail("componentType " + std::to_string(type) + " is unknown");
    }
}

// `count` elements of `element_bytes` at `offset` in a buffer view, with its stride.
AccessorView strided(const JsonView& json, const Buffers::View& view, uint64_t offset, uint64_t count,
                     uint64_t element_bytes) {
    AccessorView out;
    out.stride_bytes = view.stride_bytes > 0 ? view.stride_bytes : element_bytes;
    if (out.stride_bytes < element_bytes || out.stride_bytes > 0xFFFF)
        json.fail("an element has " + std::to_string(element_bytes) +
                  " bytes, but the byteStride of its buffer view is " + std::to_string(out.stride_bytes));
    // offset < 2^53, count < 2^53, stride < 2^16: compared by division, so that nothing overflows.
    const uint64_t size_bytes = view.bytes.size();
    const bool fits = count == 0 || (offset <= size_bytes && element_bytes <= size_bytes - offset &&
                                     count - 1 <= (size_bytes - offset - element_bytes) / out.stride_bytes);
    if (!fits)
        json.fail(std::to_string(count) + " elements of " + std::to_string(element_bytes) + " bytes from byte " +
                  std::to_string(offset) + " do not fit into its buffer view of " + std::to_string(size_bytes) +
                  " bytes");
    out.data = count == 0 ? kZeros.data() : view.bytes.data() + offset;
    return out;
}

}  // namespace

uint32_t size_of(ComponentType type) {
    switch (type) {
        case ComponentType::kInt8:
        case ComponentType::kUint8: return 1;
        case ComponentType::kInt16:
        case ComponentType::kUint16: return 2;
        default: return 4;
    }
}

const char* name_of(ComponentType type) {
    switch (type) {
        case ComponentType::kInt8: return "8-bit integers";
        case ComponentType::kUint8: return "unsigned 8-bit integers";
        case ComponentType::kInt16: return "16-bit integers";
        case ComponentType::kUint16: return "unsigned 16-bit integers";
        case ComponentType::kUint32: return "unsigned 32-bit integers";
        default: return "floats";
    }
}

bool AccessorFormat::is_unsigned() const {
    return component_type == ComponentType::kUint8 || component_type == ComponentType::kUint16 ||
           component_type == ComponentType::kUint32;
}

float AccessorView::number(uint32_t element, uint32_t component) const {
    const bool scale = format.normalized;
    switch (format.component_type) {
        case ComponentType::kFloat: return load<float>(element, component);
        case ComponentType::kInt8: {
            const float value = load<int8_t>(element, component);
            return scale ? std::max(value / 127.0f, -1.0f) : value;
        }
        case ComponentType::kUint8: {
            const float value = load<uint8_t>(element, component);
            return scale ? value / 255.0f : value;
        }
        case ComponentType::kInt16: {
            const float value = load<int16_t>(element, component);
            return scale ? std::max(value / 32767.0f, -1.0f) : value;
        }
        case ComponentType::kUint16: {
            const float value = load<uint16_t>(element, component);
            return scale ? value / 65535.0f : value;
        }
        case ComponentType::kUint32: return float(load<uint32_t>(element, component));
    }
    return 0;
}

uint32_t AccessorView::integer(uint32_t element, uint32_t component) const {
    switch (format.component_type) {
        case ComponentType::kUint8: return load<uint8_t>(element, component);
        case ComponentType::kUint16: return load<uint16_t>(element, component);
        default: return load<uint32_t>(element, component);
    }
}

AccessorFormat Accessors::format(const JsonView& user, const char* key) const {
    AccessorFormat out;
    out.index = user.required_index(key, accessors_.size(), "accessors");
    const JsonView json = accessors_[out.index];
    out.type = json.required_string("type");
    const auto* type = std::find_if(std::begin(kTypes), std::end(kTypes),
                                    [&](const TypeName& t) { return t.name == out.type; });
    if (type == std::end(kTypes)) json.fail("type '" + printable(out.type) + "' is unknown");
    out.component_count = type->component_count;
    out.component_type = component_type_of(json);
    out.normalized = json.optional_bool("normalized", false);
    const uint64_t count = json.required_uint("count");
    if (count >= kNone)
        json.fail("count " + std::to_string(count) + " is above the limit of 4294967294", ErrorCode::kLimit);
    out.count = uint32_t(count);
    return out;
}

AccessorView Accessors::open(const JsonView& user, const char* key) { return open(format(user, key)); }

AccessorView Accessors::open(const AccessorFormat& format) {
    const JsonView json = accessors_[format.index];
    AccessorView out;
    const uint32_t view_index = json.optional_index("bufferView", buffers_.view_count(), "bufferViews");
    if (view_index == kNone) {
        // Zeros by the specification: one element, seen at stride 0.
        out.data = kZeros.data();
        out.stride_bytes = 0;
    } else {
        out = strided(json, buffers_.view(view_index), json.optional_uint("byteOffset", 0), format.count,
                      format.element_bytes());
    }
    out.format = format;
    if (const auto sparse = json.optional_object("sparse")) {
        out.owner = with_sparse(json, *sparse, out);
        out.data = out.owner->data();
        out.stride_bytes = format.element_bytes();
    }
    return out;
}

std::shared_ptr<std::vector<std::byte>> Accessors::with_sparse(const JsonView& json, const JsonView& sparse,
                                                               const AccessorView& base) {
    const uint64_t element_bytes = base.format.element_bytes(), count = base.count();
    const uint64_t sparse_count = sparse.required_uint("count");
    if (sparse_count > count)
        sparse.fail("count is " + std::to_string(sparse_count) + ", but the accessor has " + std::to_string(count) +
                    " elements");

    const auto part = [&](const char* key) {
        const JsonView at = sparse.required_object(key);
        return std::pair(at, buffers_.view(at.required_index("bufferView", buffers_.view_count(), "bufferViews")));
    };
    const auto [indices_json, indices_view] = part("indices");
    AccessorFormat indices_format;
    indices_format.component_count = 1;
    indices_format.component_type = component_type_of(indices_json);
    if (!indices_format.is_unsigned()) indices_json.fail("must be unsigned integers");
    AccessorView indices = strided(indices_json, indices_view, indices_json.optional_uint("byteOffset", 0),
                                   sparse_count, indices_format.element_bytes());
    indices.format = indices_format;
    const auto [values_json, values_view] = part("values");
    const AccessorView values = strided(values_json, values_view, values_json.optional_uint("byteOffset", 0),
                                        sparse_count, element_bytes);

    budget_.charge(count, element_bytes, json.place());
    auto out = std::make_shared<std::vector<std::byte>>(count * element_bytes);
    if (base.stride_bytes > 0)
        for (uint64_t i = 0; i < count; ++i)
            std::memcpy(out->data() + i * element_bytes, base.data + i * base.stride_bytes, element_bytes);
    for (uint32_t i = 0; i < sparse_count; ++i) {
        const uint32_t element = indices.integer(i, 0);
        if (element >= count)
            indices_json.fail("index " + std::to_string(element) + ", but the accessor has " + std::to_string(count) +
                              " elements");
        std::memcpy(out->data() + element * element_bytes, values.data + i * values.stride_bytes, element_bytes);
    }
    return out;
}

}  // namespace throng::gltf
