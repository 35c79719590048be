#include "compile/file/character_file.h"

#include "base/failure.h"
#include "compile/file/character_layout.h"
#include "base/crc64.h"

#include <cassert>
#include <cstddef>
#include <cstring>

namespace throng {
namespace {

using namespace file;

ClipRecord record_of(const Clip& clip) {
    return {.duration_s = clip.duration_s,
            .first_time = clip.first_time,
            .row_count = clip.row_count,
            .row_stride = clip.row_stride,
            .first_row = clip.first_row,
            .channel_count = clip.channel_count,
            .animated_track_count = clip.animated_track_count,
            .refined_row_count = clip.refined_row_count,
            .dropped_row_count = clip.dropped_row_count,
            .first_root_row = clip.first_root_row,
            .root_row_count = clip.root_row_count,
            .first_morph_time = clip.first_morph_time,
            .morph_row_count = clip.morph_row_count,
            .morph_row_stride = clip.morph_row_stride,
            .source_key_count = clip.source_key_count,
            .size_bytes = clip.size_bytes,
            .raw_size_bytes = clip.raw_size_bytes,
            .error = clip.error,
            .bounds_min = clip.bounds_min,
            .bounds_max = clip.bounds_max};
}

SkinRecord record_of(const Skin& skin) { return {.first_entry = skin.first_entry, .joint_count = skin.joint_count}; }

MaterialRecord record_of(const AssetMaterial& material) {
    return {.base_color = material.base_color,
            .image = material.image,
            .alpha_mode = static_cast<uint32_t>(material.alpha_mode),
            .alpha_cutoff = material.alpha_cutoff,
            .double_sided = material.double_sided,
            .metallic = material.metallic,
            .roughness = material.roughness,
            .metallic_roughness_image = material.metallic_roughness_image,
            .normal_image = material.normal_image,
            .occlusion_image = material.occlusion_image,
            .emissive_image = material.emissive_image,
            .normal_scale = material.normal_scale,
            .occlusion_strength = material.occlusion_strength,
            .emissive = material.emissive};
}

MorphRecord record_of(const Morph& morph) {
    return {.node = morph.node, .target = morph.target, .default_weight = morph.default_weight};
}

ScalarsRecord scalars_of(const Character& character) {
    return {.mean_depth = character.rig.mean_depth,
            .level_count = character.rig.level_count,
            .leaf_count = character.rig.leaf_count,
            .uniform_scale = character.rig.uniform_scale,
            .packed = character.packed,
            .warning_count = static_cast<uint32_t>(character.warnings.size()),
            .bounds_min = character.bounds_min,
            .bounds_max = character.bounds_max,
            .size = character.size};
}

class Writer {
public:
    Writer(const std::string& place, uint64_t limit_bytes) : place_(place), limit_bytes_(limit_bytes) {}

    std::vector<std::byte> run(const Character& character) {
        bytes_.resize(sizeof(Header) + kSections.size() * sizeof(SectionEntry));
        add(SectionId::kScalars, std::vector{scalars_of(character)});
        add_records(SectionId::kClips, character.clips);
        add_records(SectionId::kSkins, character.skins);
        add_records(SectionId::kMaterials, character.materials);
        add_text(character);
        add_images(character);
        const auto add_array = [&](SectionId id, const auto& array) { add(id, array); };
        visit_arrays(character, add_array);
        add_records(SectionId::kMorphs, character.morphs);
        visit_later_arrays(character, add_array);

        std::memcpy(bytes_.data() + sizeof(Header), entries_.data(), entries_.size() * sizeof(SectionEntry));
        Header header{.section_count = static_cast<uint32_t>(entries_.size()), .size_bytes = bytes_.size()};
        std::memcpy(bytes_.data(), &header, sizeof(header));
        header.checksum = checksum_of(bytes_);
        std::memcpy(bytes_.data(), &header, sizeof(header));
        return std::move(bytes_);
    }

private:
    template <class T>
    void add(SectionId id, const std::vector<T>& array) {
        static_assert(std::is_trivially_copyable_v<T>);
        assert(entries_.size() == static_cast<size_t>(id) && sizeof(T) == kSections[entries_.size()].element_bytes);
        const uint64_t offset_bytes = aligned(bytes_.size()), end_bytes = offset_bytes + array.size() * sizeof(T);
        if (end_bytes > limit_bytes_)
            throw Failure(ErrorCode::kLimit, place_,
                          "a compiled file of " + std::to_string(end_bytes) + " bytes and more; the limit is " +
                              std::to_string(limit_bytes_));
        bytes_.resize(offset_bytes);
        entries_.push_back({.id = static_cast<uint32_t>(id),
                            .element_bytes = sizeof(T),
                            .offset_bytes = bytes_.size(),
                            .size_bytes = array.size() * sizeof(T),
                            .element_count = array.size()});
        const auto* first = reinterpret_cast<const std::byte*>(array.data());
        bytes_.insert(bytes_.end(), first, first + array.size() * sizeof(T));
    }

    template <class T>
    void add_records(SectionId id, const std::vector<T>& things) {
        std::vector<decltype(record_of(std::declval<T>()))> records;
        for (const T& thing : things) records.push_back(record_of(thing));
        add(id, records);
    }

    void add_text(const Character& character) {
        std::vector<uint64_t> ends;
        std::vector<char> text;
        visit_strings(character, [&](const std::string& string) {
            text.insert(text.end(), string.begin(), string.end());
            ends.push_back(text.size());
        });
        add(SectionId::kTextEnds, ends);
        add(SectionId::kText, text);
    }

    void add_images(const Character& character) {
        std::vector<uint64_t> ends;
        std::vector<std::byte> encoded;
        for (const AssetImage& image : character.images) {
            encoded.insert(encoded.end(), image.encoded.begin(), image.encoded.end());
            ends.push_back(encoded.size());
        }
        add(SectionId::kImageEnds, ends);
        add(SectionId::kImages, encoded);
    }

    const std::string& place_;
    const uint64_t limit_bytes_;
    std::vector<std::byte> bytes_;
    std::vector<SectionEntry> entries_;
};

}  // namespace

std::vector<std::byte> write_character(const Character& character, uint64_t limit_bytes) {
    const std::string place = printable(character.name, 120);
    check_character(character, place, ErrorCode::kInvalidArgument);
    return Writer(place, limit_bytes).run(character);
}

uint64_t checksum_of(std::span<const std::byte> file) {
    constexpr size_t kAt = offsetof(Header, checksum), kEnd = kAt + sizeof(Header::checksum);
    return crc64(file.subspan(kEnd), crc64(file.first(kAt)));
}

}  // namespace throng
