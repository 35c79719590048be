// A parsed JSON file that knows the line of each value.
#pragma once

#include "base/progress.h"
#include "json/json_view.h"

#include <memory>

namespace throng {

// Limits for files that people write: size, nesting, number of values
inline constexpr size_t kJsonTextLimit_bytes = size_t{4} << 20;
inline constexpr size_t kJsonNestingLimit = 32;
inline constexpr size_t kJsonValueLimit = 500'000;
// The nesting limit for files that programs write. Their readers limit the size (import/limits.h).
inline constexpr size_t kProgramNestingLimit = 64;

// nlohmann's own destructor allocates memory to destroy nested values, and terminates the program if that fails.
struct DeleteJson {
    void operator()(Json* json) const;
};

class JsonText {
public:
    // Throws kInvalidFile and kLimit. If a person wrote the text, duplicate keys in an object are an error, and the
    // place of a failure is `file` and line. Otherwise the last of several equal keys counts, and the place is empty.
    JsonText(std::string_view text, JsonAuthor author, const std::string& file = {}, const Progress& progress = {});
    JsonView view() const { return JsonView(*root_, author_); }

    // "guard.json:12: layers[0].name": a place within the file, with its line. If there is no value at `place`, the
    // line of the innermost enclosing value. A member's line is that of its key.
    std::string located(const std::string& file, const std::string& place) const;

private:
    JsonAuthor author_;
    std::unique_ptr<Json, DeleteJson> root_;
    std::vector<uint32_t> lines_;  // line of each value, from 1, in the order of the text
};

}  // namespace throng
