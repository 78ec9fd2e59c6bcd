#include "metier/motion/trajectory.hpp"

#include <algorithm>
#include <cmath>

#include "metier/base/numbers.hpp"
#include "metier/motion/rotation.hpp"
#include "plan.hpp"

namespace metier::motion {

namespace {

PathDeviation deviationAt(const Pose& planned, const Pose& pose, double s) {
    return {distanceBetween(planned, pose), rotationAngleBetween(planned.rotation, pose.rotation),
            s};
}

}  // namespace

Seconds Trajectory::duration() const noexcept {
    return Seconds(plan_->speed.profile.duration());
}

std::size_t Trajectory::axisCount() const noexcept {
    return plan_->kinematics.axisCount();
}

SetPoint Trajectory::sample(Seconds time) const noexcept {
    return sampleAt(plan_->speed.profile.at(time.count()));
}

ScalarState Trajectory::pathParameter(const ScalarState& clock) const noexcept {
    const SpeedMap& map = plan_->speed.map;
    if (clock.position >= map.end()) {
        return {1.0, 0.0, 0.0};
    }
    const ScalarState s = map.at(std::max(clock.position, 0.0));
    return {s.position, s.velocity * clock.velocity,
            s.velocity * clock.acceleration + s.acceleration * clock.velocity * clock.velocity};
}

ScalarState Trajectory::clockAt(const ScalarState& path) const noexcept {
    const SpeedMap& map = plan_->speed.map;
    if (path.position >= 1.0) {
        return {map.end(), 0.0, 0.0};
    }
    const double clock = map.clockAt(std::max(path.position, 0.0));
    const ScalarState s = map.at(clock);
    const double velocity = path.velocity / s.velocity;
    return {clock, velocity,
            (path.acceleration - s.acceleration * velocity * velocity) / s.velocity};
}

Profile Trajectory::brake(const ScalarState& path, double factor) const noexcept {
    return plan_->braking.brake(path, factor, kInfinity);
}

SetPoint Trajectory::sampleAt(const ScalarState& clock) const noexcept {
    return sampleOnPath(pathParameter(clock));
}

SetPoint Trajectory::sampleOnPath(const ScalarState& state) const noexcept {
    const PathPoint path = plan_->pathAt(state.position);
    SetPoint point{path.q, path.first, path.first};
    point.velocity.view() = state.velocity * path.first.view();
    point.acceleration.view() = state.acceleration * path.first.view() +
                                state.velocity * state.velocity * path.second.view();
    return point;
}

JointVector Trajectory::start() const noexcept {
    return plan_->pathAt(0).q;
}

JointVector Trajectory::end() const noexcept {
    return plan_->pathAt(1).q;
}

JointVector Trajectory::positionAt(double fraction) const noexcept {
    return plan_->pathAt(std::clamp(fraction, 0.0, 1.0)).q;
}

Pose Trajectory::toolPose(const JointVector& q) const noexcept {
    return plan_->kinematics.forward(q) * plan_->flange_from_tool;
}

Pose Trajectory::poseAt(double fraction) const noexcept {
    const ToolPath* path = plan_->toolPath();
    const double s = std::clamp(fraction, 0.0, 1.0);
    return path != nullptr ? path->at(s) : toolPose(plan_->pathAt(s).q);
}

PathDeviation Trajectory::deviation(const Pose& base_from_tool) const noexcept {
    if (const ToolPath* path = plan_->toolPath()) {
        const double s = path->nearest(base_from_tool);
        return deviationAt(path->at(s), base_from_tool, s);
    }
    // A PTP path is curved: nearest of many points, then halving steps round it.
    constexpr int points = 100;
    PathDeviation best = deviationAt(poseAt(0), base_from_tool, 0);
    const auto consider = [&](double s) {
        const double inside = std::clamp(s, 0.0, 1.0);
        const PathDeviation other = deviationAt(poseAt(inside), base_from_tool, inside);
        best = other.distance + other.angle < best.distance + best.angle ? other : best;
    };
    for (int i = 1; i <= points; ++i) {
        consider(static_cast<double>(i) / points);
    }
    for (double step = 1.0 / points; step > 1e-9; step /= 2) {
        const double centre = best.fraction;
        consider(centre - step);
        consider(centre + step);
    }
    return best;
}

double Trajectory::clockSpeed() const noexcept {
    return plan_->speed.velocity;
}

Profile Trajectory::brakeClock(const ScalarState& clock, double factor) const noexcept {
    return plan_->speed.clock.brake(clock, factor, clockEnd());
}

Profile Trajectory::runClock(const ScalarState& clock, double speed_override) const noexcept {
    return plan_->speed.clock.toRest(clock, clockEnd(), speed_override * clockSpeed());
}

double Trajectory::clockEnd() const noexcept {
    return plan_->speed.map.end();
}

const Profile& Trajectory::profile() const noexcept {
    return plan_->speed.profile;
}

double Trajectory::length() const noexcept {
    const ToolPath* path = plan_->toolPath();
    return path != nullptr ? path->distance() : 0.0;
}

double Trajectory::angle() const noexcept {
    const ToolPath* path = plan_->toolPath();
    return path != nullptr ? path->angle() : 0.0;
}

Trajectory Trajectory::stretchedTo(Seconds duration) const {
    const double now = plan_->speed.profile.duration();
    if (duration.count() <= now || now <= 0) {
        return *this;
    }
    auto slow = std::make_shared<Plan>(*plan_);
    slow->speed = plan_->speed.slowed(duration.count() / now);
    return Trajectory(std::move(slow));
}

}  // namespace metier::motion
