#include "bench/draw_bench.h"

#include "bench/psnr.h"
#include "bench/updates.h"
#include "bench/value_of.h"
#include "draw/native_renderer.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>

namespace throng::bench {
namespace {

// A crowd on a device of its own.
struct Stage {
    std::optional<Device> device;
    std::optional<Crowd> crowd;
    std::string unsupported_reason;
};

struct DrawCandidate {
    std::string renderer, isa;
    uint32_t threads = 0;
    Stage* stage = nullptr;
    std::unique_ptr<RendererState> native;
    std::optional<Renderer> vulkan;
    std::optional<GpuLoad> load;  // of vulkan's device
    Picture picture;
    double alike_db = 0;
    bool is_wrong = false;
    NativeTimes last;
    UpdateTimes times;
    std::vector<double> list_ms, skin_ms, shadow_ms, picture_ms, resolve_ms;

    RenderResult draw(const Camera& camera) {
        if (vulkan) return value_of(vulkan->render(*stage->crowd, camera));
        RenderResult result = native->render(std::array{&stage->crowd->state()}, camera);
        last = static_cast<NativeRenderer&>(*native).times();
        return result;
    }
    void sample(const Camera& camera) {
        if (load) load->run();
        const Stopwatch watch;
        const double draw_ms = draw(camera).draw_ms, host_ms = watch.elapsed_s() * 1e3;
        times.take(load ? credible_reading(load->gpu(), draw_ms, host_ms) : Reading{draw_ms});
        list_ms.push_back(last.list_ms);
        skin_ms.push_back(last.skin_ms);
        shadow_ms.push_back(last.shadow_ms);
        picture_ms.push_back(last.picture_ms);
        resolve_ms.push_back(last.resolve_ms);
    }
};

class DrawMeasurement {
public:
    explicit DrawMeasurement(const DrawCase& drawn) : drawn_(drawn) {}

    void check(const Progress& progress) {
        stages_.resize(drawn_.threads.size() + 1);
        for (size_t i = 0; i < drawn_.threads.size(); ++i) {
            progress(drawn_.configuration + ": making the crowd");
            Stage& stage = stages_[i];
            stage.device = value_of(Device::create({.select = "native", .threads = drawn_.threads[i]}));
            stage.crowd = drawn_.make_crowd(*stage.device);
            if (!camera_) camera_ = drawn_.camera_of(*stage.crowd);
            for (const NativeIsa isa : drawn_.isas) {
                DrawCandidate& candidate = add("native", stage);
                candidate.isa = name_of(isa);
                candidate.threads = drawn_.threads[i];
                candidate.native = std::make_unique<NativeRenderer>(stage.device->gpu(), drawn_.picture, isa);
                compare(candidate, progress);
            }
        }
        if (drawn_.vulkan_device) add_vulkan(progress);
    }

    void time(uint32_t samples, const Progress& progress) {
        std::vector<TimedRun> timed_runs;
        for (DrawCandidate& candidate : candidates_)
            if ((candidate.native || candidate.vulkan) && !candidate.is_wrong)
                timed_runs.push_back(
                    {drawn_.configuration + ": " + candidate.renderer, [&] { candidate.sample(*camera_); }});
        constexpr double kBudget_s = 60;
        run_rounds(timed_runs, Sampling{.samples = samples, .min_samples = 3}, kBudget_s, progress);
    }

    std::vector<Json> records() const {
        std::vector<Json> records;
        for (const DrawCandidate& candidate : candidates_) records.push_back(record_of(candidate));
        return records;
    }

private:
    DrawCandidate& add(const char* renderer, Stage& stage) {
        DrawCandidate& candidate = candidates_.emplace_back();
        candidate.renderer = renderer;
        candidate.stage = &stage;
        return candidate;
    }

