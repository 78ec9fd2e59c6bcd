#include "svg.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>

#include "metier/path_evaluation/square.hpp"

namespace metier::path_evaluation {
namespace {

std::string escaped(std::string_view text) {
    constexpr std::string_view special = "&<>\"";
    constexpr std::array names{"&amp;", "&lt;", "&gt;", "&quot;"};
    std::string result;
    for (const char c : text) {
        const auto name = special.find(c);
        result += name < names.size() ? names.at(name) : std::string(1, c);
    }
    return result;
}

Eigen::Vector3d toVector(Spot spot) {
    return {spot.x, spot.y, 0};
}

}  // namespace

SvgPicture::SvgPicture(double width, double height, std::string_view rules) {
    svg_ = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" "
        "viewBox=\"0 0 {0} {1}\">\n<style>\n{2}</style>\n"
        "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n",
        width, height, rules);
}

void SvgPicture::text(Spot at, std::string_view style, std::string_view content) {
    fmt::format_to(std::back_inserter(svg_),
                   "<text x=\"{:.1f}\" y=\"{:.1f}\" class=\"{}\">{}</text>\n", at.x, at.y, style,
                   escaped(content));
}

void SvgPicture::line(Spot from, Spot to, std::string_view style) {
    fmt::format_to(std::back_inserter(svg_),
                   "<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" class=\"{}\"/>\n",
                   from.x, from.y, to.x, to.y, style);
}

void SvgPicture::rectangle(const Box& box, std::string_view style) {
    fmt::format_to(
        std::back_inserter(svg_),
        "<rect class=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"/>\n",
        style, box.left, box.top, box.width, box.height);
}

void SvgPicture::circle(Spot centre, double radius, std::string_view style) {
    fmt::format_to(std::back_inserter(svg_),
                   "<circle class=\"{}\" cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"{}\"/>\n", style, centre.x,
                   centre.y, radius);
}

void SvgPicture::polyline(std::span<const Spot> spots, std::string_view style) {
    points("polyline", spots, style);
}

void SvgPicture::polygon(std::span<const Spot> spots, std::string_view style) {
    points("polygon", spots, style);
}

void SvgPicture::points(std::string_view element, std::span<const Spot> spots,
                        std::string_view style) {
    fmt::format_to(std::back_inserter(svg_), R"(<{} class="{}" points=")", element, style);
    for (const auto& spot : spots) {
        fmt::format_to(std::back_inserter(svg_), "{:.2f},{:.2f} ", spot.x, spot.y);
    }
    svg_ += "\"/>\n";
}

void SvgPicture::beginClip(const Box& box) {
    // A nested picture clips at its border, without an id that must be unique on a page.
    fmt::format_to(std::back_inserter(svg_),
                   "<svg x=\"{0:.1f}\" y=\"{1:.1f}\" width=\"{2:.1f}\" height=\"{3:.1f}\" "
                   "viewBox=\"{0:.1f} {1:.1f} {2:.1f} {3:.1f}\">\n",
                   box.left, box.top, box.width, box.height);
}

void SvgPicture::endClip() {
    svg_ += "</svg>\n";
}

std::string SvgPicture::finish() && {
    svg_ += "</svg>\n";
    return std::move(svg_);
}

std::vector<Spot> simplified(std::span<const Spot> spots, double tolerance) {
    // Ramer, Douglas and Peucker, with a stack of stretches instead of calls.
    if (spots.size() < 3) {
        return {spots.begin(), spots.end()};
    }
    std::vector<bool> kept(spots.size(), false);
    kept.front() = kept.back() = true;
    std::vector<std::pair<std::size_t, std::size_t>> stretches{{0, spots.size() - 1}};
    while (!stretches.empty()) {
        const auto [first, last] = stretches.back();
        stretches.pop_back();
        double farthest = tolerance;
        std::size_t at = first;
        for (std::size_t i = first + 1; i < last; ++i) {
            const double distance = distanceFromSegment(toVector(spots[i]), toVector(spots[first]),
                                                        toVector(spots[last]));
            if (distance > farthest) {
                farthest = distance;
                at = i;
            }
        }
        if (at != first) {
            kept[at] = true;
            stretches.emplace_back(first, at);
            stretches.emplace_back(at, last);
        }
    }
    std::vector<Spot> result;
    for (std::size_t i = 0; i < spots.size(); ++i) {
        if (kept[i]) {
            result.push_back(spots[i]);
        }
    }
    return result;
}

double roundedUp(double value) {
    const double power = std::pow(10.0, std::floor(std::log10(std::max(value, 1e-6))));
    for (const double step : {1.0, 2.0, 5.0}) {
        if (step * power >= value) {
            return step * power;
        }
    }
    return 10.0 * power;
}

std::vector<double> ticksBetween(double low, double high, int most) {
    const double step = roundedUp((high - low) / most);
    std::vector<double> ticks;
    for (double index = std::ceil(low / step - 1e-9); index * step <= high + 1e-9 * step; ++index) {
        ticks.push_back(index == 0 ? 0.0 : index * step);
    }
    return ticks;
}

}  // namespace metier::path_evaluation
