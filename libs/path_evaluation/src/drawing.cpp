#include "metier/path_evaluation/drawing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "metier/base/numbers.hpp"
#include "svg.hpp"

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

/// Maps positions of one square to the picture.
class Panel {
public:
    Panel(const DrawnPath& path, double left) : path_(path), left_(left) {}

    Spot spot(const Eigen::Vector3d& position) const {
        const double height = across(position, path_.square.up) + margin();
        return {plotLeft() + scale() * (across(position, path_.square.right) + margin()),
                kPathTop + kPlotSize - scale() * height};
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

void drawOutline(SvgPicture& picture, const Panel& panel) {
    std::vector<Spot> spots;
    for (std::size_t i = 0; i < kCorners; ++i) {
        spots.push_back(panel.spot(panel.path().square.corner(i).translation));
    }
    picture.polygon(spots, "ideal");
}

void drawMeasured(SvgPicture& picture, const Panel& panel) {
    std::vector<Spot> spots;
    for (const auto& position : panel.path().positions) {
        spots.push_back(panel.spot(position));
    }
    picture.polyline(spots, "measured");
    const auto start = panel.spot(panel.path().square.start.translation);
    picture.circle(start, 4, "start");
    picture.text({start.x + 8, start.y + 16}, "note", "start");
}

void drawSideLength(SvgPicture& picture, const Panel& panel) {
    const auto& square = panel.path().square;
    const double middle =
        (panel.spot(square.corner(0).translation).x + panel.spot(square.corner(1).translation).x) /
        2;
    picture.text({middle, panel.spot(square.corner(3).translation).y - 8}, "note centred",
                 fmt::format("{:.0f} mm", square.side * kMillimetresPerMetre));
}

std::vector<Spot> deviationCurve(const Panel& panel, double top_mm) {
    const auto& path = panel.path();
    const auto count = static_cast<double>(std::max<std::size_t>(path.positions.size(), 2) - 1);
    std::vector<Spot> spots;
    for (std::size_t i = 0; i < path.positions.size(); ++i) {
        const double mm =
            distanceFromOutline(path.square, path.positions[i]) * kMillimetresPerMetre;
        spots.push_back({panel.plotLeft() + kPlotSize * static_cast<double>(i) / count,
                         kDeviationTop + kDeviationHeight * (1 - std::min(mm / top_mm, 1.0))});
    }
    return spots;
}

void drawDeviation(SvgPicture& picture, const Panel& panel) {
    const double top_mm =
        roundedUp(panel.path().measurement.largest_deviation * kMillimetresPerMetre);
    const Box box{panel.plotLeft(), kDeviationTop, kPlotSize, kDeviationHeight};
    picture.rectangle(box, "frame");
    picture.text({box.left - 6, box.top + 10}, "note right", fmt::format("{:g} mm", top_mm));
    picture.text({box.left - 6, box.bottom()}, "note right", "0");
    picture.text({box.left, box.top - 8}, "note", "distance from the side");
    picture.text({box.right(), box.bottom() + 16}, "note right", "along the way");
    picture.polyline(deviationCurve(panel, top_mm), "deviation");
}

void drawPanel(SvgPicture& picture, const Panel& panel) {
    const auto& path = panel.path();
    picture.text({panel.plotLeft(), 28}, "title", path.name);
    picture.text({panel.plotLeft(), 48}, "note",
                 fmt::format("deviation {:.4f} mm, closure {:.4f} mm",
                             path.measurement.largest_deviation * kMillimetresPerMetre,
                             path.measurement.closure_error * kMillimetresPerMetre));
    picture.rectangle({panel.plotLeft(), kPathTop, kPlotSize, kPlotSize}, "frame");
    drawOutline(picture, panel);
    drawMeasured(picture, panel);
    drawSideLength(picture, panel);
    drawDeviation(picture, panel);
}

constexpr std::string_view kStyle = R"(text{font-family:system-ui,sans-serif;fill:#1f2933}
.title{font-size:16px;font-weight:600}
.note{font-size:12px;fill:#52606d}
.right{text-anchor:end}.centred{text-anchor:middle}
.frame{fill:#f5f7fa;stroke:#cbd2d9}
.ideal{fill:none;stroke:#9fb3c8;stroke-width:6;stroke-linejoin:round}
.measured{fill:none;stroke:#d64545;stroke-width:1.6;stroke-linejoin:round}
.start{fill:#1f2933}
.deviation{fill:none;stroke:#2680c2;stroke-width:1.2}
)";

}  // namespace

std::string drawSvg(std::span<const DrawnPath> paths) {
    const double width = kPanelWidth * static_cast<double>(std::max<std::size_t>(paths.size(), 1));
    SvgPicture picture(width, kPanelHeight, kStyle);
    for (std::size_t i = 0; i < paths.size(); ++i) {
        drawPanel(picture, Panel(paths[i], kPanelWidth * static_cast<double>(i)));
    }
    return std::move(picture).finish();
}

}  // namespace metier::path_evaluation