    void add_vulkan(const Progress& progress) {
        Stage& stage = stages_.back();
        DrawCandidate& candidate = add("vulkan", stage);
        const Result<Device> device = Device::create({.select = *drawn_.vulkan_device});
        RendererSettings settings = drawn_.picture;
        settings.path = DrawPath::kDevice;
        if (!device) {
            stage.unsupported_reason = device.error().text();
            return;
        }
        stage.device = *device;
        stage.crowd = drawn_.make_crowd(*stage.device);
        candidate.vulkan = value_of(Renderer::create(*stage.device, settings));
        candidate.load.emplace(stage.device->gpu());
        compare(candidate, progress);
    }

    // A picture is wrong if it differs at all from an earlier one of the same instruction set with another number of
    // threads, or visibly from the first one.
    void compare(DrawCandidate& candidate, const Progress& progress) {
        progress(drawn_.configuration + ": checking " + candidate.renderer + " " + candidate.isa);
        candidate.picture = candidate.draw(*camera_).picture;
        for (const DrawCandidate& before : candidates_)
            if (&before != &candidate && before.isa == candidate.isa && before.picture.rgba != candidate.picture.rgba)
                candidate.is_wrong = true;
        candidate.alike_db = psnr(candidate.picture, candidates_.front().picture);
        const uint32_t sub_pixel_bits = candidate.vulkan
                                            ? candidate.stage->device->gpu()->properties.limits.subPixelPrecisionBits
                                            : 8;
        if (!(candidate.alike_db >= min_alike_db(sub_pixel_bits))) candidate.is_wrong = true;
    }

    Json record_of(const DrawCandidate& candidate) const {
        Json record = where_and_when(candidate.stage->device ? candidate.stage->device->info()
                                                             : stages_.front().device->info());
        const RendererSettings& picture = drawn_.picture;
        record.update({{"bench", "draw"},
                       {"configuration", drawn_.configuration},
                       {"renderer", candidate.renderer},
                       {"variant", candidate.native ? candidate.isa : candidate.renderer},
                       {"size", std::to_string(picture.width) + "x" + std::to_string(picture.height)},
                       {"samples_per_pixel", picture.samples}});
        if (candidate.threads > 0) record["threads"] = candidate.threads;
        if (!candidate.stage->unsupported_reason.empty()) {
            record["unsupported_reason"] = candidate.stage->unsupported_reason;
            return record;
        }
        const NativeTimes& of = candidates_.front().last;
        record.update({{"characters", candidate.stage->crowd->instance_count()},
                       {"drawn", of.instances},
                       {"vertices", of.vertices},
                       {"triangles", of.triangles}});
        if (std::isfinite(candidate.alike_db)) record["alike_db"] = candidate.alike_db;
        if (candidate.is_wrong) record["wrong"] = true;
        if (candidate.times.count() == 0) return record;
        candidate.times.add_to(record);
        const double median_ms = candidate.times.total().median;
        if (candidate.vulkan) record["host_samples"] = candidate.times.count_by_host();
        if (candidate.native)
            record["parts"] = {{"list", spread_of(candidate.list_ms).median},
                               {"skin", spread_of(candidate.skin_ms).median},
                               {"shadow map", spread_of(candidate.shadow_ms).median},
                               {"picture", spread_of(candidate.picture_ms).median},
                               {"resolve", spread_of(candidate.resolve_ms).median}};
        const double samples = static_cast<double>(uint64_t{picture.width} * picture.height * picture.samples);
        record["mtriangles_per_s"] = static_cast<double>(of.triangles) / median_ms * 1e-3;
        record["msamples_per_s"] = samples / median_ms * 1e-3;
        if (const DrawCandidate& other = candidates_.back();
            other.vulkan && other.times.count() > 0 && candidate.native)
            record["times_faster"] = other.times.total().median / median_ms;
        return record;
    }

    const DrawCase& drawn_;
    std::vector<Stage> stages_;
    std::deque<DrawCandidate> candidates_;  // a deque: candidates keep their addresses
    std::optional<Camera> camera_;
};

}  // namespace

std::vector<Json> measure_draw(const DrawCase& drawn, uint32_t samples, const Progress& progress) {
    DrawMeasurement measurement(drawn);
    measurement.check(progress);
    measurement.time(samples, progress);
    return measurement.records();
}

}  // namespace throng::bench
