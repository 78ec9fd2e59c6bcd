#include "observation.hpp"

#include <cstddef>
#include <utility>

namespace metier::wsg50_driver {
namespace {

constexpr std::array<CommandId, 4> kValues{CommandId::system_state, CommandId::grasping_state,
                                           CommandId::width, CommandId::force};
constexpr std::array<std::string_view, 4> kNames{"system state", "grasping state", "width",
                                                 "force"};

template <typename T>
Result<void> assign(T& target, Result<T> value) {
    return std::move(value).map([&](T taken) { target = taken; });
}

}  // namespace

Result<bool> Observation::take(const Reply& reply, SteadyTime now) {
    Result<void> taken;
    switch (reply.id) {
        case CommandId::system_state:
            taken = assign(system_, parseSystemState(reply.data));
            break;
        case CommandId::grasping_state:
            taken = assign(grasping_, parseGraspingState(reply.data));
            break;
        case CommandId::width:
            taken = assign(width_, parseWidth(reply.data));
            break;
        case CommandId::force:
            taken = assign(force_, parseForce(reply.data));
            break;
        default:
            return false;
    }
    METIER_TRY(taken);
    for (std::size_t i = 0; i < kValues.size(); ++i) {
        if (kValues[i] == reply.id) {
            ++counts_[i];
            stamps_[i] = now;
        }
    }
    return true;
}

bool Observation::renewedSince(const Mark& mark) const noexcept {
    for (std::size_t i = 0; i < mark.size(); ++i) {
        if (counts_[i] == mark[i]) {
            return false;
        }
    }
    return true;
}

std::optional<std::string_view> Observation::silentValue(SteadyTime now,
                                                         SteadyTime::duration age) const {
    for (std::size_t i = 0; i < kNames.size(); ++i) {
        if (now - stamps_[i] > age) {
            return kNames[i];
        }
    }
    return std::nullopt;
}

device::GripperState Observation::state(SteadyTime now) const noexcept {
    device::GripperState state;
    state.width = width_;
    state.force = force_;
    state.moving = system_.moving();
    state.part_held = partHeld();
    state.stamp = now;
    return state;
}

}  // namespace metier::wsg50_driver
