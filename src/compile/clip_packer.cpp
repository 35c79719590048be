#include "compile/clip_packer.h"

#include "compile/track_shape.h"

#include <algorithm>
#include <optional>

namespace throng {
namespace {

constexpr size_t kLookAhead = 64;         // rows; keeps the work linear
constexpr size_t kCachedModels = 1 << 19; // exact transforms that are kept: 48 MiB
constexpr size_t kSampledRows = 16;       // for the sensitivities
constexpr size_t kUnvarying = ~size_t{0};

struct Arms {
    Vec3<double> sum;
    AffineT<double> inverse_inertia;
};

class ClipPacker {
public:
    ClipPacker(const Character& character, uint32_t clip, std::span<const Box> boxes, double bound)
        : character_(character), clip_(clip), boxes_(boxes), bound_(bound), joint_count_(character.rig.joint_count()) {
        sample_poses();
        std::vector<double> reaches(joint_count_);
        for (const auto& pose : poses_) {
            const std::vector<double> of_pose = joint_reaches(character, boxes, pose);
            for (size_t joint = 0; joint < joint_count_; ++joint) reaches[joint] = std::max(reaches[joint], of_pose[joint]);
        }
        constexpr double kOfBound = 0.1;
        grid_ = make_clip_grid(character, clip, reaches, kOfBound * bound);
        track_of_.assign(joint_count_ * 3, kUnvarying);
        for (size_t track = 0; track < grid_.tracks.size(); ++track)
            track_of_[grid_.tracks[track].joint * 3 + static_cast<size_t>(grid_.tracks[track].target)] = track;
        models_.resize(joint_count_);
        exact_models_.resize(joint_count_);
        peaks_.resize(joint_count_);
        weigh_arms();
        if (grid_.point_count() * joint_count_ <= kCachedModels) {
            cache_.reserve(grid_.point_count() * joint_count_);
            for (size_t point = 0; point < grid_.point_count(); ++point) {
                compute_exact(point);
                cache_.insert(cache_.end(), exact_models_.begin(), exact_models_.end());
            }
        }
    }

    PackedClip run() {
        double A1=getenv("A1")?atof(getenv("A1")):0.1, A2=getenv("A2")?atof(getenv("A2")):.4, A3=getenv("A3")?atof(getenv("A3")):A2;
        for (const double share : {A1,A2,A3}) {
            const std::vector<size_t> rows = keep_rows(share * bound_);
            if (rows.size() == rows_.size()) continue;
            rows_ = rows;
            search();
        }
        if (!best_) finest();
        if(getenv("DUMP")) for(size_t j=0;j<joint_count_;++j) for(size_t t=0;t<3;++t){ auto&k=best_->tracks[j*3+t]; auto&sh=shapes_[j*3+t]; if(packed_row_bits(k)) printf("%3zu parent %d t%zu bits %u %u %u range %.4f %.4f %.4f sens %.3f %.3f %.3f w %.2f peak %.3f full %d %s\n",j,(int)character_.rig.parents[j],t,packed_bit_count(k,0),packed_bit_count(k,1),packed_bit_count(k,2),sh.high[0]-sh.low[0],sh.high[1]-sh.low[1],sh.high[2]-sh.low[2],sh.sensitivity[0]/character_.size,sh.sensitivity[1]/character_.size,sh.sensitivity[2]/character_.size,weights_[j],peaks_[j]/bound_,sh.full,character_.rig.names[j].c_str()); }
        return std::move(*best_);
    }

private:
    // ---- Exact poses

    void sample_poses() {
        const Clip& clip = character_.clips[clip_];
        const size_t count = std::min<size_t>(clip.row_count, kSampledRows);
        for (size_t i = 0; i < count; ++i) {
            const size_t row = count == 1 ? 0 : i * (clip.row_count - 1) / (count - 1);
            poses_.push_back(sample_reference(character_, clip_, character_.times_s[clip.first_time + row]));
        }
    }

