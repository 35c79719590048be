// Every piece has a wanted fineness. One factor for all of them makes the mesh meet the face budget.
#include "tools/creatures/mesh.h"

#include <map>
#include <span>

namespace throng::creature {
namespace {

uint64_t face_count(const Tube& t) { return uint64_t(t.sides.parts) * (2 * t.segments.parts - (t.open_start ? 1 : 2)); }
uint64_t face_count(const Sheet& s) { return 2 * uint64_t(s.along.parts) * s.across.parts; }
uint64_t face_count(const Leaves& l) { return 2 * uint64_t(l.count.parts); }

void refine(Tube& t, double factor) {
    t.sides.refine(factor);
    t.sides.parts = std::max(t.sides.parts, 3u);
    t.segments.refine(factor);
}
void refine(Sheet& s, double factor) {
    s.along.refine(factor);
    s.across.refine(factor);
}
void refine(Leaves& l, double factor) { l.count.refine(factor); }

// Adds up the weights of each joint, and keeps the four heaviest joints.
Influences heaviest(const Influences& influences) {
    Influences out;
    for (const Influence& i : influences) {
        const auto same = std::find_if(out.begin(), out.end(), [&](const Influence& o) { return o.joint == i.joint; });
        if (same != out.end())
            same->weight += i.weight;
        else
            out.push_back(i);
    }
    std::stable_sort(out.begin(), out.end(),
                     [](const Influence& a, const Influence& b) { return a.weight > b.weight; });
    out.resize(4, {0, 0});
    return out;
}

class MeshBuilder {
public:
    MeshBuilder(std::vector<Piece> pieces, uint32_t face_budget)
        : pieces_(std::move(pieces)), face_budget_(face_budget) {}

    AssetMesh sculpt() {
        meet_budget();
        std::map<uint32_t, AssetPrimitive> by_material;
        for (const Piece& piece : pieces_) std::visit([&](const auto& p) { build(p, by_material[p.material]); }, piece);
        AssetMesh mesh{.name = "creature"};
        for (auto& [material, primitive] : by_material) {
            primitive.material = material;
            primitive.influence_count = 4;
            mesh.primitives.push_back(std::move(primitive));
        }
        return mesh;
    }

private:
    uint64_t refine_all(double factor) {
        uint64_t total = 0;
        for (Piece& piece : pieces_) std::visit([&](auto& p) { refine(p, factor), total += face_count(p); }, piece);
        return total;
    }

    void meet_budget() {
        // Few pieces in a recognisable shape are better than all of them as splinters.
        constexpr double kCoarsest = 0.3;
        while (refine_all(kCoarsest) > face_budget_ && pieces_.size() > 1) pieces_.pop_back();
        double low = 0, high = 4;
        while (refine_all(high) < face_budget_) high *= 2;
        for (int i = 0; i < 40; ++i) {
            const double middle = (low + high) / 2;
            (refine_all(middle) <= face_budget_ ? low : high) = middle;
        }
        uint64_t total = refine_all(low);
        // Spend the faces that rounding left over on more rings, the body first.
        for (Piece& piece : pieces_) {
            Tube* tube = std::get_if<Tube>(&piece);
            if (!tube || tube->segments_fixed) continue;
            const uint32_t most = &piece == &pieces_.front() ? 0xFFFFFFFFu : 1;
            const uint32_t more = uint32_t(
                std::min<uint64_t>(most, (face_budget_ - std::min(total, face_budget_)) / (2 * tube->sides.parts)));
            tube->segments.parts += more;
            total += 2 * uint64_t(tube->sides.parts) * more;
        }
    }

    uint32_t add_vertex(const Vec& position, const Vec& color, const Influences& influences) {
        const Influences four = heaviest(influences);
        double sum = 0;
        for (const Influence& i : four) sum += i.weight;
        for (const Influence& i : four) {
            out_.influence_joints.push_back(uint16_t(i.weight > 0 ? i.joint : 0));
            out_.influence_weights.push_back(float(i.weight / sum));
        }
        out_.positions.push_back(position.as<float>());
        out_.colors.push_back({float(color.x), float(color.y), float(color.z), 1});
        return uint32_t(out_.positions.size() - 1);
    }
    void add_face(uint32_t a, uint32_t b, uint32_t c) { out_.indices.insert(out_.indices.end(), {a, b, c}); }

    // Pieces share no vertices, so each piece has its own normals.
    template <class P>
    void build(const P& piece, AssetPrimitive& into) {
        out_ = {};
        given_normals_.clear();
        build(piece);
        smooth_normals();
        const auto first = static_cast<uint32_t>(into.positions.size());
        for (uint32_t& index : out_.indices) index += first;
        const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
        append(into.positions, out_.positions);
        append(into.normals, out_.normals);
        append(into.colors, out_.colors);
        append(into.influence_joints, out_.influence_joints);
        append(into.influence_weights, out_.influence_weights);
        append(into.indices, out_.indices);
    }

