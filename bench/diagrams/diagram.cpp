#include "bench/diagrams/diagram.h"

#include "bench/baselines/baselines.h"
#include "bench/diagrams/svg.h"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <tuple>

namespace throng::bench {
namespace {

constexpr double kWidth = 720, kLeft = 108, kColumn = 36.6, kTreeTop = 72, kLevel = 17, kMargin = 16;
// Strips have a segment for each joint of the chain
constexpr double kSegment = 4, kStrip = 8, kStackedStrip = 4, kStackPitch = 5.5;
constexpr double kGap = 17;       // above a row's strips: where operands come in
constexpr double kBoundary = 18;  // between two phases

constexpr uint32_t kColours = 6;  // of svg.cpp's style sheet
double height_of_breaks(std::string_view text) { return 13.0 * static_cast<double>(std::ranges::count(text, '\n')); }
std::string thread_style(uint32_t thread) { return "t" + std::to_string(thread % kColours); }

class Drawing {
public:
    Drawing(const ScanRig& rig, std::string_view name, std::string_view summary)
        : rig_(rig), name_(name), summary_(summary) {
        svg_.text({kMargin, 27}, name, "name");
        svg_.text({kMargin, 45}, summary, "soft");
    }

    void counts(const std::string& text) { svg_.text({kWidth - kMargin, 27}, text, "end bold"); }

    void tree(const std::vector<uint32_t>& writers, bool has_bones) {
        thread_count_ = *std::max_element(writers.begin(), writers.end()) + 1;
        for (uint32_t joint = 0; joint < rig_.joint_count(); ++joint)
            if (const uint32_t parent = rig_.parents[joint]; parent != kNone)
                svg_.curve(node(parent), node(joint), has_bones ? "bone" : "bone cut");
        for (uint32_t joint = 0; joint < rig_.joint_count(); ++joint) {
            svg_.dot(node(joint), 8, "joint " + thread_style(writers[joint]));
            svg_.text({node(joint).x, node(joint).y + 3.4}, std::to_string(joint), "number");
        }
        y_ = kTreeTop + (rig_.level_count - 1) * kLevel + 22;
    }

    // A product that ends in the joint, drawn as the segments that it covers of the joint's chain, root on the left.
    void strip(uint32_t joint, double y, double height, size_t covered, std::string_view style, bool stored) {
        strip_at({strip_left(joint), y}, height, rig_.depths[joint], covered, style, stored);
    }

    void locals_row(const Flow& flow) {
        svg_.text({kMargin, y_ + 8}, "local transforms", "");
        svg_.text({kWidth - 9, y_ - 7}, "step", "soft small end");
        for (uint32_t joint = 0; joint < rig_.joint_count(); ++joint) {
            const bool is_model = std::none_of(flow.steps.begin(), flow.steps.end(),
                                               [&](const FlowStep& s) { return s.joint == joint && s.stored; });
            strip(joint, y_, kStrip, 1, "own", is_model);
        }
        y_ += kStrip;
        bottoms_.assign(rig_.joint_count(), y_);
        y_ += 1;
    }

    void boundary(FlowBoundary kind) {
        const double middle = y_ + kBoundary / 2 + 4;
        const auto across = [&](double y, std::string_view style) {
            svg_.line({kLeft, y}, {kWidth - kMargin, y}, style);
        };
        if (kind == FlowBoundary::kBarrier) {
            across(middle - 1.5, "wait");
            across(middle + 1.5, "wait");
        } else {
            across(middle, kind == FlowBoundary::kShuffle ? "shuffle" : "next");
        }
        if (kind != FlowBoundary::kNothing)
            svg_.text({kMargin, middle + 3.5}, kind == FlowBoundary::kBarrier ? "barrier" : "shuffle", "bold");
        y_ += kBoundary;
    }

    void phase(const Flow& flow, uint32_t phase_index) {
        svg_.text({kMargin, y_ + kGap + 7}, flow.phases[phase_index].label, "");
        const double text_bottom = y_ + kGap + 9 + height_of_breaks(flow.phases[phase_index].label);
        for (uint32_t row = 0; row < flow.rows(phase_index); ++row) {
            // The steps that end in each joint: several, if threads make the same product at the same time
            std::map<uint32_t, std::vector<const FlowStep*>> at_joint;
            for (const FlowStep& step : flow.steps)
                if (step.phase == phase_index && step.row == row) at_joint[step.joint].push_back(&step);
            for (const auto& [joint, steps] : at_joint)
                for (size_t i = 0; i < steps.size(); ++i)
                    operand(*steps[i], static_cast<double>(steps.size() - 1 - i) * 1.7);
            const double top = y_ + kGap;
            y_ = top + kStrip;
            for (const auto& [joint, steps] : at_joint) {
                const bool alone = steps.size() == 1;
                for (size_t i = 0; i < steps.size(); ++i)
                    strip(joint, top + static_cast<double>(i) * kStackPitch, alone ? kStrip : kStackedStrip,
                          steps[i]->product.size(), "known " + thread_style(steps[i]->thread), steps[i]->stored);
                bottoms_[joint] = top + (alone ? kStrip : static_cast<double>(steps.size()) * kStackPitch);
                y_ = std::max(y_, bottoms_[joint]);
            }
            svg_.text({kWidth - 9, top + 8}, std::to_string(++row_count_), "soft small end");
        }
        y_ = std::max(y_, text_bottom);
    }

