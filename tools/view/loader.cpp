#include "tools/view/loader.h"

#include "tools/cli/command.h"

namespace throng::view {

void Loader::start(std::vector<std::string> files, const CompileSettings& settings) {
    future_ = std::async(std::launch::async,
                         [files = std::move(files), settings] { return tools::load_characters(files, settings); });
}

std::optional<std::vector<Character>> Loader::take(bool waits) {
    if (!future_.valid() || (!waits && future_.wait_for(std::chrono::seconds(0)) != std::future_status::ready))
        return std::nullopt;
    return future_.get();
}

}  // namespace throng::view
