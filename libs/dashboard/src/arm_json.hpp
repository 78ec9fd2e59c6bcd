#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "metier/base/quantities.hpp"
#include "metier/dashboard/cell.hpp"
#include "metier/opcua_skill/kinematics_data.hpp"

namespace metier::motion {
class RobotModel;
}

namespace metier::dashboard {

// Threads: any; pure.

/// Facts about an arm besides its kinematics.
struct ArmOrigin {
    std::string key;
    std::string server;
    std::string device;                      ///< BrowseName of the motion device
    std::optional<Frame> world_from_base{};  ///< none: not known
};

/// Description of an arm for drawing. Shape, maker and tool frames come from the model whose axes
/// are those that the server publishes; none if there is no such model.
nlohmann::json armJson(const ArmOrigin& origin, const opcua_skill::KinematicsData& data,
                       const std::vector<motion::RobotModel>& models);

/// The model whose axes are where the server says, to 5 mm and 0.02 rad, as arms of one kind are
/// alike but for their calibration; the closest one. nullptr: none.
const motion::RobotModel* modelOf(const opcua_skill::KinematicsData& data,
                                  const std::vector<motion::RobotModel>& models);

/// x, y, z [m], a, b, c [rad], rounded.
nlohmann::json frameJson(const Frame& frame);

}  // namespace metier::dashboard
