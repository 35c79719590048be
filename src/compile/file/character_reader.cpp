#include "compile/file/character_file.h"

#include "base/failure.h"
#include "compile/file/character_layout.h"

#include <algorithm>
#include <cassert>
#include <cstring>

namespace throng {
namespace {

using namespace file;

constexpr const char* kNotWrittenSo = "; throng writes no such file: compile it anew from its source";

class Reader {
public:
    Reader(std::span<const std::byte> bytes, const std::string& place) : bytes_(bytes), place_(place) {
        check_header();
        check_table();
    }

    Character run() {
        Character character;
        const size_t warning_count = read_scalars(character);
        read_records<ClipRecord>(SectionId::kClips, character.clips,
                                 [&](const ClipRecord& record) { return clip_of(record); });
        read_records<SkinRecord>(SectionId::kSkins, character.skins, [](const SkinRecord& record) {
            return Skin{{}, record.first_entry, record.joint_count};
        });
        read_records<MaterialRecord>(SectionId::kMaterials, character.materials,
                                     [&](const MaterialRecord& record) { return material_of(record); });
        const auto read_array = [&]<class T>(SectionId id, std::vector<T>& out) { out = array<T>(id); };
        visit_arrays(character, read_array);
        read_records<MorphRecord>(SectionId::kMorphs, character.morphs, [](const MorphRecord& record) {
            return Morph{{}, record.node, record.target, record.default_weight};
        });
        visit_later_arrays(character, read_array);
        read_images(character);
        read_text(character, warning_count);
        return character;
    }

private:
    [[noreturn]] void fail(const std::string& where, const std::string& what) const {
        throw Failure(ErrorCode::kInvalidFile, place_ + ": " + where, what + kNotWrittenSo);
    }
    [[noreturn]] void fail(SectionId id, const std::string& what) const {
        fail("section '" + std::string(kSections[static_cast<size_t>(id)].name) + "'", what);
    }

    // ---- The file as a whole

    void check_header() {
        const auto refuse = [&](ErrorCode code, const std::string& what) { throw Failure(code, place_, what); };
        if (bytes_.size() < kMagic.size() || std::memcmp(bytes_.data(), kMagic.data(), kMagic.size()) != 0)
            refuse(ErrorCode::kInvalidFile, "is not a compiled character");
        Header header;
        if (bytes_.size() < sizeof(header))
            refuse(ErrorCode::kInvalidFile, "ends within its header; copy it again, or compile it anew");
        std::memcpy(&header, bytes_.data(), sizeof(header));
        if (header.version != kVersion)
            refuse(ErrorCode::kUnsupported, "version " + std::to_string(header.version) +
                                                ", this throng reads version " + std::to_string(kVersion) +
                                                "; compile it anew from its source" +
                                                (header.version > kVersion ? ", or update throng" : ""));
        if (header.size_bytes != bytes_.size())
            refuse(ErrorCode::kInvalidFile, "has " + std::to_string(bytes_.size()) + " bytes, but " +
                                                std::to_string(header.size_bytes) +
                                                " by its header; copy it again, or compile it anew");
        if (header.checksum != checksum_of(bytes_))
            refuse(ErrorCode::kInvalidFile, "is damaged: its checksum is another; copy it again, or compile it anew");
        if (header.section_count != kSections.size())
            fail("header",
                 "has " + std::to_string(header.section_count) + " sections, not " + std::to_string(kSections.size()));
    }

