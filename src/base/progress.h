// LoadHooks inside throng: reports the progress of a part of a call's work, and tells whether the call was cancelled.
#pragma once

#include <throng/load_hooks.h>

#include <cstdint>
#include <memory>

namespace throng {

// Can be copied and used on any thread, so that worker threads of the call also see that it was cancelled.
class Progress {
public:
    Progress() = default;  // reports nothing and is never cancelled
    // All the work of a call that begins on this thread; hooks are called only on this thread. Keeps a reference.
    explicit Progress(const LoadHooks& hooks);

    // The sub-range from `begin` to `end`, both as fractions 0..1 of this range.
    Progress between(double begin, double end) const;

    // Throws kCancelled if the call was cancelled.
    void poll() const;
    // For loops of short steps: call it at each step.
    void poll_at(uint64_t step) const {
        if (step % kStepsBetweenPolls == 0) poll();
    }
    // Like poll(); on the calling thread it also calls the progress hook. `part_done`: fraction of this range, 0..1.
    void report(double part_done) const;
    void report(uint64_t done, uint64_t of) const { report(static_cast<double>(done) / static_cast<double>(of)); }

private:
    static constexpr uint64_t kStepsBetweenPolls = 1 << 14;

    struct State;
    std::shared_ptr<State> state_;  // shared by all ranges of a call
    double begin_ = 0, end_ = 1;    // of this range, as fractions of the whole call
};

}  // namespace throng
