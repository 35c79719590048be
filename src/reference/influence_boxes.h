// Boxes around the vertices that each joint moves: errors of a pose are measured there.
#pragma once

#include <throng/character.h>

#include <algorithm>
#include <vector>

namespace throng {

struct Box {
    Vec3<double> low, high;
    bool empty = true;  // until something is added

    void add(const Vec3<double>& p) { add({p, p, false}); }
    void add(const Box& box) {
        if (box.empty) return;
        low = empty ? box.low : least(low, box.low);
        high = empty ? box.high : greatest(high, box.high);
        empty = false;
    }
    Vec3<double> corner(size_t index) const;  // 0 to 7
    double largest_distance() const;          // of a corner from the origin

private:
    static Vec3<double> least(const Vec3<double>& a, const Vec3<double>& b) {
        return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
    }
    static Vec3<double> greatest(const Vec3<double>& a, const Vec3<double>& b) {
        return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
    }
};

// [joint_count], in joint space: boxes around the vertices that the joint's palette entries move with a weight above 0,
// with all morph weights that clips set, and with one morph at weight 1. For joints that move no vertex, a cube whose
// half diagonal is 2 % of the character's size, or 10 % where no joint moves any.
std::vector<Box> influence_boxes(const Character& character);

// [joint_count]: whether each vertex that the joint moves is moved by it alone. If such a joint is scaled to nothing,
// nothing of it can be seen.
std::vector<bool> joints_that_move_alone(const Character& character);

// [palette_count], in bind space: boxes around the vertices that the entry moves with a weight above 0; empty where it
// moves none.
std::vector<Box> bind_boxes(const Character& character);

// The largest distance between a point of the box under one transform and the same point under another, given the
// difference of the two transforms; infinity if that is NaN. It is a convex function of the point, so it is largest at
// a corner. A skinned vertex moves no further than the joint that moves it furthest.
double displacement(const AffineT<double>& difference, const Box& box);

}  // namespace throng
