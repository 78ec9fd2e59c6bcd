#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "metier/base/error.hpp"

namespace metier::client {

/// Places of a joint of the model at a server.
struct JointPlace {
    std::size_t axis = 0;     ///< index of its axis among those that the server lists
    std::size_t element = 0;  ///< index of its value in the server's arrays

    friend bool operator==(const JointPlace&, const JointPlace&) = default;
};

/// Names of a model and of a server for the same joints.
struct AxisNames {
    std::vector<std::string> joints;  ///< of the model, axis 1 first
    std::vector<std::string> axes;    ///< as the server lists them
    /// Joints of the model in the order of the server's arrays; empty: not given.
    std::vector<std::string> array_order{};
};

/// Finds the axis and the array element of each joint, joint 1 first.
///
/// Axes that are called like the joints are these. Else, axes whose names end with 1 to n are
/// counted by that number: the arrays have them in this order. Other names need `array_order`: the
/// server then lists its axes in the order of its arrays. Axes that are called like the joints are
/// in the arrays as they are listed, unless `array_order` is given.
/// Errors: invalid_argument, with the names of both sides.
Result<std::vector<JointPlace>> placesOf(const AxisNames& names);

}  // namespace metier::client
