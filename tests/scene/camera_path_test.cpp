// Camera paths: smooth, periodic, and aimed at their subject.
#include "tools/scene/camera_path.h"
#include "tools/cli/command.h"

#include <gtest/gtest.h>

#include <cmath>

namespace throng::tools {
namespace {

constexpr float kAspectRatio = 16.0f / 9;

CameraSubject subject_of(const Vec3<float>& half) {
    const Vec3<float> centre{3, half.y, -8};
    CameraSubject subject{{centre - half, centre + half},
                          kAspectRatio,
                          to_affine(Trs<float>{axis_angle(Vec3<float>{0, 1, 0}, 2.0f), {5, 0, -6}, {0.5f, 0.5f, 0.5f}}),
                          {{-1, -0.5f, -2}, {1, 3.5f, 2}}};
    return subject;
}

// A crowd, one character, and a vast one.
const CameraSubject kSubjects[] = {subject_of({40, 1, 30}), subject_of({1, 2, 1.5f}), subject_of({900, 2, 900})};

// x / w and y / w in clip space. Infinite behind the camera.
Vec3<float> seen_at(const Camera& camera, const Vec3<float>& p) {
    const CrowdView view = *view_of(camera, 1600, 900, {});
    const auto row = [&](size_t r) {
        return view.clip_from_world[r][0] * p.x + view.clip_from_world[r][1] * p.y + view.clip_from_world[r][2] * p.z +
               view.clip_from_world[r][3];
    };
    return row(3) > 0 ? Vec3<float>{row(0) / row(3), row(1) / row(3), 0} : Vec3<float>{INFINITY, INFINITY, 0};
}
bool is_seen(const Camera& camera, const Vec3<float>& p) {
    return std::abs(seen_at(camera, p).x) <= 1 && std::abs(seen_at(camera, p).y) <= 1;
}

Vec3<float> centre_of(const Bounds& bounds) { return (bounds.min + bounds.max) * 0.5f; }

TEST(CameraPath, MovesSmoothlyAndComesBack) {
    for (const char* text : {"fit", "orbit:seconds=10", "flyover:seconds=10", "low:seconds=10", "follow"})
        for (const CameraSubject& subject : kSubjects) {
            const CameraPath path(text);
            const float extent = length(subject.bounds.max - subject.bounds.min) +
                                 length(path.at(0, subject).eye - centre_of(subject.bounds));
            Vec3<float> last_step{};
            for (int frame = 0; frame <= 300; ++frame) {
                const Camera camera = path.at(frame / 30.0, subject), next = path.at((frame + 1) / 30.0, subject);
                const Vec3<float> step = next.eye - camera.eye;
                ASSERT_TRUE(std::isfinite(length(camera.eye)) && std::isfinite(length(camera.target))) << text;
                EXPECT_GT(length(camera.target - camera.eye), 0.1f) << text;
                EXPECT_GT(camera.eye.y, subject.bounds.min.y) << text;
                EXPECT_LT(length(step), 0.03f * extent) << text << " " << frame;
                EXPECT_LT(length(next.target - camera.target), 0.03f * extent) << text << " " << frame;
                if (frame > 0) {
                    EXPECT_LT(length(step - last_step), 0.002f * extent) << text << " " << frame;
                }
                last_step = step;
            }
            EXPECT_LT(length(path.at(10, subject).eye - path.at(0, subject).eye), 1e-4f * extent) << text;
            EXPECT_LT(length(path.at(10'000'003, subject).eye - path.at(3, subject).eye), 1e-4f * extent) << text;
        }
}

TEST(CameraPath, HoldsTheCrowdInView) {
    for (const CameraSubject& subject : {kSubjects[0], kSubjects[1]})
        for (int frame = 0; frame < 60; ++frame) {
            const Vec3<float> centre = centre_of(subject.bounds),
                              half = (subject.bounds.max - subject.bounds.min) * 0.5f;
            for (const char* text : {"orbit:seconds=60", "low:seconds=60"})
                EXPECT_TRUE(is_seen(CameraPath(text).at(frame, subject), centre)) << text << frame;
            const Camera orbit = CameraPath("orbit:seconds=60").at(frame, subject);
            for (const float turn : {0.0f, 1.0f, 2.0f, 3.0f, 4.0f, 5.0f, 6.0f})
                EXPECT_TRUE(is_seen(orbit, centre + Vec3<float>{half.x * std::sin(turn), 0, half.z * std::cos(turn)}))
                    << turn << " " << frame;
            // From above the heads, the flyover sees some of the crowd, though maybe not its middle.
            const Camera flight = CameraPath("flyover:seconds=60").at(frame, subject);
            EXPECT_TRUE(is_seen(flight, flight.target));
            EXPECT_LE(std::abs(flight.target.x - centre.x), half.x);
            EXPECT_LE(std::abs(flight.target.z - centre.z), half.z);
            EXPECT_GT(flight.eye.y, subject.bounds.max.y);
        }
}

TEST(CameraPath, FollowsOneFromBehind) {
    const CameraPath path("follow:character=17,distance=3");
    EXPECT_EQ(path.followed_character(), 17u);
    CameraSubject subject = subject_of({40, 1, 30});
    const Camera camera = path.at(0, subject);
    const Vec3<float> head = transform_point(subject.world_from_model, Vec3<float>{0, 3.5f, 0}),
                      feet = transform_point(subject.world_from_model, Vec3<float>{0, -0.5f, 0});
    EXPECT_TRUE(is_seen(camera, head));
    EXPECT_TRUE(is_seen(camera, feet));
    const Vec3<float> ahead = transform_vector(subject.world_from_model, Vec3<float>{0, 0, 1}),
                      look = camera.target - camera.eye;
    EXPECT_GT(dot(normalized(ahead), normalized(look)), 0.9f);
    EXPECT_GT(camera.eye.y, head.y);
    for (auto& row : subject.world_from_model.row) row[3] += 2;
    EXPECT_LT(length(path.at(0, subject).eye - camera.eye - Vec3<float>{2, 2, 2}), 1e-5f);
}

TEST(CameraPath, ParametersChangeThePath) {
    const CameraSubject& subject = kSubjects[0];
    const Vec3<float> centre = centre_of(subject.bounds);
    const auto eye = [&](const char* text) { return CameraPath(text).at(0, subject).eye - centre; };
    EXPECT_GT(length(eye("orbit:distance=2")), 1.6f * length(eye("orbit")));
    EXPECT_GT(eye("orbit:height=2").y, 1.6f * eye("orbit").y);
    EXPECT_GT(eye("flyover:height=3").y, eye("flyover").y + 3);
    EXPECT_GT(eye("low:height=0.9").y, eye("low:height=0.2").y);
}

TEST(CameraPath, WrongTextsAreRefused) {
    for (const char* text : {"", "circle", "Fit", "fit:seconds=3", "orbit:seconds", "orbit:seconds=", "orbit:seconds=0",
                             "orbit:seconds=nan", "orbit:seconds=1e9", "orbit:seconds=5x", "orbit:character=1",
                             "follow:character=-1", "follow:character=1.5", "orbit:seconds=20,,height=1"})
        EXPECT_THROW(CameraPath{std::string(text)}, UsageError) << text;
}

}  // namespace
}  // namespace throng::tools
