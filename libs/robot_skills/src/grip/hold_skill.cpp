#include <fmt/format.h>

#include <chrono>
#include <memory>
#include <utility>

#include "grip/gripper_report.hpp"
#include "metier/base/numbers.hpp"
#include "metier/robot_skills/gripper_skills.hpp"

namespace metier::robot_skills {

using device::Gripper;
using device::SafetyState;
using skill::Reason;

namespace {

using namespace std::chrono_literals;

// Grippers send their state 20 to 100 times a second.
constexpr auto kInterval = 20ms;

/// Errors: the gripper does not hold a part, or its state is unknown.
Result<void> checkHeld(const Gripper& gripper) {
    const auto safety = gripper.safety();
    if (safety.state != SafetyState::normal) {
        return fail(
            safety.state == SafetyState::disconnected ? Errc::connection_lost : Errc::device_fault,
            fmt::format("{} ({})", safety.text, device::toString(safety.state)));
    }
    const auto state = gripper.state();
    if (!state.part_held) {
        return fail(Errc::device_fault,
                    fmt::format("{} holds no part: the jaws are at {:.1f} mm", gripper.info().name,
                                state.width / kMillimetre));
    }
    return {};
}

class HoldWork final : public skill::ExecutionWork {
public:
    HoldWork(const Gripper& gripper, std::shared_ptr<skill::Executor> executor)
        : gripper_(gripper), executor_(std::move(executor)) {}

    void start(skill::ExecutionHandle execution) override {
        execution_ = std::move(execution);
        watch();
    }
    Result<void> suspend() override {
        timer_.cancel();
        execution_.atRest();
        return {};
    }
    Result<void> resume() override {
        return checkHeld(gripper_).map([this] { watch(); });
    }
    void halt() override {
        timer_.cancel();
        execution_.atRest();
    }
    void forceStop() noexcept override {}

private:
    void watch() {
        if (const auto held = checkHeld(gripper_); !held) {
            const bool lost = held.error().code == Errc::connection_lost;
            execution_.fail(lost ? Reason::device_lost : Reason::error, held.error().message);
            return;
        }
        timer_ = executor_->after(kInterval, [this] { watch(); });
    }

    const Gripper& gripper_;
    std::shared_ptr<skill::Executor> executor_;  // shared by what its thread owns
    skill::ExecutionHandle execution_;
    skill::Timer timer_;
};

class HoldSkill final : public skill::Skill {
public:
    HoldSkill(const Gripper& gripper, std::shared_ptr<skill::Executor> executor)
        : gripper_(gripper), executor_(std::move(executor)) {}

    const skill::SkillDescription& description() const override { return description_; }
    Result<std::unique_ptr<skill::ExecutionWork>> prepare(
        const skill::ValueMap& /*none*/) override {
        return checkHeld(gripper_).map([this]() -> std::unique_ptr<skill::ExecutionWork> {
            return std::make_unique<HoldWork>(gripper_, executor_);
        });
    }
    Result<skill::CheckReport> check(const skill::ValueMap& /*none*/) override {
        return gripperReport(checkHeld(gripper_));
    }
    Result<void> reset() override { return {}; }

private:
    const Gripper& gripper_;
    std::shared_ptr<skill::Executor> executor_;  // shared by what its thread owns
    skill::SkillDescription description_{
        .name = "HoldGripperSkill",
        .type = "HoldGripperSkillType",
        .description = "Watches that the jaws hold a part, and is Halted if they lose it"};
};

}  // namespace

std::unique_ptr<skill::Skill> makeHoldSkill(const Gripper& gripper,
                                            std::shared_ptr<skill::Executor> executor) {
    return std::make_unique<HoldSkill>(gripper, std::move(executor));
}

}  // namespace metier::robot_skills
