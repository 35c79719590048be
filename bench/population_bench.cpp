#include "bench/population_bench.h"

#include "bench/value_of.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <random>

namespace throng::bench {
namespace {

constexpr std::array kParts{0.1, 0.5, 1.0};

enum class Kind { kForGood, kTogether, kAnywhere };
constexpr std::array kKindNames{"for good", "together", "anywhere"};

struct PopulationEntrant {
    Kind kind = Kind::kForGood;
    uint32_t count = 0;
    Crowd crowd;
    std::vector<InstanceHandle> instances{};
    std::vector<uint32_t> plays{};  // for each of `instances`: the number of its playback in the case
    size_t found_count = 0;         // instances that the check has found
    double max_error = 0;
    UpdateTimes times{};

    bool is_wrong() const { return !(max_error <= kSkinErrorBound); }
};

// Frames in which many instances change.
struct Turnover {
    const char* name = "";
    PopulationEntrant entrant;
    std::function<void(PopulationEntrant&)> change;
    std::vector<double> call_ms{}, update_ms{};
};

class PopulationMeasurement {
public:
    PopulationMeasurement(const Device& device, const PopulationCase& population, const SkinReference& reference)
        : device_(device),
          load_(device.gpu()),
          population_(population),
          reference_(reference),
          capacity_(static_cast<uint32_t>(population.playback.size())),
          changed_count_(std::max(1u, capacity_ / 4)) {}

    void check(const Progress& progress) {
        for (const double part : kParts)
            for (const Kind kind : {Kind::kForGood, Kind::kTogether, Kind::kAnywhere}) {
                const auto count = std::max(1u, static_cast<uint32_t>(part * capacity_));
                progress(population_.configuration + ": checking " + std::to_string(count));
                compare(entrants_.emplace_back(make(kind, count)));
            }
    }

    // Crowds that fill half of their capacity; half of their instances change in each frame. Each is checked after one.
    void check_turnover(const Progress& progress) {
        const uint32_t count = std::max(1u, capacity_ / 2);
        turnovers_.push_back({"playbacks", make(Kind::kAnywhere, count), [&](auto& told) { tell(told); }});
        turnovers_.push_back(
            {"births and deaths", make(Kind::kAnywhere, count), [&](auto& reborn) { replace(reborn); }});
        turnovers_.push_back({"by shaders", make_commanded(count), [&](auto& commanded) { command(commanded); }});
        for (Turnover& turnover : turnovers_) {
            progress(population_.configuration + ": checking " + turnover.name);
            value_of(turnover.entrant.crowd.update(0));
            turnover.change(turnover.entrant);
            compare(turnover.entrant);
        }
    }

    void time(uint32_t samples, const Progress& progress) {
        std::vector<Contestant> contestants;
        for (PopulationEntrant& entrant : entrants_)
            if (!entrant.is_wrong())
                contestants.push_back({population_.configuration + ": " + std::to_string(entrant.count),
                                       [&] { entrant.times.take(load_, entrant.crowd); }});
        run_rounds(contestants, samples, progress);
    }

    void time_turnover(uint32_t samples, const Progress& progress) {
        std::vector<Contestant> contestants;
        for (Turnover& turnover : turnovers_)
            if (!turnover.entrant.is_wrong())
                contestants.push_back(
                    {population_.configuration + ": " + turnover.name, [&] { take_sample(turnover); }});
        run_rounds(contestants, samples, progress);
    }

    std::vector<Json> records() const {
        std::vector<Json> all;
        for (const PopulationEntrant& entrant : entrants_) all.push_back(record_of(entrant));
        for (const Turnover& turnover : turnovers_) all.push_back(record_of(turnover));
        return all;
    }

private:
    // The n-th instance of each entrant plays and stands as the n-th of the case.
    PopulationEntrant make(Kind kind, uint32_t count) const {
        CrowdGroup group{.character = population_.character};
        if (kind == Kind::kForGood)
            group.instance_count = count;
        else
            group.capacity = capacity_;
        PopulationEntrant entrant = entrant_of(kind, count, group);
        Crowd& crowd = entrant.crowd;
        if (kind == Kind::kForGood) {
            for (uint32_t i = 0; i < count; ++i) entrant.instances.push_back({.instance = i});
        } else {
            const uint32_t born = kind == Kind::kAnywhere ? capacity_ : count;
            entrant.instances = value_of(crowd.spawn(0, population_.placement.first(born)));
            std::shuffle(entrant.instances.begin(), entrant.instances.end(), std::mt19937(1));
            value_of(crowd.despawn(std::span(entrant.instances).subspan(count)));
            entrant.instances.resize(count);
        }
        value_of(crowd.set_placement(entrant.instances, population_.placement.first(count)));
        value_of(crowd.set_playback(entrant.instances, population_.playback.first(count)));
        return entrant;
    }

