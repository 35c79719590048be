#include "compile/file/character_file.h"

#include "base/count.h"
#include "base/crc64.h"
#include "base/failure.h"
#include "base/message_name.h"
#include "compile/file/character_check.h"
#include "compile/file/character_layout.h"

#include <cassert>
#include <cstddef>
#include <cstring>

namespace throng {
namespace {

using namespace file;

template <class Record, class T>
Record record_of(const T& thing) {
    Record record;
    visit_fields(record, thing, [](auto& stored, const auto& value, const char* = "") {
        stored = static_cast<std::remove_reference_t<decltype(stored)>>(value);
    });
    return record;
}

template <class Record, class T>
void store(std::vector<Record>& records, const std::vector<T>& things) {
    for (const T& thing : things) records.push_back(record_of<Record>(thing));
}

class Writer {
public:
    Writer(const std::string& place, uint64_t limit_bytes) : place_(place), limit_bytes_(limit_bytes) {}

    std::vector<std::byte> run(const Character& character) {
        bytes_.resize(sizeof(Header) + kSectionCount * sizeof(SectionEntry));
        const Records records = records_of(character);
        visit_sections(records, character,
                       [&](SectionId id, const char*, const auto& elements, uint64_t = 0) { add(id, elements); });

        std::memcpy(bytes_.data() + sizeof(Header), entries_.data(), entries_.size() * sizeof(SectionEntry));
        Header header{.section_count = count_of(entries_), .size_bytes = bytes_.size()};
        std::memcpy(bytes_.data(), &header, sizeof(header));
        header.checksum = checksum_of(bytes_);
        std::memcpy(bytes_.data(), &header, sizeof(header));
        return std::move(bytes_);
    }

private:
    Records records_of(const Character& character) {
        Records records;
        records.scalars.push_back(record_of<ScalarsRecord>(character));
        records.scalars.front().warning_count = count_of(character.warnings);
        store(records.clips, character.clips);
        store(records.skins, character.skins);
        store(records.materials, character.materials);
        store(records.morphs, character.morphs);
        visit_strings(character, [&](const std::string& string) {
            text_ += string;
            records.text_ends.push_back(text_.size());
        });
        records.text = text_;
        for (const AssetImage& image : character.images) {
            images_.insert(images_.end(), image.encoded.begin(), image.encoded.end());
            records.image_ends.push_back(images_.size());
        }
        records.images = images_;
        return records;
    }

    template <class Elements>
    void add(SectionId id, const Elements& elements) {
        using T = typename Elements::value_type;
        static_assert(std::is_trivially_copyable_v<T>);
        assert(entries_.size() == static_cast<size_t>(id));
        const uint64_t offset_bytes = aligned(bytes_.size()), end_bytes = offset_bytes + elements.size() * sizeof(T);
        if (end_bytes > limit_bytes_)
            throw Failure(ErrorCode::kLimit, place_, "the compiled file would have at least ", end_bytes,
                          " bytes; the limit is ", limit_bytes_);
        bytes_.resize(offset_bytes);
        entries_.push_back({.id = static_cast<uint32_t>(id),
                            .element_bytes = sizeof(T),
                            .offset_bytes = offset_bytes,
                            .size_bytes = elements.size() * sizeof(T),
                            .element_count = elements.size()});
        const auto added = std::as_bytes(std::span(elements));
        bytes_.insert(bytes_.end(), added.begin(), added.end());
    }

    const std::string& place_;
    const uint64_t limit_bytes_;
    std::string text_;               // of all strings
    std::vector<std::byte> images_;  // of all images
    std::vector<std::byte> bytes_;
    std::vector<SectionEntry> entries_;
};

}  // namespace

std::vector<std::byte> write_character(const Character& character, uint64_t limit_bytes) {
    const std::string place = message_name(character.name);
    check_character(character, place, ErrorCode::kInvalidArgument);
    return Writer(place, limit_bytes).run(character);
}

uint64_t checksum_of(std::span<const std::byte> file) {
    constexpr size_t kAt = offsetof(Header, checksum), kEnd = kAt + sizeof(Header::checksum);
    return crc64(file.subspan(kEnd), crc64(file.first(kAt)));
}

}  // namespace throng
