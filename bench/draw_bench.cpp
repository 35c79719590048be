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

struct DrawEntrant {
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
        times.take(load ? believed_reading(load->gpu(), draw_ms, host_ms) : Reading{draw_ms});
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
                DrawEntrant& entrant = add("native", stage);
                entrant.isa = name_of(isa);
                entrant.threads = drawn_.threads[i];
                entrant.native = std::make_unique<NativeRenderer>(stage.device->gpu(), drawn_.picture, isa);
                compare(entrant, progress);
            }
        }
        if (drawn_.vulkan_device) add_vulkan(progress);
    }

    void time(uint32_t samples, const Progress& progress) {
        std::vector<Contestant> contestants;
        for (DrawEntrant& entrant : entrants_)
            if ((entrant.native || entrant.vulkan) && !entrant.is_wrong)
                contestants.push_back(
                    {drawn_.configuration + ": " + entrant.renderer, [&] { entrant.sample(*camera_); }});
        constexpr double kBudget_s = 60;
        run_rounds(contestants, Sampling{.samples = samples, .least_samples = 3}, kBudget_s, progress);
    }

    std::vector<Json> records() const {
        std::vector<Json> records;
        for (const DrawEntrant& entrant : entrants_) records.push_back(record_of(entrant));
        return records;
    }

private:
    DrawEntrant& add(const char* renderer, Stage& stage) {
        DrawEntrant& entrant = entrants_.emplace_back();
        entrant.renderer = renderer;
        entrant.stage = &stage;
        return entrant;
    }

    void add_vulkan(const Progress& progress) {
        Stage& stage = stages_.back();
        DrawEntrant& entrant = add("vulkan", stage);
        const Result<Device> device = Device::create({.select = *drawn_.vulkan_device});
        RendererSettings settings = drawn_.picture;
        settings.path = DrawPath::kDevice;
        if (!device) {
            stage.unsupported_reason = device.error().text();
            return;
        }
        stage.device = *device;
        stage.crowd = drawn_.make_crowd(*stage.device);
        entrant.vulkan = value_of(Renderer::create(*stage.device, settings));
        entrant.load.emplace(stage.device->gpu());
        compare(entrant, progress);
    }

    // A picture is wrong if it differs at all from an earlier one of the same instruction set with another number of
    // threads, or visibly from the first one.
    void compare(DrawEntrant& entrant, const Progress& progress) {
        progress(drawn_.configuration + ": checking " + entrant.renderer + " " + entrant.isa);
        entrant.picture = entrant.draw(*camera_).picture;
        for (const DrawEntrant& before : entrants_)
            if (&before != &entrant && before.isa == entrant.isa && before.picture.rgba != entrant.picture.rgba)
                entrant.is_wrong = true;
        entrant.alike_db = psnr(entrant.picture, entrants_.front().picture);
        const uint32_t sub_pixel_bits = entrant.vulkan
                                            ? entrant.stage->device->gpu()->properties.limits.subPixelPrecisionBits
                                            : 8;
        if (!(entrant.alike_db >= least_alike_db(sub_pixel_bits))) entrant.is_wrong = true;
    }

    Json record_of(const DrawEntrant& entrant) const {
        Json record = where_and_when(entrant.stage->device ? entrant.stage->device->info()
                                                           : stages_.front().device->info());
        const RendererSettings& picture = drawn_.picture;
        record.update({{"bench", "draw"},
                       {"configuration", drawn_.configuration},
                       {"renderer", entrant.renderer},
                       {"variant", entrant.native ? entrant.isa : entrant.renderer},
                       {"size", std::to_string(picture.width) + "x" + std::to_string(picture.height)},
                       {"samples_per_pixel", picture.samples}});
        if (entrant.threads > 0) record["threads"] = entrant.threads;
        if (!entrant.stage->unsupported_reason.empty()) {
            record["unsupported_reason"] = entrant.stage->unsupported_reason;
            return record;
        }
        const NativeTimes& of = entrants_.front().last;
        record.update({{"characters", entrant.stage->crowd->instance_count()},
                       {"drawn", of.instances},
                       {"vertices", of.vertices},
                       {"triangles", of.triangles}});
        if (std::isfinite(entrant.alike_db)) record["alike_db"] = entrant.alike_db;
        if (entrant.is_wrong) record["wrong"] = true;
        if (entrant.times.count() == 0) return record;
        entrant.times.add_to(record);
        const double median_ms = entrant.times.total().median;
        if (entrant.vulkan) record["host_samples"] = entrant.times.count_by_host();
        if (entrant.native)
            record["parts"] = {{"list", spread_of(entrant.list_ms).median},
                               {"skin", spread_of(entrant.skin_ms).median},
                               {"shadow map", spread_of(entrant.shadow_ms).median},
                               {"picture", spread_of(entrant.picture_ms).median},
                               {"resolve", spread_of(entrant.resolve_ms).median}};
        const double samples = static_cast<double>(uint64_t{picture.width} * picture.height * picture.samples);
        record["mtriangles_per_s"] = static_cast<double>(of.triangles) / median_ms * 1e-3;
        record["msamples_per_s"] = samples / median_ms * 1e-3;
        if (const DrawEntrant& other = entrants_.back(); other.vulkan && other.times.count() > 0 && entrant.native)
            record["times_faster"] = other.times.total().median / median_ms;
        return record;
    }

    const DrawCase& drawn_;
    std::vector<Stage> stages_;
    std::deque<DrawEntrant> entrants_;  // a deque: entrants keep their addresses
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
