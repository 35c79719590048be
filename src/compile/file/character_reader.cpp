#include "compile/file/character_file.h"

#include "base/failure.h"
#include "compile/file/character_check.h"
#include "compile/file/character_layout.h"

#include <algorithm>
#include <cassert>
#include <cstring>

namespace throng {
namespace {

using namespace file;

constexpr const char* kNotWrittenByThrong = "; throng never writes such a file: compile it again from its source";

class Reader {
public:
    Reader(std::span<const std::byte> bytes, const std::string& place) : bytes_(bytes), place_(place) {}

    Character run() {
        Character character;
        Records records;
        visit_sections(records, character,
                       [&]<class Elements>(SectionId id, const char* name, Elements&, uint64_t = 0) {
                           kinds_[static_cast<size_t>(id)] = {name, sizeof(typename Elements::value_type)};
                       });
        check_header();
        check_table();
        visit_sections(records, character,
                       [&](SectionId id, const char*, auto& elements, uint64_t = 0) { read(id, elements); });
        read_scalars(records, character);
        read_records(SectionId::kClips, records.clips, character.clips);
        read_records(SectionId::kSkins, records.skins, character.skins);
        read_records(SectionId::kMaterials, records.materials, character.materials);
        read_records(SectionId::kMorphs, records.morphs, character.morphs);
        read_images(records, character);
        read_text(records, character);
        return character;
    }

private:
    template <class... Parts>
    [[noreturn]] void fail(const std::string& where, const Parts&... what) const {
        throw Failure(ErrorCode::kInvalidFile, joined(place_, ": ", where), what..., kNotWrittenByThrong);
    }
    template <class... Parts>
    [[noreturn]] void fail(SectionId id, const Parts&... what) const {
        fail(joined("section '", kinds_[static_cast<size_t>(id)].name, "'"), what...);
    }

    // ---- The file as a whole

    void check_header() {
        const auto refuse = [&](ErrorCode code, const auto&... what) { throw Failure(code, place_, what...); };
        if (bytes_.size() < kMagic.size() || std::memcmp(bytes_.data(), kMagic.data(), kMagic.size()) != 0)
            refuse(ErrorCode::kInvalidFile, "is not a compiled character");
        Header header;
        if (bytes_.size() < sizeof(header))
            refuse(ErrorCode::kInvalidFile, "ends within its header; copy it again, or compile it again");
        std::memcpy(&header, bytes_.data(), sizeof(header));
        if (header.version != kVersion)
            refuse(ErrorCode::kUnsupported, "has version ", header.version, ", but this throng reads version ",
                   kVersion, "; compile it again from its source",
                   header.version > kVersion ? ", or update throng" : "");
        if (header.size_bytes != bytes_.size())
            refuse(ErrorCode::kInvalidFile, "has ", bytes_.size(), " bytes, but its header says ", header.size_bytes,
                   "; copy it again, or compile it again");
        if (header.checksum != checksum_of(bytes_))
            refuse(ErrorCode::kInvalidFile,
                   "is damaged: its checksum does not match; copy it again, or compile it again");
        if (header.section_count != kSectionCount)
            fail("header", "has ", header.section_count, " sections, not ", kSectionCount);
    }

    // Sections follow one another without overlap, in the order of their ids, with nothing but padding zeros between:
    // so no byte is read twice, and what is allocated is bounded by the size of the file.
    void check_table() {
        const uint64_t table_end = sizeof(Header) + sizeof(entries_);
        if (bytes_.size() < table_end) fail("section table", "ends beyond the end of the file");
        std::memcpy(entries_.data(), bytes_.data() + sizeof(Header), sizeof(entries_));
        uint64_t end = table_end;
        for (uint32_t i = 0; i < entries_.size(); ++i) {
            const SectionEntry& entry = entries_[i];
            const auto id = static_cast<SectionId>(i);
            if (entry.id != i) fail(id, "has id ", entry.id, ", not ", i);
            if (entry.element_bytes != kinds_[i].element_bytes)
                fail(id, "has elements of ", entry.element_bytes, " bytes, not ", kinds_[i].element_bytes);
            const uint64_t begin = aligned(end);
            if (begin > bytes_.size() || entry.offset_bytes != begin)
                fail(id, "begins at byte ", entry.offset_bytes, ", not ", begin);
            if (entry.size_bytes > bytes_.size() - begin)
                fail(id, "has ", entry.size_bytes, " bytes, but only ", bytes_.size() - begin, " are left");
            if (entry.size_bytes % entry.element_bytes != 0 ||
                entry.element_count != entry.size_bytes / entry.element_bytes)
                fail(id, entry.element_count, " elements do not make ", entry.size_bytes, " bytes");
            const auto padding = bytes_.subspan(end, begin - end);
            if (std::any_of(padding.begin(), padding.end(), [](std::byte b) { return b != std::byte{}; }))
                fail(id, "is not padded with zeros");
            end = begin + entry.size_bytes;
        }
        if (end != bytes_.size())
            fail("section table", "the last section ends at byte ", end, ", but the file has ", bytes_.size());
    }

