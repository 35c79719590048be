#include "base/progress.h"

#include "base/failure.h"

#include <atomic>
#include <cmath>
#include <thread>

namespace throng {

struct Progress::State {
    explicit State(const LoadHooks& of) : hooks(of) {}

    bool is_calling_thread() const { return std::this_thread::get_id() == thread; }
    // An exception from a hook ends the work of the other threads too.
    template <class Hook>
    void call(const char* name, const Hook& hook) {
        try {
            call_application("", name, hook);
        } catch (...) {
            ends = true;
            throw;
        }
    }

    const LoadHooks& hooks;
    const std::thread::id thread = std::this_thread::get_id();
    std::atomic<bool> ends{false};
    double reported = -1;
};

Progress::Progress(const LoadHooks& hooks)
    : state_(hooks.progress || hooks.is_cancelled ? std::make_shared<State>(hooks) : nullptr) {}

Progress Progress::between(double begin, double end) const {
    Progress part = *this;
    part.begin_ = std::lerp(begin_, end_, begin);
    part.end_ = std::lerp(begin_, end_, end);
    return part;
}

void Progress::poll() const {
    if (!state_) return;
    State& state = *state_;
    if (state.hooks.is_cancelled && !state.ends && state.is_calling_thread())
        state.call("is_cancelled", [&] {
            if (state.hooks.is_cancelled()) state.ends = true;
        });
    if (state.ends) throw Failure(ErrorCode::kCancelled, "", "cancelled");
}

void Progress::report(double part_done) const {
    poll();
    if (!state_ || !state_->hooks.progress || !state_->is_calling_thread()) return;
    const double part = std::lerp(begin_, end_, part_done);
    if (part <= state_->reported) return;
    state_->reported = part;
    state_->call("progress", [&] { state_->hooks.progress(part); });
}

}  // namespace throng
