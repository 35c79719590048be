#include "import/uri.h"

#include "base/text.h"

#include <algorithm>
#include <array>
#include <charconv>

namespace throng::gltf {
namespace {

namespace fs = std::filesystem;

std::string percent_decoded(std::string_view text, const std::string& place) {
    std::string out;
    out.reserve(text.size());
    for (size_t i = 0; i < text.size(); ++i) {
        if (text[i] != '%') {
            out.push_back(text[i]);
            continue;
        }
        const std::string_view digits = text.substr(i + 1, 2);
        uint8_t byte = 0;
        const char* end = std::from_chars(digits.data(), digits.data() + digits.size(), byte, 16).ptr;
        if (end != digits.data() + 2)
            throw Failure(ErrorCode::kInvalidFile, place, "bad percent escape in '", printable(text), "'");
        out.push_back(char(byte));
        i += 2;
    }
    return out;
}

constexpr std::array<int8_t, 256> kBase64Digits = [] {
    std::array<int8_t, 256> digits{};
    digits.fill(-1);
    constexpr std::string_view kAlphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < kAlphabet.size(); ++i) digits[uint8_t(kAlphabet[i])] = int8_t(i);
    digits[uint8_t('-')] = 62;  // the URL-safe alphabet
    digits[uint8_t('_')] = 63;
    return digits;
}();

std::vector<std::byte> base64_decoded(std::string_view text, const Budget& budget, const std::string& place) {
    std::vector<std::byte> out;
    out.reserve(text.size() / 4 * 3 + 3);
    uint32_t bits = 0, bit_count = 0;
    bool ended = false;
    for (size_t i = 0; i < text.size(); ++i) {
        budget.poll_at(i);
        const char c = text[i];
        if (c == ' ' || c == '\n' || c == '\r' || c == '\t') continue;
        if (c == '=') {
            ended = true;
            continue;
        }
        const int digit = kBase64Digits[uint8_t(c)];
        if (digit < 0 || ended)
            throw Failure(ErrorCode::kInvalidFile, place, "the data: URI is not base64: '", printable({&c, 1}),
                          "' in it");
        bits = (bits << 6 | uint32_t(digit)) & 0xFFFFFF;
        bit_count += 6;
        if (bit_count >= 8) {
            bit_count -= 8;
            out.push_back(std::byte(bits >> bit_count & 0xFF));
        }
    }
    if (bit_count >= 6) throw Failure(ErrorCode::kInvalidFile, place, "the base64 of the data: URI is cut short");
    return out;
}

bool has_scheme(std::string_view uri) {
    const size_t end = uri.find_first_of(":/?#");
    return end != uri.npos && uri[end] == ':';
}

// Both separators count on every system, since an application can have file systems of its own.
constexpr std::string_view kSeparators = "/\\";
bool is_absolute(std::string_view path) {
    return kSeparators.find(path[0]) != kSeparators.npos || (path.size() > 1 && path[1] == ':');
}
bool leads_up(std::string_view path) {
    for (size_t begin = 0, end = 0; end != path.npos; begin = end + 1) {
        end = path.find_first_of(kSeparators, begin);
        if (path.substr(begin, end - begin) == "..") return true;
    }
    return false;
}

[[noreturn]] void refuse(ErrorCode code, std::string_view uri, const std::string& place, const char* why) {
    throw Failure(code, place, "'", printable(uri), "' ", why);
}

}  // namespace

bool is_data_uri(std::string_view uri) { return ascii_lower(std::string(uri.substr(0, 5))) == "data:"; }

std::vector<std::byte> decode_data_uri(std::string_view uri, Budget& budget, const std::string& place) {
    const size_t comma = uri.find(',');
    if (comma == uri.npos) throw Failure(ErrorCode::kInvalidFile, place, "the data: URI has no comma");
    const std::string_view header = uri.substr(0, comma), payload = uri.substr(comma + 1);
    const bool escaped = payload.find('%') != payload.npos;
    budget.charge(payload.size() * (escaped ? 2 : 1), place);
    const std::string unescaped = escaped ? percent_decoded(payload, place) : std::string();
    const std::string_view text = escaped ? std::string_view(unescaped) : payload;
    if (header.ends_with(";base64")) return base64_decoded(text, budget, place);
    const auto* bytes = reinterpret_cast<const std::byte*>(text.data());
    return {bytes, bytes + text.size()};
}

std::string side_file_name(std::string_view uri, const std::string& place) {
    const auto fail = [&](const char* why) { refuse(ErrorCode::kInvalidFile, uri, place, why); };
    if (has_scheme(uri)) fail("is not a relative path: only data: URIs and files beside the glTF file are read");
    std::string name = percent_decoded(uri, place);
    if (name.empty() || name.find('\0') != name.npos) fail("is not a file name");
    if (is_absolute(name)) fail("is an absolute path: side files must lie in the file's folder");
    if (leads_up(name)) fail("has '..' in it: side files must lie in the file's folder");
    return name;
}

fs::path resolve_side_file(std::string_view uri, const fs::path& folder, const std::string& place) {
    const auto fail = [&](ErrorCode code, const char* why) { refuse(code, uri, place, why); };
    const fs::path relative(side_file_name(uri, place));
    std::error_code error;
    const fs::path root = fs::weakly_canonical(folder.empty() ? fs::path(".") : folder, error);
    if (error) fail(ErrorCode::kFile, "cannot be found");
    const fs::path file = fs::weakly_canonical(root / relative, error);
    if (error || !fs::exists(file, error)) fail(ErrorCode::kFile, "cannot be found");
    // A symbolic link may lead out of the folder.
    const auto [root_end, file_end] = std::mismatch(root.begin(), root.end(), file.begin(), file.end());
    if (root_end != root.end()) fail(ErrorCode::kInvalidFile, "leads out of the file's folder");
    if (!fs::is_regular_file(file, error)) fail(ErrorCode::kFile, "is not a regular file");
    return file;
}

}  // namespace throng::gltf