    void compute_models(const std::vector<Trs<double>>& pose, std::vector<AffineT<double>>& models) const {
        const std::vector<uint32_t>& parents = character_.rig.parents;
        for (size_t joint = 0; joint < joint_count_; ++joint) {
            const AffineT<double> parent_from_joint = to_affine(pose[joint]);
            models[joint] = parents[joint] == kNone ? parent_from_joint : models[parents[joint]] * parent_from_joint;
        }
    }

    void compute_exact(size_t point) {
        pose_ = grid_.still;
        for (size_t track = 0; track < grid_.tracks.size(); ++track)
            set_component(pose_[grid_.tracks[track].joint], grid_.tracks[track].target, grid_.value(track, point));
        compute_models(pose_, exact_models_);
    }

    // model_from_joint of every joint at a point of the grid.
    std::span<const AffineT<double>> exact(size_t point) {
        if (!cache_.empty()) return std::span(cache_).subspan(point * joint_count_, joint_count_);
        compute_exact(point);
        return exact_models_;
    }

    // ---- Rows

    // Greedy: from each row as far as the rows between are reproduced; doubling, then halving the distance.
    std::vector<size_t> keep_rows(double bound) {
        std::vector<size_t> kept{0};
        const size_t last = grid_.row_count() - 1;
        while (kept.back() < last) {
            const size_t from = kept.back();
            size_t end = from + 1;
            while (!grid_.fixed[end] && end - from < kLookAhead) ++end;
            size_t good = 1, bad = end - from + 1;  // distances
            for (size_t next = 2; next < 2 * bad; next *= 2) {
                const size_t distance = std::min(next, end - from);
                if (distance <= good) break;
                if (!reproduces(from, from + distance, bound)) {
                    bad = distance;
                    break;
                }
                good = distance;
            }
            while (bad - good > 1) {
                const size_t middle = (good + bad) / 2;
                (reproduces(from, from + middle, bound) ? good : bad) = middle;
            }
            kept.push_back(from + good);
        }
        return kept;
    }

    bool reproduces(size_t from, size_t to, double bound) {
        const size_t points = grid_.point_count(), parts = grid_.points_per_row;
        pose_ = grid_.still;
        for (size_t row = from + 1; row < to; ++row) {
            for (size_t track = 0; track < grid_.tracks.size(); ++track) {
                const TrackKey* values = &grid_.values[track * points];
                mix(grid_.tracks[track], values[from * parts], values[to * parts], fraction(from, to, row * parts));
            }
            compute_models(pose_, models_);
            if (largest_displacement(row * parts, bound) > bound) return false;
        }
        return true;
    }

    double fraction(size_t from_row, size_t to_row, size_t point) const {
        const double from_s = grid_.times_s[from_row];
        return (grid_.time_s(point) - from_s) / (double{grid_.times_s[to_row]} - from_s);
    }

    void mix(const GridTrack& track, const TrackKey& earlier, const TrackKey& later, double w) {
        if (track.step) w = 0;
        TrackSample value{};
        for (size_t c = 0; c < 4; ++c) value[c] = double{earlier[c]} * (1 - w) + double{later[c]} * w;
        if (track.target == TrackTarget::kRotation) {
            const double scale = 1 / std::sqrt(value[0] * value[0] + value[1] * value[1] + value[2] * value[2] + value[3] * value[3]);
            for (double& v : value) v *= scale;
        }
        set_component(pose_[track.joint], track.target, value);
    }

    // Of models_ against the exact ones. May stop above `enough`.
    double largest_displacement(size_t point, double enough) {
        const std::span<const AffineT<double>> wanted = exact(point);
        double largest = 0;
        for (size_t joint = 0; joint < joint_count_ && largest <= enough; ++joint)
            if (!boxes_[joint].empty) largest = std::max(largest, displacement_at(joint, wanted[joint]));
        return largest;
    }

