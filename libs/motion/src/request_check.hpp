#pragma once

#include <initializer_list>
#include <string>
#include <string_view>

#include "metier/motion/planner.hpp"

namespace metier::motion {

/// Checks of what a planner is asked: nothing, or the refusal.
using Checked = tl::expected<void, Refusal>;

Refusal refuse(RefusalReason reason, Errc code, std::string text);
tl::unexpected<Refusal> invalid(std::string text, Errc code = Errc::invalid_argument);
tl::unexpected<Refusal> invalid(const Error& error);

/// \param tolerance how far beyond a limit is still taken [rad]
Checked checkPosition(const RobotModel& model, const JointVector& q, std::string_view what,
                      double tolerance);
Checked checkPose(const motion::Pose& pose);
Checked checkPtp(const RobotModel& model, const PtpRequest& request);
Checked checkLin(const RobotModel& model, const LinRequest& request);
Checked checkPath(const RobotModel& model, const PathRequest& request);

}  // namespace metier::motion
