#include "import/uri.h"

#include "base/text.h"

#include <algorithm>
#include <array>
#include <charconv>

namespace throng::gltf {
namespace {

namespace fs = std::filesystem;

// Calls bad_escape() at a `%` that begins no escape; if that returns, the `%` stands for itself.
template <class BadEscape>
std::string percent_decoded(std::string_view text, const BadEscape& bad_escape) {
    std::string out;
    out.reserve(text.size());
    for (size_t i = 0; i < text.size(); ++i) {
        out.push_back(text[i]);
        if (text[i] != '%') continue;
        const std::string_view digits = text.substr(i + 1, 2);
        uint8_t byte = 0;
        const char* end = std::from_chars(digits.data(), digits.data() + digits.size(), byte, 16).ptr;
        if (end != digits.data() + 2) {
            bad_escape();
            continue;
        }
        out.back() = char(byte);
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
            throw Failure(ErrorCode::kInvalidFile, place, "the data: URI is not base64: it contains '",
                          printable({&c, 1}), "'");
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

// Without dot segments (RFC 3986, 5.2.4), but for those at the beginning that lead out of the folder.
std::string normal_path(std::string_view path) { return fs::path(path).lexically_normal().generic_string(); }
std::string with_slashes(std::string path) {
    std::ranges::replace(path, '\\', '/');
    return path;
}
// Whether a normal path begins with '..'. It can have none elsewhere.
bool leads_up(std::string_view path) { return path == ".." || path.starts_with("../"); }

[[noreturn]] void refuse(ErrorCode code, std::string_view uri, const std::string& place, const char* why) {
    throw Failure(code, place, "'", printable(uri), "' ", why);
}

// The path in a URI, percent-decoded and normal.
struct RelativePath {
    std::string as_written, name;  // with `\`, and with `/` for it
};

RelativePath relative_path(std::string_view uri, const std::string& place) {
    const auto fail = [&](const char* why) { refuse(ErrorCode::kInvalidFile, uri, place, why); };
    if (has_scheme(uri)) fail("is not a relative path: only data: URIs and files beside the glTF file are read");
    // Some exporters do not escape names, so a `%` can be a part of a name.
    const std::string path = percent_decoded(uri, [] {});
    std::string name = normal_path(with_slashes(path));
    if (path.empty() || path.find('\0') != path.npos || name == ".") fail("is not a file name");
    // "./c:/file" begins with a drive once it is normal.
    if (is_absolute(path) || is_absolute(name)) fail("is an absolute path: side files must lie in the file's folder");
    return {normal_path(path), std::move(name)};
}

}  // namespace

bool is_data_uri(std::string_view uri) { return ascii_lower(std::string(uri.substr(0, 5))) == "data:"; }

std::vector<std::byte> decode_data_uri(std::string_view uri, Budget& budget, const std::string& place) {
    const size_t comma = uri.find(',');
    if (comma == uri.npos) throw Failure(ErrorCode::kInvalidFile, place, "the data: URI has no comma");
    const std::string_view header = uri.substr(0, comma), payload = uri.substr(comma + 1);
    const bool escaped = payload.find('%') != payload.npos;
    budget.charge(payload.size() * (escaped ? 2 : 1), place);
    const auto fail = [&] {
        throw Failure(ErrorCode::kInvalidFile, place, "bad percent escape in '", printable(payload), "'");
    };
    const std::string unescaped = escaped ? percent_decoded(payload, fail) : std::string();
    const std::string_view text = escaped ? std::string_view(unescaped) : payload;
    if (header.ends_with(";base64")) return base64_decoded(text, budget, place);
    const auto* bytes = reinterpret_cast<const std::byte*>(text.data());
    return {bytes, bytes + text.size()};
}

std::string side_file_name(std::string_view uri, const std::string& place) { return relative_path(uri, place).name; }

fs::path resolve_side_file(std::string_view uri, const fs::path& folder, const std::string& place) {
    const auto fail = [&](ErrorCode code, const char* why) { refuse(code, uri, place, why); };
    const auto [as_written, name] = relative_path(uri, place);
    if (leads_up(name))
        fail(ErrorCode::kInvalidFile, "leads out of the file's folder by '..': side files must lie in it or below");
    std::error_code error;
    const fs::path root = fs::weakly_canonical(folder.empty() ? fs::path(".") : folder, error);
    if (error) fail(ErrorCode::kFile, "cannot be found");
    // Where a backslash is no separator, it can be part of a name.
    const bool is_as_written = !leads_up(as_written) && fs::exists(root / as_written, error);
    const fs::path file = fs::weakly_canonical(root / (is_as_written ? as_written : name), error);
    if (error || !fs::exists(file, error)) fail(ErrorCode::kFile, "cannot be found");
    // A symbolic link may lead out of the folder.
    const auto [root_end, file_end] = std::mismatch(root.begin(), root.end(), file.begin(), file.end());
    if (root_end != root.end()) fail(ErrorCode::kInvalidFile, "leads out of the file's folder");
    if (!fs::is_regular_file(file, error)) fail(ErrorCode::kFile, "is not a regular file");
    return file;
}

}  // namespace throng::gltf
