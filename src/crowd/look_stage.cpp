#include "crowd/look_stage.h"

#include "base/failure.h"
#include "base/message_name.h"
#include "crowd/change_stage.h"
#include "crowd/state_archive.h"
#include "crowd/state_checks.h"

#include <algorithm>

namespace throng {

static_assert(sizeof(InstanceLook) == sizeof(io::InstanceLook));

bool is_color(const std::array<float, 3>& color) {
    constexpr float kMaximum = 1000;
    return std::ranges::all_of(color, [](float of) { return of >= 0 && of <= kMaximum; });
}

std::vector<io::SectionLook> section_looks_of(const CrowdGroup& group) {
    const Character& character = *group.character;
    const auto section_count = static_cast<uint32_t>(character.sections.size()),
               material_count = static_cast<uint32_t>(character.materials.size());
    std::vector<io::SectionLook> of_sections;
    for (const MeshSection& section : character.sections)
        of_sections.push_back({1, 1, 1, 1, std::min(section.material, material_count)});
    std::vector<io::SectionLook> looks = of_sections;
    for (size_t i = 1; i < group.outfits.size(); ++i) looks.insert(looks.end(), of_sections.begin(), of_sections.end());
    for (size_t i = 0; i < group.outfits.size(); ++i)
        for (const SectionLook& look : group.outfits[i].sections) {
            const std::string place = message_name(character.name) + ": outfit " + std::to_string(i);
            if (look.section >= section_count)
                throw Failure(ErrorCode::kInvalidArgument, place, "section ", look.section,
                              " is out of range: the mesh has ", section_count);
            if (!is_color(look.color) || !(look.tint >= 0 && look.tint <= 1))
                throw Failure(ErrorCode::kInvalidArgument, place, "section ", look.section,
                              ": color must be within 0..1000, and tint within 0..1");
            if (look.material && *look.material >= material_count)
                throw Failure(ErrorCode::kInvalidArgument, place, "section ", look.section, ": material ",
                              *look.material, " is out of range: the character has ", material_count);
            const auto [red, green, blue] = look.color;
            const uint32_t own = of_sections[look.section].material;
            looks[i * section_count + look.section] = {red, green, blue, look.tint,
                                                       look.is_shown ? look.material.value_or(own) : kNone};
        }
    return looks;
}

bool LookStage::is_needed(const CrowdSettings& settings) {
    return std::ranges::any_of(settings.groups, [](const CrowdGroup& group) { return !group.outfits.empty(); });
}

void LookStage::plan(BatchPlan& plan) {
    plan.add_host(sizeof(looks_[0]));
    if (plan.group().outfit_count > 0) plan.add_filled(io::kInstanceLooksBuffer, std::vector<InstanceLook>(1));
}

LookStage::LookStage(const StageContext& context) : Stage(context), looks_(context.instance_count) {
    dirty_.add(0, context.instance_count);
}

void LookStage::set(const Instances& instances, const Each<InstanceLook>& look) {
    for (uint32_t i = 0; i < instances.size(); ++i) {
        const uint32_t outfit_count = group_at(instances.number(i)).outfit_count;
        const ErrorPlace place("look", instances.number(i));
        if (look[i].outfit >= outfit_count)
            throw Failure(ErrorCode::kInvalidArgument, place, "outfit ", look[i].outfit,
                          " is out of range: the group has ", outfit_count, " (CrowdGroup::outfits)");
        if (!is_color(look[i].tint))
            throw Failure(ErrorCode::kInvalidArgument, place, "the tint must be within 0..1000");
    }
    for (uint32_t i = 0; i < instances.size(); ++i) {
        looks_[instances.number(i)] = look[i];
        dirty_.add(instances.number(i), 1);
    }
}

void LookStage::despawn(std::span<const InstanceHandle> gone) {
    for (const InstanceHandle& one : gone)
        if (group_at(one.instance).outfit_count > 0) set(one, Each(InstanceLook()));
}

void LookStage::begin(const Update& update) {
    const std::span<const DirtyRanges::Range> ranges = dirty_.take();
    for_each_part(batches_, ranges, [&](const Batch& batch, uint32_t first, uint32_t count) {
        if (batch[io::kInstanceLooksBuffer])
            update.changes->write(update, ranges.size(), batch, io::kInstanceLooksBuffer, first - batch.first_instance,
                                  std::span<const InstanceLook>(looks_).subspan(first, count));
    });
}

void LookStage::exchange_group(StateArchive& archive, uint32_t group) {
    for_each_batch_of(group, [&](const Batch& batch, uint32_t) {
        const auto looks = std::span(looks_).subspan(batch.first_instance, batch.instance_count);
        archive.values(looks);
        archive.changes(dirty_, batch.first_instance, batch.instance_count);
        if (archive.reads()) check_looks(looks, group_of(batch).outfit_count);
    });
}

}  // namespace throng
