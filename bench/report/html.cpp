#include "bench/report/html.h"

#include <array>
#include <cmath>
#include <cstdio>

namespace throng::bench {
namespace {

constexpr std::string_view kHtmlStyle = R"(
:root { color-scheme: light dark; --ink: #1f2328; --soft: #59636e; --line: #d8dee4; --page: #ffffff; --raised: )"
                                        R"(#f6f8fa; --best: #0550ae; --bad: #b3261e; }
@media (prefers-color-scheme: dark) {
  :root { --ink: #e6edf3; --soft: #9da7b1; --line: #30363d; --page: #0d1117; --raised: #161b22; --best: #79c0ff; )"
                                        R"(--bad: #ff8a80; }
}
* { box-sizing: border-box; }
body { margin: 0 auto; padding: 2.5rem 1.5rem 5rem; max-width: 64rem; background: var(--page); color: var(--ink);
  font: 16px/1.55 Inter, system-ui, -apple-system, "Segoe UI", "Helvetica Neue", Arial, sans-serif; }
h1 { font-size: 2rem; line-height: 1.2; letter-spacing: -0.02em; margin: 0 0 0.75rem; }
h2 { font-size: 1.4rem; letter-spacing: -0.01em; margin: 3.5rem 0 0.75rem; padding-top: 1rem; border-top: 1px solid )"
                                        R"(var(--line); }
section:first-of-type h2 { margin-top: 1rem; }
h3 { font-size: 1.08rem; margin: 2.5rem 0 0.25rem; }
p, figcaption { max-width: 46rem; }
p { margin: 0.4rem 0 1rem; }
code { font: 0.88em ui-monospace, "SF Mono", Menlo, Consolas, monospace; }
.facts { display: flex; flex-wrap: wrap; gap: 0.2rem 1.6rem; margin: 0; color: var(--soft); font-size: 0.9rem; }
.facts div { display: flex; gap: 0.4rem; } .facts dt { white-space: nowrap; } .facts dd { margin: 0; color: )"
                                        R"(var(--ink); overflow-wrap: anywhere; }
figure { margin: 0.75rem 0 1.5rem; }
.plot svg { display: block; width: 100%; height: auto; }
figcaption, .soft { color: var(--soft); font-size: 0.9rem; }
[data-series] { transition: opacity 0.12s; }
.legend { display: flex; flex-wrap: wrap; gap: 0.4rem; padding: 0.6rem 0; background: var(--page); }
.legend button { display: inline-flex; align-items: center; gap: 0.4rem; padding: 0.1rem 0.6rem; border: 1px solid )"
                                        R"(var(--line); border-radius: 1rem;
  background: none; color: inherit; font: inherit; font-size: 0.8rem; cursor: pointer; }
.legend button[aria-pressed=false] { opacity: 0.45; text-decoration: line-through; }
.swatch { display: inline-block; width: 0.65rem; height: 0.65rem; border-radius: 50%; background: var(--light); )"
                                        R"(flex: none; }
@media (prefers-color-scheme: dark) { .swatch { background: var(--dark); } }
@media (min-width: 60rem) and (min-height: 40rem) { .legend { position: sticky; top: 0; z-index: 1; } }
.scroll { overflow-x: auto; margin: 0.5rem 0 1rem; }
table { border-collapse: collapse; font-size: 0.86rem; line-height: 1.35; font-variant-numeric: tabular-nums; }
th, td { padding: 0.28rem 0.7rem; text-align: right; white-space: nowrap; border-bottom: 1px solid var(--line); }
th { color: var(--soft); font-weight: 500; vertical-align: bottom; }
td:first-child, th:first-child { text-align: left; padding-left: 0; }
.note, .wide, .cell { text-align: left; } .note, .wide { white-space: normal; } td.note { color: var(--soft); )"
                                        R"(min-width: 14rem; }
.bad { color: var(--bad); }
tr:hover td { background: var(--raised); }
td b { color: var(--best); font-weight: 650; }
td small { color: var(--soft); }
td .swatch { margin-right: 0.5rem; }
td br + small { margin-left: 1.15rem; white-space: nowrap; }
details { margin: 0.35rem 0; }
summary { cursor: pointer; padding: 0.25rem 0; }
summary small { color: var(--soft); font-size: 0.9em; margin-left: 0.4rem; }
.pair { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 27rem), 1fr)); gap: 0 2rem; }
@media (max-width: 40rem) { body { padding: 1.25rem 1rem 3rem; } h1 { font-size: 1.6rem; } figure > .plot:not(.pair )"
                                        R"(*) text { font-size: 16px; } }
@media print { .legend { display: none; } }
)";

// A click on a method hides it in every plot; the pointer over it dims the others.
constexpr std::string_view kScript = R"(
const series = [...document.querySelectorAll("svg [data-series]")];
for (const button of document.querySelectorAll(".legend button")) {
  const own = series.filter(part => part.dataset.series === button.dataset.method);
  const dim = opacity => series.forEach(part => { part.style.opacity = own.includes(part) ? "" : opacity; });
  button.addEventListener("click", () => {
    const shown = button.getAttribute("aria-pressed") === "false";
    button.setAttribute("aria-pressed", shown);
    own.forEach(part => { part.style.display = shown ? "" : "none"; });
  });
  button.addEventListener("mouseenter", () => dim("0.12"));
  button.addEventListener("mouseleave", () => dim(""));
}
)";

std::string print(const char* format, double value) {
    std::array<char, 64> text;
    std::snprintf(text.data(), text.size(), format, value);
    return text.data();
}

}  // namespace

std::string escape(std::string_view text) {
    std::string escaped;
    for (const char c : text)
        escaped += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '"' ? "&quot;" : std::string(1, c);
    return escaped;
}

std::string whole(double value) {
    if (std::isnan(value)) return "–";
    std::string text = print("%.0f", value);
    const size_t first = value < 0 ? 1 : 0;
    for (size_t place = text.size(); place > first + 3;) text.insert(place -= 3, ",");
    return text;
}

std::string digits(double value) {
    if (std::isnan(value)) return "–";
    if (std::abs(value) >= 99.95) return whole(value);
    if (value == 0) return "0";
    if (std::abs(value) < 9.995e-4) return print("%.1e", value);
    const int decimals = 2 - static_cast<int>(std::floor(std::log10(std::abs(value))));
    return print(("%." + std::to_string(decimals) + "f").c_str(), value);
}

std::string details(const std::string& summary, const std::string& content, bool open) {
    return content.empty() ? ""
                           : std::string("<details") + (open ? " open" : "") + "><summary>" + summary + "</summary>\n" +
                                 content + "</details>\n";
}

std::string html_page(const std::string& title, const std::string& body) {
    return "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" "
           "content=\"width=device-width, initial-scale=1\">\n<title>" +
           escape(title) + "</title>\n<style>" + std::string(kHtmlStyle) + "</style>\n</head>\n<body>\n" + body +
           "<script>" + std::string(kScript) + "</script>\n</body>\n</html>\n";
}

}  // namespace throng::bench
