#include "metier/path_evaluation/drawing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace metier::path_evaluation {
namespace {

constexpr double kPanelWidth = 340;
constexpr double kPanelHeight = 470;
constexpr double kPlotSize = 240;  // edge of the path plot and width of the deviation plot [px]
constexpr double kPlotLeft = 70;
constexpr double kPathTop = 70;
constexpr double kDeviationTop = 365;
constexpr double kDeviationHeight = 60;
constexpr double kMargin = 0.15;  // free space around the square, as a part of its side
constexpr double kMillimetre = 1000;

using Out = std::back_insert_iterator<std::string>;

std::string escaped(const std::string& text) {
    std::string result;
    for (const char c : text) {
        switch (c) {
            case '&':
                result += "&amp;";
                break;
            case '<':
                result += "&lt;";
                break;
            case '>':
                result += "&gt;";
                break;
            case '"':
                result += "&quot;";
                break;
            default:
                result += c;
        }
    }
    return result;
}

/// Maps positions of one square to the picture.
class Panel {
public:
    Panel(const DrawnPath& path, double left) : path_(path), left_(left) {}

    double x(const Eigen::Vector3d& position) const {
        return plotLeft() + scale() * (across(position, path_.square.right) + margin());
    }
    double y(const Eigen::Vector3d& position) const {
        const double height = across(position, path_.square.up) + margin();
        return kPathTop + kPlotSize - scale() * height;
    }
    double plotLeft() const { return left_ + kPlotLeft; }
    const DrawnPath& path() const { return path_; }

private:
    double margin() const { return kMargin * path_.square.side; }
    double scale() const { return kPlotSize / (path_.square.side + 2 * margin()); }
    double across(const Eigen::Vector3d& position, const Eigen::Vector3d& direction) const {
        return (position - path_.square.start.translation).dot(direction);
    }

    const DrawnPath& path_;
    double left_;
};

void drawText(Out out, double x, double y, std::string_view style, std::string_view text) {
    fmt::format_to(out, "<text x=\"{:.1f}\" y=\"{:.1f}\" class=\"{}\">{}</text>\n", x, y, style,
                   text);
}

void drawOutline(Out out, const Panel& panel) {
    fmt::format_to(out, "<polygon class=\"ideal\" points=\"");
    for (const auto& corner : panel.path().square.corners()) {
        fmt::format_to(out, "{:.2f},{:.2f} ", panel.x(corner.translation),
                       panel.y(corner.translation));
    }
    fmt::format_to(out, "\"/>\n");
}

void drawMeasured(Out out, const Panel& panel) {
    fmt::format_to(out, "<polyline class=\"measured\" points=\"");
    for (const auto& position : panel.path().positions) {
        fmt::format_to(out, "{:.2f},{:.2f} ", panel.x(position), panel.y(position));
    }
    fmt::format_to(out, "\"/>\n");
    const auto& start = panel.path().square.start.translation;
    fmt::format_to(out, "<circle class=\"start\" cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"4\"/>\n",
                   panel.x(start), panel.y(start));
    drawText(out, panel.x(start) + 8, panel.y(start) + 16, "note", "start");
}

void drawSideLength(Out out, const Panel& panel) {
    const auto& square = panel.path().square;
    const double middle =
        (panel.x(square.corner(0).translation) + panel.x(square.corner(1).translation)) / 2;
    drawText(out, middle, panel.y(square.corner(3).translation) - 8, "note centred",
             fmt::format("{:.0f} mm", square.side * kMillimetre));
}

/// The smallest of 1, 2, 5 times a power of ten that is at least `value`.
double roundScale(double value) {
    const double power = std::pow(10.0, std::floor(std::log10(std::max(value, 1e-6))));
    for (const double step : {1.0, 2.0, 5.0}) {
        if (step * power >= value) {
            return step * power;
        }
    }
    return 10.0 * power;
}

void drawDeviation(Out out, const Panel& panel) {
    const auto& path = panel.path();
    const double top_mm = roundScale(path.measurement.largest_deviation * kMillimetre);
    const double bottom = kDeviationTop + kDeviationHeight;
    fmt::format_to(out,
                   "<rect class=\"frame\" x=\"{:.1f}\" y=\"{}\" width=\"{}\" height=\"{}\"/>\n",
                   panel.plotLeft(), kDeviationTop, kPlotSize, kDeviationHeight);
    drawText(out, panel.plotLeft() - 6, kDeviationTop + 10, "note right",
             fmt::format("{:g} mm", top_mm));
    drawText(out, panel.plotLeft() - 6, bottom, "note right", "0");
    drawText(out, panel.plotLeft(), kDeviationTop - 8, "note", "distance from the side");
    drawText(out, panel.plotLeft() + kPlotSize, bottom + 16, "note right", "along the way");
    fmt::format_to(out, "<polyline class=\"deviation\" points=\"");
    const auto count = static_cast<double>(std::max<std::size_t>(path.positions.size(), 2) - 1);
    for (std::size_t i = 0; i < path.positions.size(); ++i) {
        const double mm = distanceFromOutline(path.square, path.positions[i]) * kMillimetre;
        fmt::format_to(out, "{:.2f},{:.2f} ",
                       panel.plotLeft() + kPlotSize * static_cast<double>(i) / count,
                       bottom - kDeviationHeight * std::min(mm / top_mm, 1.0));
    }
    fmt::format_to(out, "\"/>\n");
}

void drawPanel(Out out, const Panel& panel) {
    const auto& path = panel.path();
    drawText(out, panel.plotLeft(), 28, "title", escaped(path.name));
    drawText(out, panel.plotLeft(), 48, "note",
             fmt::format("deviation {:.4f} mm, closure {:.4f} mm",
                         path.measurement.largest_deviation * kMillimetre,
                         path.measurement.closure_error * kMillimetre));
    fmt::format_to(out,
                   "<rect class=\"frame\" x=\"{:.1f}\" y=\"{}\" width=\"{}\" height=\"{}\"/>\n",
                   panel.plotLeft(), kPathTop, kPlotSize, kPlotSize);
    drawOutline(out, panel);
    drawMeasured(out, panel);
    drawSideLength(out, panel);
    drawDeviation(out, panel);
}

constexpr std::string_view kStyle = R"(<style>
text{font-family:system-ui,sans-serif;fill:#1f2933}
.title{font-size:16px;font-weight:600}
.note{font-size:12px;fill:#52606d}
.right{text-anchor:end}.centred{text-anchor:middle}
.frame{fill:#f5f7fa;stroke:#cbd2d9}
.ideal{fill:none;stroke:#9fb3c8;stroke-width:6;stroke-linejoin:round}
.measured{fill:none;stroke:#d64545;stroke-width:1.6;stroke-linejoin:round}
.start{fill:#1f2933}
.deviation{fill:none;stroke:#2680c2;stroke-width:1.2}
</style>
)";

}  // namespace

std::string drawSvg(std::span<const DrawnPath> paths) {
    std::string svg;
    const Out out(svg);
    const double width = kPanelWidth * static_cast<double>(std::max<std::size_t>(paths.size(), 1));
    fmt::format_to(out,
                   "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" "
                   "viewBox=\"0 0 {0} {1}\">\n{2}<rect width=\"100%\" height=\"100%\" "
                   "fill=\"#ffffff\"/>\n",
                   width, kPanelHeight, kStyle);
    for (std::size_t i = 0; i < paths.size(); ++i) {
        drawPanel(out, Panel(paths[i], kPanelWidth * static_cast<double>(i)));
    }
    svg += "</svg>\n";
    return svg;
}

}  // namespace metier::path_evaluation
