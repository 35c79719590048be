// The text of a JSON file, parsed; each value knows its line.
#pragma once

#include "base/progress.h"
#include "json/json_view.h"

#include <memory>

namespace throng {

// Limits of what people write: size, nesting, number of values
inline constexpr size_t kJsonTextLimit_bytes = size_t{4} << 20;
inline constexpr size_t kJsonNestingLimit = 32;
inline constexpr size_t kJsonValueLimit = 500'000;
// The deepest nesting of files that programs write. Their readers bound the size (import/limits.h).
inline constexpr size_t kProgramNestingLimit = 64;

// nlohmann's own destructor allocates memory for what a value contains, and ends the program if there is none.
struct DeleteJson {
    void operator()(Json* json) const;
};

class JsonText {
public:
    // Throws kInvalidFile and kLimit. If a person wrote the text, no key may stand twice in an object, and the place of
    // a failure is `file` and line; else the last of several equal keys counts, and the place is empty.
    JsonText(std::string_view text, JsonAuthor author, const std::string& file = {}, const Progress& progress = {});
    JsonView view() const { return JsonView(*root_, author_); }

    // "guard.json:12: layers[0].name": a place within the file, with its line or that of the innermost value around it
    // that exists. A member's line is that of its key.
    std::string located(const std::string& file, const std::string& place) const;

private:
    JsonAuthor author_;
    std::unique_ptr<Json, DeleteJson> root_;
    std::vector<uint32_t> lines_;  // from 1; of each value, in the order of the text
};

}  // namespace throng
