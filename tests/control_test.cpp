// The control stage: playback times and rows of keys against the reference, over many updates.
#include "control/control.h"
#include "control/control_reference.h"
#include "control/playback.h"
#include "base/failure.h"
#include "tests/kernel_runner.h"
#include "tests/subset.h"
#include "tests/test_rig.h"

#include <cmath>
#include <cstdio>
#include <limits>

namespace throng {
namespace {

const test::InSubset kControlInSubsets({test::Subset::kGpuAssisted}, {"Control.*"});
const test::InSubset kControlNatively({test::Subset::kNative}, {"Control.*"});

using namespace test;

constexpr uint32_t kJointCount = 7;  // of the tables that the cursors point into

// The time axes of clips, and of the rest pose as the crowd makes it.
struct Timelines {
    std::vector<float> times_s{0};  // the rest pose's row; the clips' follow
    std::vector<io::ClipTimeline> clips;

    void add(const std::vector<float>& axis_s, float duration_s, uint32_t row_stride) {
        clips.push_back({static_cast<uint32_t>(times_s.size()), static_cast<uint32_t>(axis_s.size()), row_stride,
                         static_cast<uint32_t>(1000 * clips.size()), duration_s});
        times_s.insert(times_s.end(), axis_s.begin(), axis_s.end());
    }
    std::vector<uint32_t> words() const { return as_words(clips); }
    std::span<const float> times_of(uint32_t clip) const {
        return std::span(times_s).subspan(clips[clip].first_time, clips[clip].row_count);
    }
};

Timelines make_timelines() {
    Timelines timelines;
    Random random(1);
    std::vector<float> uniform_s, uneven_s{0};
    for (int i = 0; i <= 32; ++i) uniform_s.push_back(static_cast<float>(i) / 32);
    for (int i = 0; i < 100; ++i)
        uneven_s.push_back(uneven_s.back() + static_cast<float>(random.chance(0.2) ? random.between(0.1, 0.5)
                                                                                   : random.between(0.001, 0.01)));
    timelines.add(uniform_s, 1, 11);
    timelines.add(uneven_s, uneven_s.back(), 3);
    timelines.add({0.5f, 0.75f, 1.5f}, 2, 5);  // starts late, ends early
    timelines.add({0}, 0, 0);                  // no duration
    timelines.add({0.3f}, 0.3f, 2);            // one row
    timelines.add({0, 600}, 600, 1);           // ten minutes
    timelines.clips.push_back({.first_time = 0, .row_count = 1, .row_stride = 0, .duration_s = 0});
    return timelines;
}

void check_cursor(const Timelines& timelines, const io::ClipPlay& play, const io::ClipCursor& cursor) {
    const io::ClipTimeline& timeline = timelines.clips[play.clip];
    const std::span<const float> times_s = timelines.times_of(play.clip);
    const RowCursor wanted = find_rows_reference(times_s, play.time_s);
    EXPECT_EQ(cursor.first_track, play.clip * kJointCount);
    ASSERT_EQ(cursor.earlier, timeline.first_row + wanted.earlier * timeline.row_stride)
        << "clip " << play.clip << " at " << play.time_s << " s";
    if (cursor.fraction > 0) {
        EXPECT_EQ(cursor.later, timeline.first_row + wanted.later * timeline.row_stride);
    } else {  // any row, since its weight in the result is 0
        EXPECT_LE(cursor.later, timeline.first_row + (timeline.row_count - 1) * timeline.row_stride);
    }
    EXPECT_NEAR(cursor.fraction, wanted.fraction, 1e-6) << "clip " << play.clip << " at " << play.time_s << " s";
}

class Runner {
public:
    Runner(const Timelines& timelines, std::vector<io::InstancePlayback> playbacks)
        : kernel_(control_kernel(test_gpu())),
          count_(static_cast<uint32_t>(playbacks.size())),
          state(std::move(playbacks)),
          playbacks_(state),
          timelines_(timelines.words()),
          times_(timelines.times_s),
          cursors_(poison<io::InstanceCursor>(count_)) {}

