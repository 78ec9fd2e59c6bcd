#include "joint_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "metier/base/text.hpp"
#include "metier/motion/frame.hpp"

namespace metier::app {
namespace {

using motion::JointVector;
using nlohmann::ordered_json;

constexpr double kShown = 5e-13;  // half of the last digit that is printed

/// Added, it turns -0 into 0 and leaves all else as it is.
constexpr double kNoSign = 0.0;

/// Without the sign of a zero, which would only puzzle.
double shown(double value) {
    return std::abs(value) < kShown ? 0.0 : value;
}

Result<double> parseNumber(std::string_view word, std::string_view what, std::size_t number) {
    word.remove_prefix(std::min(word.find_first_not_of(' '), word.size()));
    const bool plus = word.starts_with('+') && !word.starts_with("+-");
    const auto value = numberIn<double>(word.substr(plus ? 1 : 0));
    if (!value || !std::isfinite(*value)) {
        return fail(Errc::invalid_argument,
                    fmt::format("{} {}: '{}' is not a finite number, as -1.57 or 2e-3 is", what,
                                number, word));
    }
    return *value;
}

/// The one of two equal quaternions whose first component that is not 0 is positive.
Eigen::Quaterniond normalForm(const Eigen::Quaterniond& rotation) {
    for (const double component : {rotation.w(), rotation.x(), rotation.y(), rotation.z()}) {
        if (std::abs(component) > 1e-12) {
            return component > 0 ? rotation : Eigen::Quaterniond(-rotation.coeffs());
        }
    }
    return rotation;
}

}  // namespace

Result<std::vector<double>> parseNumbers(std::span<const std::string> words,
                                         std::string_view what) {
    std::vector<double> values;
    for (std::string_view rest : words) {
        for (;;) {
            const auto comma = rest.find(',');
            METIER_ASSIGN(const auto value,
                          parseNumber(rest.substr(0, comma), what, values.size() + 1));
            values.push_back(value);
            if (comma == std::string_view::npos) {
                break;
            }
            rest.remove_prefix(comma + 1);
        }
    }
    return values;
}

Result<JointVector> parseJoints(const motion::RobotModel& model, std::span<const std::string> words,
                                std::string_view what) {
    METIER_ASSIGN(const auto values, parseNumbers(words, what));
    if (values.size() != model.axisCount()) {
        return fail(Errc::invalid_argument,
                    fmt::format("{}: {} values given, {} has {} axes: one value for each, rad",
                                what, values.size(), model.name(), model.axisCount()));
    }
    return JointVector::from(values);
}

Result<motion::Pose> parsePose(std::span<const std::string> words, std::string_view what) {
    METIER_ASSIGN(const auto values, parseNumbers(words, what));
    const auto& v = values;
    if (v.size() != 6) {
        return fail(Errc::invalid_argument,
                    fmt::format("{}: {} values given, a pose has 6: x y z in m, a b c in rad", what,
                                v.size()));
    }
    return motion::toPose({v[0], v[1], v[2], v[3], v[4], v[5]});
}

std::string toText(const JointVector& joints) {
    std::vector<double> values;
    for (const double value : joints) {
        values.push_back(std::abs(value) < 5e-7 ? 0.0 : value);
    }
    return fmt::format("{:.6f}", fmt::join(values, ", "));
}

std::string toText(const motion::Pose& pose) {
    const auto frame = motion::toFrame(pose);
    const auto rotation = normalForm(pose.rotation);
    return fmt::format(
        "position    x {:.12f}  y {:.12f}  z {:.12f}  m\n"
        "quaternion  w {:.12f}  x {:.12f}  y {:.12f}  z {:.12f}\n"
        "rotation    a {:.12f}  b {:.12f}  c {:.12f}  rad, about x, y, z\n",
        shown(frame.x), shown(frame.y), shown(frame.z), shown(rotation.w()), shown(rotation.x()),
        shown(rotation.y()), shown(rotation.z()), shown(frame.a), shown(frame.b), shown(frame.c));
}

ordered_json toJson(const JointVector& joints) {
    auto list = ordered_json::array();
    for (const double value : joints) {
        list.push_back(value + kNoSign);
    }
    return list;
}

ordered_json toJson(const motion::Pose& pose) {
    const auto frame = motion::toFrame(pose);
    const auto rotation = normalForm(pose.rotation);
    return {{"position",
             {{"x", frame.x + kNoSign}, {"y", frame.y + kNoSign}, {"z", frame.z + kNoSign}}},
            {"quaternion",
             {{"w", rotation.w() + kNoSign},
              {"x", rotation.x() + kNoSign},
              {"y", rotation.y() + kNoSign},
              {"z", rotation.z() + kNoSign}}},
            {"rotation",
             {{"a", frame.a + kNoSign}, {"b", frame.b + kNoSign}, {"c", frame.c + kNoSign}}}};
}

}  // namespace metier::app
