#include "compile/mesh/morph.h"

#include "base/count.h"
#include "base/failure.h"
#include "compile/limits.h"
#include "control/control_reference.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <span>

namespace throng {
namespace {

constexpr size_t kMorphNameLimit = 256;  // bytes; longer names are cut
// How closely rows follow cubic tracks of weights; relative to the largest weight of the track if that exceeds 1
constexpr double kFollowed = 1e-4;
constexpr size_t kRefinedWeightLimit = 4'000'000;  // of a clip's cubic tracks: seconds of work

void require_size(uint64_t size_bytes, const std::string& place, const char* of) {
    if (size_bytes > kKeyLimit_bytes)
        throw Failure(ErrorCode::kLimit, place, size_bytes >> 20, " MiB of ", of, "; the limit is ",
                      kKeyLimit_bytes >> 20, " MiB a character");
}

std::string place_of(const Asset& asset) { return printable(asset.name, 120) + ": morph targets"; }

const Vec3<float> kNothing{0, 0, 0};
const Vec3<float>& at(const std::vector<Vec3<float>>& differences, size_t vertex) {
    return differences.empty() ? kNothing : differences[vertex];
}

uint32_t pack_normal_difference(const Vec3<float>& n) {
    uint32_t packed = 0;
    for (const float component : {n.z, n.y, n.x})
        packed = packed << 10 |
                 (static_cast<uint32_t>(std::lround(std::clamp(component / kMorphNormalStep, -511.0f, 511.0f))) & 1023);
    return packed;
}

bool moves(const AssetMorphTarget& target, size_t vertex) {
    return !(at(target.positions, vertex) == kNothing && at(target.normals, vertex) == kNothing);
}

void add_deltas(const AssetPrimitive& primitive, const MeshSection& section, Character& character,
                const std::string& place, const Progress& progress) {
    std::vector<const AssetMorphTarget*> moving;  // a file may have thousands that hold nothing
    for (const AssetMorphTarget& target : primitive.targets)
        if (!target.positions.empty() || !target.normals.empty()) moving.push_back(&target);
    for (size_t v = 0; v < primitive.positions.size(); ++v) {
        progress.poll();
        if (std::ranges::none_of(moving, [&](const AssetMorphTarget* target) { return moves(*target, v); })) continue;
        character.vertices[section.first_vertex + v].first_delta = static_cast<uint32_t>(character.morph_deltas.size() +
                                                                                         1);
        for (const AssetMorphTarget& target : primitive.targets)
            character.morph_deltas.push_back({at(target.positions, v), pack_normal_difference(at(target.normals, v))});
        require_size(character.morph_deltas.size() * sizeof(MorphDelta), place, "differences and more");
    }
}

// ---- Weights

// The weight of one target in a track of the file, at any time (glTF 2.0, appendix C).
class WeightTrack {
public:
    WeightTrack(const AssetMorphTrack& track, uint32_t target, uint32_t target_count)
        : track_(track), target_(target), target_count_(target_count) {
        for (size_t key = 0; key < track_.times_s.size(); ++key) largest_ = std::max(largest_, std::abs(value(key)));
    }

    const AssetMorphTrack& source() const { return track_; }
    bool is_cubic() const { return track_.interpolation == Interpolation::kCubicSpline; }
    double bound() const { return kFollowed * std::max(largest_, 1.0); }

    bool is_constant() const {
        const size_t key_count = track_.times_s.size();
        for (size_t key = 0; key < key_count; ++key)
            if (value(key) != value(0) || (is_cubic() && key_count > 1 && (part(key, 0) != 0 || part(key, 2) != 0)))
                return false;
        return true;
    }

    double evaluate(double time_s) const {
        const RowCursor keys = find_rows_reference(track_.times_s, time_s);
        const double w = keys.fraction, a = value(keys.earlier), b = value(keys.later);
        if (track_.interpolation == Interpolation::kStep || keys.earlier == keys.later) return a;
        if (!is_cubic()) return a * (1 - w) + b * w;
        const double interval_s = double{track_.times_s[keys.later]} - track_.times_s[keys.earlier], w2 = w * w,
                     w3 = w2 * w;
        return (2 * w3 - 3 * w2 + 1) * a + interval_s * (w3 - 2 * w2 + w) * part(keys.earlier, 2) +
               (3 * w2 - 2 * w3) * b + interval_s * (w3 - w2) * part(keys.later, 0);
    }

private:
    // A key of a cubic track has an in-tangent, a value and an out-tangent; tangents are per second.
    double part(size_t key, size_t which) const { return track_.values[(key * 3 + which) * target_count_ + target_]; }
    double value(size_t key) const {
        return is_cubic() ? part(key, 1) : double{track_.values[key * target_count_ + target_]};
    }

