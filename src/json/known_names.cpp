#include "json/known_names.h"

#include "base/count.h"
#include "base/failure.h"
#include "base/text.h"

#include <throng/asset.h>

#include <algorithm>
#include <numeric>

namespace throng {
namespace {

bool is_same_letter(char a, char b) {  // ignores case
    return ascii_lower(a) == ascii_lower(b);
}

bool contains(std::string_view whole, std::string_view part) {
    return !std::ranges::search(whole, part, is_same_letter).empty();
}

// The number of insertions, deletions, replacements and swaps of neighbours that turn `a` into `b` (F. Damerau, 1964;
// no letter is changed twice).
size_t edit_distance(std::string_view a, std::string_view b) {
    // row[j]: distance from the first i letters of a to the first j of b
    std::vector<size_t> row(b.size() + 1), above(b.size() + 1), above_that(b.size() + 1);
    std::iota(row.begin(), row.end(), size_t{0});
    for (size_t i = 1; i <= a.size(); ++i) {
        above_that.swap(above);
        above.swap(row);
        row[0] = i;
        for (size_t j = 1; j <= b.size(); ++j) {
            row[j] = std::min({above[j - 1] + !is_same_letter(a[i - 1], b[j - 1]), above[j] + 1, row[j - 1] + 1});
            if (i > 1 && j > 1 && is_same_letter(a[i - 1], b[j - 2]) && is_same_letter(a[i - 2], b[j - 1]))
                row[j] = std::min(row[j], above_that[j - 2] + 1);
        }
    }
    return row.back();
}

}  // namespace

bool KnownNames::add(std::string_view name) {
    const bool is_new = indices_.emplace(name, count_of(names_)).second;
    names_.push_back(name);
    return is_new;
}

uint32_t KnownNames::find(std::string_view name) const {
    const auto found = indices_.find(name);
    return found == indices_.end() ? kNone : found->second;
}

uint32_t KnownNames::require(std::string_view name, const std::string& place) const {
    const uint32_t index = find(name);
    if (index == kNone) throw Failure(ErrorCode::kInvalidArgument, place, unknown(name));
    return index;
}

std::string_view KnownNames::nearest(std::string_view name) const {
    std::string_view best;
    size_t least = std::max<size_t>(name.size() / 3, 1) + 1;  // names further away are other words
    if (name.size() > kNameLimit) return best;
    for (const std::string_view known : names_) {
        if (known.size() > name.size() + least || name.size() > known.size() + least) continue;
        const size_t distance = edit_distance(name, known);
        if (distance >= least) continue;
        least = distance;
        best = known;
    }
    return best;
}

std::string KnownNames::unknown(std::string_view name) const {
    constexpr size_t kShown = 12, kWord = 3;  // kWord in letters: shorter words can be part of a name by chance
    std::string text = "there is no " + kind_ + " '" + printable(name) + "'";
    if (names_.empty()) return text + ", nor any other";
    std::vector<std::string_view> listed = names_;
    std::string_view near = nearest(name);
    if (near.empty() && name.size() >= kWord && name.size() <= kNameLimit) {
        const auto others = std::ranges::stable_partition(listed, [&](auto known) { return contains(known, name); });
        if (others.begin() != listed.begin())
            near = *std::min_element(listed.begin(), others.begin(),
                                     [](auto a, auto b) { return a.size() < b.size(); });
    }
    if (!near.empty())
        text += "; did you mean '" + printable(near) + "'?";
    else
        text += ".";
    text += " There " + std::string(listed.size() == 1 ? "is: " : "are: ");
    for (size_t i = 0; i < std::min(listed.size(), kShown); ++i) text += (i ? ", " : "") + printable(listed[i]);
    if (listed.size() > kShown) text += ", … (" + std::to_string(listed.size()) + " in all)";
    return text;
}

}  // namespace throng
