#include "tests/host/compile_cases.h"

#include "tests/test_rig.h"

#include "tools/creatures/creature.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace throng::test {
namespace {

using Value = std::array<double, 4>;

Value unit(Value v) {
    const double l = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2] + v[3] * v[3]);
    for (double& x : v) x /= l;
    return v;
}

Value track_value(const AssetTrack& track, double time_s) {
    const size_t components = track.target == TrackTarget::kRotation ? 4 : 3;
    const bool cubic = track.interpolation == Interpolation::kCubicSpline, rotation = components == 4;
    const auto element = [&](size_t key, size_t part) {  // part: 0 in-tangent, 1 value, 2 out-tangent
        Value v{};
        for (size_t c = 0; c < components; ++c) v[c] = track.values[(cubic ? key * 3 + part : key) * components + c];
        return v;
    };
    const auto finished = [&](const Value& v) { return rotation ? unit(v) : v; };
    const auto& times = track.times_s;
    if (time_s <= times.front()) return finished(element(0, 1));
    if (time_s >= times.back()) return finished(element(times.size() - 1, 1));
    size_t k = 0;
    while (times[k + 1] <= time_s) ++k;
    const double td = double{times[k + 1]} - times[k], t = (time_s - times[k]) / td;
    Value a = element(k, 1), b = element(k + 1, 1), out{};
    switch (track.interpolation) {
        case Interpolation::kStep: return finished(a);
        case Interpolation::kLinear: {
            double from = 1 - t, to = t;
            if (rotation) {
                a = unit(a);
                b = unit(b);
                double d = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
                const double sign = d < 0 ? -1 : 1;
                const double angle = std::acos(std::min(1.0, d * sign));
                if (angle > 1e-6) {
                    from = std::sin((1 - t) * angle) / std::sin(angle);
                    to = std::sin(t * angle) / std::sin(angle);
                }
                to *= sign;
            }
            for (size_t c = 0; c < 4; ++c) out[c] = from * a[c] + to * b[c];
            return finished(out);
        }
        case Interpolation::kCubicSpline: {
            const Value out_tangent = element(k, 2), in_tangent = element(k + 1, 0);
            for (size_t c = 0; c < 4; ++c)
                out[c] = (2 * t * t * t - 3 * t * t + 1) * a[c] + td * (t * t * t - 2 * t * t + t) * out_tangent[c] +
                         (-2 * t * t * t + 3 * t * t) * b[c] + td * (t * t * t - t * t) * in_tangent[c];
            return finished(out);
        }
    }
    return out;
}

}  // namespace

Trs<double> moved(double x, double y, double z) {
    Trs<double> trs;
    trs.translation = {x, y, z};
    return trs;
}

Asset walker_asset() {
    CreatureSettings settings = creature_settings(CreatureKind::kWalker);
    settings.joint_count = 40;
    settings.level_count = 10;
    settings.face_count = 200;
    Asset asset = make_creature(settings).expect();
    asset.name = "walker.glb";
    return asset;
}

Error refusal_of(const Asset& asset) {
    const Result<Character> character = compile_character(asset, kExact);
    if (!character) return character.error();
    ADD_FAILURE() << "nothing was refused";
    return {};
}

Trs<double> node_trs(const Asset& asset, uint32_t node, const AssetClip* clip, double time_s) {
    Trs<double> trs = asset.nodes[node].parent_from_node;
    if (!clip) return trs;
    for (const AssetTrack& track : clip->tracks) {
        if (track.node != node) continue;
        const Value v = track_value(track, time_s);
        if (track.target == TrackTarget::kRotation)
            trs.rotation = {v[0], v[1], v[2], v[3]};
        else
            (track.target == TrackTarget::kTranslation ? trs.translation : trs.scale) = {v[0], v[1], v[2]};
    }
    return trs;
}

std::vector<AffineT<double>> node_models(const Asset& asset, const AssetClip* clip, double time_s) {
    std::vector<AffineT<double>> models(asset.nodes.size());
    for (uint32_t node = 0; node < asset.nodes.size(); ++node)
        for (uint32_t up = node; up != kNone; up = asset.nodes[up].parent)
            models[node] = to_affine(node_trs(asset, up, clip, time_s)) * models[node];
    return models;
}

}  // namespace throng::test