    // Sections follow one another without overlap, in the order of their ids, with nothing but padding zeros between:
    // so no byte is read twice, and what is allocated is bounded by the size of the file.
    void check_table() {
        const uint64_t table_end = sizeof(Header) + sizeof(entries_);
        if (bytes_.size() < table_end) fail("section table", "ends behind the file");
        std::memcpy(entries_.data(), bytes_.data() + sizeof(Header), sizeof(entries_));
        uint64_t end = table_end;
        for (uint32_t i = 0; i < entries_.size(); ++i) {
            const SectionEntry& entry = entries_[i];
            const auto id = static_cast<SectionId>(i);
            if (entry.id != i) fail(id, "has id " + std::to_string(entry.id) + ", not " + std::to_string(i));
            if (entry.element_bytes != kSections[i].element_bytes)
                fail(id, "has elements of " + std::to_string(entry.element_bytes) + " bytes, not " +
                             std::to_string(kSections[i].element_bytes));
            const uint64_t begin = aligned(end);
            if (begin > bytes_.size() || entry.offset_bytes != begin)
                fail(id, "begins at byte " + std::to_string(entry.offset_bytes) + ", not " + std::to_string(begin));
            if (entry.size_bytes > bytes_.size() - begin)
                fail(id, "has " + std::to_string(entry.size_bytes) + " bytes, and " +
                             std::to_string(bytes_.size() - begin) + " are left");
            if (entry.size_bytes % entry.element_bytes != 0 ||
                entry.element_count != entry.size_bytes / entry.element_bytes)
                fail(id, std::to_string(entry.element_count) + " elements do not make " +
                             std::to_string(entry.size_bytes) + " bytes");
            const auto padding = bytes_.subspan(end, begin - end);
            if (std::any_of(padding.begin(), padding.end(), [](std::byte b) { return b != std::byte{}; }))
                fail(id, "is not padded with zeros");
            end = begin + entry.size_bytes;
        }
        if (end != bytes_.size())
            fail("section table", "ends at byte " + std::to_string(end) + " of " + std::to_string(bytes_.size()));
    }

    // ---- Sections

    template <class T>
    std::vector<T> array(SectionId id) const {
        static_assert(std::is_trivially_copyable_v<T>);
        const SectionEntry& entry = entries_[static_cast<size_t>(id)];
        assert(entry.element_bytes == sizeof(T));
        std::vector<T> out(entry.element_count);
        if (!out.empty())
            std::memcpy(static_cast<void*>(out.data()), bytes_.data() + entry.offset_bytes, entry.size_bytes);
        return out;
    }

    template <class Record, class T, class Convert>
    void read_records(SectionId id, std::vector<T>& out, const Convert& convert) const {
        const std::vector<Record> records = array<Record>(id);
        out.reserve(records.size());
        for (const Record& record : records) out.push_back(convert(record));
    }

    bool bool_of(SectionId id, const char* name, uint32_t value) const {
        if (value > 1) fail(id, std::string(name) + " is " + std::to_string(value) + ", neither 0 nor 1");
        return value == 1;
    }

    // Returns the number of warnings.
    size_t read_scalars(Character& character) const {
        const std::vector<ScalarsRecord> records = array<ScalarsRecord>(SectionId::kScalars);
        if (records.size() != 1)
            fail(SectionId::kScalars, "is there " + std::to_string(records.size()) + " times, not once");
        const ScalarsRecord& record = records.front();
        if (record.reserved != std::array<uint32_t, 2>{}) fail(SectionId::kScalars, "what is reserved is not 0");
        character.rig.mean_depth = record.mean_depth;
        character.rig.level_count = record.level_count;
        character.rig.leaf_count = record.leaf_count;
        character.rig.uniform_scale = bool_of(SectionId::kScalars, "uniform_scale", record.uniform_scale);
        character.packed = bool_of(SectionId::kScalars, "packed", record.packed);
        character.bounds_min = record.bounds_min;
        character.bounds_max = record.bounds_max;
        character.size = record.size;
        return record.warning_count;
    }

    Clip clip_of(const ClipRecord& record) const {
        return {.name = {},
                .duration_s = record.duration_s,
                .first_time = record.first_time,
                .row_count = record.row_count,
                .row_stride = record.row_stride,
                .first_row = record.first_row,
                .channel_count = record.channel_count,
                .source_key_count = record.source_key_count,
                .animated_track_count = record.animated_track_count,
                .refined_row_count = record.refined_row_count,
                .dropped_row_count = record.dropped_row_count,
                .size_bytes = record.size_bytes,
                .raw_size_bytes = record.raw_size_bytes,
                .first_root_row = record.first_root_row,
                .root_row_count = record.root_row_count,
                .error = record.error,
                .first_morph_time = record.first_morph_time,
                .morph_row_count = record.morph_row_count,
                .morph_row_stride = record.morph_row_stride,
                .bounds_min = record.bounds_min,
                .bounds_max = record.bounds_max};
    }