    double displacement_at(size_t joint, const AffineT<double>& wanted) {
        AffineT<double> difference;
        for (size_t r = 0; r < 3; ++r)
            for (size_t c = 0; c < 4; ++c) difference.row[r][c] = models_[joint].row[r][c] - wanted.row[r][c];
        const double d = displacement(difference, boxes_[joint]);
        peaks_[joint] = std::max(peaks_[joint], d);
        return d;
    }

    // ---- Quantisation

    void plan(double scale) {
        tracks_.resize(joint_count_ * 3);
        uint32_t bit = 0;
        packed_still_ = grid_.still;
        moving_.clear();
        for (size_t slot = 0; slot < tracks_.size(); ++slot) {
            PackedTrack& track = tracks_[slot] = plan_track(shapes_[slot], scale * weights_[slot / 3] * bound_);
            const uint32_t bits = packed_row_bits(track);
            if (bits == 0) {
                TrackSample value = packed_value(track, shapes_[slot].target, {});
                set_component(packed_still_[slot / 3], shapes_[slot].target, value);
                continue;
            }
            track.first_bit = bit;
            bit += bits;
            moving_.push_back(track_of_[slot]);
        }
        for (Trs<double>& joint : packed_still_) joint.rotation = normalized(joint.rotation);
        row_stride_ = (bit + 31) / 32;
    }

    // What a joint's transform must be for its place in the model to be exact, although its parent's is not: the errors of a chain do not
    // add up. Rotations make up for rotations, translations for places.
    Trs<double> aim(size_t joint, const Trs<double>& local, std::span<const AffineT<double>> wanted) const {
        const uint32_t parent = character_.rig.parents[joint];
        if (parent == kNone) return local;
        const auto& m = models_[parent].row;
        const auto cofactor = [&](size_t r, size_t c) {
            const size_t r1 = (r + 1) % 3, r2 = (r + 2) % 3, c1 = (c + 1) % 3, c2 = (c + 2) % 3;
            return m[r1][c1] * m[r2][c2] - m[r1][c2] * m[r2][c1];
        };
        const double determinant = m[0][0] * cofactor(0, 0) + m[0][1] * cofactor(0, 1) + m[0][2] * cofactor(0, 2);
        double norm = 0;
        for (const auto& row : m) norm += row[0] * row[0] + row[1] * row[1] + row[2] * row[2];
        if (!(std::abs(determinant) > 1e-6 * norm * std::sqrt(norm))) return local;  // flat: there is no way back
        AffineT<double> parent_from_model;
        for (size_t r = 0; r < 3; ++r)
            for (size_t c = 0; c < 3; ++c) parent_from_model.row[r][c] = cofactor(c, r) / determinant;
        const auto apply = [&](const Vec3<double>& v) { return transform_vector(parent_from_model, v); };

        Trs<double> out = local;
        const auto& joint_rows = wanted[joint].row;
        out.translation = apply({joint_rows[0][3] - m[0][3], joint_rows[1][3] - m[1][3], joint_rows[2][3] - m[2][3]});
        const auto& p = wanted[parent].row;  // the exact parent, seen from the packed one, is nearly the identity
        const Vec3<double> x = apply({p[0][0], p[1][0], p[2][0]}), y = apply({p[0][1], p[1][1], p[2][1]}), z = apply({p[0][2], p[1][2], p[2][2]});
        const double trace = x.x + y.y + z.z;
        const Quaternion<double> turn{y.z - z.y, z.x - x.z, x.y - y.x, 4 * trace / 3};
        if (trace > 2) out.rotation = normalized(normalized(turn) * local.rotation);
        return out;
    }

