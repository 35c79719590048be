#include "draw/draw_timer.h"

namespace throng {

DrawTimer::DrawTimer(const std::shared_ptr<Gpu>& gpu) {
    constexpr uint32_t kStamps = 4;
    if (gpu->has_timestamps()) stamps_.emplace(gpu, kStamps);
}

void DrawTimer::begin_occluders(VkCommandBuffer commands) {
    has_occluders_ = true;
    if (stamps_) stamps_->begin(commands);
    write(commands);
}

void DrawTimer::begin(VkCommandBuffer commands) {
    if (!has_occluders_) {
        begin_occluders(commands);
        end_occluders(commands);
    }
    has_occluders_ = false;
    write(commands);
}

void DrawTimer::end(VkCommandBuffer commands) {
    write(commands);
    if (stamps_) stamps_->publish(commands);
}

void DrawTimer::write(VkCommandBuffer commands) {
    if (stamps_) stamps_->write(commands);
}

double DrawTimer::read_ms() const {
    const std::optional<Timestamps::Frame> frame = stamps_ ? stamps_->newest() : std::nullopt;
    return frame ? (frame->ms[1] - frame->ms[0]) + (frame->ms[3] - frame->ms[2]) : 0;
}

}  // namespace throng
