#include "crowd/placement_stage.h"

#include "base/finite.h"
#include "crowd/change_stage.h"
#include "crowd/state_archive.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace throng {

io::RootState standing_at(const Affine& world_from_model) {
    io::RootState root{.move = {0, 0, 1, 0}, .place = {0, 0, 1, 0}, .base = {}};
    std::memcpy(root.base, &world_from_model, sizeof root.base);
    return root;
}

void PlacementStage::plan(BatchPlan& plan) {
    plan.add_table<Affine>(io::kPlacementsBuffer);
    plan.add_host(sizeof(placements_[0]) + sizeof(set_for_[0]));
}

PlacementStage::PlacementStage(const StageContext& context)
    : Stage(context),
      placements_(context.instance_count),
      set_for_(context.instance_count),
      population_(*find_stage<PopulationStage>(context.before)) {
    dirty_.add(0, context.instance_count);
}

void PlacementStage::set(const Instances& instances, const Each<Affine>& world_from_model) {
    for (uint32_t i = 0; i < instances.size(); ++i) {
        placements_[instances.number(i)] = world_from_model[i];
        set_for_[instances.number(i)] = update_count_ + 1;
        dirty_.add(instances.number(i), 1);
    }
}

void PlacementStage::follow(bool wait) {
    if (followed_ && (knows_earlier_ || !wait)) return;
    std::vector<FollowedBatch> moving;
    for (size_t i = 0; i < batches_.size(); ++i)
        if (const Group& group = group_of(batches_[i]); group.moves_placements())
            moving.push_back({i, group.shaders_populate});
    if (moving.empty()) return;
    if (!followed_) {
        followed_.emplace(gpu_, batches_, moving);
        knows_earlier_ = update_count_ == 0;
    }
    if (knows_earlier_ || !wait) return;
    for (const FollowedBatch& of : moving) {
        const Batch& batch = batches_[of.batch];
        if (!batch.has_updated) continue;
        const auto births = of.has_births ? download<uint32_t>(gpu_, BufferRange(batch[io::kBirthsBuffer], 0,
                                                                                 followed_->birth_bytes(of)))
                                          : std::vector<uint32_t>();
        take_over(batch,
                  download<Affine>(gpu_, BufferRange(batch[io::kPlacementsBuffer], 0, followed_->placement_bytes(of))),
                  births, update_count_);
    }
    knows_earlier_ = true;
}

void PlacementStage::follow_like(const PlacementStage& before) {
    if (!before.followed_) return;
    follow(false);
    knows_earlier_ = before.knows_earlier_;
}

const std::vector<Affine>& PlacementStage::known() {
    const uint64_t update = followed_ ? followed_->take_newest() : 0;
    if (update == 0) return placements_;
    followed_->for_each([&](const Batch& batch, std::span<const Affine> moved, std::span<const uint32_t> births) {
        take_over(batch, moved, births, update);
    });
    knows_earlier_ = true;
    return placements_;
}

void PlacementStage::take_over(const Batch& batch, std::span<const Affine> moved, std::span<const uint32_t> births,
                               uint64_t update) {
    if (!births.empty()) population_.take_over(batch, births);
    for (uint32_t i = 0; i < moved.size(); ++i)
        if (const uint32_t instance = batch.first_instance + i; set_for_[instance] <= update)
            placements_[instance] = moved[i];
}

void PlacementStage::begin(const Update& update) {
    for (Batch& batch : batches_) batch.is_moved = false;
    const std::span<const DirtyRanges::Range> ranges = dirty_.take();
    for_each_part(batches_, ranges, [&](const Batch& batch, uint32_t first, uint32_t count) {
        batches_[batch_index_of(batches_, first)].is_moved = true;
        const uint32_t first_of_batch = first - batch.first_instance;
        update.changes->write(update, ranges.size(), batch, io::kPlacementsBuffer, first_of_batch,
                              std::span<const Affine>(placements_).subspan(first, count));
        if (!batch[io::kRootsBuffer]) return;
        std::vector<io::RootState> roots;
        for (uint32_t i = first; i < first + count; ++i) roots.push_back(standing_at(placements_[i]));
        update.changes->write(update, ranges.size(), batch, io::kRootsBuffer, first_of_batch,
                              std::span<const io::RootState>(roots));
        if (!batch[io::kRootRemaindersBuffer]) return;
        update.changes->write(update, ranges.size(), batch, io::kRootRemaindersBuffer, first_of_batch,
                              std::span<const io::vec2>(std::vector<io::vec2>(count)));
    });
    for (Batch& batch : batches_) batch.move_count += batch.is_moved;
    ++update_count_;
    if (followed_) followed_->begin(update_count_);
}

void PlacementStage::end(VkCommandBuffer commands) {
    if (followed_) followed_->end(commands);
}

void PlacementStage::discard() {
    dirty_.put_back();
    // What has been set since is taken up by the next update, which will have this number.
    for (uint32_t& update : set_for_) update = std::min(update, update_count_);
    --update_count_;
    if (followed_) followed_->discard();
}

// Copies under way have the numbers of the old updates: they are dropped, and placements are not followed until
// follow() is called again.
void PlacementStage::exchange(StateArchive& archive) {
    archive.value(update_count_);
    if (!archive.reads()) return;
    followed_.reset();
    knows_earlier_ = false;
}

void PlacementStage::exchange_group(StateArchive& archive, uint32_t group) {
    for_each_batch_of(group, [&](Batch& batch, uint32_t) {
        const auto placements = std::span(placements_).subspan(batch.first_instance, batch.instance_count);
        archive.values(placements);
        archive.values(std::span(set_for_).subspan(batch.first_instance, batch.instance_count));
        archive.changes(dirty_, batch.first_instance, batch.instance_count);
        if (!archive.reads()) return;
        StateArchive::require(std::ranges::all_of(placements, [](const Affine& at) { return all_finite(at); }),
                              "a placement is not finite");
        ++batch.move_count;
    });
}

}  // namespace throng
