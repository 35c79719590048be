#include "compile/transfer/node_names.h"

#include "base/text.h"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>

namespace throng {
namespace {

// "mixamorig:Left Hand" as "lefthand": exporters put a namespace in front of names, and take characters out of them.
std::string loose_name(std::string_view name) {
    std::string out;
    for (const char c : name.substr(name.rfind(':') + 1))
        if (static_cast<unsigned char>(c) >= 0x80 || is_ascii_alphanumeric(c)) out += ascii_lower(c);
    return out;
}

enum class NameForm { kExact, kLoose, kWithoutPrefix, kWithoutNumber };

// Names as they are compared.
class Names {
public:
    // `is_chosen`: the nodes that matter. Some forms leave out the prefix that all of them share.
    Names(const Asset& asset, const std::vector<bool>& is_chosen) : asset_(asset) {
        bool is_first = true;
        for (uint32_t node = 0; node < is_chosen.size(); ++node) {
            if (!is_chosen[node]) continue;
            const std::string name = loose_name(asset.nodes[node].name);
            if (std::exchange(is_first, false)) prefix_ = name;
            shorten_prefix(name);
        }
        // What few nodes share is more than a prefix: "mixamorigLeft" of gloves. The nodes above them tell.
        std::vector<bool> is_seen = is_chosen;
        for (uint32_t node = 0; node < is_chosen.size(); ++node) {
            if (!is_chosen[node]) continue;
            for (uint32_t above = asset.nodes[node].parent; above != kNone && !is_seen[above];
                 above = asset.nodes[above].parent) {
                is_seen[above] = true;
                const std::string name = loose_name(asset.nodes[above].name);
                if (name.starts_with(prefix_)) continue;
                if (common_length(prefix_, name) < kShortestPrefix) break;  // the node that holds the rig
                shorten_prefix(name);
            }
        }
    }
    std::string of(uint32_t node, NameForm form) const {
        const std::string& name = asset_.nodes[node].name;
        if (form == NameForm::kExact) return name;
        // Sketchfab numbers nodes: "Hips_03".
        const size_t last = name.find_last_not_of("0123456789");
        const bool is_numbered = last != name.npos && last + 1 < name.size() && name[last] == '_';
        const bool cuts_number = form == NameForm::kWithoutNumber && is_numbered;
        const std::string loose = loose_name(cuts_number ? name.substr(0, last) : name);
        return form != NameForm::kLoose && loose.starts_with(prefix_) ? loose.substr(prefix_.size()) : loose;
    }

private:
    static constexpr size_t kShortestPrefix = 3;
    static size_t common_length(std::string_view a, std::string_view b) {
        return static_cast<size_t>(std::ranges::mismatch(a, b).in1 - a.begin());
    }
    void shorten_prefix(const std::string& name) { prefix_.resize(common_length(prefix_, name)); }

    const Asset& asset_;
    std::string prefix_;  // three.js writes "mixamorig:Hips" as "mixamorigHips"
};

}  // namespace

std::vector<uint32_t> find_sources(const Asset& from, const std::vector<bool>& comes_first, const Asset& to,
                                   const std::vector<bool>& is_joint) {
    struct Step {
        NameForm from, to;
        bool is_unique = true;  // skips names that several nodes have in this form
    };
    constexpr std::array kSteps{Step{NameForm::kExact, NameForm::kExact, false},
                                Step{NameForm::kLoose, NameForm::kLoose, false},
                                Step{NameForm::kWithoutPrefix, NameForm::kWithoutPrefix},
                                Step{NameForm::kWithoutNumber, NameForm::kWithoutPrefix},
                                Step{NameForm::kWithoutPrefix, NameForm::kWithoutNumber}};
    const Names from_names(from, comes_first), to_names(to, is_joint);
    std::vector<uint32_t> sources(to.nodes.size(), kNone);
    std::vector<bool> is_taken(from.nodes.size(), false);
    using NodesByName = std::unordered_map<std::string, std::vector<uint32_t>>;
    for (const Step& step : kSteps) {
        const auto by_name = [](const Names& names, NameForm form, const std::vector<bool>& is_chosen,
                                const auto& is_free) {
            NodesByName nodes;
            for (const bool first : {true, false})
                for (uint32_t node = 0; node < is_chosen.size(); ++node)
                    if (is_chosen[node] == first && is_free(node)) nodes[names.of(node, form)].push_back(node);
            return nodes;
        };
        const NodesByName there = by_name(from_names, step.from, comes_first,
                                          [&](uint32_t node) { return !is_taken[node]; }),
                          wanted = by_name(to_names, step.to, is_joint,
                                           [&](uint32_t node) { return sources[node] == kNone; });
        for (const auto& [name, nodes] : wanted) {
            const auto found = there.find(name);
            if (name.empty() || found == there.end()) continue;
            const std::vector<uint32_t>& named = found->second;
            if (step.is_unique && (nodes.size() > 1 || named.size() > 1)) continue;
            for (size_t i = 0; i < nodes.size(); ++i) {
                const bool is_another = named.size() == 1 && i > 0;
                if (is_another ? !is_joint[nodes[i]] : i >= named.size()) break;
                const uint32_t parent = to.nodes[nodes[i]].parent;
                if (is_another && parent != kNone && sources[parent] == named[0]) continue;  // it would move twice
                sources[nodes[i]] = named[is_another ? 0 : i];
                is_taken[sources[nodes[i]]] = true;
            }
        }
    }
    return sources;
}

}  // namespace throng
