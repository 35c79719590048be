// Ctrl-C in work that is worth finishing a piece of.
#pragma once

#include <csignal>

namespace throng::tools {

// While one lives, SIGINT and SIGTERM are only noted; a second one ends the program. What was ignored stays ignored.
class Interruption {
public:
    Interruption() : before_{take(SIGINT), take(SIGTERM)} {}
    ~Interruption() {
        std::signal(SIGINT, before_[0]);
        std::signal(SIGTERM, before_[1]);
    }
    Interruption(const Interruption&) = delete;
    Interruption& operator=(const Interruption&) = delete;

    bool is_asked_for() const { return is_noted_ != 0; }

private:
    using Handler = void (*)(int);
    static Handler take(int signal) {
        const Handler before = std::signal(signal, note);
        if (before == SIG_IGN) std::signal(signal, SIG_IGN);
        return before;
    }
    static void note(int signal) {
        is_noted_ = 1;
        std::signal(signal, SIG_DFL);
    }

    inline static volatile std::sig_atomic_t is_noted_ = 0;
    Handler before_[2];
};

}  // namespace throng::tools
