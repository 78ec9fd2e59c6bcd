#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace metier::path_evaluation {

/// A place in a picture [px]; y grows downwards.
struct Spot {
    double x = 0;
    double y = 0;
};

/// A rectangle in a picture [px].
struct Box {
    double left = 0;
    double top = 0;
    double width = 0;
    double height = 0;
    double right() const noexcept { return left + width; }
    double bottom() const noexcept { return top + height; }
};

/// Writes an SVG picture on white. Texts are escaped; `style` names CSS classes of the picture.
class SvgPicture {
public:
    /// \param rules the picture's CSS
    SvgPicture(double width, double height, std::string_view rules);

    void text(Spot at, std::string_view style, std::string_view content);
    void line(Spot from, Spot to, std::string_view style);
    void rectangle(const Box& box, std::string_view style);
    void circle(Spot centre, double radius, std::string_view style);
    void polyline(std::span<const Spot> spots, std::string_view style);
    void polygon(std::span<const Spot> spots, std::string_view style);
    /// Limits the following drawing to the inside of the box, until endClip().
    void beginClip(const Box& box);
    void endClip();

    /// The whole picture; nothing can be drawn after it.
    std::string finish() &&;

private:
    void points(std::string_view element, std::span<const Spot> spots, std::string_view style);

    std::string svg_;
};

/// The spots that a line must keep so that no left-out one is more than `tolerance` [px] off it.
std::vector<Spot> simplified(std::span<const Spot> spots, double tolerance);

/// The smallest of 1, 2, 5 times a power of ten that is at least `value` (at least 1e-6).
double roundedUp(double value);

/// Multiples of a round step from `low` to `high`, at most `most` + 1 of them; low < high.
std::vector<double> ticksBetween(double low, double high, int most);

}  // namespace metier::path_evaluation
