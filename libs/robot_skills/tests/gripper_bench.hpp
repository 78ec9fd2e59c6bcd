#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "metier/robot_skills/gripper_skills.hpp"
#include "metier/skill/program.hpp"
#include "metier/skill/testing/manual_executor.hpp"

namespace metier::robot_skills {

/// A gripper that does what the test says, on the test's thread.
class HandDrivenGripper final : public device::Gripper {
public:
    struct Asked {
        std::string motion;
        device::GripperRequest request;
    };

    const device::GripperInfo& info() const noexcept override { return info_; }
    device::GripperState state() const noexcept override { return state_; }
    device::Safety safety() const override { return safety_; }
    Result<void> grasp(const device::GripperRequest& request, Done done) override {
        return ask("grasp", request, std::move(done));
    }
    Result<void> release(const device::GripperRequest& request, Done done) override {
        return ask("release", request, std::move(done));
    }
    Result<void> move(const device::GripperRequest& request, Done done) override {
        return ask("move", request, std::move(done));
    }
    void stop() noexcept override { ++stops; }
    Result<void> resetFault() override {
        ++resets;
        return reset_answer;
    }
    device::Registration onSafetyChange(SafetyCallback callback) override {
        const auto id = next_++;
        callbacks_[id] = std::move(callback);
        return device::Registration([this, id] { callbacks_.erase(id); });
    }

    bool moves() const { return done_ != nullptr; }
    void end(Result<device::GripperOutcome> outcome) {
        state_.moving = false;
        std::exchange(done_, nullptr)(std::move(outcome));
    }
    void setSafety(device::Safety safety) {
        safety_ = std::move(safety);
        const auto callbacks = callbacks_;
        for (const auto& [id, callback] : callbacks) {
            callback(safety_);
        }
    }
    void setPartHeld(bool held) { state_.part_held = held; }
    void setMoving(bool moving) { state_.moving = moving; }
    void setForceControl(bool has) { info_.max_force = has ? 80.0 : 0.0; }

    std::vector<Asked> asked;
    int stops = 0;
    int resets = 0;
    Result<void> reset_answer;
    Result<void> ask_answer;

private:
    Result<void> ask(std::string motion, const device::GripperRequest& request, Done done) {
        if (!ask_answer) {
            return ask_answer;
        }
        asked.push_back({std::move(motion), request});
        done_ = std::move(done);
        state_.moving = true;
        return {};
    }

    device::GripperInfo info_{
        .name = "tool", .stroke = 0.11, .min_force = 5, .max_force = 80, .max_speed = 0.42};
    device::GripperState state_;
    device::Safety safety_;
    Done done_;
    std::map<int, SafetyCallback> callbacks_;
    int next_ = 0;
};

inline const std::string kGrasp = "GraspGripperSkill";
inline const std::string kRelease = "ReleaseGripperSkill";
inline const std::string kMove = "MoveGripperSkill";

/// A gripper with all its skills as Programs.
class GripperBench {
public:
    GripperBench() {
        auto made = makeGripperSkills(gripper);
        for (auto& skill : made.skills) {
            const auto name = skill->description().name;
            skill::ProgramOptions options;
            options.resource = made.resource;
            programs_[name] = std::make_unique<skill::Program>(options, std::move(skill), executor,
                                                               executor->clock());
        }
    }

    skill::Program& program(const std::string& name) { return *programs_.at(name); }
    void destroyProgram(const std::string& name) { programs_.erase(name); }

    Result<void> start(const std::string& name, const skill::ValueMap& values = {}) {
        for (const auto& [parameter, value] : values) {
            METIER_TRY(program(name).write(caller, parameter, value));
        }
        return run([&] { return program(name).start(caller); });
    }
    template <typename Command>
    Result<void> run(Command command) {
        auto answer = command();
        executor->run();
        return answer;
    }
    void end(Result<device::GripperOutcome> outcome) {
        gripper.end(std::move(outcome));
        executor->run();
    }
    void setSafety(device::Safety safety) {
        gripper.setSafety(std::move(safety));
        executor->run();
    }

    HandDrivenGripper gripper;
    // Shared with the Programs, as they ask for.
    std::shared_ptr<skill::testing::ManualExecutor> executor =
        std::make_shared<skill::testing::ManualExecutor>();
    skill::Caller caller{"session", "client", "user"};

private:
    std::map<std::string, std::unique_ptr<skill::Program>> programs_;
};

}  // namespace metier::robot_skills
