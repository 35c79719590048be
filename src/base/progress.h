// LoadHooks inside throng: a range of a call's work, and whether the call is to continue.
#pragma once

#include <throng/load_hooks.h>

#include <cstdint>
#include <memory>

namespace throng {

// Can be copied, and used by any thread: those that the calling thread has started learn from it that they are to end.
class Progress {
public:
    Progress() = default;  // reports to nobody, and is never cancelled
    // The whole of a call that begins on this thread, the only one on which the hooks are called. Keeps a reference.
    explicit Progress(const LoadHooks& hooks);

    // What lies between two parts of this range, each 0..1, as a range of its own.
    Progress between(double begin, double end) const;

    // Throws kCancelled where the call is to end.
    void poll() const;
    // For loops of short steps, at each of them.
    void poll_at(uint64_t step) const {
        if (step % kStepsBetweenPolls == 0) poll();
    }
    // As poll(); on the calling thread it also tells the hook that this part of the range, 0..1, is done.
    void report(double part_done) const;
    void report(uint64_t done, uint64_t of) const { report(static_cast<double>(done) / static_cast<double>(of)); }

private:
    static constexpr uint64_t kStepsBetweenPolls = 1 << 14;

    struct State;
    std::shared_ptr<State> state_;  // of all ranges of a call
    double begin_ = 0, end_ = 1;    // in the whole
};

}  // namespace throng
