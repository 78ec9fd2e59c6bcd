#include "host/shown_arm.hpp"

#include <chrono>
#include <vector>

#include "metier/base/recent_mean.hpp"
#include "metier/motion/frame.hpp"

namespace metier::server {
namespace {

opcua_skill::SafetyStateKind kindOf(device::SafetyState state) {
    using Kind = opcua_skill::SafetyStateKind;
    switch (state) {
        case device::SafetyState::normal:
            return Kind::normal;
        case device::SafetyState::protective_stop:
            return Kind::protective_stop;
        case device::SafetyState::emergency_stop:
            return Kind::emergency_stop;
        case device::SafetyState::fault:
            return Kind::fault;
        case device::SafetyState::disconnected:
            return Kind::unknown;
    }
    return Kind::unknown;
}

opcua_skill::StreamFigures toStreamFigures(const robot_skills::StreamReport& report) {
    const auto now = report.figures();
    return {now.lag, now.largest_lag, now.clock_step, now.refused, now.dropped};
}

}  // namespace

opcua_skill::KinematicsState stateOf(const ShownArm& shown) {
    const auto state = shown.arm.state();
    opcua_skill::KinematicsState result;
    result.joint_position.assign(state.position.begin(), state.position.end());
    if (const auto joints = motion::JointVector::from(result.joint_position);
        joints && joints->size() == shown.model.axisCount()) {
        result.pose = motion::toFrame(shown.model.kinematics().forward(*joints));
    }
    result.safety_state = kindOf(state.safety);
    result.missed_cycles = state.missed_cycles;
    return result;
}

opcua_skill::ArmFigures figuresOf(const ShownArm& shown, const Clock& clock) {
    const auto& arm = shown.arm;
    opcua_skill::ArmFigures figures;
    figures.commanded_joint_position = [&arm]() -> std::optional<std::vector<double>> {
        const auto state = arm.state();
        if (state.safety == device::SafetyState::disconnected) {
            return std::nullopt;
        }
        return std::vector(state.commanded_position.begin(), state.commanded_position.end());
    };
    figures.standstill = [&arm]() -> std::optional<bool> {
        const auto state = arm.state();
        return state.safety == device::SafetyState::disconnected ? std::nullopt
                                                                 : std::optional(state.standstill);
    };
    figures.stopping = [&arm, &model = shown.model,
                        report = shown.stopping]() -> std::optional<opcua_skill::StoppingFigures> {
        const auto state = arm.state();
        if (state.safety == device::SafetyState::disconnected) {
            return std::nullopt;
        }
        const auto planned = report ? report->read() : std::nullopt;
        const auto way = planned ? *planned : robot_skills::stoppingEstimateOf(state, model);
        return opcua_skill::StoppingFigures{way.time.count(), way.distance};
    };
    if (const auto* jitter = arm.cycleJitter()) {
        // Shared by the copies of the function.
        const auto mean =
            std::make_shared<RecentMean>(*jitter, clock, std::chrono::milliseconds(100));
        figures.cycle_jitter = [mean] { return mean->read(); };
    }
    if (shown.stream) {
        figures.stream = [report = shown.stream] { return toStreamFigures(*report); };
    }
    if (const auto* sensor = shown.sensor) {
        figures.flange_wrench = [sensor]() -> std::optional<opcua_skill::FlangeWrench> {
            const auto sample = sensor->sample();
            if (sample.health != device::SafetyState::normal) {
                return std::nullopt;
            }
            return opcua_skill::FlangeWrench{sample.force, sample.torque};
        };
    }
    return figures;
}

}  // namespace metier::server