    PopulationEntrant entrant_of(Kind kind, uint32_t count, const CrowdGroup& group) const {
        PopulationEntrant entrant{
            kind, count,
            value_of(Crowd::create(device_, {.groups = {group}, .path = population_.path, .culling = Culling{}}))};
        entrant.plays.resize(count);
        std::iota(entrant.plays.begin(), entrant.plays.end(), 0u);
        return entrant;
    }

    // Checks after an update of zero time. A wrong number of instances counts as an infinite error.
    void compare(PopulationEntrant& entrant) const {
        value_of(entrant.crowd.update(0));
        entrant.found_count = value_of(entrant.crowd.read_drawn()).size();
        if (entrant.found_count != entrant.count)
            entrant.max_error = std::numeric_limits<double>::infinity();
        else
            entrant.max_error = largest_error_of_some(entrant.count, [&](uint32_t i) { return error_of(entrant, i); });
    }

    double error_of(PopulationEntrant& entrant, uint32_t i) const {
        return skin_error(value_of(entrant.crowd.read_skin_matrices(entrant.instances[i])),
                          reference_(*population_.character, population_.playback[entrant.plays[i]]),
                          population_.character->size);
    }

    void take_sample(Turnover& turnover) const {
        load_.run();
        const Stopwatch calls;
        turnover.change(turnover.entrant);
        turnover.call_ms.push_back(calls.elapsed_s() * 1e3);
        const Stopwatch update;
        value_of(turnover.entrant.crowd.update(kFrame_s));
        turnover.update_ms.push_back(update.elapsed_s() * 1e3);
    }

    // Moves the instances to be changed, chosen at random, to the end of the list.
    void choose(PopulationEntrant& entrant) {
        for (uint32_t i = 0; i < changed_count_; ++i) {
            const uint32_t last = entrant.count - 1 - i,
                           chosen = std::uniform_int_distribution<uint32_t>(0, last)(random_);
            std::swap(entrant.instances[last], entrant.instances[chosen]);
            std::swap(entrant.plays[last], entrant.plays[chosen]);
        }
    }

    void tell(PopulationEntrant& entrant) {
        choose(entrant);
        set_playback(entrant);
    }

    void replace(PopulationEntrant& entrant) {
        choose(entrant);
        const uint32_t kept = entrant.count - changed_count_;
        value_of(entrant.crowd.despawn(std::span(entrant.instances).subspan(kept)));
        const std::vector<InstanceHandle> born = value_of(
            entrant.crowd.spawn(0, population_.placement.subspan(kept, changed_count_)));
        std::ranges::copy(born, entrant.instances.begin() + kept);
        set_playback(entrant);
    }

    // Sets the playback of the instances at the end of the list.
    void set_playback(PopulationEntrant& entrant) const {
        const uint32_t kept = entrant.count - changed_count_;
        value_of(entrant.crowd.set_playback(std::span(entrant.instances).subspan(kept),
                                            population_.playback.subspan(kept, changed_count_)));
        std::iota(entrant.plays.begin() + kept, entrant.plays.end(), kept);
    }

    // Like make(), but spawns the instances by commands, as shaders do, at a random half of the instance numbers.
    PopulationEntrant make_commanded(uint32_t count) const {
        PopulationEntrant entrant = entrant_of(Kind::kAnywhere, count,
                                               {.character = population_.character,
                                                .capacity = capacity_,
                                                .command_capacity = 3 * capacity_,
                                                .shaders_populate = true});
        for (uint32_t i = 0; i < capacity_; ++i) entrant.instances.push_back({.instance = i});
        std::shuffle(entrant.instances.begin(), entrant.instances.end(), std::mt19937(1));
        value_of(entrant.crowd.update(0));
        std::vector<InstanceCommand> commands;
        for (uint32_t i = 0; i < count; ++i) add_birth(commands, entrant, i);
        write(entrant.crowd, commands);
        return entrant;
    }

