#include "bench/diagrams/svg.h"

#include "bench/report/html.h"

#include <algorithm>
#include <cstdio>

namespace throng::bench {
namespace {

// Threads: the palette of Okabe and Ito (Color Universal Design, 2008) without its yellow and black.
constexpr std::string_view kSvgStyle = R"(<style>
svg{--paper:#fff;--edge:#d0d7de;--ink:#1f2328;--soft:#656d76;--faint:#eef1f4;--cell:#dfe4ea;--own:#9aa4b0}
@media(prefers-color-scheme:dark){svg{--paper:#0d1117;--edge:#30363d;--ink:#e6edf3;--soft:#9198a1;--faint:#1a2028;)"
                                       R"(--cell:#2b323b;--own:#6e7884}.t0.t0{--t:#2a86d1}}
.t0{--t:#0072b2}.t1{--t:#e69f00}.t2{--t:#009e73}.t3{--t:#cc79a7}.t4{--t:#56b4e9}.t5{--t:#d55e00}
text{font-family:Inter,system-ui,Helvetica,Arial,sans-serif;font-size:11px;fill:var(--ink)}
.paper{fill:var(--paper);stroke:var(--edge)}
.name{font-size:16px;font-weight:600}.soft{fill:var(--soft)}.small{font-size:9.5px}.mid{text-anchor:middle})"
                                       R"(.end{text-anchor:end}.bold{font-weight:600}
.joint{fill:var(--t);stroke:none}.number{font-size:9.5px;font-weight:600;fill:#fff;text-anchor:middle}
.bone{stroke:var(--soft);stroke-width:1.4;fill:none}.cut{stroke-dasharray:2 3;opacity:.6}
.guide{stroke:var(--faint);stroke-width:1}.block{stroke:var(--soft);stroke-dasharray:3 4;opacity:.6}
.cell{fill:var(--cell)}.own{fill:var(--own)}.known{fill:var(--t)}.done{fill:none;stroke:var(--ink);stroke-width:1.2}
.carry{stroke:var(--t);stroke-width:1;opacity:.6}.kept{stroke:var(--own);stroke-width:1}
.move{stroke:var(--t);stroke-width:1.5;fill:none}.from{fill:var(--t);stroke:var(--t);stroke-width:1.2})"
                                       R"(.hollow{fill:var(--paper)}
.wait{stroke:var(--ink);stroke-width:1.2}.shuffle{stroke:var(--ink);stroke-width:1.2;stroke-dasharray:5 4})"
                                       R"(.next{stroke:var(--edge)}
</style>)";

std::string svg_number(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.1f", value);
    std::string out = text;
    if (out.ends_with(".0")) out.resize(out.size() - 2);
    return out == "-0" ? "0" : out;
}

using Attributes = std::initializer_list<std::pair<const char*, double>>;

std::string attributes(Attributes numbers) {
    std::string all;
    for (const auto& [name, value] : numbers) all += std::string(" ") + name + "=\"" + svg_number(value) + "\"";
    return all;
}

}  // namespace

void Svg::element(const std::string& beginning, std::string_view style, const std::string& end) {
    body_ += "<" + beginning + " class=\"" + std::string(style) + "\"" + end + "\n";
}

void Svg::rect(Point corner, double width, double height, std::string_view style, double rounding) {
    element("rect" + attributes({{"x", corner.x}, {"y", corner.y}, {"width", width}, {"height", height}}) +
                (rounding > 0 ? attributes({{"rx", rounding}}) : ""),
            style);
}

void Svg::line(Point from, Point to, std::string_view style) {
    element("line" + attributes({{"x1", from.x}, {"y1", from.y}, {"x2", to.x}, {"y2", to.y}}), style);
}

void Svg::curve(Point from, Point to, std::string_view style) {
    const std::string middle = svg_number((from.y + to.y) / 2);
    element("path d=\"M" + svg_number(from.x) + " " + svg_number(from.y) + "C" + svg_number(from.x) + " " + middle +
                " " + svg_number(to.x) + " " + middle + " " + svg_number(to.x) + " " + svg_number(to.y) + "\"",
            style);
}

void Svg::dot(Point centre, double radius, std::string_view style) {
    element("circle" + attributes({{"cx", centre.x}, {"cy", centre.y}, {"r", radius}}), style);
}

void Svg::text(Point at, std::string_view text, std::string_view style) {
    constexpr double kLine = 13;
    for (size_t begin = 0; begin <= text.size(); at.y += kLine) {
        const size_t end = std::min(text.find('\n', begin), text.size());
        element("text" + attributes({{"x", at.x}, {"y", at.y}}), style,
                ">" + escape(text.substr(begin, end - begin)) + "</text>");
        begin = end + 1;
    }
}

std::string Svg::document(double width, double height, std::string_view title) const {
    return "<svg xmlns=\"http://www.w3.org/2000/svg\"" + attributes({{"width", width}, {"height", height}}) +
           " viewBox=\"0 0 " + svg_number(width) + " " + svg_number(height) + "\" role=\"img\">\n<title>" +
           escape(title) + "</title>\n" + std::string(kSvgStyle) + "\n<rect x=\"0.5\" y=\"0.5\"" +
           attributes({{"width", width - 1}, {"height", height - 1}}) + " rx=\"8\" class=\"paper\"/>\n" + body_ +
           "</svg>\n";
}

}  // namespace throng::bench
