// Indices: each kind is a type of its own. Sockets are found by the names of their joints.
#include <throng/throng.h>

#include <gtest/gtest.h>

#include <type_traits>

namespace throng {
namespace {

static_assert(std::is_convertible_v<uint32_t, ClipIndex> && std::is_convertible_v<ClipIndex, uint32_t>);
static_assert(!std::is_convertible_v<JointIndex, SocketIndex>);
static_assert(!std::is_convertible_v<ClipIndex, LayerIndex> && !std::is_convertible_v<StateIndex, ClipIndex>);
static_assert(sizeof(ClipIndex) == sizeof(uint32_t) && std::is_trivially_copyable_v<ClipIndex>);
template <class A, class B>
concept Comparable = requires(A a, B b) {
    a == b;
};
static_assert(Comparable<ClipIndex, ClipIndex> && Comparable<ClipIndex, uint32_t>);
static_assert(!Comparable<ClipIndex, LayerIndex>);
template <class Index>
concept PlaysOn = requires(Crowd crowd, Index layer) {
    crowd.play(InstanceHandle(), layer, LayerPlayback());
};
static_assert(PlaysOn<LayerIndex> && PlaysOn<uint32_t> && !PlaysOn<ClipIndex> && !PlaysOn<ParameterIndex>);

TEST(Indices, SocketsAreFoundByTheNamesOfTheirJoints) {
    Character character;
    character.rig.names = {"hips", "spine", "hand", "hand"};
    character.rig.parents = {kNone, 0, 1, 1};
    const CrowdGroup group{.character = &character, .sockets = {3, 0, 99}};
    EXPECT_EQ(group.find_socket("hand"), 0u);
    EXPECT_EQ(group.find_socket("hips"), 1u);
    EXPECT_EQ(group.find_socket("spine"), kNone) << "a joint, but no socket";
    EXPECT_EQ(group.socket_named("hips").value(), 1u);
    EXPECT_EQ(group.find_socket(""), kNone);
    const Result<SocketIndex> unknown = group.socket_named("hans");
    ASSERT_FALSE(unknown);
    EXPECT_EQ(unknown.error().code, ErrorCode::kInvalidArgument);
    EXPECT_EQ(unknown.error().message,
              "there is no socket 'hans'; did you mean 'hand'? There are: hand, hips, (no joint)");
    EXPECT_EQ(CrowdGroup{.sockets = {0}}.find_socket("hips"), kNone) << "no character yet";
}

}  // namespace
}  // namespace throng
