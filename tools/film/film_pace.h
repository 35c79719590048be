// How long a film will still take.
#pragma once

#include <cstddef>

namespace throng::tools {

// Frames that are only stepped over take a fraction of the time of those that are drawn, so each kind has its own mean.
class FilmPace {
public:
    void drew(double frame_s) { drawn_.add(frame_s); }
    void skipped(double frame_s) { skipped_.add(frame_s); }

    // The time for these numbers of frames, by each kind's mean so far. A kind that has had no frames yet counts as
    // nothing.
    double left_s(size_t to_draw, size_t to_skip) const { return drawn_.left_s(to_draw) + skipped_.left_s(to_skip); }

private:
    struct Kind {
        void add(double frame_s) {
            passed_s += frame_s;
            ++count;
        }
        double left_s(size_t frames) const {
            return count == 0 ? 0 : passed_s / static_cast<double>(count) * static_cast<double>(frames);
        }

        double passed_s = 0;
        size_t count = 0;
    };
    Kind drawn_, skipped_;
};

}  // namespace throng::tools
