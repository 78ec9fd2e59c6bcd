#pragma once

#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "metier/device/motion_planner.hpp"
#include "metier/joint_simulator/joint_simulator.hpp"
#include "metier/motion/frame.hpp"
#include "metier/motion/motion_run.hpp"
#include "metier/motion/planner.hpp"

namespace metier::robot_skills {

/// Stands for the planner of a controller: plans by itself and moves a simulated arm.
class SimulatedPlanner final : public device::MotionPlanner {
public:
    /// Settings of its behaviour from now on.
    struct Behaviour {
        std::optional<Error> refuses{};      ///< the next motions
        std::optional<double> contact_at{};  ///< part of the path after which the force is there
        std::array<double, 3> force{};       ///< of the contact, in flange axes [N]
        double misses_by = 0.0;              ///< axis 1 ends so far from the target [rad]
        /// In the middle, as when stopped by hand at the panel
        bool stops_by_itself = false;
    };

    SimulatedPlanner(joint_simulator::JointSimulator& arm, const motion::RobotModel& model)
        : arm_(arm), model_(model) {}

    Behaviour behaviour;
    std::vector<device::ControllerPlannedMotion> asked;

    Result<void> move(const device::ControllerPlannedMotion& motion, Done done) override {
        asked.push_back(motion);
        if (behaviour.refuses) {
            return fail(*behaviour.refuses);
        }
        auto run = std::make_shared<Run>(*this, plan(motion), motion, std::move(done));
        run_ = run;
        return arm_.attach(run);
    }
    void stopMotion() noexcept override {
        if (const auto run = run_.lock()) {
            run->stop();
        }
    }

private:
    class Run final : public device::SetPointSource {
    public:
        Run(const SimulatedPlanner& planner, const motion::Trajectory& trajectory,
            device::ControllerPlannedMotion motion, Done done)
            : behaviour_(planner.behaviour),
              cycle_(planner.arm_.info().cycleSeconds()),
              execution_(trajectory),
              motion_(std::move(motion)),
              done_(std::move(done)) {}

        void stop() noexcept {
            stopped_ = true;
            execution_.stop();
        }
        Next next(const device::ArmState& state, device::JointArray& set_point) noexcept override {
            if (motion_.observer) {
                motion_.observer->observe(state);
            }
            watch();
            const bool rests = execution_.finished() || (ends() && execution_.atRest());
            if (rests && state.standstill && waited_++ > 5) {
                return Next::done;
            }
            if (!rests) {
                const auto at = execution_.next(motion::Seconds(cycle_)).position;
                set_point = device::JointArray(at.span());
            }
            return Next::set_point;
        }
        void ended(device::EndCause cause, const device::Safety& safety) override {
            if (cause == device::EndCause::disconnected) {
                done_(fail(Errc::connection_lost, safety.text));
            } else if (cause == device::EndCause::safety) {
                done_(fail(Errc::device_fault, safety.text));
            } else {
                auto largest = behaviour_.force;
                for (auto& force : largest) {
                    force = std::abs(force);
                }
                done_(device::MotionOutcome{end(), behaviour_.force, {}, largest});
            }
        }

    private:
        using End = device::MotionOutcome::End;
        bool ends() const noexcept { return stopped_ || contact_; }
        End end() const noexcept {
            return contact_ ? End::force : stopped_ ? End::stopped : End::at_target;
        }
        void watch() noexcept {
            const double part = execution_.pathParameter();
            if (behaviour_.contact_at && motion_.until && part >= *behaviour_.contact_at) {
                contact_ = true;
                execution_.halt();
            }
            if (behaviour_.stops_by_itself && part > 0.5) {
                stop();
            }
        }

        const Behaviour behaviour_;
        const double cycle_;
        motion::MotionRun execution_;
        device::ControllerPlannedMotion motion_;
        Done done_;
        bool stopped_ = false;
        bool contact_ = false;
        int waited_ = 0;
    };

    motion::Trajectory plan(const device::ControllerPlannedMotion& motion) const {
        const auto start =
            motion::JointVector::from(arm_.state().commanded_position.values()).value();
        if (motion.path == device::ControllerPlannedMotion::Path::line) {
            motion::LinRequest request;
            request.start = start;
            request.target = motion::toPose(*motion.target_flange);
            request.max_velocity = {
                motion.line_velocity, motion.line_velocity, motion.line_velocity, 0, 0, 0};
            request.max_acceleration = {motion.line_acceleration,
                                        motion.line_acceleration,
                                        motion.line_acceleration,
                                        0,
                                        0,
                                        0};
            return motion::Planner(model_).lin(request).value();
        }
        motion::PtpRequest request;
        request.start = start;
        auto target = motion::JointVector::from(motion.target_joints.values()).value();
        target[0] += behaviour.misses_by;
        request.target = target;
        request.max_velocity = motion::JointVector(model_.axisCount());
        request.max_acceleration = request.max_velocity;
        for (std::size_t axis = 0; axis < model_.axisCount(); ++axis) {
            const auto& limits = model_.limits(axis);
            request.max_velocity[axis] = motion.velocity_share * limits.velocity;
            request.max_acceleration[axis] = motion.acceleration_share * limits.acceleration;
        }
        return motion::Planner(model_).ptp(request).value();
    }

    joint_simulator::JointSimulator& arm_;
    const motion::RobotModel& model_;
    std::weak_ptr<Run> run_;
};

}  // namespace metier::robot_skills
