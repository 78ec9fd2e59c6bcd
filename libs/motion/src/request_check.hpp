#pragma once

#include <initializer_list>
#include <string>
#include <string_view>

#include "metier/motion/planner.hpp"

namespace metier::motion {

/// Answer of a check: nothing, or the refusal.
using Checked = tl::expected<void, Refusal>;

/// \param axis axis that causes the refusal, from 0, if there is one
Refusal refuse(RefusalReason reason, Errc code, std::string text,
               std::optional<std::size_t> axis = std::nullopt);
tl::unexpected<Refusal> invalid(std::string text, Errc code = Errc::invalid_argument);

/// \param tolerance how far beyond a limit is still taken [rad]
Checked checkPosition(const RobotModel& model, const JointVector& q, std::string_view what,
                      double tolerance);
Checked checkPose(const Pose& pose);
Checked checkPtp(const RobotModel& model, const PtpRequest& request);
Checked checkLin(const RobotModel& model, const LinRequest& request);
Checked checkPath(const RobotModel& model, const PathRequest& request);

}  // namespace metier::motion
