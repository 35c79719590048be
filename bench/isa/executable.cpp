#include "bench/isa/executable.h"

#include "base/failure.h"

#include <algorithm>
#include <map>

namespace throng::bench {
namespace {

constexpr const char* kAssembly = "Assembly";

std::map<std::string, uint64_t> statistics_of(const Gpu& gpu, const VkPipelineExecutableInfoKHR& which) {
    constexpr VkPipelineExecutableStatisticKHR kEmpty{.sType = VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_STATISTIC_KHR};
    uint32_t count = 0;
    check(gpu.vk.vkGetPipelineExecutableStatisticsKHR(gpu.device, &which, &count, nullptr), "statistics of a pipeline");
    std::vector<VkPipelineExecutableStatisticKHR> statistics(count, kEmpty);
    check(gpu.vk.vkGetPipelineExecutableStatisticsKHR(gpu.device, &which, &count, statistics.data()),
          "statistics of a pipeline");
    std::map<std::string, uint64_t> values;
    for (const auto& statistic : statistics)
        if (statistic.format == VK_PIPELINE_EXECUTABLE_STATISTIC_FORMAT_UINT64_KHR)
            values[statistic.name] = statistic.value.u64;
    return values;
}

std::string assembly_of(const Gpu& gpu, const VkPipelineExecutableInfoKHR& which) {
    constexpr VkPipelineExecutableInternalRepresentationKHR kEmpty{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_INTERNAL_REPRESENTATION_KHR};
    const auto ask = [&](uint32_t& count, VkPipelineExecutableInternalRepresentationKHR* texts) {
        check(gpu.vk.vkGetPipelineExecutableInternalRepresentationsKHR(gpu.device, &which, &count, texts),
              "machine code of a pipeline");
    };
    uint32_t count = 0;
    ask(count, nullptr);
    std::vector<VkPipelineExecutableInternalRepresentationKHR> texts(count, kEmpty);
    ask(count, texts.data());  // their sizes
    std::vector<std::string> bytes;
    for (const auto& text : texts) bytes.emplace_back(text.dataSize, '\0');
    for (uint32_t i = 0; i < count; ++i) texts[i].pData = bytes[i].data();
    ask(count, texts.data());
    for (uint32_t i = 0; i < count; ++i)
        if (texts[i].name == std::string_view(kAssembly)) return bytes[i].c_str();
    throw Failure(ErrorCode::kUnsupported, gpu.info.driver, "the driver does not report machine code");
}

uint32_t statistic(const std::map<std::string, uint64_t>& values, const char* name) {
    const auto found = values.find(name);
    if (found == values.end())
        throw Failure(ErrorCode::kUnsupported, "statistics of a pipeline",
                      std::string("'") + name + "' is missing: is this another driver than Mesa's radv 22?");
    return static_cast<uint32_t>(found->second);
}

}  // namespace

std::vector<Executable> executables_of(const Gpu& gpu, const MadePipeline& made) {
    const VkPipelineInfoKHR pipeline{.sType = VK_STRUCTURE_TYPE_PIPELINE_INFO_KHR, .pipeline = made.pipeline};
    constexpr VkPipelineExecutablePropertiesKHR kEmpty{.sType = VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_PROPERTIES_KHR};
    uint32_t count = 0;
    check(gpu.vk.vkGetPipelineExecutablePropertiesKHR(gpu.device, &pipeline, &count, nullptr),
          "properties of a pipeline");
    std::vector<VkPipelineExecutablePropertiesKHR> properties(count, kEmpty);
    check(gpu.vk.vkGetPipelineExecutablePropertiesKHR(gpu.device, &pipeline, &count, properties.data()),
          "properties of a pipeline");
    std::vector<Executable> executables;
    for (uint32_t i = 0; i < count; ++i) {
        const VkPipelineExecutableInfoKHR which{
            .sType = VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_INFO_KHR, .pipeline = made.pipeline, .executableIndex = i};
        const auto values = statistics_of(gpu, which);
        const std::string stage = made.workgroup_size > 0 ? "" : std::string(": ") + properties[i].name;
        executables.push_back({.name = std::string(made.name) + stage,
                               .workgroup_size = made.workgroup_size,
                               .subgroup_size = properties[i].subgroupSize,
                               .vgprs = statistic(values, "VGPRs"),
                               .sgprs = statistic(values, "SGPRs"),
                               .spilled_vgprs = statistic(values, "Spilled VGPRs"),
                               .spilled_sgprs = statistic(values, "Spilled SGPRs"),
                               .scratch_bytes = statistic(values, "Scratch size"),
                               .shared_bytes = statistic(values, "LDS size"),
                               .code = read_machine_code(assembly_of(gpu, which))});
    }
    return executables;
}

}  // namespace throng::bench