    const AssetMorphTrack& track_;
    uint32_t target_, target_count_;
    double largest_ = 0;
};

class WeightRows {
public:
    WeightRows(Character& character, const std::string& place, const Progress& progress)
        : character_(character), place_(place), progress_(progress) {}

    void add(const WeightTrack& track, uint32_t& word) {
        if (track.is_constant()) {
            word = count_of(character_.morph_values);
            character_.morph_values.push_back(static_cast<float>(track.evaluate(0)));
        } else {
            columns_.push_back({track, &word});
        }
    }

    void write(Clip& clip) {
        clip.first_morph_time = count_of(character_.morph_times_s);
        if (columns_.empty()) return check_size(0);
        unite_times();
        refine();
        check_size(times_s_.size());
        const size_t first = character_.morph_values.size();
        for (size_t i = 0; i < columns_.size(); ++i)
            *columns_[i].word = static_cast<uint32_t>(first + i) | kTrackAnimated |
                                (columns_[i].track.source().interpolation == Interpolation::kStep ? kTrackStep : 0);
        for (const float time_s : times_s_)
            for (const Column& column : columns_) character_.morph_values.push_back(value_of(column.track, time_s));
        character_.morph_times_s.insert(character_.morph_times_s.end(), times_s_.begin(), times_s_.end());
        clip.morph_row_count = count_of(times_s_);
        clip.morph_row_stride = count_of(columns_);
    }

private:
    struct Column {
        WeightTrack track;
        uint32_t* word;
    };

    void check_size(size_t row_count) const {
        require_size((character_.morph_values.size() + uint64_t{row_count} * columns_.size()) * sizeof(float), place_,
                     "weights of morph targets");
    }

    float value_of(const WeightTrack& track, float time_s) const {
        const double weight = track.evaluate(time_s);
        if (!(std::abs(weight) <= std::numeric_limits<float>::max()))
            throw Failure(ErrorCode::kInvalidFile, place_, "a weight of a morph target exceeds all floats at ", time_s,
                          " s");
        return static_cast<float>(weight);
    }

    void unite_times() {
        const AssetMorphTrack* last = nullptr;  // the targets of a node share one track
        for (const Column& column : columns_) {
            const AssetMorphTrack& source = column.track.source();
            if (&source != last) times_s_.insert(times_s_.end(), source.times_s.begin(), source.times_s.end());
            last = &source;
        }
        std::ranges::sort(times_s_);
        const auto repeated = std::ranges::unique(times_s_);
        times_s_.erase(repeated.begin(), repeated.end());
        check_size(times_s_.size());
    }

    static bool fits(std::span<const WeightTrack* const> cubic, double from_s, double to_s) {
        constexpr double kBetween = 0.9;  // of the bound; the rest is a margin for the error between the eighths
        return std::ranges::all_of(cubic, [&](const WeightTrack* track) {
            const double from = track->evaluate(from_s), to = track->evaluate(to_s);
            return std::ranges::all_of(std::array{0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875}, [&](double w) {
                return std::abs(from * (1 - w) + to * w - track->evaluate(from_s + w * (to_s - from_s))) <=
                       kBetween * track->bound();
            });
        });
    }

    // Halves intervals until linear interpolation follows the cubic tracks.
    void refine() {
        std::vector<const WeightTrack*> cubic;
        for (const Column& column : columns_)
            if (column.track.is_cubic()) cubic.push_back(&column.track);
        if (cubic.empty()) return;
        std::vector<float> refined;
        for (size_t row = 0; row < times_s_.size(); ++row) {
            std::vector<float> ends{times_s_[row]};  // of the intervals still to check, the nearest last
            while (!ends.empty()) {
                progress_.poll();  // a step evaluates all cubic tracks
                const float to_s = ends.back(), from_s = refined.empty() ? to_s : refined.back(),
                            middle_s = from_s + (to_s - from_s) / 2;
                if (middle_s > from_s && middle_s < to_s && !fits(cubic, from_s, to_s)) {
                    ends.push_back(middle_s);
                } else {
                    ends.pop_back();
                    refined.push_back(to_s);
                }
                if ((refined.size() + ends.size()) * cubic.size() >
                    std::max(kRefinedWeightLimit, times_s_.size() * cubic.size()))
                    throw Failure(ErrorCode::kLimit, place_,
                                  "its cubic tracks of morph targets would need more than the limit of ",
                                  kRefinedWeightLimit, " weights to be followed");
            }
        }
        times_s_ = std::move(refined);
    }

