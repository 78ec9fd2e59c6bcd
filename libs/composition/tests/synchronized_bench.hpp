#pragma once

#include <gmock/gmock.h>

#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "metier/composition/synchronized_move_skill.hpp"
#include "metier/skill/program.hpp"
#include "metier/skill/testing/manual_executor.hpp"
#include "metier/skill/testing/recording_observer.hpp"
#include "scripted_used_skill.hpp"

namespace metier::composition {

using namespace std::chrono_literals;
using composition::ClockOffset;
using composition::testing::ScriptedUsedSkill;

inline const skill::Caller kClient{"session", "client", "user"};

inline skill::SkillDescription moveDescription(const std::string& name) {
    skill::SkillDescription description{.name = name, .type = name + "Type"};
    for (const auto* parameter :
         {"TargetJointPosition", "ToolFrame", "Duration", "StartTime", "StopTime"}) {
        description.parameters.push_back({.name = parameter});
    }
    return description;
}

/// The two moves of one arm, as the test has them behave.
struct ScriptedArm {
    ScriptedUsedSkill* pose;
    ScriptedUsedSkill* joint;
};

/// A synchronized move of two scripted arms; the test moves the time and everything else.
class Bench {
public:
    Bench() {
        std::vector<Arm> arms;
        for (const std::string name : {"left", "right"}) {
            auto pose = std::make_unique<ScriptedUsedSkill>(
                "CartesianPtpMoveSkill of " + name, moveDescription("CartesianPtpMoveSkill"));
            auto joint = std::make_unique<ScriptedUsedSkill>("JointPtpMoveSkill of " + name,
                                                             moveDescription("JointPtpMoveSkill"));
            arms_[name] = {pose.get(), joint.get()};
            arms.push_back({name, std::move(pose), std::move(joint)});
        }
        program = std::make_unique<skill::Program>(
            skill::ProgramOptions{.rest_deadline = kRestDeadline},
            std::make_unique<SynchronizedMoveSkill>(
                std::move(arms),
                Options{executor, executor->clock(), "both.SynchronizedMoveSkill"}),
            executor, executor->clock());
        program->attach(observer);
    }

    ScriptedArm& operator[](const std::string& arm) { return arms_.at(arm); }

    Result<void> start(skill::ValueMap parameters = twoPoses()) {
        auto started = program->startWith(kClient, {"run", std::move(parameters)});
        run();
        return started.map([](const std::string& /*id*/) {});
    }
    static skill::ValueMap twoPoses() {
        return {{"TargetPoses", std::vector<skill::Frame>{{0.4, 0, 0.5}, {0.5, 0, 0.4}}}};
    }
    void run() { executor->run(); }
    Result<void> call(Result<void> outcome) {
        run();
        return outcome;
    }

    /// The arm's answers to Check: a way of one axis.
    void answerCheck(const std::string& arm, double duration, double from, double to) {
        skill::CheckReport report;
        report.planned_duration = duration;
        report.joint_path = {{from}, {(from + to) / 2}, {to}};
        auto& asked = arms_.at(arm);
        for (auto* used : {asked.pose, asked.joint}) {
            if (auto done = std::exchange(used->check_done, nullptr)) {
                done(report);
                run();
            }
        }
    }
    void refuseCheck(const std::string& arm, const std::string& why) {
        skill::CheckReport report;
        report.possible = false;
        report.reason = why;
        std::exchange(arms_.at(arm).pose->check_done, nullptr)(report);
        run();
    }
    void answerClocks(const std::string& arm, std::chrono::nanoseconds ahead,
                      std::chrono::nanoseconds uncertainty) {
        std::exchange(arms_.at(arm).joint->clocks_done, nullptr)(ClockOffset{ahead, uncertainty});
        run();
    }
    /// Both ways are known and both clocks right: the arms have been begun.
    void answerAll() {
        answerCheck("left", 2.0, 0.0, 1.0);
        answerCheck("right", 3.0, 0.0, -1.0);
        answerClocks("left", 0ns, 1ms);
        answerClocks("right", 0ns, 2ms);
    }
    void startBoth() {
        EXPECT_TRUE(start());
        answerAll();
    }
    void finish(const std::string& arm, double start, double end, double lateness = 0.0) {
        arms_.at(arm).joint->finish(
            {{"MotionStartTime", start}, {"MotionEndTime", end}, {"LargestLateness", lateness}});
        run();
    }

    double requested(const std::string& arm, const std::string& parameter) {
        return std::get<double>(arms_.at(arm).joint->request.parameters.at(parameter));
    }
    double utc() const {
        return std::chrono::duration<double>(executor->clock().utcNow().time_since_epoch()).count();
    }
    double result(const std::string& name) const {
        return std::get<double>(program->finalResult().at(name));
    }
    std::string state() const { return std::string(toString(program->state())); }
    const std::string& why() const { return program->reasonText(); }

    std::shared_ptr<skill::testing::ManualExecutor> executor =
        std::make_shared<skill::testing::ManualExecutor>();
    skill::testing::RecordingObserver observer;
    std::unique_ptr<skill::Program> program;

private:
    std::map<std::string, ScriptedArm> arms_;
};

}  // namespace metier::composition
