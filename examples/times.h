// How long calls take: processor time of the calling thread, and wall-clock time, which includes time in which other
// threads had the processor.
#pragma once

#include <throng/throng.h>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <utility>
#include <vector>

inline double now_ms(clockid_t clock) {
    timespec now{};
    clock_gettime(clock, &now);
    return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

struct Elapsed {
    double own_ms = 0, clock_ms = 0;
};

class Stopwatch {
public:
    Elapsed elapsed() const { return {now_ms(CLOCK_THREAD_CPUTIME_ID) - own_ms_, now_ms(CLOCK_MONOTONIC) - clock_ms_}; }

private:
    double own_ms_ = now_ms(CLOCK_THREAD_CPUTIME_ID), clock_ms_ = now_ms(CLOCK_MONOTONIC);
};

// A crowd that times each call made through `->`, up to the end of the expression. `*` gives the crowd itself, for
// calls that take less time than timing them, and for calls that no frame waits for.
class TimedCrowd {
public:
    explicit TimedCrowd(throng::Crowd crowd) : crowd_(std::move(crowd)) {}

    class Call {
    public:
        explicit Call(TimedCrowd& of) : of_(of) {}
        ~Call() { of_.calls.push_back(stopwatch_.elapsed()); }
        Call(const Call&) = delete;
        throng::Crowd* operator->() { return &of_.crowd_; }

    private:
        TimedCrowd& of_;
        Stopwatch stopwatch_;
    };
    Call operator->() { return Call(*this); }
    throng::Crowd& operator*() { return crowd_; }

    std::vector<Elapsed> calls;

private:
    throng::Crowd crowd_;
};

inline void print(const char* what, std::vector<Elapsed> all) {
    std::printf("%-28s", what);
    for (double Elapsed::*const ms : {&Elapsed::own_ms, &Elapsed::clock_ms}) {
        std::ranges::sort(all, {}, ms);
        std::printf("  median %.3f, worst %.3f", all[all.size() / 2].*ms, all.back().*ms);
    }
    std::printf("\n");
}
