// Skinning in the native renderer, against double precision.
#include "tests/host/raster_coverage.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace throng::test {
namespace {

class RasterSkin : public testing::TestWithParam<NativeIsa> {};
INSTANTIATE_TEST_SUITE_P(InstructionSets, RasterSkin, testing::ValuesIn(native_isas()), isa_name);

TEST_P(RasterSkin, SkinsVerticesAndTheirNormals) {
    const raster::Kernel& kernel = raster::kernel_of(GetParam());
    Random random(13);
    for (const uint32_t influence_count : {4u, 8u})
        for (const bool some_mirror : {false, true}) {
            constexpr uint32_t kEntries = 9, kVertices = 37;
            std::vector<Affine> skin(kEntries);
            for (Affine& matrix : skin) {
                Trs<double> trs = random.trs(1, 0.4);
                if (some_mirror && random.chance(0.3)) trs.scale.x = -trs.scale.x;
                matrix = to_affine(trs).as<float>();
            }
            const Affine placement = to_affine(random.trs(20, 0.5)).as<float>();
            const native::AlignedBytes columns = native::aligned_bytes(kEntries * 16 * sizeof(float)),
                                       bind = native::aligned_bytes(48 * 8 * sizeof(float)),
                                       kept = native::aligned_bytes(48 * 4 * sizeof(float));
            const auto floats = [](const native::AlignedBytes& bytes) { return reinterpret_cast<float*>(bytes.get()); };
            // Half turns by all axes blend to a point reflection, though none of them mirrors
            for (size_t axis = 0; axis < 3; ++axis) {
                skin[axis] = Affine{};
                for (size_t row = 0; row < 3; ++row) skin[axis].row[row][row] = row == axis ? 1 : -1;
            }
            kernel.place(&placement.row[0][0], &skin[0].row[0][0], kEntries, floats(columns));

            std::vector<float> weights;
            std::vector<uint16_t> entries;
            for (uint32_t v = 0; v < kVertices; ++v) {
                const Vec3<float> place = random.vector(1).as<float>(), normal = random.direction().as<float>();
                const float numbers[8]{place.x, place.y, place.z, 1, normal.x, normal.y, normal.z, 0};
                std::ranges::copy(numbers, floats(bind) + size_t{v} * 8);
                float left = 1;
                // Only one influence if some mirror, since blends of mirroring and other matrices may be flat
                for (uint32_t i = 0; i < influence_count; ++i) {
                    const float weight = i + 1 == influence_count ? left : some_mirror ? 0 : left * 0.6f;
                    left -= weight;
                    weights.push_back(weight);
                    entries.push_back(static_cast<uint16_t>(random.below(kEntries)));
                }
            }
            for (uint32_t i = 0; i < influence_count; ++i) {
                weights[i] = i < 3 ? 1 / 3.0f : 0;
                entries[i] = static_cast<uint16_t>(i);
            }
            RasterFrame frame(4);
            raster::Section section{.vertex_count = kVertices,
                                    .bind = floats(bind),
                                    .weights = weights.data(),
                                    .entries = entries.data(),
                                    .influence_count = influence_count};
            raster::Draw draw{.section = &section, .vertices = floats(kept)};
            kernel.skin(frame.frame(), floats(columns), nullptr, draw);

            for (uint32_t v = 0; v < kVertices; ++v) {
                AffineT<double> blended{};
                for (auto& row : blended.row) std::ranges::fill(row, 0.0);
                for (uint32_t i = 0; i < influence_count; ++i)
                    for (size_t r = 0; r < 3; ++r)
                        for (size_t c = 0; c < 4; ++c)
                            blended.row[r][c] += double{weights[v * influence_count + i]} *
                                                 double{skin[entries[v * influence_count + i]].row[r][c]};
                const AffineT<double> world = placement.as<double>() * blended;
                const float* const in = floats(bind) + size_t{v} * 8;
                const Vec3<double> place = transform_point(world,
                                                           Vec3<double>{double{in[0]}, double{in[1]}, double{in[2]}});
                constexpr uint32_t kFour = raster::kFour, kFourFloats = raster::kFourFloats;
                const float* const out = floats(kept) + v / kFour * kFourFloats + v % kFour;
                EXPECT_NEAR(static_cast<double>(out[0]), place.x, 2e-5);
                EXPECT_NEAR(static_cast<double>(out[kFour]), place.y, 2e-5);
                EXPECT_NEAR(static_cast<double>(out[2 * kFour]), place.z, 2e-5);
                // The normal of two transformed tangents, on the same side as the vertex normal
                const Vec3<double> normal{double{in[4]}, double{in[5]}, double{in[6]}};
                const Vec3<double> along = normalized(
                    cross(normal, std::abs(normal.x) < 0.9 ? Vec3<double>{1, 0, 0} : Vec3<double>{0, 1, 0}));
                const auto turned = [&](const Vec3<double>& t) {
                    return transform_point(world, t) - transform_point(world, Vec3<double>{});
                };
                Vec3<double> wanted = normalized(cross(turned(along), turned(cross(normal, along))));
                if (determinant(world) < 0) wanted = wanted * -1.0;
                EXPECT_LT(length(test::unpacked_normal(out[3 * kFour]) - wanted), 2e-4) << v;
            }
            const auto right_edge_at = [&](float distance) {
                Affine moved = placement;
                moved.row[2][3] = distance;
                kernel.place(&moved.row[0][0], &skin[0].row[0][0], kEntries, floats(columns));
                kernel.skin(frame.frame(), floats(columns), nullptr, draw);
                return draw.picture_box[2];
            };
            EXPECT_EQ(right_edge_at(RasterFrame::kNear), RasterFrame::kSize) << "partly behind the eye it is anywhere";
            EXPECT_LT(right_edge_at(-100), 0) << "wholly, nowhere";
        }
}

}  // namespace
}  // namespace throng::test