    // Matrices that were multiplied offline.
    void stored_row(std::string_view label) {
        svg_.text({kMargin, y_ + 8}, label, "");
        for (uint32_t joint = 0; joint < rig_.joint_count(); ++joint)
            strip(joint, y_, kStrip, rig_.depths[joint], "own", false);
        y_ += kStrip + 6;
    }

    // A row in which each joint's thread works only on what is above it in its own column.
    void column_row(std::string_view label, uint32_t operands, bool is_last) {
        svg_.text({kMargin, y_ + kGap + 7}, label, "");
        for (uint32_t joint = 0; joint < rig_.joint_count(); ++joint) {
            for (uint32_t i = 0; i < operands; ++i)
                svg_.line({centre(joint) + 8 * (i - (operands - 1) / 2.0), y_}, {centre(joint), y_ + kGap - 3},
                          "move " + thread_style(joint));
            strip(joint, y_ + kGap, kStrip, rig_.depths[joint], "known " + thread_style(joint), is_last);
        }
        y_ += kGap + kStrip + 5;
    }

    void block_edges(uint32_t block) {
        for (uint32_t joint = block; joint < rig_.joint_count(); joint += block) {
            const double x = kLeft + joint * kColumn;
            svg_.line({x, kTreeTop - 10}, {x, y_ + 6}, "block");
            svg_.text({x + 5, kTreeTop - 2}, "block " + std::to_string(joint / block), "soft small");
            if (joint == block) svg_.text({x - 5, kTreeTop - 2}, "block 0", "soft small end");
        }
    }

    // Lines from each joint down its column, beneath everything else.
    void guides() {
        Svg below;
        for (uint32_t joint = 0; joint < rig_.joint_count(); ++joint)
            below.line(node(joint), {centre(joint), y_ + 4}, "guide");
        svg_.put_below(below);
    }

    void note(std::string_view text) {
        y_ += 28;
        svg_.text({kMargin, y_}, text, "");
        y_ += height_of_breaks(text);
    }

    void legend() {
        legend_of_strips(3, "known t0", "a joint's chain, the root on the left: what the joint's product covers so far",
                         "all of it: the joint's model_from_joint");
        y_ += 16;
        x_ = kMargin;
        legend_text("left factor:", 62);
        constexpr std::array<std::tuple<const char*, const char*, double>, 3> kSources{
            {{"from hollow t0", "local transform", 90},
             {"from t0", "product from memory or another thread", 206},
             {"", "own register", 0}}};
        for (const auto& [style, text, width] : kSources) {
            svg_.line({x_, y_ - 3}, {x_ + 14, y_ - 3}, "move t0");
            if (*style) svg_.dot({x_ + 1, y_ - 3}, 2.3, style);
            x_ += 19;
            legend_text(text, width);
        }
        legend_of_colours();
    }

    void legend_of_stored() {
        legend_of_strips(5, "own", "stored in the clip: the joint's whole chain, multiplied offline",
                         "the joint's skin matrix");
        legend_of_colours();
    }

    std::string finish() const { return svg_.document(kWidth, y_ + kMargin, name_ + ": " + summary_); }

private:
    void legend_of_colours() {
        svg_.text({kWidth - kMargin, y_}, thread_count_ > kColours ? "colour: thread (they repeat)" : "colour: thread",
                  "soft small end");
    }

    // Explains a strip with `covered` segments in `style`, and one with an outline.
    void legend_of_strips(uint32_t covered, std::string_view style, std::string_view what, std::string_view result) {
        y_ += 14;
        svg_.line({kMargin, y_}, {kWidth - kMargin, y_}, "next");
        y_ += 17;
        x_ = kMargin;
        legend_strip(covered, style, false);
        legend_text(what, 358);
        legend_strip(5, "known t0", true);
        legend_text(result, 0);
    }

    void legend_text(std::string_view text, double width) {
        svg_.text({x_, y_}, text, "soft small");
        x_ += width;
    }

    void legend_strip(uint32_t covered, std::string_view style, bool stored) {
        constexpr uint32_t kCells = 5;
        strip_at({x_, y_ - kStrip}, kStrip, kCells, covered, style, stored);
        x_ += kCells * kSegment + 6;
    }

    void strip_at(Point corner, double height, uint32_t depth, size_t covered, std::string_view style, bool stored) {
        for (uint32_t i = 0; i < depth; ++i)
            svg_.rect({corner.x + i * kSegment, corner.y}, kSegment - 0.6, height,
                      i + covered >= depth ? style : "cell");
        if (stored) svg_.rect({corner.x - 1.8, corner.y - 1.8}, depth * kSegment + 3, height + 3.6, "done", 2);
    }

