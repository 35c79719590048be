// Skin matrices against the reference, exactly.
#include "bind/bind.h"
#include "bind/bind_reference.h"
#include "tests/kernel_runner.h"
#include "tests/subset.h"
#include "tests/test_rig.h"

#include <cstdio>

namespace throng {
namespace {

const test::InSubset kBindInSubsets({test::Subset::kGpuAssisted}, {"Bind.*"});
const test::InSubset kBindNatively({test::Subset::kNative}, {"Bind.*"});

using namespace test;

struct Bound {
    std::vector<PaletteEntry> palette;
    std::vector<Affine> model;            // [instance][joint]
    std::vector<Affine> got;              // [instance][entry]
    std::vector<AffineT<double>> wanted;  // the same
};

// Palettes name joints in any order, some several times, some never.
template <class Transform>
Bound run_bind(uint32_t joint_count, uint32_t palette_count, uint32_t instance_count, Random& random,
               const Transform& transform) {
    Bound bound;
    std::vector<uint32_t> joints;
    std::vector<Affine> binds;
    for (uint32_t entry = 0; entry < palette_count; ++entry) {
        bound.palette.push_back(
            {.joint = entry == 0 ? joint_count - 1 : random.below(joint_count), .joint_from_bind = transform()});
        joints.push_back(bound.palette.back().joint);
        binds.push_back(bound.palette.back().joint_from_bind);
    }
    for (uint32_t instance = 0; instance < instance_count; ++instance) {
        std::vector<AffineT<double>> model_from_joint;
        for (uint32_t joint = 0; joint < joint_count; ++joint) {
            bound.model.push_back(transform());
            model_from_joint.push_back(bound.model.back().template as<double>());
        }
        const auto wanted = bind_reference(bound.palette, model_from_joint);
        bound.wanted.insert(bound.wanted.end(), wanted.begin(), wanted.end());
    }
    const Guarded<Affine> model(bound.model), bind_buffer(binds),
        skin(poison<Affine>(size_t{palette_count} * instance_count));
    const Guarded<uint32_t> joint_buffer(joints);
    run_workgroups(bind_kernel(test_gpu(), SkinFormat::kAffine),
                   BufferTable{{io::kModelBuffer, model},
                               {io::kPaletteJointsBuffer, joint_buffer},
                               {io::kJointFromBindBuffer, bind_buffer},
                               {io::kSkinBuffer, skin},
                               {io::kBirthsBuffer, Guarded<uint32_t>({})}},
                   io::BindPush{joint_count, palette_count}, instance_count);
    bound.got = skin.read();
    EXPECT_TRUE(same_bits(model.read(), bound.model)) << "the stage wrote its input";
    return bound;
}

TEST(Bind, IsExact) {
    size_t compared = 0;
    for (const uint32_t joint_count : {1u, 20u, 300u}) {
        for (const uint32_t palette_count : {1u, 63u, 64u, 65u, 500u}) {
            Random random(joint_count + palette_count);
            const Bound bound = run_bind(joint_count, palette_count, 9, random,
                                         [&] { return exact_transform(random); });
            for (size_t i = 0; i < bound.got.size(); ++i)
                ASSERT_EQ(bound.got[i].as<double>(), bound.wanted[i])
                    << joint_count << " joints, " << palette_count << " entries";
            compared += bound.got.size();
        }
    }
    std::printf("  %zu matrices, equal bit for bit\n", compared);
}

TEST(Bind, RoundsLittle) {
    Random random(6);
    const Bound bound = run_bind(100, 130, 20, random, [&] { return to_affine(random.trs(1, 0.5)).as<float>(); });
    for (size_t i = 0; i < bound.got.size(); ++i) EXPECT_LE(matrix_error(bound.got[i], bound.wanted[i], 1), 1e-6);
}

TEST(Bind, TheReferenceAppliesTheBindMatrixFirst) {
    Affine turn_x, turn_z;
    turn_x.row = {{{1, 0, 0, 1}, {0, 0, -1, 0}, {0, 1, 0, 0}}};
    turn_z.row = {{{0, -1, 0, 2}, {1, 0, 0, 0}, {0, 0, 1, 0}}};
    const auto skin = bind_reference(std::vector<PaletteEntry>{{1, turn_z}, {1, {}}},
                                     std::vector{AffineT<double>{}, turn_x.as<double>()});
    EXPECT_EQ(transform_point(skin[0], Vec3<double>{3, 5, 7}), (Vec3<double>{1 + 2 - 5, -7, 3}));
    EXPECT_EQ(skin[1], turn_x.as<double>());
}

}  // namespace
}  // namespace throng