    void step(float time_step_s) {
        run_invocations(kernel_,
                        BufferTable{{io::kPlaybacksBuffer, playbacks_},
                                    {io::kTimelineBuffer, timelines_},
                                    {io::kTimesBuffer, times_},
                                    {io::kBirthsBuffer, times_},
                                    {io::kCursorsBuffer, cursors_}},
                        io::ControlPush{count_, kJointCount, time_step_s, 0}, count_);
        state = playbacks_.read();
        cursors = cursors_.read();
    }

private:
    Kernel kernel_;
    uint32_t count_;

public:
    std::vector<io::InstancePlayback> state;  // after the last step
    std::vector<io::InstanceCursor> cursors;

private:
    Guarded<io::InstancePlayback> playbacks_;
    Guarded<uint32_t> timelines_;
    Guarded<float> times_;
    Guarded<io::InstanceCursor> cursors_;
};

TEST(Control, FollowsTheReferenceOverManySteps) {
    const Timelines timelines = make_timelines();
    Random random(2);
    std::vector<io::InstancePlayback> playbacks;
    for (int i = 0; i < 1000; ++i) {
        const auto play = [&] {
            const uint32_t clip = random.below(static_cast<uint32_t>(timelines.clips.size()));
            return io::ClipPlay{.clip = clip,
                                .loop = random.below(2),
                                .time_s = static_cast<float>(random.unit()) * timelines.clips[clip].duration_s,
                                .speed = static_cast<float>(random.between(-2, 2))};
        };
        playbacks.push_back({play(), play(), static_cast<float>(random.unit())});
    }
    Runner runner(timelines, playbacks);
    double worst_s = 0;
    size_t wraps = 0;
    for (int step = 0; step < 200; ++step) {
        const std::vector<io::InstancePlayback> before = runner.state;
        const float step_s = step % 20 == 19 ? 3.7f : step % 7 == 6 ? -0.05f : 1.0f / 60;
        runner.step(step_s);
        for (size_t i = 0; i < before.size(); ++i) {
            const auto check = [&](const io::ClipPlay& was, const io::ClipPlay& is, const io::ClipCursor& cursor) {
                const double duration_s = timelines.clips[was.clip].duration_s;
                EXPECT_EQ(is.clip, was.clip);
                EXPECT_EQ(is.loop, was.loop);
                EXPECT_EQ(is.speed, was.speed);
                EXPECT_GE(is.time_s, 0);
                EXPECT_TRUE(was.loop && duration_s > 0 ? is.time_s < duration_s : is.time_s <= duration_s) << is.time_s;
                const double unwrapped_s = was.time_s + double{step_s} * was.speed;
                const double wanted_s = local_time_reference(unwrapped_s, duration_s, was.loop != 0);
                wraps += unwrapped_s != wanted_s;
                double difference_s = std::abs(is.time_s - wanted_s);
                // For a loop, the end is the same as the beginning
                if (was.loop) difference_s = std::min(difference_s, duration_s - difference_s);
                const double rounding_s = 2e-7 * std::max(duration_s, std::abs(unwrapped_s)) + 1e-9;
                EXPECT_LE(difference_s, std::max(1e-6, rounding_s))
                    << "clip " << was.clip << ", from " << was.time_s << " by " << step_s << " x " << was.speed;
                if (duration_s < 10) worst_s = std::max(worst_s, difference_s);
                check_cursor(timelines, is, cursor);
            };
            check(before[i].first, runner.state[i].first, runner.cursors[i].first);
            check(before[i].second, runner.state[i].second, runner.cursors[i].second);
            EXPECT_EQ(runner.state[i].weight, before[i].weight);
            EXPECT_EQ(runner.cursors[i].weight, before[i].weight);
        }
        if (testing::Test::HasFailure()) FAIL() << "in step " << step;
    }
    EXPECT_GT(wraps, 1000u);
    std::printf("  1000 instances x 200 steps, %zu wraps or clamps; largest error of clips below 10 s %.1e s\n", wraps,
                worst_s);
}

TEST(Control, FindsTheRowsAtAndAroundEveryKey) {
    const Timelines timelines = make_timelines();
    std::vector<io::InstancePlayback> playbacks;
    const auto add = [&](uint32_t clip, float time_s) {
        // A device may flush subnormal numbers to 0
        if (std::fpclassify(time_s) == FP_SUBNORMAL) time_s = std::copysign(std::numeric_limits<float>::min(), time_s);
        for (const uint32_t loop : {0u, 1u})
            playbacks.push_back({{clip, loop, time_s, 0}, {clip, 1 - loop, time_s, 0}, 0.5f});
    };
    for (uint32_t clip = 0; clip < timelines.clips.size(); ++clip) {
        for (const float time_s : timelines.times_of(clip))
            for (const float at_s : {time_s, std::nextafter(time_s, -1.0f), std::nextafter(time_s, 1e9f)})
                add(clip, at_s);
        for (const float time_s : {0.0f, timelines.clips[clip].duration_s, -1.0f, 1e4f}) add(clip, time_s);
    }
    Runner runner(timelines, playbacks);
    runner.step(0);
    for (size_t i = 0; i < playbacks.size(); ++i) {
        check_cursor(timelines, runner.state[i].first, runner.cursors[i].first);
        check_cursor(timelines, runner.state[i].second, runner.cursors[i].second);
        const io::ClipPlay& was = playbacks[i].first;
        const float duration_s = timelines.clips[was.clip].duration_s;
        if (was.loop && was.time_s == duration_s) {
            EXPECT_EQ(runner.state[i].first.time_s, 0) << "t = D wraps to 0";
        }
        if (!was.loop) {
            EXPECT_EQ(runner.state[i].first.time_s, std::clamp(was.time_s, 0.0f, duration_s));
        }
        if (was.loop && was.time_s >= 0 && was.time_s < duration_s) {
            EXPECT_EQ(runner.state[i].first.time_s, was.time_s);
        }
    }
    std::printf("  %zu instances on and beside the keys of %zu axes\n", playbacks.size(), timelines.clips.size());
}

// Speeds and steps are finite, but their product need not be: the time stays within the clip, and comes back.
TEST(Control, OverflowingTimesStayInTheClip) {
    const Timelines timelines = make_timelines();
    Runner runner(timelines,
                  {{{0, 1, 0.5f, 3e38f}, {0, 0, 0.5f, 3e38f}, 1}, {{1, 1, 0.5f, -3e38f}, {1, 0, 0.5f, -3e38f}, 1}});
    for (const float step_s : {1000.0f, -1000.0f, 1e-39f}) {
        runner.step(step_s);
        for (size_t i = 0; i < 2; ++i)
            for (const io::ClipPlay& play : {runner.state[i].first, runner.state[i].second}) {
                EXPECT_GE(play.time_s, 0) << play.time_s;
                EXPECT_LE(play.time_s, timelines.clips[play.clip].duration_s);
            }
        check_cursor(timelines, runner.state[0].first, runner.cursors[0].first);
        check_cursor(timelines, runner.state[1].second, runner.cursors[1].second);
    }
}

// A workgroup covers 64 instances; writes for the others would change the guard words behind this one.
TEST(Control, ASingleInstanceWritesNothingBeyondItsSlot) {
    const Timelines timelines = make_timelines();
    Runner runner(timelines, {{{0, 1, 0.25f, 1}, {6, 0, 0, 0}, 1}});
    runner.step(0.5f);
    EXPECT_EQ(runner.state[0].first.time_s, 0.75f);
    check_cursor(timelines, runner.state[0].first, runner.cursors[0].first);
    check_cursor(timelines, runner.state[0].second, runner.cursors[0].second);
}

TEST(Control, TheReferenceWrapsAndClamps) {
    EXPECT_EQ(local_time_reference(2.5, 2, true), 0.5);
    EXPECT_EQ(local_time_reference(-0.5, 2, true), 1.5);
    EXPECT_EQ(local_time_reference(2, 2, true), 0);
    EXPECT_EQ(local_time_reference(4, 2, true), 0);
    EXPECT_EQ(local_time_reference(2, 2, false), 2);
    EXPECT_EQ(local_time_reference(2.5, 2, false), 2);
    EXPECT_EQ(local_time_reference(-0.5, 2, false), 0);
    EXPECT_EQ(local_time_reference(5, 0, true), 0);
    EXPECT_EQ(local_time_reference(5, 0, false), 0);
    EXPECT_LT(local_time_reference(-1e-30, 2, true), 2);
    const std::vector<float> times_s{1, 2, 4};
    const auto expect_rows = [&](double time_s, uint32_t earlier, uint32_t later, double fraction) {
        const RowCursor rows = find_rows_reference(times_s, time_s);
        EXPECT_EQ(rows.earlier, earlier);
        EXPECT_EQ(rows.later, later);
        EXPECT_EQ(rows.fraction, fraction);
    };
    expect_rows(0, 0, 0, 0);
    expect_rows(1, 0, 1, 0);
    expect_rows(2, 1, 2, 0);
    expect_rows(3.5, 1, 2, 0.75);
    expect_rows(4, 2, 2, 0);
    expect_rows(9, 2, 2, 0);
}

TEST(Control, InvalidPlaybacksAreRefused) {
    EXPECT_NO_THROW(check_playback({.first = {.clip = 1}, .weight = 0}, 2, "here"));
    EXPECT_NO_THROW(check_playback({}, 0, "here"));
    EXPECT_THROW(check_playback({.first = {.clip = 2}}, 2, "here"), Failure);
    EXPECT_THROW(check_playback({.second = {.clip = 2}}, 2, "here"), Failure);
    EXPECT_THROW(check_playback({.second = {.time_s = std::numeric_limits<double>::infinity()}}, 2, "here"), Failure);
    EXPECT_THROW(check_playback({.weight = std::numeric_limits<float>::quiet_NaN()}, 2, "here"), Failure);
    try {
        check_playback({.weight = -1}, 2, "here");
    } catch (const Failure& failure) {
        EXPECT_EQ(failure.error.place, "here");
        EXPECT_EQ(failure.error.code, ErrorCode::kInvalidArgument);
    }
}

}  // namespace
}  // namespace throng
