#include "compile/transfer/names.h"

#include "base/text.h"

#include <algorithm>
#include <iterator>

namespace throng {
namespace {

constexpr size_t kShown = 5;  // of a list

}  // namespace

std::string quoted(const std::string& name) {
    return name.empty() ? "one without a name" : "'" + printable(name) + "'";
}

void NameList::add(const std::string& name, const std::string& note) {
    if (count_++ >= kShown) return;
    list_ += joined(list_.empty() ? "" : ", ", quoted(name), note);
}

std::string NameList::text() const {
    return count_ > kShown ? joined(list_, " and ", count_ - kShown, " more") : list_;
}

std::string some_joints(const Asset& asset, const std::vector<bool>& is_joint) {
    constexpr size_t kSome = 3;
    std::string list;
    size_t count = 0;
    for (uint32_t node = 0; node < asset.nodes.size() && count < kSome; ++node) {
        if (!is_joint[node]) continue;
        list += joined(count == 0 ? "'" : ", '", printable(asset.nodes[node].name), "'");
        ++count;
    }
    return list;
}

std::vector<std::string> new_warnings(const Asset& asset, const Asset& from,
                                      const std::function<bool(const std::string&)>& relevant) {
    const std::unordered_set<std::string> there(asset.warnings.begin(), asset.warnings.end());
    std::vector<std::string> out;
    std::ranges::copy_if(from.warnings, std::back_inserter(out),
                         [&](const std::string& line) { return !there.contains(line) && relevant(line); });
    return out;
}

std::string stem_of(const std::string& file, const char* unnamed) {
    const std::string name = file.substr(file.find_last_of("/\\") + 1), stem = name.substr(0, name.rfind('.'));
    return stem.empty() ? unnamed : stem;
}

std::string UniqueNames::add(const std::string& name, bool is_generic, const std::string& stem) {
    if (!is_generic && names_.insert(name).second) return name;
    const std::string base = is_generic ? stem : stem + " " + name;
    if (names_.insert(base).second) return base;
    for (uint32_t& number = last_numbers_.try_emplace(base, 1).first->second;;) {
        std::string numbered = joined(base, " ", ++number);
        if (names_.insert(numbered).second) return numbered;
    }
}

}  // namespace throng