    // The joint lies `off` (in its parent's space) from its place: the rotation that best brings what hangs on it back, in the sense of
    // least squares.
    Quaternion<double> turned(size_t joint, const Trs<double>& aimed, const Vec3<double>& off) const {
        const Arms& arms = arms_[joint];
        const Quaternion<double>& q = aimed.rotation;
        const AffineT<double> joint_from_parent = to_affine(Trs<double>{.rotation = {-q.x, -q.y, -q.z, q.w}});
        const Vec3<double> turn = transform_vector(arms.inverse_inertia, cross(transform_vector(joint_from_parent, off), arms.sum)) * (0.5 / aimed.scale.x);
        if (!(dot(turn, turn) < 0.01)) return q;
        return normalized(q * Quaternion<double>{turn.x, turn.y, turn.z, 1});
    }

    // What hangs on each joint, in its space: its own skin, and the joints below it.
    void weigh_arms() {
        arms_.resize(joint_count_);
        std::vector<std::array<double, 6>> products(joint_count_);  // sums of xx yy zz xy xz yz
        const auto add = [&](size_t joint, const Vec3<double>& arm, double weight) {
            arms_[joint].sum = arms_[joint].sum + arm * weight;
            const std::array<double, 6> p{arm.x * arm.x, arm.y * arm.y, arm.z * arm.z, arm.x * arm.y, arm.x * arm.z, arm.y * arm.z};
            for (size_t i = 0; i < 6; ++i) products[joint][i] += weight * p[i];
        };
        static const double CW = getenv("CW") ? atof(getenv("CW")) : 1.0;
        for (size_t joint = 0; joint < joint_count_; ++joint) {
            if (!boxes_[joint].empty)
                for (size_t i = 0; i < 8; ++i) add(joint, boxes_[joint].corner(i), 0.125);
            const uint32_t parent = character_.rig.parents[joint];
            if (parent != kNone) add(parent, poses_.front()[joint].translation, CW);
        }
        for (size_t joint = 0; joint < joint_count_; ++joint) {
            const auto& [xx, yy, zz, xy, xz, yz] = products[joint];
            const double least = 1e-3 * (xx + yy + zz);  // of arms all in one line
            const std::array<std::array<double, 3>, 3> m{{{yy + zz + least, -xy, -xz}, {-xy, xx + zz + least, -yz}, {-xz, -yz, xx + yy + least}}};
            arms_[joint].inverse_inertia = inverse3(m);
        }
    }
    static AffineT<double> inverse3(const std::array<std::array<double, 3>, 3>& m) {
        const auto cofactor = [&](size_t r, size_t c) {
            const size_t r1 = (r + 1) % 3, r2 = (r + 2) % 3, c1 = (c + 1) % 3, c2 = (c + 2) % 3;
            return m[r1][c1] * m[r2][c2] - m[r1][c2] * m[r2][c1];
        };
        const double determinant = m[0][0] * cofactor(0, 0) + m[0][1] * cofactor(0, 1) + m[0][2] * cofactor(0, 2);
        AffineT<double> out;
        for (size_t r = 0; r < 3; ++r)
            for (size_t c = 0; c < 3; ++c) out.row[r][c] = determinant > 0 ? cofactor(c, r) / determinant : 0;
        return out;
    }

    // Writes all kept rows. Returns the largest displacement in them.
    double encode() {
        const std::vector<uint32_t>& parents = character_.rig.parents;
        words_.assign(rows_.size() * row_stride_ + 1, 0);
        decoded_.resize(grid_.tracks.size() * rows_.size());
        double largest = 0;
        for (size_t row = 0; row < rows_.size(); ++row) {
            const size_t point = rows_[row] * grid_.points_per_row;
            const std::span<const AffineT<double>> wanted = exact(point);
            for (size_t joint = 0; joint < joint_count_; ++joint) {
                Trs<double> packed = packed_still_[joint];
                encode_joint(joint, row, wanted, packed);
                const AffineT<double> parent_from_joint = to_affine(packed);
                models_[joint] = parents[joint] == kNone ? parent_from_joint : models_[parents[joint]] * parent_from_joint;
                if (!boxes_[joint].empty) largest = std::max(largest, displacement_at(joint, wanted[joint]));
            }
        }
        return largest;
    }

