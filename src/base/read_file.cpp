#include "base/read_file.h"

#include "base/failure.h"

#include <algorithm>
#include <fstream>

namespace throng {

std::vector<std::byte> read_file(const std::filesystem::path& path, uint64_t limit_bytes, const std::string& place,
                                 const char* too_large, const Progress& progress) {
    namespace fs = std::filesystem;
    if (path.empty()) throw Failure(ErrorCode::kFile, place, "the name of the file is empty");
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    // `place` names the file without its folder, but the folder may be what is wrong.
    const std::string where = path.has_parent_path() ? ": " + printable(path.string(), 1000) : "";
    if (status.type() == fs::file_type::not_found) throw Failure(ErrorCode::kFile, place, "no such file", where);
    // A pipe or a device could be read for ever.
    if (status.type() != fs::file_type::regular) throw Failure(ErrorCode::kFile, place, "not a regular file", where);
    const uint64_t size_bytes = fs::file_size(path, error);
    if (error) throw Failure(ErrorCode::kFile, place, "the file cannot be read");
    if (size_bytes > limit_bytes) throw Failure(ErrorCode::kLimit, place, too_large);
    std::ifstream stream(path, std::ios::binary);
    if (!stream) throw Failure(ErrorCode::kFile, place, "the file cannot be opened");
    constexpr uint64_t kPiece_bytes = 4 << 20;  // takes some milliseconds to read
    std::vector<std::byte> bytes;
    bytes.reserve(size_bytes);
    for (uint64_t begin = 0; begin < size_bytes; begin = bytes.size()) {
        progress.report(begin, size_bytes);
        const uint64_t piece_bytes = std::min(kPiece_bytes, size_bytes - begin);
        bytes.resize(begin + piece_bytes);
        stream.read(reinterpret_cast<char*>(bytes.data() + begin), std::streamsize(piece_bytes));
        if (uint64_t(stream.gcount()) != piece_bytes)
            throw Failure(ErrorCode::kFile, place, "the file cannot be read to its end");
    }
    return bytes;
}

}  // namespace throng
