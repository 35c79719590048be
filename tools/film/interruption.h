// Ctrl-C in work that should finish its current piece first.
#pragma once

#include <time.h>

#include <array>
#include <csignal>

namespace throng::tools {

// While an object lives, SIGINT, SIGTERM and SIGHUP are only noted; a second signal, half a second later or more, ends
// the program. (A sooner one is the same request: timeout(1) signals a process and then its group.) Signals that were
// ignored stay ignored.
class Interruption {
public:
    Interruption() {
        for (size_t i = 0; i < kSignals.size(); ++i) before_[i] = take(kSignals[i]);
    }
    ~Interruption() {
        for (size_t i = 0; i < kSignals.size(); ++i) std::signal(kSignals[i], before_[i]);
    }
    Interruption(const Interruption&) = delete;
    Interruption& operator=(const Interruption&) = delete;

    bool is_asked_for() const { return is_noted_ != 0; }

private:
    using Handler = void (*)(int);
    static constexpr std::array kSignals{SIGINT, SIGTERM, SIGHUP};
    static Handler take(int signal) {
        const Handler before = std::signal(signal, note);
        if (before == SIG_IGN) std::signal(signal, SIG_IGN);
        return before;
    }
    static void note(int signal) {
        timespec now{};
        clock_gettime(CLOCK_MONOTONIC, &now);
        const double since = double(now.tv_sec - noted_at_.tv_sec) + 1e-9 * double(now.tv_nsec - noted_at_.tv_nsec);
        if (!is_noted_) {
            noted_at_ = now;
            is_noted_ = 1;
        } else if (since >= 0.5) {
            std::signal(signal, SIG_DFL);
            std::raise(signal);
        }
    }

    inline static volatile std::sig_atomic_t is_noted_ = 0;
    inline static timespec noted_at_{};
    std::array<Handler, kSignals.size()> before_{};
};

}  // namespace throng::tools
