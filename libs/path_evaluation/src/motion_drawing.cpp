#include "metier/path_evaluation/motion_drawing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "svg.hpp"

namespace metier::path_evaluation {
namespace {

using motion::RobotModel;

constexpr double kWidth = 1000;
constexpr double kLeft = 70;        // left edge of the panels over time [px]
constexpr double kPlotWidth = 560;  // the same
constexpr double kPlotHeight = 104;
constexpr double kPanelPitch = 150;
constexpr double kFirstPanel = 128;
constexpr double kViewLeft = 752;
constexpr double kViewWidth = 224;
constexpr double kViewHeight = 186;
constexpr double kViewPitch = 250;
constexpr double kTableTop = 908;
constexpr double kRow = 20;
constexpr double kTolerance = 0.1;     // largest error of a simplified curve [px]
constexpr double kHighestShare = 2.5;  // curves farther beyond a limit are cut off
constexpr double kRoom = 1.1;          // range of an axis, as a multiple of the largest value

constexpr std::string_view kPlotStyle =
    R"(text{font-family:system-ui,sans-serif;font-size:12px;fill:#52606d}
.title{font-size:18px;font-weight:600;fill:#1f2933}
.head{font-size:13px;font-weight:600;fill:#1f2933}
.right{text-anchor:end}.centred{text-anchor:middle}
.frame{fill:#f8fafc;stroke:#cbd2d9}
.grid{stroke:#e4e7eb}.zero{stroke:#9aa5b1}
.limit{stroke:#c81e1e;stroke-width:1.2;stroke-dasharray:6 4}
.limit-text{fill:#c81e1e}
.curve,.key{fill:none;stroke-width:1.6;stroke-linejoin:round}.key{stroke-width:4}
.axis1{stroke:#0072b2}.axis2{stroke:#d55e00}.axis3{stroke:#009e73}.axis4{stroke:#b5489b}
.axis5{stroke:#e69f00}.axis6{stroke:#56b4e9}.axis7{stroke:#3b3b3b}
.path,.speed{stroke:#1f2933}
.start{fill:#1f2933}.end{fill:#ffffff;stroke:#1f2933;stroke-width:2}
)";

/// Name of a quantity and the place of its panel.
struct PanelText {
    Quantity quantity;
    std::string_view name;
    std::string_view title;
    std::string_view unit;
};
constexpr std::array kPanels{
    PanelText{Quantity::position, "position", "joint position / % (-100: lower, 100: upper limit)",
              "rad"},
    PanelText{Quantity::velocity, "velocity", "joint velocity / % of limit", "rad/s"},
    PanelText{Quantity::acceleration, "acceleration", "joint acceleration / % of limit", "rad/s²"},
    PanelText{Quantity::jerk, "jerk", "joint jerk / % of limit", "rad/s³"},
};

/// Maps time and values to one panel.
struct Scale {
    Box box;
    double duration = 1;
    double low = -1;
    double high = 1;

    Spot spot(double time, double value) const {
        return {box.left + box.width * time / duration,
                box.bottom() - box.height * (value - low) / (high - low)};
    }
};

std::string axisClass(std::size_t axis) {
    return fmt::format("axis{}", axis + 1);
}

bool isFinite(const MotionSample& sample) {
    return std::isfinite(sample.time) && sample.position.allFinite() &&
           sample.velocity.allFinite() && sample.acceleration.allFinite() &&
           sample.jerk.allFinite();
}

/// The picture while it is drawn.
class Drawing {
public:
    Drawing(const RobotModel& model, const MotionPicture& content)
        : model_(model),
          content_(content),
          svg_(kWidth, kTableTop + kRow * static_cast<double>(model.axisCount() + 2), kPlotStyle),
          duration_(std::max(content.samples.back().time, 1e-9)) {}

    std::string draw() && {
        svg_.text({24, 34}, "title", content_.title);
        svg_.text({24, 58}, "", content_.note);
        drawKey();
        double top = kFirstPanel;
        for (const auto& panel : kPanels) {
            drawQuantity(panel, {kLeft, top, kPlotWidth, kPlotHeight});
            top += kPanelPitch;
        }
        drawSpeed({kLeft, top, kPlotWidth, kPlotHeight});
        drawViews();
        drawTable();
        return std::move(svg_).finish();
    }

private:
    void drawKey() {
        const double pitch = kPlotWidth / static_cast<double>(model_.axisCount());
        for (std::size_t axis = 0; axis < model_.axisCount(); ++axis) {
            const double left = kLeft + pitch * static_cast<double>(axis);
            svg_.line({left, 84}, {left + 16, 84}, "key " + axisClass(axis));
            svg_.text({left + 21, 88}, "", nameOf(axis));
        }
        svg_.circle({kViewLeft + 5, 84}, 5, "start");
        svg_.text({kViewLeft + 16, 88}, "", "start");
        svg_.circle({kViewLeft + 65, 84}, 5, "end");
        svg_.text({kViewLeft + 76, 88}, "", "end");
    }

    std::string nameOf(std::size_t axis) const {
        const auto& name = model_.chain().joints[axis].name;
        return name.empty() ? fmt::format("axis {}", axis + 1) : name;
    }

    /// Frame, title and time grid of a panel.
    void drawFrame(const Scale& scale, std::string_view title, std::string_view remark) {
        const Box& box = scale.box;
        svg_.rectangle(box, "frame");
        svg_.text({box.left, box.top - 8}, "head", title);
        svg_.text({box.right(), box.top - 8}, "right", remark);
        for (const double time : ticksBetween(0, duration_, 8)) {
            const double x = scale.spot(time, 0).x;
            svg_.line({x, box.top}, {x, box.bottom()}, "grid");
            svg_.text({x, box.bottom() + 15}, "centred", fmt::format("{:g}", time));
        }
        svg_.text({box.right() + 8, box.bottom() + 15}, "", "time / s");
    }

    void drawValueTick(const Scale& scale, double value, std::string_view style,
                       std::string_view text) {
        const double y = scale.spot(0, value).y;
        svg_.line({scale.box.left, y}, {scale.box.right(), y}, style);
        svg_.text({scale.box.left - 8, y + 4}, "right", text);
    }

    void drawLimit(const Scale& scale, double value, std::string_view text) {
        const double y = scale.spot(0, value).y;
        svg_.line({scale.box.left, y}, {scale.box.right(), y}, "limit");
        svg_.text({scale.box.right() + 8, y + 4}, "limit-text", text);
    }

    void drawQuantity(const PanelText& panel, const Box& box) {
        const auto peak = peakOf(content_.samples, model_, panel.quantity);
        const double most = kRoom * std::clamp(peak.share, 1.0, kHighestShare);
        const Scale scale{box, duration_, -most, most};
        drawFrame(scale, panel.title,
                  fmt::format("peak {:.1f} %: {} at {:.2f} s", 100 * peak.share, nameOf(peak.axis),
                              peak.time));
        drawValueTick(scale, -1, "grid", "-100");
        drawValueTick(scale, 0, "zero", "0");
        drawValueTick(scale, 1, "grid", "100");
        svg_.beginClip(box);
        for (std::size_t axis = 0; axis < model_.axisCount(); ++axis) {
            std::vector<Spot> spots;
            for (const auto& sample : content_.samples) {
                const double value = valuesOf(sample, panel.quantity)[axis];
                spots.push_back(scale.spot(
                    sample.time, shareOfLimit(model_.limits(axis), panel.quantity, value)));
            }
            svg_.polyline(simplified(spots, kTolerance),
                          fmt::format("curve {} {}", panel.name, axisClass(axis)));
        }
        svg_.endClip();
        drawLimit(scale, -1, "limit");
        drawLimit(scale, 1, "limit");
    }

    /// Speed of the tool frame's origin between neighbouring samples, at the middle of their times.
    std::vector<std::pair<double, double>> speeds() const {
        std::vector<std::pair<double, double>> result;
        for (std::size_t i = 1; i < content_.samples.size(); ++i) {
            const double step = content_.samples[i].time - content_.samples[i - 1].time;
            const double way = (content_.tool_positions[i] - content_.tool_positions[i - 1]).norm();
            result.emplace_back(content_.samples[i].time - step / 2, step > 0 ? way / step : 0.0);
        }
        return result;
    }

    void drawSpeed(const Box& box) {
        const auto curve = speeds();
        const auto highest =
            std::max_element(curve.begin(), curve.end(),
                             [](const auto& a, const auto& b) { return a.second < b.second; });
        const double most = std::max({highest->second, content_.asked_speed.value_or(0), 1e-3});
        const Scale scale{box, duration_, 0, kRoom * most};
        drawFrame(scale, "speed of the tool frame / (m/s)",
                  fmt::format("peak {:.3f} m/s at {:.2f} s", highest->second, highest->first));
        for (const double value : ticksBetween(0, kRoom * most, 4)) {
            drawValueTick(scale, value, "grid", fmt::format("{:g}", value));
        }
        std::vector<Spot> spots;
        spots.reserve(curve.size());
        for (const auto& [time, speed] : curve) {
            spots.push_back(scale.spot(time, speed));
        }
        svg_.polyline(simplified(spots, kTolerance), "curve speed");
        if (content_.asked_speed) {
            drawLimit(scale, *content_.asked_speed, "asked");
        }
    }

    /// The path as seen along one axis of the base frame.
    struct View {
        std::string_view title;
        int across;
        int up;
    };

    void drawViews() {
        constexpr std::array views{View{"path from above: x, y", 0, 1},
                                   View{"path from the side: x, z", 0, 2},
                                   View{"path from the front: y, z", 1, 2}};
        Eigen::AlignedBox3d extent;
        for (const auto& position : content_.tool_positions) {
            extent.extend(position);
        }
        // The same scale in all views, so that lengths can be compared.
        double metre = 224 / 0.01;  // [px/m]
        for (const auto& view : views) {
            metre = std::min(metre, kViewWidth / (1.3 * extent.sizes()[view.across] + 1e-9));
            metre = std::min(metre, kViewHeight / (1.3 * extent.sizes()[view.up] + 1e-9));
        }
        double top = kFirstPanel;
        for (const auto& view : views) {
            drawView(view, {kViewLeft, top, kViewWidth, kViewHeight}, {extent.center(), metre});
            top += kViewPitch;
        }
    }

    struct ViewScale {
        Eigen::Vector3d centre;
        double metre;  // [px/m]
    };

    void drawView(const View& view, const Box& box, const ViewScale& scale) {
        const Spot middle{box.left + box.width / 2, box.top + box.height / 2};
        const auto x = [&](double value) {
            return middle.x + scale.metre * (value - scale.centre[view.across]);
        };
        const auto y = [&](double value) {
            return middle.y - scale.metre * (value - scale.centre[view.up]);
        };
        svg_.rectangle(box, "frame");
        svg_.text({box.left, box.top - 8}, "head", view.title);
        const double half_width = box.width / 2 / scale.metre;
        const double half_height = box.height / 2 / scale.metre;
        const double centre_x = scale.centre[view.across];
        const double centre_y = scale.centre[view.up];
        for (const double tick : ticksBetween(centre_x - half_width, centre_x + half_width, 4)) {
            svg_.line({x(tick), box.top}, {x(tick), box.bottom()}, "grid");
            svg_.text({x(tick), box.bottom() + 15}, "centred", fmt::format("{:g}", tick));
        }
        for (const double tick : ticksBetween(centre_y - half_height, centre_y + half_height, 4)) {
            svg_.line({box.left, y(tick)}, {box.right(), y(tick)}, "grid");
            svg_.text({box.left - 6, y(tick) + 4}, "right", fmt::format("{:g}", tick));
        }
        constexpr std::array names{"x / m", "y / m", "z / m"};
        svg_.text({box.right(), box.bottom() + 31}, "right",
                  fmt::format("across: {}, up: {}", names.at(static_cast<std::size_t>(view.across)),
                              names.at(static_cast<std::size_t>(view.up))));
        std::vector<Spot> spots;
        for (const auto& position : content_.tool_positions) {
            spots.push_back({x(position[view.across]), y(position[view.up])});
        }
        svg_.polyline(simplified(spots, kTolerance), "curve path");
        svg_.circle(spots.back(), 5, "end");
        svg_.circle(spots.front(), 3.5, "start");
    }

    void drawTable() {
        constexpr std::array columns{70.0, 180.0, 385.0, 580.0, 805.0};
        svg_.text({columns[0] + 24, kTableTop}, "head", "axis");
        svg_.text({columns[1], kTableTop}, "head", "position limits / rad");
        for (std::size_t i = 1; i < kPanels.size(); ++i) {
            svg_.text({columns.at(i + 1), kTableTop}, "head",
                      fmt::format("{} limit / ({})", kPanels.at(i).name, kPanels.at(i).unit));
        }
        for (std::size_t axis = 0; axis < model_.axisCount(); ++axis) {
            const double y = kTableTop + kRow * static_cast<double>(axis + 1);
            const auto& limits = model_.limits(axis);
            svg_.line({columns[0], y - 4}, {columns[0] + 16, y - 4}, "key " + axisClass(axis));
            svg_.text({columns[0] + 24, y}, "", nameOf(axis));
            svg_.text({columns[1], y}, "",
                      fmt::format("{:.4g} to {:.4g}{}", limits.lower, limits.upper,
                                  peakText(Quantity::position, axis)));
            const std::array values{limits.velocity, limits.acceleration, limits.jerk};
            for (std::size_t i = 0; i < values.size(); ++i) {
                svg_.text({columns.at(i + 2), y}, "",
                          fmt::format("{:.4g}{}", values.at(i),
                                      peakText(kPanels.at(i + 1).quantity, axis)));
            }
        }
    }

    std::string peakText(Quantity quantity, std::size_t axis) const {
        return fmt::format(", peak {:.1f} %",
                           100 * peakOfAxis(content_.samples, model_, quantity, axis).share);
    }

    const RobotModel& model_;
    const MotionPicture& content_;
    SvgPicture svg_;
    double duration_;
};

}  // namespace

Result<std::string> drawMotion(const RobotModel& model, const MotionPicture& picture) {
    if (picture.samples.size() < 2 || picture.tool_positions.size() != picture.samples.size()) {
        return fail(
            Errc::invalid_argument,
            fmt::format("{} samples and {} tool positions: at least 2 of each, equally many",
                        picture.samples.size(), picture.tool_positions.size()));
    }
    for (std::size_t i = 0; i < picture.samples.size(); ++i) {
        const auto& sample = picture.samples[i];
        if (sample.position.size() != model.axisCount()) {
            return fail(Errc::invalid_argument,
                        fmt::format("{} joint positions, {} has {} axes", sample.position.size(),
                                    model.name(), model.axisCount()));
        }
        if (!isFinite(sample) || !picture.tool_positions[i].allFinite()) {
            return fail(Errc::invalid_argument,
                        fmt::format("the motion is not finite at {} s", sample.time));
        }
    }
    return Drawing(model, picture).draw();
}

}  // namespace metier::path_evaluation
