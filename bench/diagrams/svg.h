// Drawing into an SVG document that is legible on light and on dark pages. Colours are names of the style sheet in
// svg.cpp.
#pragma once

#include <string>
#include <string_view>

namespace throng::bench {

struct Point {
    double x = 0, y = 0;
};

class Svg {
public:
    void rect(Point corner, double width, double height, std::string_view style, double rounding = 0);
    void line(Point from, Point to, std::string_view style);
    void curve(Point from, Point to, std::string_view style);  // leaves and arrives vertically
    void dot(Point centre, double radius, std::string_view style);
    // Lines are separated by \n; `style` can set the anchor
    void text(Point at, std::string_view text, std::string_view style);

    void put_below(const Svg& other) { body_ = other.body_ + body_; }

    // The document; `title` describes it to screen readers.
    std::string document(double width, double height, std::string_view title) const;

private:
    // `beginning`: its name and attributes except the class.
    void element(const std::string& beginning, std::string_view style, const std::string& end = "/>");

    std::string body_;
};

}  // namespace throng::bench