    void encode_joint(size_t joint, size_t row, std::span<const AffineT<double>> wanted, Trs<double>& packed) {
        const auto moves = [&](size_t slot) { return packed_row_bits(tracks_[slot]) > 0; };
        const size_t first = joint * 3;
        if (!moves(first) && !moves(first + 1) && !moves(first + 2)) return;
        const size_t point = rows_[row] * grid_.points_per_row;
        Trs<double> local = grid_.still[joint];
        for (size_t slot = first; slot < first + 3; ++slot)
            if (moves(slot)) set_component(local, shapes_[slot].target, grid_.value(track_of_[slot], point));
        Trs<double> aimed = aim(joint, local, wanted);
        for (size_t slot = first; slot < first + 3; ++slot) {
            if (!moves(slot)) continue;
            const PackedTrack& track = tracks_[slot];
            const TrackTarget target = shapes_[slot].target;
            if (target == TrackTarget::kRotation) aimed.rotation = turned(joint, aimed, packed.translation - aimed.translation);
            TrackSample value = component(shapes_[slot].step ? local : aimed, target);
            if (target == TrackTarget::kRotation && !shapes_[slot].full && value[shapes_[slot].left_out] < 0)
                for (double& v : value) v = -v;
            const PackedBits bits = quantised(track, target, value);
            write_row(words_, row * row_stride_ * 32, track, bits);
            const TrackSample got = packed_value(track, target, bits);
            for (size_t c = 0; c < 4; ++c) decoded_[track_of_[slot] * rows_.size() + row][c] = static_cast<float>(got[c]);
            set_component(packed, target, got);
        }
        packed.rotation = normalized(packed.rotation);
    }

    // The largest displacement between the kept rows.
    double measure_between() {
        double largest = 0;
        pose_ = packed_still_;
        const size_t parts = grid_.points_per_row;
        for (size_t row = 0; row + 1 < rows_.size(); ++row)
            for (size_t point = rows_[row] * parts + 1; point < rows_[row + 1] * parts; ++point) {
                if (cache_.empty()) {
                    compute_exact(point);  // which uses pose_
                    pose_ = packed_still_;
                }
                const double w = fraction(rows_[row], rows_[row + 1], point);
                for (const size_t track : moving_) {
                    const TrackKey* values = &decoded_[track * rows_.size() + row];
                    mix(grid_.tracks[track], values[0], values[1], w);
                }
                compute_models(pose_, models_);
                const std::span<const AffineT<double>> wanted = cache_.empty() ? std::span<const AffineT<double>>(exact_models_) : exact(point);
                for (size_t joint = 0; joint < joint_count_; ++joint)
                    if (!boxes_[joint].empty) largest = std::max(largest, displacement_at(joint, wanted[joint]));
            }
        return largest;
    }

    // ---- Search

    double evaluate(double scale) {
        plan(scale);
        peaks_.assign(joint_count_, 0);
        const double in_rows = encode();
        const double error = std::max(in_rows, measure_between());
        return error;
    }

    size_t size_bytes() const {
        size_t bytes = moving_.empty() ? 4 : rows_.size() * (row_stride_ + 1) * 4;
        for (size_t slot = 0; slot < tracks_.size(); ++slot) {
            const bool rest = tracks_[slot].minimum == constant_track(shapes_[slot].target, shapes_[slot].rest).minimum;
            bytes += packed_row_bits(tracks_[slot]) > 0 ? 32 : rest ? 0 : 16;
        }
        return bytes;
    }

    void keep(double error) {
        if (best_ && size_bytes() >= best_bytes_) return;
        best_bytes_ = size_bytes();
        best_.emplace();
        best_->tracks = tracks_;
        best_->error = error;
        best_->row_stride = row_stride_;
        best_->left_out_row_count = static_cast<uint32_t>(grid_.row_count() - rows_.size());
        const size_t row_count = moving_.empty() ? 1 : rows_.size();
        for (size_t row = 0; row < row_count; ++row) best_->times_s.push_back(grid_.times_s[rows_[row]]);
        best_->words.assign(words_.begin(), words_.begin() + static_cast<ptrdiff_t>(row_count * row_stride_));
    }

