#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "arm_bench.hpp"
#include "commands.hpp"

namespace metier::iiwa_driver {

/// A cabinet that executes everything, stands at home and is ready; until the test says otherwise.
inline CabinetState readyCabinet() {
    CabinetState state;
    state.executed = true;
    state.ready = true;
    state.position = ArmBench::toJoints(0.0).target_joints;
    state.velocity = device::JointArray(kAxes);
    return state;
}

/// Asks a function of the test for each set-point.
class Player final : public device::SetPointSource {
public:
    Next next(const device::ArmState& /*state*/, device::JointArray& set_point) noexcept override {
        ++asked;
        return play(set_point);
    }
    void ended(device::EndCause how, const device::Safety& why) override {
        cause = how;
        safety = why;
    }

    std::function<Next(device::JointArray&)> play = [](device::JointArray&) {
        return Next::set_point;
    };
    int asked = 0;
    std::optional<device::EndCause> cause;
    device::Safety safety;
};

inline std::vector<int> codesOf(const std::vector<Command>& commands) {
    std::vector<int> codes;
    for (const auto& command : commands) {
        codes.push_back(static_cast<int>(command.code));
    }
    return codes;
}

}  // namespace metier::iiwa_driver