    // ---- Sections

    std::span<const std::byte> content(SectionId id) const {
        const SectionEntry& entry = entries_[static_cast<size_t>(id)];
        return bytes_.subspan(entry.offset_bytes, entry.size_bytes);
    }

    template <class T>
    void read(SectionId id, std::vector<T>& out) const {
        static_assert(std::is_trivially_copyable_v<T>);
        const auto from = content(id);
        out.resize(from.size() / sizeof(T));
        if (!out.empty()) std::memcpy(static_cast<void*>(out.data()), from.data(), from.size());
    }
    template <class T>
    void read(SectionId id, std::span<T>& out) const {
        static_assert(sizeof(T) == 1);
        out = {reinterpret_cast<T*>(content(id).data()), content(id).size()};
    }

    template <class Record, class T>
    void read_record(SectionId id, const Record& record, T& out) const {
        visit_fields(record, out, [&]<class Value>(const auto& stored, Value& value, const char* name = "") {
            if constexpr (std::is_same_v<Value, bool>)
                if (stored > 1) fail(id, name, " is ", uint32_t{stored}, ", neither 0 nor 1");
            if constexpr (std::is_enum_v<Value>)
                if (uint32_t{stored} > static_cast<uint32_t>(last_of<Value>))
                    fail(id, name, " ", uint32_t{stored}, " is unknown");
            value = static_cast<Value>(stored);
        });
    }

    template <class Record, class T>
    void read_records(SectionId id, const std::vector<Record>& records, std::vector<T>& out) const {
        out.resize(records.size());
        for (size_t i = 0; i < records.size(); ++i) read_record(id, records[i], out[i]);
    }

    void read_scalars(const Records& records, Character& character) const {
        const size_t count = records.scalars.size();
        if (count != 1) fail(SectionId::kScalars, "has ", count, " elements, not 1");
        const ScalarsRecord& scalars = records.scalars.front();
        if (scalars.reserved != std::array<uint32_t, 2>{}) fail(SectionId::kScalars, "a reserved field is not 0");
        read_record(SectionId::kScalars, scalars, character);
    }

    // Checks where the pieces of a section of bytes end: in ascending order, the last one at the section's end.
    void check_ends(SectionId id, const std::vector<uint64_t>& ends, uint64_t size_bytes) const {
        uint64_t before = 0;
        for (const uint64_t end : ends) {
            if (end < before) fail(id, "byte ", end, " follows byte ", before, ", but ends must ascend");
            before = end;
        }
        if (before != size_bytes) fail(id, "the last end is byte ", before, ", but there are ", size_bytes, " bytes");
    }

    void read_images(const Records& records, Character& character) const {
        check_ends(SectionId::kImageEnds, records.image_ends, records.images.size());
        character.images.reserve(records.image_ends.size());
        uint64_t begin = 0;
        for (const uint64_t end : records.image_ends) {
            const auto encoded = records.images.subspan(begin, end - begin);
            character.images.push_back({{}, {encoded.begin(), encoded.end()}});
            begin = end;
        }
    }

    // The number of strings follows from the arrays that have been read. It bounds what is allocated for them.
    void read_text(const Records& records, Character& character) const {
        check_ends(SectionId::kTextEnds, records.text_ends, records.text.size());
        const size_t warning_count = records.scalars.front().warning_count;
        const size_t count = 1 + character.rig.parents.size() + character.clips.size() + character.skins.size() +
                             character.materials.size() + character.images.size() + character.morphs.size() +
                             character.sections.size() + warning_count;
        if (records.text_ends.size() != count)
            fail(SectionId::kTextEnds, "has ", records.text_ends.size(), " strings, not ", count);
        character.rig.names.resize(character.rig.parents.size());
        character.section_names.resize(character.sections.size());
        character.warnings.resize(warning_count);
        size_t next = 0;
        uint64_t begin = 0;
        visit_strings(character, [&](std::string& string) {
            const uint64_t end = records.text_ends[next++];
            string.assign(records.text.data() + begin, end - begin);
            begin = end;
        });
    }

    struct Kind {
        const char* name = "";
        uint32_t element_bytes = 0;
    };

    std::span<const std::byte> bytes_;
    const std::string& place_;
    std::array<Kind, kSectionCount> kinds_;
    std::array<SectionEntry, kSectionCount> entries_;
};

}  // namespace

Character read_character(std::span<const std::byte> bytes, const std::string& place) {
    Character character = Reader(bytes, place).run();
    check_character(character, place, ErrorCode::kInvalidFile);
    return character;
}

}  // namespace throng
