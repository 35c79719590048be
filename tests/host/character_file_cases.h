// Files of small characters, and tools to forge them.
#pragma once

#include "compile/file/character_file.h"
#include "compile/file/character_layout.h"
#include "tests/test_rig.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <tuple>
#include <vector>

namespace throng::test {

using Bytes = std::vector<std::byte>;

// The fields of a struct. Adding a field fails to compile here: write it to the file, and compare it.
inline auto fields_of(const Clip& clip) {
    const auto& [name, duration_s, first_time, row_count, row_stride, first_row, channels, source_keys, animated,
                 refined, dropped, size_bytes, raw_size_bytes, first_root_row, root_row_count, error, first_morph_time,
                 morph_row_count, morph_row_stride, bounds_min, bounds_max] = clip;
    return std::tie(name, duration_s, first_time, row_count, row_stride, first_row, channels, source_keys, animated,
                    refined, dropped, size_bytes, raw_size_bytes, first_root_row, root_row_count, error,
                    first_morph_time, morph_row_count, morph_row_stride, bounds_min, bounds_max);
}
inline auto fields_of(const Morph& morph) {
    const auto& [name, node, target, default_weight] = morph;
    return std::tie(name, node, target, default_weight);
}
inline auto fields_of(const Skin& skin) {
    const auto& [name, first_entry, joint_count] = skin;
    return std::tie(name, first_entry, joint_count);
}
inline auto fields_of(const AssetMaterial& material) {
    const auto& [name, base_color, image, alpha_mode, alpha_cutoff, double_sided, filter, wrap_u, wrap_v, metallic,
                 roughness, metallic_roughness_image, normal_image, normal_scale, occlusion_image, occlusion_strength,
                 emissive, emissive_image] = material;
    return std::tie(name, base_color, image, alpha_mode, alpha_cutoff, double_sided, filter, wrap_u, wrap_v, metallic,
                    roughness, metallic_roughness_image, normal_image, normal_scale, occlusion_image,
                    occlusion_strength, emissive, emissive_image);
}
inline auto fields_of(const AssetImage& image) {
    const auto& [name, encoded] = image;
    return std::tie(name, encoded);
}

inline constexpr double kErrors[] = {0, 1e-4};  // exact and packed

// An asset with every feature of a character, and names that are not plain text.
Asset make_full_asset(const AssetSettings& settings);

// A file of a few kilobytes.
Bytes small_file(double error);

inline Result<Character> load(const Bytes& bytes) { return load_compiled_character(bytes, "small.throng"); }

// A file with forged content and a corrected checksum.
class Forged {
public:
    explicit Forged(Bytes bytes) : bytes_(std::move(bytes)) {}

    const Bytes& sealed() {
        header().checksum = checksum_of(bytes_);
        return bytes_;
    }
    Bytes& bytes() { return bytes_; }
    file::Header& header() { return *reinterpret_cast<file::Header*>(bytes_.data()); }
    file::SectionEntry& entry(file::SectionId id) {
        return *reinterpret_cast<file::SectionEntry*>(bytes_.data() + sizeof(file::Header) +
                                                      static_cast<size_t>(id) * sizeof(file::SectionEntry));
    }
    // An element of a section. A negative `index` counts from the end.
    template <class T>
    T& at(file::SectionId id, int64_t index = 0) {
        const file::SectionEntry& of = entry(id);
        EXPECT_EQ(of.element_bytes, sizeof(T));
        const auto count = static_cast<int64_t>(of.element_count);
        EXPECT_TRUE(index < count && -index <= count) << "the case has nothing to change";
        return *reinterpret_cast<T*>(bytes_.data() + of.offset_bytes +
                                     static_cast<uint64_t>(index < 0 ? count + index : index) * sizeof(T));
    }

private:
    Bytes bytes_;
};

}  // namespace throng::test
