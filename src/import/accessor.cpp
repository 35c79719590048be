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
    const uint64_t type = json.required_uint("componentType");
    if (type < 5120 || type > 5126 || type == 5124) json.fail("componentType ", type, " is unknown");
    return ComponentType(type);
}

// Elements of `element_bytes` each, from the `byteOffset` of `json` in its buffer view on, with the stride of that
// view.
struct Strided {
    const std::byte* data = nullptr;
    uint64_t stride_bytes = 0;
    uint64_t count = 0;  // that lie in the view
};

Strided strided(const JsonView& json, const Buffers::View& view, uint64_t element_bytes) {
    const uint64_t offset = json.optional_uint("byteOffset", 0), size_bytes = view.bytes.size();
    Strided out{.stride_bytes = view.stride_bytes > 0 ? view.stride_bytes : element_bytes};
    if (out.stride_bytes < element_bytes || out.stride_bytes > 0xFFFF)
        json.fail("an element has ", element_bytes, " bytes, but the byteStride of its buffer view is ",
                  out.stride_bytes);
    if (offset > size_bytes || element_bytes > size_bytes - offset) return out;
    out.data = view.bytes.data() + offset;
    out.count = (size_bytes - offset - element_bytes) / out.stride_bytes + 1;
    return out;
}

template <class... Parts>
[[noreturn]] void fail_to_fit(const JsonView& json, const Buffers::View& view, uint64_t count, uint64_t element_bytes,
                              const Parts&... more) {
    json.fail(count, " elements of ", element_bytes, " bytes from byte ", json.optional_uint("byteOffset", 0),
              " do not fit into its buffer view of ", view.bytes.size(), " bytes", more...);
}

// `count` such elements; fails if the view holds fewer.
AccessorView whole(const JsonView& json, const Buffers::View& view, uint64_t count, uint64_t element_bytes) {
    const Strided found = strided(json, view, element_bytes);
    if (found.count < count) fail_to_fit(json, view, count, element_bytes);
    return {.format = {}, .data = count == 0 ? kZeros.data() : found.data, .stride_bytes = found.stride_bytes};
}

}  // namespace

std::string AccessorFormat::component_text() const {
    if (is_float()) return "floats";
    return joined(is_unsigned() ? "unsigned " : "", 8 * size_of(component_type), "-bit integers");
}

float AccessorView::number(uint32_t element, uint32_t component) const {
    return visit_component(format.component_type, [&](auto zero) {
        using T = decltype(zero);
        const auto value = float(load<T>(element, component));
        if (sizeof(T) == 4 || !format.normalized) return value;
        return std::max(value / float(std::numeric_limits<T>::max()), -1.0f);
    });
}

uint32_t AccessorView::integer(uint32_t element, uint32_t component) const {
    return visit_component(format.component_type,
                           [&](auto zero) { return uint32_t(load<decltype(zero)>(element, component)); });
}

AccessorFormat Accessors::format(const JsonView& user, std::string_view key) const {
    AccessorFormat out;
    out.index = user.required_index(key, accessors_.size(), "accessors");
    const JsonView json = accessors_[out.index];
    out.type = json.required_string("type");
    const auto* type = std::find_if(std::begin(kTypes), std::end(kTypes),
                                    [&](const TypeName& t) { return t.name == out.type; });
    if (type == std::end(kTypes)) json.fail("type '", printable(out.type), "' is unknown");
    out.component_count = type->component_count;
    out.component_type = component_type_of(json);
    out.normalized = json.optional_bool("normalized", false);
    const uint64_t count = json.required_uint("count");
    if (count >= kNone)
        throw Failure(ErrorCode::kLimit, json.place(), "count ", count, " is above the limit of 4294967294");
    out.count = uint32_t(count);
    return out;
}

AccessorView Accessors::open(const AccessorFormat& format, Missing missing) {
    const JsonView json = accessors_[format.index];
    // By the specification, an accessor without a view is all zeros: here one element, read with a stride of 0.
    AccessorView out{.format = format, .data = kZeros.data()};
    if (json.has("bufferView")) out = in_view(json, format, missing);
    if (const auto sparse = json.optional_object("sparse")) {
        out.owner = with_sparse(json, *sparse, format.count, out);
        out.data = out.owner->data();
        out.stride_bytes = format.element_bytes();
    }
    return out;
}

// Exporters sometimes declare slightly too many elements, so a tenth of all may be missing.
AccessorView Accessors::in_view(const JsonView& json, const AccessorFormat& format, Missing missing) {
    const Buffers::View view = buffers_.view_of(json);
    const uint64_t element_bytes = format.element_bytes(), count = format.count;
    const Strided found = strided(json, view, element_bytes);
    AccessorView out{.format = format, .data = found.data, .stride_bytes = found.stride_bytes};
    if (count == 0) out.data = kZeros.data();
    if (found.count >= count) return out;
    const uint64_t missing_count = count - found.count;
    if (missing_count > count / 10)
        fail_to_fit(json, view, count, element_bytes, "; at most a tenth of them may be missing");
    warnings_.add(json.place(), missing_count, " of ", count, " elements lie beyond its buffer view: they are ",
                  missing == Missing::kAreZero ? "set to 0" : "left out");
    if (missing == Missing::kAreLeftOut) {
        out.format.count = uint32_t(found.count);
        return out;
    }
    auto padded = charged_bytes(budget_, count, element_bytes, json.place());
    for (uint64_t i = 0; i < found.count; ++i)
        std::memcpy(padded->data() + i * element_bytes, found.data + i * found.stride_bytes, element_bytes);
    return {.format = format, .data = padded->data(), .stride_bytes = element_bytes, .owner = padded};
}

std::shared_ptr<std::vector<std::byte>> Accessors::with_sparse(const JsonView& json, const JsonView& sparse,
                                                               uint64_t count, const AccessorView& base) {
    const uint64_t element_bytes = base.format.element_bytes();
    const uint64_t sparse_count = sparse.required_uint("count");
    if (sparse_count > count) sparse.fail("count is ", sparse_count, ", but the accessor has ", count, " elements");

    const JsonView indices_json = sparse.required_object("indices");
    const Buffers::View indices_view = buffers_.view_of(indices_json);
    const AccessorFormat indices_format{.component_count = 1, .component_type = component_type_of(indices_json)};
    if (!indices_format.is_unsigned()) indices_json.fail("must be unsigned integers");
    AccessorView indices = whole(indices_json, indices_view, sparse_count, indices_format.element_bytes());
    indices.format = indices_format;
    const JsonView values_json = sparse.required_object("values");
    const AccessorView values = whole(values_json, buffers_.view_of(values_json), sparse_count, element_bytes);

    auto out = charged_bytes(budget_, base.count(), element_bytes, json.place());
    if (base.stride_bytes > 0)
        for (uint64_t i = 0; i < base.count(); ++i)
            std::memcpy(out->data() + i * element_bytes, base.data + i * base.stride_bytes, element_bytes);
    for (uint32_t i = 0; i < sparse_count; ++i) {
        const uint32_t element = indices.integer(i, 0);
        if (element >= count) indices_json.fail("index ", element, ", but the accessor has ", count, " elements");
        if (element >= base.count()) continue;  // left out
        std::memcpy(out->data() + element * element_bytes, values.data + i * values.stride_bytes, element_bytes);
    }
    return out;
}

}  // namespace throng::gltf