    Character& character_;
    const std::string& place_;
    const Progress& progress_;
    std::vector<Column> columns_;
    std::vector<float> times_s_;
};

struct NodeMorphs {
    uint32_t first = 0, count = 0;
};

std::map<uint32_t, NodeMorphs> morphs_by_node(const Character& character) {
    std::map<uint32_t, NodeMorphs> out;
    for (uint32_t i = 0; i < character.morphs.size(); ++i) {
        const auto [known, is_new] = out.emplace(character.morphs[i].node, NodeMorphs{i, 0});
        ++known->second.count;
    }
    return out;
}

}  // namespace

void compile_morphs(const Asset& asset, Character& character, const Progress& progress) {
    const std::string place = place_of(asset);
    for (const AssetMeshInstance& instance : asset.mesh_instances) {
        const AssetMesh& mesh = asset.meshes[instance.mesh];
        const std::vector<float>& weights = instance.weights.empty() ? mesh.weights : instance.weights;
        if (character.morphs.size() + weights.size() > kMorphLimit)
            throw Failure(ErrorCode::kLimit, place, "at least ", character.morphs.size() + weights.size(),
                          ", each counted once for every node that shows its mesh; the limit is ", kMorphLimit);
        if (!weights.empty() && !character.morphs.empty() && character.morphs.back().node == instance.node)
            throw Failure(ErrorCode::kInvalidFile, place, "node ", instance.node,
                          " shows two meshes with morph targets");
        for (uint32_t target = 0; target < weights.size(); ++target)
            character.morphs.push_back(
                {.name = printable(
                     mesh.target_names.empty() ? mesh.name + "." + std::to_string(target) : mesh.target_names[target],
                     kMorphNameLimit),
                 .node = instance.node,
                 .target = target,
                 .default_weight = weights[target]});
    }
    const std::map<uint32_t, NodeMorphs> by_node = morphs_by_node(character);
    for (MeshSection& section : character.sections) {
        const auto of_node = by_node.find(section.node);
        if (of_node == by_node.end()) continue;
        const AssetPrimitive& primitive = asset.meshes[section.mesh].primitives[section.primitive];
        if (primitive.targets.empty()) continue;
        section.first_morph = of_node->second.first;
        section.morph_count = of_node->second.count;
        if (primitive.targets.size() != section.morph_count)
            throw Failure(ErrorCode::kInvalidFile, place, "a primitive has ", primitive.targets.size(),
                          ", but its mesh has ", section.morph_count, " weights");
        add_deltas(primitive, section, character, place, progress);
    }
}

void compile_morph_tracks(const Asset& asset, Character& character, const Progress& progress) {
    const uint64_t table_bytes = character.clips.size() * uint64_t{character.morphs.size()} * sizeof(uint32_t);
    require_size(table_bytes, place_of(asset), "tracks (clips x morph targets)");
    character.morph_tracks.assign(character.clips.size() * character.morphs.size(), kNone);
    const std::map<uint32_t, NodeMorphs> by_node = morphs_by_node(character);
    for (size_t index = 0; index < character.clips.size(); ++index) {
        progress.poll();
        const std::string place = printable(asset.name, 120) + ": animations[" + std::to_string(index) + "]";
        WeightRows rows(character, place, progress);
        for (const AssetMorphTrack& track : asset.clips[index].morph_tracks) {
            const auto of_node = by_node.find(track.node);
            if (of_node == by_node.end()) continue;  // not in the scene
            const auto [first, count] = of_node->second;
            for (uint32_t target = 0; target < count; ++target)
                rows.add(WeightTrack(track, target, count),
                         character.morph_tracks[index * character.morphs.size() + first + target]);
        }
        rows.write(character.clips[index]);
    }
}

}  // namespace throng
