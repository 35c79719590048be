#include "bench/isa/compiler.h"

#include "base/failure.h"

#include <cstdlib>
#include <filesystem>
#include <optional>

namespace throng::bench {
namespace {

// An environment variable that is set as long as the object lives.
class Variable {
public:
    Variable(const char* name, const std::string& value) : name_(name) {
        if (const char* before = std::getenv(name)) before_ = before;
        setenv(name, value.c_str(), 1);
    }
    ~Variable() {
        if (before_)
            setenv(name_, before_->c_str(), 1);
        else
            unsetenv(name_);
    }
    Variable(const Variable&) = delete;

private:
    const char* name_;
    std::optional<std::string> before_;
};

// The descriptions of AMD's driver for the Vulkan loader, as VK_DRIVER_FILES takes them; empty where there are none.
std::string driver_files() {
    std::string files;
    std::error_code error;
    for (const char* folder : {"/usr/local/etc/vulkan/icd.d", "/usr/local/share/vulkan/icd.d", "/etc/vulkan/icd.d",
                               "/usr/share/vulkan/icd.d"})
        for (const auto& file : std::filesystem::directory_iterator(folder, error))
            if (file.path().filename().string().starts_with("radeon_icd") && file.path().extension() == ".json")
                files += (files.empty() ? "" : ":") + file.path().string();
    return files;
}

}  // namespace

std::shared_ptr<Gpu> open_compiler(const std::string& family) {
    const std::string place = "AMD's Vulkan driver (radv)";
    const Variable forced("RADV_FORCE_FAMILY", family);
    std::optional<Variable> driver;
    if (!std::getenv("VK_DRIVER_FILES") && !std::getenv("VK_ICD_FILENAMES")) {
        const std::string files = driver_files();
        if (files.empty())
            throw Failure(ErrorCode::kNoDevice, place, "not installed (Debian: apt-get install mesa-vulkan-drivers)");
        driver.emplace("VK_DRIVER_FILES", files);
    }
    std::shared_ptr<Gpu> gpu = Gpu::create_compiler();
    if (!gpu)
        throw Failure(ErrorCode::kNoDevice, place,
                      "not among the drivers that VK_DRIVER_FILES and VK_ICD_FILENAMES name");
    return gpu;
}

Compiler::Compiler(const std::string& family, uint32_t subgroup_size) : gpu_(open_compiler(family)) {
    gpu_->compiled_subgroup_size = subgroup_size;
}

Compiler::~Compiler() { gpu_->on_pipeline = nullptr; }

ScanLimits Compiler::scan_limits() const {
    ScanLimits limits = throng::scan_limits(*gpu_);
    limits.subgroup_size = gpu_->compiled_subgroup_size;
    return limits;
}

std::vector<Executable> Compiler::made_by(const std::function<void()>& make) const {
    std::vector<Executable> made;
    gpu_->on_pipeline = [&](const MadePipeline& pipeline) {
        for (Executable& executable : executables_of(*gpu_, pipeline)) made.push_back(std::move(executable));
    };
    make();
    gpu_->on_pipeline = nullptr;
    return made;
}

}  // namespace throng::bench