    // Tracks whose errors stay below what the clip has elsewhere may be coarser.
    void reweight() {
        std::vector<double> below = peaks_;
        for (size_t joint = joint_count_; joint-- > 0;) {
            const uint32_t parent = character_.rig.parents[joint];
            if (parent != kNone) below[parent] = std::max(below[parent], below[joint]);
        }
        const double largest = *std::max_element(below.begin(), below.end());
        for (size_t joint = 0; joint < joint_count_; ++joint)
            if (below[joint] > 0) weights_[joint] *= std::clamp(std::sqrt(largest / below[joint]), 1.0, 4.0);
    }

    void prepare() {
        std::vector<size_t> points;
        for (const size_t row : rows_) points.push_back(row * grid_.points_per_row);
        shapes_ = track_shapes(character_, grid_, points);
        for (const auto& pose : poses_) add_sensitivity(shapes_, character_, boxes_, pose, bound_);
        weights_.assign(joint_count_, 1);
    }

    void search() {
        prepare();
        constexpr double kMargin = 0.99;  // the points of the grid may miss the largest displacement by a little
        const double goal = kMargin * bound_;
        double scale = 0.3, good = 0, bad = 0;
        for (int round = 0; round < 10; ++round) {
            const double error = evaluate(scale);
            if(getenv("T")) printf("rows %zu round %d scale %.4f err %.3f stride %u tracks %zu size %zu between %.3f\n",rows_.size(),round,scale,error/bound_,row_stride_,moving_.size(),size_bytes(),measure_between()/bound_);
            if (error <= goal) keep(error);
            if (round < 3) {
                reweight();
                scale *= std::clamp(goal / std::max(error, 1e-30), 0.05, 8.0);
                continue;
            }
            (error <= goal ? good : bad) = scale;
            if (good > 0 && bad > 0) scale = std::sqrt(good * bad);
            else if (good > 0) scale *= std::clamp(goal / std::max(error, 1e-30), 1.05, 8.0);
            else scale *= std::clamp(0.97 * goal / error, 0.05, 0.95);
            if (good > 0 && bad > 0 && bad / good < 1.03) break;
        }
    }

    void finest() {
        rows_ = keep_rows(0);
        prepare();
        keep(evaluate(0));
    }

    const Character& character_;
    const uint32_t clip_;
    const std::span<const Box> boxes_;
    const double bound_;
    const size_t joint_count_;
    ClipGrid grid_;
    std::vector<size_t> track_of_;                 // [joint_count][3], of the grid, or kUnvarying
    std::vector<std::vector<Trs<double>>> poses_;  // [sampled row][joint_count]
    std::vector<AffineT<double>> cache_;           // [point][joint_count], exact; empty where that is too much
    std::vector<AffineT<double>> exact_models_, models_;
    std::vector<Trs<double>> pose_, packed_still_;
    std::vector<Arms> arms_;                       // [joint_count]

    std::vector<size_t> rows_;                     // that are kept, of the grid's
    std::vector<TrackShape> shapes_;               // [joint_count][3]
    std::vector<double> weights_, peaks_;          // [joint_count]
    std::vector<PackedTrack> tracks_;              // [joint_count][3]
    std::vector<size_t> moving_;                   // tracks of the grid with bits
    std::vector<uint32_t> words_;
    uint32_t row_stride_ = 0;
    std::vector<TrackKey> decoded_;                // [track][row]
    std::optional<PackedClip> best_;
    size_t best_bytes_ = 0;
};

}  // namespace

PackedClip pack_clip(const Character& character, uint32_t clip, std::span<const Box> boxes, double bound) {
    return ClipPacker(character, clip, boxes, bound).run();
}

}  // namespace throng