    AssetMaterial material_of(const MaterialRecord& record) const {
        if (record.alpha_mode > static_cast<uint32_t>(AlphaMode::kBlend))
            fail(SectionId::kMaterials, "alpha_mode " + std::to_string(record.alpha_mode) + " is unknown");
        return {.name = {},
                .base_color = record.base_color,
                .image = record.image,
                .alpha_mode = static_cast<AlphaMode>(record.alpha_mode),
                .alpha_cutoff = record.alpha_cutoff,
                .double_sided = bool_of(SectionId::kMaterials, "double_sided", record.double_sided),
                .metallic = record.metallic,
                .roughness = record.roughness,
                .metallic_roughness_image = record.metallic_roughness_image,
                .normal_image = record.normal_image,
                .normal_scale = record.normal_scale,
                .occlusion_image = record.occlusion_image,
                .occlusion_strength = record.occlusion_strength,
                .emissive = record.emissive,
                .emissive_image = record.emissive_image};
    }

    // Where each piece of a section of bytes ends: ascending, the last at the section's end.
    std::vector<uint64_t> ends(SectionId id, SectionId of) const {
        const std::vector<uint64_t> ends = array<uint64_t>(id);
        uint64_t before = 0;
        for (const uint64_t end : ends) {
            if (end < before) fail(id, "byte " + std::to_string(end) + " comes before " + std::to_string(before));
            before = end;
        }
        const uint64_t size_bytes = entries_[static_cast<size_t>(of)].size_bytes;
        if (before != size_bytes)
            fail(id, "the last is byte " + std::to_string(before) + " of " + std::to_string(size_bytes));
        return ends;
    }

    std::span<const std::byte> content(SectionId id) const {
        const SectionEntry& entry = entries_[static_cast<size_t>(id)];
        return bytes_.subspan(entry.offset_bytes, entry.size_bytes);
    }

    void read_images(Character& character) const {
        const std::vector<uint64_t> image_ends = ends(SectionId::kImageEnds, SectionId::kImages);
        character.images.reserve(image_ends.size());
        uint64_t begin = 0;
        for (const uint64_t end : image_ends) {
            const auto encoded = content(SectionId::kImages).subspan(begin, end - begin);
            character.images.push_back({{}, {encoded.begin(), encoded.end()}});
            begin = end;
        }
    }

    // The strings' number is known from the arrays that have been read; it bounds what is allocated for them.
    void read_text(Character& character, uint64_t warning_count) const {
        const std::vector<uint64_t> string_ends = ends(SectionId::kTextEnds, SectionId::kText);
        const uint64_t count = 1 + character.rig.parents.size() + character.clips.size() + character.skins.size() +
                               character.materials.size() + character.images.size() + character.morphs.size() +
                               warning_count;
        if (string_ends.size() != count)
            fail(SectionId::kTextEnds,
                 "has " + std::to_string(string_ends.size()) + " strings, not " + std::to_string(count));
        character.rig.names.resize(character.rig.parents.size());
        character.warnings.resize(warning_count);
        const auto* text = reinterpret_cast<const char*>(content(SectionId::kText).data());
        size_t next = 0;
        uint64_t begin = 0;
        visit_strings(character, [&](std::string& string) {
            const uint64_t end = string_ends[next++];
            string.assign(text + begin, end - begin);
            begin = end;
        });
    }

    std::span<const std::byte> bytes_;
    const std::string& place_;
    std::array<SectionEntry, kSections.size()> entries_;
};

}  // namespace

Character read_character(std::span<const std::byte> bytes, const std::string& place) {
    Character character = Reader(bytes, place).run();
    check_character(character, place, ErrorCode::kInvalidFile);
    return character;
}

}  // namespace throng
