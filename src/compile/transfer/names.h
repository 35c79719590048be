// Names and warnings of two files that become one.
#pragma once

#include <throng/asset.h>

#include <cstddef>
#include <functional>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <vector>

namespace throng {

std::string quoted(const std::string& name);

// Names for a message, the first of them in full: "'tail', 'wing' and 3 more".
class NameList {
public:
    void add(const std::string& name, const std::string& note = {});
    size_t count() const { return count_; }
    std::string text() const;

private:
    std::string list_;
    size_t count_ = 0;
};

// The first joints, so that a message shows how the names of an asset look.
std::string some_joints(const Asset& asset, const std::vector<bool>& is_joint);

// The warnings of `from` that `asset` does not have already, and that are `relevant` to what is taken over.
std::vector<std::string> new_warnings(const Asset& asset, const Asset& from,
                                      const std::function<bool(const std::string&)>& relevant);

// "walk" of "moves/walk.glb"; `unnamed` for a file without a name.
std::string stem_of(const std::string& file, const char* unnamed);

// Names, each once.
class UniqueNames {
public:
    void insert(const std::string& name) { names_.insert(name); }

    // The name itself, unless it is there already or `is_generic`; else with the stem of its file before it, or in its
    // place, and a number behind it if need be.
    std::string add(const std::string& name, bool is_generic, const std::string& stem);

private:
    std::unordered_set<std::string> names_;
    std::unordered_map<std::string, uint32_t> last_numbers_;  // by the name without its number
};

}  // namespace throng