    double centre(uint32_t joint) const { return kLeft + (joint + 0.5) * kColumn; }
    Point node(uint32_t joint) const { return {centre(joint), kTreeTop + (rig_.depths[joint] - 1) * kLevel}; }
    double strip_left(uint32_t joint) const { return centre(joint) - rig_.depths[joint] * kSegment / 2; }

    // Draws a line from the left factor's joint to the segments that the factor adds; `raised` keeps the lines of a
    // stack apart.
    void operand(const FlowStep& step, double raised) {
        if (step.source == FlowSource::kIdentity) {
            svg_.text({strip_left(step.joint) - 4, y_ + kGap + 7}, "×1", "soft small end");
            return;
        }
        const std::string style = thread_style(step.thread);
        const size_t right_length = step.product.size() - step.source_length;
        const double middle = rig_.depths[step.joint] - static_cast<double>(right_length) -
                              static_cast<double>(step.source_length) / 2;
        const Point from{centre(step.source_joint), y_ + 3 - raised / 2},
            to{strip_left(step.joint) + middle * kSegment, y_ + kGap - 1.5 - raised};
        if (step.source != FlowSource::kLocal && from.y - bottoms_[step.source_joint] > 4)
            svg_.line({from.x, bottoms_[step.source_joint] + 2}, from,
                      step.source == FlowSource::kRegister ? "carry " + style : "kept");
        svg_.line(from, to, "move " + style);
        if (step.source == FlowSource::kLocal) svg_.dot(from, 2.2, "from hollow " + style);
        if (step.source == FlowSource::kShared) svg_.dot(from, 2.4, "from " + style);
    }

    const ScanRig& rig_;
    std::string name_, summary_;
    Svg svg_;
    double y_ = 0;                 // the bottom of what has been drawn
    double x_ = 0;                 // the right end of the last line of the legend
    std::vector<double> bottoms_;  // [joint], of its last strip
    uint32_t row_count_ = 0, thread_count_ = 0;
};

std::string plural(uint32_t count, const std::string& word) {
    return std::to_string(count) + " " + word + (count == 1 ? "" : "s");
}

std::string counts_text(size_t multiplications, uint32_t longest, uint32_t barriers) {
    return plural(static_cast<uint32_t>(multiplications), "multiplication") + "  ·  longest thread " +
           std::to_string(longest) + "  ·  " + (barriers == 0 ? "no barrier" : plural(barriers, "barrier"));
}

Diagram draw(const ScanMethod& method) {
    const ScanRig rig = diagram_rig();
    const Flow flow = method.picture.simulate(rig, kDiagramSettings);
    Drawing drawing(rig, method.name, method.summary);
    drawing.counts(counts_text(flow.steps.size(), flow.longest_thread(), flow.barriers()));
    drawing.tree(flow.writers, true);
    drawing.locals_row(flow);
    for (uint32_t phase = 0; phase < flow.phases.size(); ++phase) {
        if (phase > 0) drawing.boundary(flow.phases[phase].before);
        if (flow.rows(phase) > 0) drawing.phase(flow, phase);
    }
    drawing.guides();
    if (method.picture.has_blocks) drawing.block_edges(kDiagramSettings.block);
    drawing.note(method.picture.note);
    drawing.legend();
    return {std::string(method.name), drawing.finish()};
}

// The baselines have no hierarchy left to scan.
Diagram draw(const Baseline& baseline, bool binds_at_run_time) {
    const ScanRig rig = diagram_rig();
    std::vector<uint32_t> own_threads(rig.joint_count());
    std::iota(own_threads.begin(), own_threads.end(), 0u);
    Drawing drawing(rig, baseline.name, baseline.summary);
    drawing.counts("no scan  ·  no barrier");
    drawing.tree(own_threads, false);
    drawing.stored_row("earlier frame");
    drawing.stored_row("later frame");
    drawing.column_row("interpolate", 2, !binds_at_run_time);
    if (binds_at_run_time) drawing.column_row("bind", 1, true);
    drawing.guides();
    drawing.note(binds_at_run_time ? "Nothing passes between joints: each moves in model space by itself. A second "
                                     "clip is read likewise and blended\n"
                                     "in before the bind: there joints drift from their parents."
                                   : "Nothing passes between joints: the skin matrices of two frames are mixed number "
                                     "by number. A second clip\n"
                                     "is read likewise and mixed in: there limbs shrink.");
    drawing.legend_of_stored();
    return {std::string(baseline.name), drawing.finish()};
}

}  // namespace

ScanRig diagram_rig() {
    constexpr std::array<uint32_t, 16> kParents{kNone, 0, 1, 0, 3, 4, 3, 6, 6, 8, 9, 8, 11, 12, 13, 13};
    return ScanRig(kParents);
}

std::vector<Diagram> scan_diagrams() {
    std::vector<Diagram> out;
    for (const ScanMethod& method : scan_table())
        if (method.picture.simulate) out.push_back(draw(method));
    out.push_back(draw(baked(), false));
    out.push_back(draw(flattened(), true));
    return out;
}

}  // namespace throng::bench