    void build(const Tube& tube) {
        const uint32_t sides = tube.sides.parts, segments = tube.segments.parts;
        Vec up = tube.up;
        uint32_t before = 0;  // the first vertex of the ring before, or the point that the tube starts with
        for (uint32_t ring = 0; ring <= segments; ++ring) {
            const double part = double(ring) / segments, t = mix(tube.from, tube.to, part);
            const Station station = tube.outline.at(t);
            const Influences influences = influences_at(tube.bones, t);
            const bool is_start = ring == 0, is_end = ring == segments;
            if (is_end || (is_start && !tube.open_start)) {
                const uint32_t point = add_vertex(station.center, tube.paint(part, 0), influences);
                for (uint32_t k = 0; is_end && k < sides; ++k) add_face(before + k, before + (k + 1) % sides, point);
                before = point;
                continue;
            }
            const Vec forward = tube.outline.direction(t);
            up = perpendicular(up, forward);
            const Vec side = cross(up, forward);
            const uint32_t first = uint32_t(out_.positions.size());
            for (uint32_t k = 0; k < sides; ++k) {
                const double angle_turns = 0.25 + double(k) / sides;
                const double x = cosine(angle_turns), y = sine(angle_turns);
                add_vertex(station.center + side * (x * station.width) + up * (y * station.height), tube.paint(part, y),
                           influences);
            }
            for (uint32_t k = 0; k < sides && !is_start; ++k) {
                const uint32_t next = (k + 1) % sides;
                if (ring == 1 && !tube.open_start) {
                    add_face(before, first + next, first + k);
                } else {
                    add_face(before + k, before + next, first + next);
                    add_face(before + k, first + next, first + k);
                }
            }
            before = first;
        }
    }

    void build(const Sheet& sheet) {
        const uint32_t along = sheet.along.parts, across = sheet.across.parts;
        const uint32_t first = uint32_t(out_.positions.size());
        for (uint32_t i = 0; i <= along; ++i)
            for (uint32_t k = 0; k <= across; ++k) {
                const double u = double(i) / along, v = double(k) / across;
                const SkinPoint point = sheet.at(u, v);
                add_vertex(point.position, sheet.paint(u, v), point.influences);
            }
        const uint32_t row = across + 1;
        for (uint32_t i = 0; i < along; ++i)
            for (uint32_t k = 0; k < across; ++k) {
                const uint32_t a = first + i * row + k;
                uint32_t left = a + row, right = a + 1;
                if (sheet.mirrored) std::swap(left, right);
                add_face(a, left, a + row + 1);
                add_face(a, a + row + 1, right);
            }
    }

    void build(const Leaves& leaves) {
        for (uint32_t i = 0; i < leaves.count.parts; ++i) {
            const Leaf leaf = leaves.at(i, leaves.count.parts);
            const uint32_t first = uint32_t(out_.positions.size());
            const Vec widest = leaf.base + leaf.along * 0.45;
            for (const Vec& corner : {leaf.base, widest - leaf.across, leaf.base + leaf.along, widest + leaf.across}) {
                add_vertex(corner, leaf.color, leaf.influences);
                given_normals_.push_back({out_.positions.size() - 1, leaf.normal});
            }
            const bool faces_back = dot(cross(leaf.along, leaf.across), leaf.normal) < 0;
            const uint32_t left = faces_back ? first + 3 : first + 1, right = faces_back ? first + 1 : first + 3;
            add_face(first, left, first + 2);
            add_face(first, first + 2, right);
        }
    }

    // A vertex's normal is the sum of the normals of the faces around it, weighted by area.
    void smooth_normals() {
        std::vector<Vec> sum(out_.positions.size());
        const std::span<const uint32_t> indices = out_.indices;
        for (size_t i = 0; i + 2 < indices.size(); i += 3) {
            const auto corner = [&](size_t k) { return out_.positions[indices[i + k]].as<double>(); };
            const Vec area = cross(corner(1) - corner(0), corner(2) - corner(0));
            for (size_t k = 0; k < 3; ++k) sum[indices[i + k]] = sum[indices[i + k]] + area;
        }
        for (const auto& [vertex, normal] : given_normals_) sum[vertex] = normal;
        for (const Vec& s : sum) out_.normals.push_back(normalized(s).as<float>());
    }

    std::vector<Piece> pieces_;
    uint64_t face_budget_;
    AssetPrimitive out_;                                 // the piece that is being built
    std::vector<std::pair<size_t, Vec>> given_normals_;  // of vertices that do not get them from their faces
};

}  // namespace

AssetMesh make_mesh(std::vector<Piece> pieces, uint32_t face_count) {
    return MeshBuilder(std::move(pieces), face_count).sculpt();
}

}  // namespace throng::creature
