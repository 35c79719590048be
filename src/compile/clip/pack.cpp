#include "compile/clip/pack.h"

#include "base/failure.h"
#include "base/message_name.h"
#include "base/processor.h"
#include "compile/clip/clip_grid.h"
#include "compile/clip/clip_packer.h"
#include "compile/clip/packed_clip_writer.h"
#include "compile/limits.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <exception>
#include <future>
#include <mutex>
#include <system_error>
#include <utility>

namespace throng {

void check_error_bound(double error, const std::string& place) {
    if (error == 0 || (error >= 1e-6 && error <= 0.1)) return;
    char text[32];
    std::snprintf(text, sizeof(text), "%g", error);
    throw Failure(
        ErrorCode::kInvalidArgument, place,
        std::string("the error bound is ") + text + "; it must be 0 (exact) or 1e-6 to 0.1 of the character's size");
}

// What the threads share.
class ClipPacking::Work {
public:
    Work(std::span<const ExactClip> clips, double error, Character& character, const Progress& progress)
        : clips_(clips),
          character_(character),
          progress_(progress),
          row_count_(count_rows(clips, character)),
          boxes_(influence_boxes(character)),
          settings_{error * double{character.size},
                    std::min(GridSettings().joint_rows, kPackingLimit / std::max<size_t>(1, clips.size()))},
          writer_(clips, error, character) {
        constexpr size_t kMaxThreads = 3;  // beside the calling one; for a long clip each may hold some 400 MB
        const size_t thread_count = std::min({clips.size(), kMaxThreads, size_t{processor_threads()} - 1});
        try {
            for (size_t i = 0; i < thread_count; ++i)
                threads_.push_back(std::async(std::launch::async, [this] { pack(); }));
        } catch (const std::system_error&) {
            // The system can start no more threads: those that run do all of the work
        }
    }
    ~Work() { next_ = clips_.size(); }

    void finish() {
        constexpr std::chrono::milliseconds kReportInterval(10);
        pack();
        for (std::future<void>& thread : threads_) {
            while (thread.wait_for(kReportInterval) != std::future_status::ready)
                attempt(clips_.size(), [&] { report(); });
            thread.get();
        }
        if (failure_) std::rethrow_exception(failure_);
        writer_.finish();
    }

private:
    static uint64_t count_rows(std::span<const ExactClip> clips, const Character& character) {
        uint64_t row_count = 0;
        for (const ExactClip& clip : clips) row_count += clip.times_s.size();
        const uint64_t joint_rows = row_count * character.rig.joint_count();
        if (joint_rows > kPackingLimit)
            throw Failure(ErrorCode::kLimit, message_name(character.name), "its clips have ", joint_rows,
                          " poses of a joint (rows times joints); the limit for packing is ", kPackingLimit,
                          "; exact keys have no such limit (error 0, or --error exact)");
        return row_count;
    }

    void report() const { progress_.report(rows_done_, row_count_); }

    // Clips do not depend on each other: the result is the same with any number of threads.
    void pack() {
        for (size_t clip = next_++; clip < clips_.size(); clip = next_++) {
            attempt(clip, [&] {
                report();
                writer_.add(static_cast<uint32_t>(clip),
                            pack_clip(character_, clips_[clip], boxes_, settings_, progress_));
                rows_done_ += clips_[clip].times_s.size();
            });
        }
    }

    // A failure of `work` is kept, to be reported when all threads have ended.
    template <class Body>
    void attempt(size_t clip, const Body& work) {
        try {
            work();
        } catch (const Failure& failure) {
            fail(clip, failure.error.code == ErrorCode::kCancelled);
        } catch (...) {
            fail(clip, false);
        }
    }

    // Begins no more clips. Those before `clip` have begun, so that the failure of the first is reported whichever
    // thread is the fastest. That the call was cancelled is reported last: the failure of a hook cancels the others.
    void fail(size_t clip, bool is_cancelled) {
        next_ = clips_.size();
        const std::lock_guard lock(failing_);
        if (failure_ && failed_ < std::pair(is_cancelled, clip)) return;
        failed_ = {is_cancelled, clip};
        failure_ = std::current_exception();
    }

    const std::span<const ExactClip> clips_;
    const Character& character_;
    const Progress progress_;
    const uint64_t row_count_;
    const std::vector<Box> boxes_;
    const PackSettings settings_;
    PackedClipWriter writer_;
    std::atomic<size_t> next_ = 0, rows_done_ = 0;
    std::mutex failing_;
    std::pair<bool, size_t> failed_;  // whether it was only cancelled, and the clip
    std::exception_ptr failure_;
    // Destroyed first: the destructor of a future waits for its thread.
    std::vector<std::future<void>> threads_;
};

ClipPacking::ClipPacking(std::span<const ExactClip> clips, double error, Character& character, const Progress& progress)
    : work_(std::make_unique<Work>(clips, error, character, progress)) {}

ClipPacking::~ClipPacking() = default;

void ClipPacking::finish() { work_->finish(); }

}  // namespace throng
