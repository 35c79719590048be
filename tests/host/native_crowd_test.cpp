// Culling, agents, terrain, procedural rules and skipped updates, as devices without Vulkan compute them.
#include "bind/bind_io.h"
#include "cull/cull.kernel.h"
#include "cull/cull_reference.h"
#include "cull/list.kernel.h"
#include "cull/offsets.kernel.h"
#include "procedural/procedural.kernel.h"
#include "procedural/procedural_reference.h"
#include "steer/places.kernel.h"
#include "steer/steer.kernel.h"
#include "steer/steer_io.h"
#include "steer/steer_reference.h"
#include "steer/terrain.kernel.h"
#include "steer/terrain_io.h"
#include "tests/host/native_runner.h"
#include "tests/test_rig.h"
#include "update_rate/update_rate.kernel.h"
#include "update_rate/update_rate_io.h"
#include "update_rate/update_rate_reference.h"

#include <algorithm>
#include <cmath>

namespace throng {
namespace {

using namespace test;

// A view that sees a box around the eye, which reaches half of `extent` each way.
io::CullView view_of_box(float extent, uint32_t update_number) {
    io::CullView view{};
    for (uint32_t axis = 0; axis < 3; ++axis)
        for (uint32_t side = 0; side < 2; ++side) {
            io::vec4& plane = view.planes[2 * axis + side];
            plane[axis] = side == 0 ? 1.0f : -1.0f;
            plane.w = extent / 2;
        }
    view.eye = {0, 0, 0, 30};
    view.shadow = {0.5f, -3, 0, 8};
    view.ground = -5;
    view.update_number = update_number;
    return view;
}

// The sections of a list that these verdicts give, each in ascending order of instances.
std::vector<std::vector<uint32_t>> sections_of(const std::vector<uint32_t>& verdicts) {
    std::vector<std::vector<uint32_t>> sections(io::kLodCount + io::kWorkSections);
    for (uint32_t i = 0; i < verdicts.size(); ++i) {
        const uint32_t verdict = verdicts[i], section = verdict >> io::kVerdictSectionShift & io::kVerdictSectionMask;
        if (verdict & io::kVerdictDrawn) sections[verdict & io::kVerdictLodMask].push_back(i);
        if (verdict & io::kVerdictAnimated) sections[io::kLodCount + section].push_back(i);
        if (verdict & io::kVerdictInterpolated) sections[io::kLodCount + io::kInterpolated].push_back(i);
        if (verdict & io::kVerdictAppears) sections[io::kLodCount + io::kAppearing].push_back(i);
    }
    return sections;
}

TEST(NativeCrowd, ListsWhatTheReferenceSees) {
    for (const uint32_t count : {1u, 64u, 65u, 1000u}) {
        Random random(count);
        const CullBox box{{0.1, 1, 0}, {0.5, 1, 0.4}};
        std::vector<Affine> placements;
        for (uint32_t i = 0; i < count; ++i) placements.push_back(to_affine(random.trs(30, 0.3)).as<float>());
        const uint32_t cells_of_workgroup = count % 3 + 1, of_workgroup = cells_of_workgroup * io::kCullWorkgroupSize,
                       workgroups = (count + of_workgroup - 1) / of_workgroup;
        std::vector<uint32_t> states(count);
        uint32_t going_on = 0, seen = 0;
        for (uint32_t update = 0; update < 9; ++update) {
            std::vector<io::CullView> view{view_of_box(static_cast<float>(random.between(30, 60)), update)};
            auto verdicts = unwritten<uint32_t>(count), counts = unwritten<uint32_t>(workgroups * io::kCounters),
                 list = unwritten<uint32_t>(io::kFirstListed + count),
                 work = unwritten<uint32_t>(io::kFirstWork + io::kMaxWorkOfInstance * count),
                 dispatches = unwritten<uint32_t>(3 * (io::kWorkSections + 1));
            std::vector<io::DrawCommand> draws(2 * io::kLodCount);
            const io::CullPush push{.centre = {0.1f, 1, 0, 0},
                                    .half_extent = {0.5f, 1, 0.4f, 0},
                                    .lod_errors = {0, 0.2f, 0.4f, 0.7f},
                                    .instance_count = count,
                                    .lod_count = 4,
                                    .joint_set_count = 3,
                                    .keeps_previous = update % 2,
                                    .may_skip = 1,
                                    .cells_of_workgroup = cells_of_workgroup};
            NativeRun cull(kernels::cull.native), offsets(kernels::offsets.native), lists(kernels::list.native);
            cull.bind(io::kViewBuffer, view).bind(io::kPlacementsBuffer, placements).bind(io::kStatesBuffer, states);
            cull.bind(io::kVerdictsBuffer, verdicts).bind(io::kCountsBuffer, counts);
            offsets.bind(io::kCountsBuffer, counts).bind(io::kListBuffer, list).bind(io::kWorkBuffer, work);
            offsets.bind(io::kDispatchesBuffer, dispatches).bind(io::kDrawsBuffer, draws);
            lists.bind(io::kVerdictsBuffer, verdicts).bind(io::kCountsBuffer, counts);
            lists.bind(io::kListBuffer, list).bind(io::kWorkBuffer, work);
            cull.workgroups(push, workgroups);
            offsets.workgroups(io::OffsetsPush{workgroups, 2, 0, 0, {1, 2, 3, 4}}, 1);
            lists.workgroups(push, workgroups);
            for (uint32_t i = 0; i < count; ++i) {
                const double reach = seen_by(view[0], placements[i].as<double>(), box);
                if (std::abs(reach) < 1e-3) continue;
                ASSERT_EQ((verdicts[i] & io::kVerdictDrawn) != 0, reach > 0) << "instance " << i;
                const uint32_t lod = verdicts[i] & io::kVerdictLodMask;
                if (reach < 0) continue;
                ++seen;
                const auto spare = [&](uint32_t of) {
                    return spare_of_lod(view[0], placements[i].as<double>(), box, double{push.lod_errors[of]});
                };
                EXPECT_TRUE(lod == 0 || spare(lod) >= -1e-3) << "too coarse";
                EXPECT_TRUE(lod == 3 || spare(lod + 1) <= 1e-3) << "too fine";
            }
            const std::vector<std::vector<uint32_t>> sections = sections_of(verdicts);
            uint32_t listed = 0, worked = io::kFirstWork;
            for (uint32_t s = 0; s < sections.size(); ++s) {
                const auto size = static_cast<uint32_t>(sections[s].size());
                const bool is_drawn = s < io::kLodCount;
                const uint32_t begin = is_drawn ? io::kFirstListed + listed : worked;
                for (uint32_t k = 0; k < size; ++k)
                    ASSERT_EQ((is_drawn ? list : work)[begin + k], sections[s][k]) << "section " << s;
                if (is_drawn) {
                    EXPECT_EQ(list[io::kListBegins + s], listed);
                    EXPECT_EQ(draws[io::kLodCount + s].instance_count, size);
                    listed += size;
                    continue;
                }
                const uint32_t of_work = s - io::kLodCount;
                EXPECT_EQ(work[2 * of_work], begin);
                EXPECT_EQ(work[2 * of_work + 1], size);
                const uint32_t each = of_work < io::kInterpolated ? of_work % io::kLodCount + 1 : 1;
                EXPECT_EQ(dispatches[3 * of_work], (size + each - 1) / each);
                EXPECT_EQ(dispatches[3 * of_work + 1], 1u);
                worked += size;
            }
            EXPECT_EQ(list[io::kListCount], listed);
            EXPECT_EQ(dispatches[3 * io::kWorkSections], listed);
            going_on += static_cast<uint32_t>(sections[io::kLodCount + io::kInterpolated].size());
        }
        EXPECT_TRUE(count < 1000 || (seen > count && going_on > count / 4)) << seen << ", " << going_on;
    }
}

TEST(NativeCrowd, AgentsFollowTheReference) {
    constexpr uint32_t kAgents = 150;
    Random random(9);
    const Steering steering{};
    std::vector<Affine> placements;
    std::vector<io::vec4> destinations;
    for (uint32_t i = 0; i < kAgents; ++i) {
        placements.push_back(to_affine(Trs<double>{axis_angle(Vec3<double>{0, 1, 0}, random.between(-3, 3)),
                                                   {random.between(-4, 4), 0, random.between(-4, 4)},
                                                   {1.5, 1.5, 1.5}})
                                 .as<float>());
        destinations.push_back({static_cast<float>(random.between(-4, 4)), 0, static_cast<float>(random.between(-4, 4)),
                                random.chance(0.9) ? 1.0f : 0.0f});
    }
    std::vector<io::AgentState> states(kAgents, io::AgentState{0, 1, 0});
    double moved = 0;
    for (int step = 0; step < 20; ++step) {
        std::vector<SteeredAgent> agents;
        for (uint32_t i = 0; i < kAgents; ++i) {
            agents.push_back({.steering = steering,
                              .world_from_model = placements[i].as<double>(),
                              .destination = {},
                              .speed = double{states[i].speed},
                              .patience = double{states[i].patience},
                              .stands = states[i].stands != 0});
            if (destinations[i].w > 0)
                agents.back().destination = Vec3<double>{destinations[i].x, destinations[i].y, destinations[i].z};
        }
        const std::vector<SteeredAgent> wanted = steer_reference(agents, double{0.05f});
        std::vector<io::AgentPlace> places(kAgents);
        std::vector<uint32_t> heads(64, kNone);
        const float inverse_cell = 1 / (4 * steering.radius);
        const auto turn_rad = static_cast<double>(steering.turn) * double{0.05f};
        NativeRun find(kernels::places.native), steer(kernels::steer.native);
        find.bind(io::kPlacementsBuffer, placements).bind(io::kAgentPlacesBuffer, places);
        find.bind(io::kAgentBucketsBuffer, heads);
        steer.bind(io::kAgentPlacesBuffer, places).bind(io::kAgentBucketsBuffer, heads);
        steer.bind(io::kDestinationsBuffer, destinations).bind(io::kAgentsBuffer, states);
        steer.bind(io::kPlacementsBuffer, placements);
        find.invocations(io::PlacesPush{kAgents, 0, steering.radius, 0, inverse_cell, 63}, kAgents);
        const std::vector<Affine> before = placements;
        steer.invocations(io::SteerPush{.instance_count = kAgents,
                                        .first_agent = 0,
                                        .bucket_mask = 63,
                                        .speed = steering.speed,
                                        .turn_cos = static_cast<float>(std::cos(turn_rad)),
                                        .turn_sin = static_cast<float>(std::sin(turn_rad)),
                                        .time_step_s = 0.05f,
                                        .is_carried = 0,
                                        .parameter_count = 0,
                                        .speed_parameter = kNone,
                                        .grid_count = 1,
                                        .largest = {steering.radius},
                                        .inverse_cells = {inverse_cell}},
                          kAgents);
        for (uint32_t i = 0; i < kAgents; ++i) {
            ASSERT_LE(matrix_error(placements[i], wanted[i].world_from_model, 1), 2e-3) << "agent " << i;
            EXPECT_NEAR(states[i].speed, wanted[i].speed, 2e-3);
            EXPECT_NEAR(states[i].patience, wanted[i].patience, 1e-5);
            moved += std::abs(double{placements[i].row[0][3]} - double{before[i].row[0][3]});
        }
    }
    EXPECT_GT(moved, kAgents * 0.05);
}

// Placements on a plane that rises along x and z, and beyond its edges.
TEST(NativeCrowd, TerrainLiftsPlacements) {
    std::vector<float> heights;
    for (uint32_t row = 0; row < 5; ++row)
        for (uint32_t column = 0; column < 4; ++column)
            heights.push_back(static_cast<float>(column) * 2 + static_cast<float>(row) * 3);
    std::vector<Affine> placements(4);
    placements[0].row[0][3] = 10.5f, placements[0].row[2][3] = -3.25f;
    placements[1].row[0][3] = -100, placements[1].row[2][3] = -100;
    placements[2].row[0][3] = 100, placements[2].row[2][3] = 100;
    placements[3].row[0][3] = 10, placements[3].row[2][3] = 0;
    NativeRun run(kernels::terrain.native);
    run.bind(io::kPlacementsBuffer, placements).bind(io::kHeightsBuffer, heights);
    run.invocations(io::TerrainPush{4, 4, 5, 10, -4, 1}, 4);
    EXPECT_FLOAT_EQ(placements[0].row[1][3], 0.5f * 2 + 0.75f * 3);
    EXPECT_EQ(placements[1].row[1][3], 0);
    EXPECT_EQ(placements[2].row[1][3], 3 * 2 + 4 * 3);
    EXPECT_EQ(placements[3].row[1][3], 4 * 3);
}

// Only instance 1, with two palette entries, is interpolated. Tests of bind and skin cover all formats.
TEST(NativeCrowd, MatricesAreInterpolatedToTheirTarget) {
    constexpr uint32_t kPalette = 3;
    Random random(10);
    std::vector<Affine> previous, target;
    for (uint32_t i = 0; i < 2 * kPalette; ++i) {
        previous.push_back(to_affine(random.trs(1, 0.2)).as<float>());
        target.push_back(to_affine(random.trs(1, 0.2)).as<float>());
    }
    std::vector<uint32_t> work(io::kFirstWork + 2), entries{2, 0}, states{0, 4u << io::kStateStepShift};
    work[2 * io::kInterpolated] = io::kFirstWork;
    work[io::kFirstWork] = 1;
    for (const uint32_t section : {io::kInterpolated, io::kAppearing}) {
        work[2 * section] = io::kFirstWork;
        auto current = unwritten<Affine>(previous.size());
        NativeRun run(kernels::update_rate.native, {io::kSkinAffine});
        run.bind(io::kWorkBuffer, work).bind(io::kStatesBuffer, states).bind(io::kPreviousSkinBuffer, previous);
        run.bind(io::kSkinTargetBuffer, target).bind(io::kSkinBuffer, current).bind(io::kPaletteBySetBuffer, entries);
        run.workgroups(io::UpdateRatePush{section, kPalette, 0, 0, {2, 0, 0, 0}}, 1);
        for (const uint32_t entry : {0u, 2u}) {
            const Affine &from = previous[kPalette + entry], &to = target[kPalette + entry];
            const AffineT<double> wanted = section == io::kInterpolated
                                               ? update_rate_reference(from.as<double>(), to.as<double>(), 4)
                                               : from.as<double>();
            EXPECT_LE(matrix_error(current[kPalette + entry], wanted, 1), 1e-6);
        }
        EXPECT_TRUE(std::isnan(current[kPalette + 1].row[0][0]));
    }
}

// Rules of all kinds on a chain, over several updates.
TEST(NativeCrowd, RulesFollowTheReference) {
    constexpr uint32_t kInstances = 70, kJoints = 12;
    Character character = make_character(
        {.joint_count = kJoints, .shape = RigShape::kChain, .seed = 9, .scale_spread = 0, .clip_count = 1});
    const std::vector<std::string>& names = character.rig.names;
    const ProceduralRules rules{
        .targets = {"prey", "ledge"},
        .rules = {LookAtRule{.joint = names[1], .target = "prey", .limit_rad = 1},
                  WindRule{.joint = names[2], .bend_rad = 0.05f, .sway_rad = 0.02f, .sway_hz = 1.3f},
                  SpringRule{.joint = names[9],
                             .frequency_hz = 1.5f,
                             .damping = 0.5f,
                             .gravity = {0, -3, 0},
                             .drag = 0.3f,
                             .radius = 0.01f,
                             .colliders = {{.joint = names[0], .a = {0, 0, 0}, .b = {0, 1, 0}, .radius = 0.3f}}},
                  ReachRule{.joint = names[7], .target = "ledge", .weight = 0.7f}}};
    ProceduralTables tables = make_procedural_tables(rules, character);
    Random random(11);
    WindClock clock;
    clock.set({.velocity = {3, 0, 1}, .gust = 0.5f, .wavelength = 2});
    std::vector<ProceduralReference> references;
    std::vector<Trs<double>> rest;
    for (const Trs<float>& joint : character.rig.rest) rest.push_back(joint.as<double>());
    std::vector<Affine> placements;
    std::vector<io::vec4> targets;
    for (uint32_t i = 0; i < kInstances; ++i) {
        references.emplace_back(rules, character);
        placements.push_back(to_affine(Trs<double>{.translation = random.vector(3)}).as<float>());
        for (ProceduralReference::Target& target : references.back().targets) {
            const Vec3<float> place = (random.direction() * (2 * double{character.size})).as<float>();
            target = {place.as<double>(), 0.5};
            targets.push_back({place.x, place.y, place.z, 0.5f});
        }
    }
    std::vector<io::SpringState> springs(kInstances * size_t{tables.spring_count});
    std::vector<double> errors;
    for (int update = 0; update < 8; ++update) {
        clock.advance(double{0.02f});
        std::vector<Affine> local;
        for (uint32_t i = 0; i < kInstances; ++i)
            for (const Trs<double>& joint : rest) local.push_back(to_affine(joint).as<float>());
        for (const ProceduralTables::Dispatch& dispatch : tables.dispatches) {
            io::ProceduralPush push{.instance_count = kInstances,
                                    .first_instance = 5,
                                    .joint_count = kJoints,
                                    .spring_count = tables.spring_count,
                                    .target_count = tables.target_count,
                                    .first_chain = dispatch.first_chain,
                                    .workgroups = 2,
                                    .time_step_s = 0.02f};
            clock.moment().tell(push);
            NativeRun run(kernels::procedural.native, {false, dispatch.kind});
            run.bind(io::kRulesBuffer, tables.words).bind(io::kPlacementsBuffer, placements);
            run.bind(io::kTargetsBuffer, targets).bind(io::kSpringsBuffer, springs).bind(io::kLocalBuffer, local);
            run.workgroups(push, 2 * dispatch.chain_count);
        }
        for (uint32_t i = 0; i < kInstances; ++i) {
            std::vector<Trs<double>> wanted = rest;
            references[i].update(wanted, {.world_from_model = placements[i].as<double>(),
                                          .wind = clock.moment(),
                                          .instance = 5 + i,
                                          .time_step_s = double{0.02f}});
            for (uint32_t joint = 0; joint < kJoints; ++joint)
                errors.push_back(matrix_error(local[i * kJoints + joint], to_affine(wanted[joint]), 1));
        }
    }
    std::ranges::sort(errors);
    EXPECT_LE(errors[errors.size() * 98 / 100], 1e-4);  // a spring driven past its joint may swing back another way
    EXPECT_LE(errors.back(), 0.02);
}

}  // namespace
}  // namespace throng