    // The first `count` instances of the list are alive. Some of them die, and as many others are born with the same
    // playbacks.
    void command(PopulationEntrant& entrant) {
        std::vector<InstanceCommand> commands;
        for (uint32_t i = 0; i < changed_count_; ++i) {
            const uint32_t gone = std::uniform_int_distribution<uint32_t>(0, entrant.count - 1)(random_),
                           born = std::uniform_int_distribution<uint32_t>(std::min(entrant.count, capacity_ - 1),
                                                                          capacity_ - 1)(random_);
            commands.push_back(InstanceCommand::despawn(entrant.instances[gone].instance));
            std::swap(entrant.instances[gone], entrant.instances[born]);
            add_birth(commands, entrant, gone);
        }
        write(entrant.crowd, commands);
    }

    void add_birth(std::vector<InstanceCommand>& commands, const PopulationEntrant& entrant, uint32_t i) const {
        const uint32_t instance = entrant.instances[i].instance;
        commands.push_back(InstanceCommand::spawn(instance, population_.placement[i]));
        commands.push_back(InstanceCommand::set_playback(instance, population_.playback[i]));
    }

    // Writes the commands to the first block as a shader would.
    void write(const Crowd& crowd, std::span<const InstanceCommand> commands) const {
        const OutputBlock& block = crowd.outputs()[0];
        const CommandHead head{.count = static_cast<uint32_t>(commands.size())};
        if (!block.host.command.empty()) {
            std::ranges::copy(commands, block.host.command.begin());
            block.host.command_head[0] = head;
            return;
        }
        const Gpu& gpu = *device_.gpu();
        const BufferRange range(block.command.buffer, block.command.offset_bytes, block.command.size_bytes);
        gpu.submit_and_wait([&](VkCommandBuffer recorded) {
            record_update(gpu, recorded, range, 0, std::span(&head, 1));
            record_update(gpu, recorded, range, 1, commands);
        });
    }

    Json record_of(const PopulationEntrant& entrant, const char* field, const char* name) const {
        Json record = new_record(device_, "population", population_.configuration, *population_.character);
        record.update({{"path", path_name(entrant.crowd)},
                       {"capacity", capacity_},
                       {field, name},
                       {"characters", entrant.count},
                       {"max_error", entrant.max_error}});
        if (entrant.is_wrong()) record["wrong"] = true;
        if (entrant.found_count != entrant.count) record["found"] = entrant.found_count;
        return record;
    }

    Json record_of(const PopulationEntrant& entrant) const {
        Json record = record_of(entrant, "instances", kKindNames[static_cast<size_t>(entrant.kind)]);
        record["memory_bytes"] = entrant.crowd.size_bytes();
        entrant.times.add_to(record);
        return record;
    }

    Json record_of(const Turnover& turnover) const {
        Json record = record_of(turnover.entrant, "frames_with", turnover.name);
        record["changed"] = changed_count_;
        if (turnover.entrant.is_wrong()) return record;
        record.update({{"samples", turnover.call_ms.size()},
                       {"call_ms", spread_json(spread_of(turnover.call_ms))},
                       {"update_ms", spread_json(spread_of(turnover.update_ms))}});
        return record;
    }

    const Device& device_;
    GpuLoad load_;
    const PopulationCase& population_;
    const SkinReference& reference_;
    uint32_t capacity_, changed_count_;
    std::mt19937 random_{2};
    std::vector<PopulationEntrant> entrants_;
    std::vector<Turnover> turnovers_;
};

}  // namespace

std::vector<Json> measure_population(const Device& device, const PopulationCase& population, uint32_t samples,
                                     const Progress& progress, const SkinReference& reference) {
    PopulationMeasurement measurement(device, population, reference);
    measurement.check(progress);
    measurement.check_turnover(progress);
    measurement.time(samples, progress);
    measurement.time_turnover(samples, progress);
    return measurement.records();
}

}  // namespace throng::bench
