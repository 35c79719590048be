#include "crowd/population_stage.h"

#include "base/failure.h"
#include "crowd/change_stage.h"
#include "crowd/state_archive.h"

#include <algorithm>

namespace throng {
namespace {

constexpr uint64_t kUpdatesRemembered = 8;  // at least as many as feedback() may lag behind

// Never 0, which marks a number that is free.
uint32_t birth_of(uint64_t update) { return static_cast<uint32_t>(1 + update % UINT32_MAX); }

}  // namespace

std::string name_of(const InstanceHandle& handle) {
    return "instance " + std::to_string(handle.instance) + " of generation " + std::to_string(handle.generation);
}

CrowdSettings with_implied(CrowdSettings settings) {
    for (CrowdGroup& group : settings.groups) {
        if (group.shader_commands && group.shader_commands->populate && group.instance_count > 0)
            throw Failure(ErrorCode::kInvalidArgument, "crowd: shader_commands",
                          "with `populate`, instance_count must be 0, but is " + std::to_string(group.instance_count) +
                              ": only shaders spawn instances of the group");
        if ((group.capacity > 0 || group.skin_pool) && !settings.culling) settings.culling.emplace();
        if (group.capacity == 0) continue;
        if (group.capacity < group.instance_count)
            throw Failure(ErrorCode::kInvalidArgument, "crowd: capacity",
                          std::to_string(group.capacity) + " is below the group's instance_count of " +
                              std::to_string(group.instance_count));
        group.instance_count = group.capacity;
    }
    return settings;
}

void PopulationStage::plan(BatchPlan& plan) {
    if (!plan.group().varies) return;
    plan.add_filled_table(io::kBirthsBuffer, std::vector<uint32_t>(1));
    plan.add_host(sizeof(Population::births[0]) + sizeof(Population::generations[0]));
}

PopulationStage::PopulationStage(const StageContext& context)
    : Stage(context), has_feedback_(context.feedback), populations_(groups_.size()) {
    std::vector<uint32_t> counts(groups_.size());
    for (const Batch& batch : batches_) {
        if (counts[batch.group] == 0) populations_[batch.group].first_instance = batch.first_instance;
        counts[batch.group] += batch.instance_count;
    }
    for (size_t i = 0; i < groups_.size(); ++i) {
        if (!groups_[i].varies) continue;
        Population& population = populations_[i];
        population.numbers = InstanceNumbers(counts[i]);
        population.births.resize(counts[i]);
        population.generations.resize(counts[i]);
        population.is_of_shaders = groups_[i].shaders_populate;
    }
}

void PopulationStage::begin_group(uint32_t group) {
    if (groups_[group].varies) spawn(group, groups_[group].initial_count);
}

void PopulationStage::join_group(uint32_t group) {
    Population& population = populations_[group];
    if (population.is_of_shaders) return;  // whose instances have no handles
    population.generation += next_generation_;
    for (uint32_t& generation : population.generations) generation += next_generation_;
    for (uint32_t& birth : population.births)
        if (birth != 0) birth = birth_of(update_number_ + 1);
}

// Feedback of updates under way may still name its instances.
void PopulationStage::end_group(uint32_t group) {
    const Population& population = populations_[group];
    next_generation_ = std::max(next_generation_, population.generation + 1);
    for (const uint32_t generation : population.generations)
        next_generation_ = std::max(next_generation_, generation + 1);
    if (!has_feedback_) return;
    std::unordered_map<uint32_t, uint32_t>& gone = deaths_after_last_update().generations;
    for_each_batch_of(group, [&](const Batch& batch, uint32_t) {
        for (uint32_t i = batch.first_instance; i < batch.first_instance + batch.instance_count; ++i)
            gone.try_emplace(i, generation(i));
    });
}

const PopulationStage::Population& PopulationStage::population_of(uint32_t instance) const {
    return populations_[batches_[batch_index_of(batches_, instance)].group];
}

std::vector<uint32_t> PopulationStage::spawn(uint32_t group, uint32_t count) {
    Population& population = populations_[group];
    InstanceNumbers& numbers = population.numbers;
    if (count > numbers.free_count())
        throw Failure(ErrorCode::kLimit, groups_[group].name + ": spawn",
                      std::to_string(count) + " instances, but CrowdGroup::capacity leaves room for " +
                          std::to_string(numbers.free_count()));
    std::vector<uint32_t> instances;
    instances.reserve(count);
    for (uint32_t i = 0; i < count; ++i) {
        const uint32_t number = numbers.take(), instance = population.first_instance + number;
        population.births[number] = birth_of(update_number_ + 1);
        dirty_.add(instance, 1);
        instances.push_back(instance);
    }
    return instances;
}

PopulationStage::Deaths& PopulationStage::deaths_after_last_update() {
    if (deaths_.empty() || deaths_.back().update != update_number_)
        deaths_.push_back({.update = update_number_, .generations = {}});
    return deaths_.back();
}

void PopulationStage::despawn(std::span<const InstanceHandle> gone) {
    for (const auto& [instance, known_generation] : gone) {
        Population& population = populations_[batches_[batch_index_of(batches_, instance)].group];
        const uint32_t number = instance - population.first_instance;
        if (has_feedback_) deaths_after_last_update().generations.try_emplace(instance, known_generation);
        ++population.generations[number];
        population.births[number] = 0;
        population.numbers.give_back(number);
        dirty_.add(instance, 1);
    }
}

bool PopulationStage::is_alive(const Batch& batch, const InstanceHandle& handle) const {
    const Population& population = populations_[batch.group];
    if (population.births.empty()) return handle.generation == population.generation;
    const uint32_t number = handle.instance - population.first_instance;
    return !population.is_of_shaders && population.births[number] != 0 &&
           population.generations[number] == handle.generation;
}

bool PopulationStage::has_instance(uint32_t instance) const {
    const Population& population = population_of(instance);
    return population.births.empty() || population.births[instance - population.first_instance] != 0;
}

uint32_t PopulationStage::generation(uint32_t instance) const { return generation(population_of(instance), instance); }

uint32_t PopulationStage::generation(const Population& population, uint32_t instance) {
    return population.generations.empty() ? population.generation
                                          : population.generations[instance - population.first_instance];
}

uint32_t PopulationStage::generation_at(uint32_t instance, uint64_t update) const {
    for (const Deaths& deaths : deaths_) {
        if (deaths.update < update) continue;
        const auto found = deaths.generations.find(instance);
        if (found != deaths.generations.end()) return found->second;
    }
    const Batch* const batch = batch_at(batches_, instance);
    return batch ? generation(populations_[batch->group], instance) : 0;
}

uint32_t PopulationStage::alive_count(uint32_t group) const {
    const InstanceNumbers& numbers = populations_[group].numbers;
    return numbers.capacity() - numbers.free_count();
}

void PopulationStage::take_over(const Batch& batch, std::span<const uint32_t> births) {
    Population& population = populations_[batch.group];
    std::ranges::copy(births, population.births.begin() + (batch.first_instance - population.first_instance));
}

// Kernels go no further than the last instance that exists, if the CPU knows which one that is.
void PopulationStage::update_batches() const {
    for (Batch& batch : batches_) {
        const Population& population = populations_[batch.group];
        if (population.numbers.capacity() == 0) continue;
        batch.birth = birth_of(update_number_);
        if (population.is_of_shaders) continue;
        const uint32_t first = batch.first_instance - population.first_instance, end = population.numbers.end();
        batch.used_count = std::clamp(end, first, first + batch.instance_count) - first;
    }
}

void PopulationStage::begin(const Update& update) {
    ++update_number_;
    while (!deaths_.empty() && deaths_.front().update + kUpdatesRemembered < update_number_) deaths_.pop_front();
    update_batches();
    const std::span<const DirtyRanges::Range> ranges = dirty_.take();
    for_each_part(batches_, ranges, [&](const Batch& batch, uint32_t first, uint32_t count) {
        const Population& population = populations_[batch.group];
        update.changes->write(
            update, ranges.size(), batch, io::kBirthsBuffer, first - batch.first_instance,
            std::span<const uint32_t>(population.births).subspan(first - population.first_instance, count));
    });
}

// The next update gets the number of this one, so the births of instances born in it stay right.
void PopulationStage::discard() {
    dirty_.put_back();
    // Instances spawned since then have the birth of the update after it. They are born in the next update, which gets
    // the number of the discarded one.
    for (Population& population : populations_)
        std::ranges::replace(population.births, birth_of(update_number_ + 1), birth_of(update_number_));
    const uint64_t discarded = update_number_--;
    if (deaths_.empty() || deaths_.back().update != discarded) return;
    std::unordered_map<uint32_t, uint32_t> generations = std::move(deaths_.back().generations);
    deaths_.pop_back();
    deaths_after_last_update().generations.merge(generations);
}

void PopulationStage::exchange(StateArchive& archive) {
    archive.value(update_number_);
    archive.value(next_generation_);
    auto death_count = static_cast<uint64_t>(deaths_.size());
    archive.value(death_count);
    if (archive.reads()) {
        StateArchive::require(death_count <= kUpdatesRemembered + 1,
                              "it lists the despawned instances of too many updates");
        deaths_.resize(death_count);
    }
    for (auto& [update, generations] : deaths_) {
        std::vector<InstanceHandle> all;
        for (const auto& [instance, generation] : generations) all.push_back({instance, generation});
        std::ranges::sort(all, {}, &InstanceHandle::instance);
        archive.value(update);
        archive.list(all, UINT32_MAX);
        generations.clear();
        for (const auto& [instance, generation] : all) generations.emplace(instance, generation);
    }
}

// All births go to the device with the next update, except those that shaders have set, which it has already.
void PopulationStage::exchange_group(StateArchive& archive, uint32_t group) {
    Population& population = populations_[group];
    archive.value(population.generation);
    if (population.is_of_shaders) return;
    archive.values(std::span(population.births));
    archive.values(std::span(population.generations));
    if (!archive.reads() || population.births.empty()) return;
    const auto capacity = static_cast<uint32_t>(population.births.size());
    population.numbers = InstanceNumbers(capacity);
    for (uint32_t number = 0; number < capacity; ++number)
        if (population.births[number] != 0) population.numbers.take(number);
    dirty_.add(population.first_instance, capacity);
}

}  // namespace throng
