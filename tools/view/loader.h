// Reads files in the background, so that the window stays responsive.
#pragma once

#include <throng/character.h>

#include <atomic>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace throng::view {

class Loader {
public:
    Loader() = default;
    // Cancels what is being read, and waits until it has ended.
    ~Loader() { cancel(); }
    Loader(const Loader&) = delete;
    Loader& operator=(const Loader&) = delete;

    // Replaces what is being read, which is cancelled; does not wait for it.
    void start(std::vector<std::string> files, const CompileSettings& settings);
    bool is_busy() const { return future_.valid(); }
    // The part of the work (reading and compiling) that is done for the files of the last start(), 0..1.
    double part_done() const { return job_->part_done; }

    // Returns what has been read, once; nothing while reading goes on, unless `waits`. Throws a CommandError if a file
    // is wrong.
    std::optional<std::vector<Character>> take(bool waits);

private:
    struct Job {
        std::atomic<bool> is_cancelled{false};
        std::atomic<double> part_done{0};
    };
    void cancel() {
        if (job_) job_->is_cancelled = true;
    }

    std::shared_ptr<Job> job_;
    std::future<std::vector<Character>> future_;  // its destructor waits
};

}  // namespace throng::view
