#include "remote_arm/axis_order.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <optional>

namespace metier::client {
namespace {

using Names = std::vector<std::string>;
using Indices = std::vector<std::size_t>;

/// Index of each of `wanted` in `names`; nothing unless both have the same names, each once.
std::optional<Indices> indicesOf(const Names& wanted, const Names& names) {
    if (wanted.size() != names.size()) {
        return std::nullopt;
    }
    Indices indices;
    for (const auto& name : wanted) {
        const auto found = std::find(names.begin(), names.end(), name);
        if (found == names.end() || std::count(wanted.begin(), wanted.end(), name) != 1) {
            return std::nullopt;
        }
        indices.push_back(static_cast<std::size_t>(found - names.begin()));
    }
    return indices;
}

/// Number at the end of a name; nothing without digits there.
std::optional<std::size_t> numberAtEndOf(const std::string& name) {
    const auto last_other = name.find_last_not_of("0123456789");
    const auto digits = last_other == std::string::npos ? name : name.substr(last_other + 1);
    std::size_t number = 0;
    const auto* end = digits.data() + digits.size();
    const auto [stop, error] = std::from_chars(digits.data(), end, number);
    return digits.empty() || error != std::errc() || stop != end ? std::nullopt
                                                                 : std::optional(number);
}

/// Index of the axis with number 1, with number 2 and so on; nothing unless they are 1 to n.
std::optional<Indices> byNumber(const Names& axes) {
    Indices indices(axes.size(), axes.size());
    for (std::size_t axis = 0; axis < axes.size(); ++axis) {
        const auto number = numberAtEndOf(axes[axis]).value_or(0);
        if (number < 1 || number > axes.size() || indices[number - 1] != axes.size()) {
            return std::nullopt;
        }
        indices[number - 1] = axis;
    }
    return indices;
}

std::vector<JointPlace> joined(const Indices& axes, const Indices& elements) {
    std::vector<JointPlace> places;
    for (std::size_t joint = 0; joint < axes.size(); ++joint) {
        places.push_back({axes[joint], elements[joint]});
    }
    return places;
}

/// Places by a given order of the arrays.
/// \param elements index of each joint in the arrays
std::vector<JointPlace> inGivenOrder(const AxisNames& names, const Indices& elements) {
    if (const auto axes = indicesOf(names.joints, names.axes)) {
        return joined(*axes, elements);
    }
    const auto numbered = byNumber(names.axes);
    Indices axes;
    for (const auto element : elements) {
        axes.push_back(numbered ? (*numbered)[element] : element);
    }
    return joined(axes, elements);
}

Result<std::vector<JointPlace>> unclear(const AxisNames& names, std::string_view why) {
    return fail(Errc::invalid_argument,
                fmt::format("{}: the server's axes are {}; the model's joints are {}", why,
                            fmt::join(names.axes, ", "), fmt::join(names.joints, ", ")));
}

}  // namespace

Result<std::vector<JointPlace>> placesOf(const AxisNames& names) {
    if (names.axes.size() != names.joints.size()) {
        return unclear(names, "the numbers of axes differ");
    }
    if (!names.array_order.empty()) {
        const auto elements = indicesOf(names.joints, names.array_order);
        return elements ? inGivenOrder(names, *elements)
                        : unclear(names, fmt::format("\"{}\" is no order of the joints",
                                                     fmt::join(names.array_order, ", ")));
    }
    if (const auto axes = indicesOf(names.joints, names.axes)) {
        return joined(*axes, *axes);
    }
    const auto numbered = byNumber(names.axes);
    if (!numbered) {
        return unclear(names, "the order of the axes is not known, it must be given");
    }
    Indices elements;
    for (std::size_t joint = 0; joint < names.joints.size(); ++joint) {
        elements.push_back(joint);
    }
    return joined(*numbered, elements);
}

}  // namespace metier::client
