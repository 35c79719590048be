// Which instances exist. The stage numbers updates, and tells kernels in which update an instance of a group with
// CrowdGroup::capacity was born, so that they start it afresh.
#pragma once

#include "crowd/batch_plan.h"
#include "crowd/dirty_ranges.h"
#include "crowd/instance_numbers.h"
#include "crowd/stage.h"

#include <throng/population.h>

#include <deque>
#include <unordered_map>

namespace throng {

// The settings with what others imply: a group's capacity, if it has one, as its instance_count, and culling where a
// group needs it. Throws kInvalidArgument where capacity, ShaderCommands::populate and instance_count do not go
// together.
CrowdSettings with_implied(CrowdSettings settings);

// The name of an instance in messages.
std::string name_of(const InstanceHandle& handle);

class PopulationStage : public Stage {
public:
    static void plan(BatchPlan& plan);
    explicit PopulationStage(const StageContext& context);

    // A group that is made with the crowd: spawns the instances that CrowdGroup::instance_count asks for.
    void begin_group(uint32_t group);
    // A group that comes from another crowd: its instances count as born in the next update, and get generations that
    // no handle of an earlier group has.
    void join_group(uint32_t group);
    // A group that is about to be removed: remembers its generations, for feedback of updates that are under way.
    void end_group(uint32_t group);
    // The numbers of new instances of a group, in the crowd. Throws kLimit where there is no room for all.
    std::vector<uint32_t> spawn(uint32_t group, uint32_t count);
    void despawn(std::span<const InstanceHandle> gone) override;

    // Whether the instance of this handle exists, as far as the CPU knows. `batch`: the one that has the handle's
    // number.
    bool is_alive(const Batch& batch, const InstanceHandle& handle) const;
    // `instance` must belong to a group.
    bool has_instance(uint32_t instance) const;
    uint32_t generation(uint32_t instance) const;
    // The generation of the instance that had the number in one of the last few updates; updates are counted from 1.
    uint32_t generation_at(uint32_t instance, uint64_t update) const;
    uint32_t alive_count(uint32_t group) const;
    uint64_t update_count() const { return update_number_; }
    // Takes over the births of a batch that shaders populate, as an update that has run left them.
    void take_over(const Batch& batch, std::span<const uint32_t> births);

    void begin(const Update& update) override;
    void discard() override;
    void exchange(StateArchive& archive) override;
    void exchange_group(StateArchive& archive, uint32_t group) override;
    uint32_t end_count() const override { return 0; }

private:
    struct Population {
        uint32_t first_instance = 0;
        uint32_t generation = 0;  // that instances begin with, and keep if the group has no capacity
        // If instances come and go
        InstanceNumbers numbers;
        // For each number, the number of the update that its instance was born in, as kernels know it; 0 if it is free
        std::vector<uint32_t> births;
        std::vector<uint32_t> generations;
        bool is_of_shaders = false;  // ShaderCommands::populate: `births` are those read back last
    };
    // Instances removed after this update and before the next. If several had the same number, it is the first: the
    // others were in no update.
    struct Deaths {
        uint64_t update = 0;
        std::unordered_map<uint32_t, uint32_t> generations;  // by their numbers in the crowd
    };
    Deaths& deaths_after_last_update();
    const Population& population_of(uint32_t instance) const;
    static uint32_t generation(const Population& population, uint32_t instance);
    void update_batches() const;

    bool has_feedback_;
    std::vector<Population> populations_;  // [group]
    uint32_t next_generation_ = 0;         // of groups to come: above those of groups that have gone
    std::deque<Deaths> deaths_;            // where there is feedback: of the last few updates, oldest first
    uint64_t update_number_ = 0;           // of the last update
    DirtyRanges dirty_;
};

}  // namespace throng
