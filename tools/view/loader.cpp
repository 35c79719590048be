#include "tools/view/loader.h"

#include "tools/cli/command.h"

#include <chrono>
#include <utility>

namespace throng::view {

void Loader::start(std::vector<std::string> files, const CompileSettings& settings) {
    cancel();
    job_ = std::make_shared<Job>();
    future_ = std::async(std::launch::async,
                         [before = std::move(future_), files = std::move(files), settings, job = job_]() mutable {
                             before = {};  // waits: the characters of two loads need not fit into memory together
                             const LoadHooks hooks{.progress = [&](double part_done) { job->part_done = part_done; },
                                                   .is_cancelled = [&] { return job->is_cancelled.load(); }};
                             return tools::load_characters(files, settings, hooks);
                         });
}

std::optional<std::vector<Character>> Loader::take(bool waits) {
    if (!future_.valid() || (!waits && future_.wait_for(std::chrono::seconds(0)) != std::future_status::ready))
        return std::nullopt;
    return future_.get();
}

}  // namespace throng::view
