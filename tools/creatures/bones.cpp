#include "tools/creatures/bones.h"

namespace throng::creature {

// A quadratic B-spline over the bounds: it is smooth, up to three joints move a point, and where two bones meet each
// has half of the weight. A smaller `blend` keeps the middle of each bone stiff.
Influences influences_at(const Bones& bones, double t, double scale) {
    const auto& b = bones.bounds;
    const size_t last = bones.joints.size() - 1;
    const size_t i = size_t(std::upper_bound(b.begin() + 1, b.end() - 1, t) - b.begin()) - 1;
    const double length = b[i + 1] - b[i];
    const double x = std::clamp((t - b[i]) / length, 0.0, 1.0);
    const double start = std::max(0.0, 1 - x / bones.blend), end = std::max(0.0, 1 - (1 - x) / bones.blend);
    const double before = i > 0 ? start * start * length / (b[i + 1] - b[i - 1]) : 0;
    const double after = i < last ? end * end * length / (b[i + 2] - b[i]) : 0;
    Influences out;
    const auto add = [&](size_t bone, double weight) {
        if (bone > 0 || bones.base.empty())
            out.push_back({bones.joints[bone], scale * weight});
        else
            for (const Influence& influence : bones.base)
                out.push_back({influence.joint, scale * weight * influence.weight});
    };
    add(i, 1 - before - after);
    if (before > 0) add(i - 1, before);
    if (after > 0) add(i + 1, after);
    return out;
}

Bones bones_of(const Chain& chain) {
    Bones bones{{chain.parent_joint}, {chain.begin - chain.step}, chain.base};
    for (uint32_t k = 0; k < chain.joint_count; ++k) {
        bones.joints.push_back(chain.first_joint + k);
        bones.bounds.push_back(chain.at(k));
    }
    bones.bounds.push_back(1);
    return bones;
}

Bones stiff(Influences base) { return {.base = std::move(base)}; }

Influences joined(Influences a, const Influences& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

Influences scaled(Influences influences, double scale) {
    for (Influence& influence : influences) influence.weight *= scale;
    return influences;
}

}  // namespace throng::creature
