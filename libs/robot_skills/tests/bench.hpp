#pragma once

#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "metier/joint_simulator/joint_simulator.hpp"
#include "metier/joint_simulator/robot_options.hpp"
#include "metier/motion/robot_model.hpp"
#include "metier/robot_skills/arm_skills.hpp"
#include "metier/skill/program.hpp"
#include "metier/skill/testing/manual_executor.hpp"

namespace metier::robot_skills {

inline motion::RobotModel modelOf(const std::string& robot) {
    return motion::RobotModel::load(std::string(METIER_MODELS_DIR) + "/" + robot + ".toml").value();
}

/// Records the states of a Program.
class States final : public skill::ProgramObserver {
public:
    void onTransition(const skill::TransitionEvent& event) override {
        seen.push_back(event.to);
        if (told) {
            told(event);
        }
    }

    std::vector<skill::State> seen;
    std::function<void(const skill::TransitionEvent&)> told;
};

using Change = std::function<void(joint_simulator::JointSimulatorOptions&)>;
/// Further interfaces of the simulated arm.
using MakeDevices =
    std::function<ArmDevices(joint_simulator::JointSimulator&, const motion::RobotModel&)>;

/// One simulated arm with all its skills as Programs, and time moved by hand.
class Bench {
public:
    explicit Bench(const std::string& robot = "ur5", const Change& change = {},
                   const MakeDevices& devices = {}, const PositionStreamOptions& stream = {})
        : model_(modelOf(robot)), executor_(std::make_shared<skill::testing::ManualExecutor>()) {
        auto options = joint_simulator::optionsFor(model_);
        if (change) {
            change(options);
        }
        arm_ = joint_simulator::JointSimulator::create(std::move(options)).value();
        auto skills = makeArmSkills(devices ? devices(*arm_, model_) : ArmDevices{*arm_}, model_,
                                    executor_->clock(), stream)
                          .value();
        resource_ = skills.resource;
        stream_report_ = skills.stream_report;
        stopping_report_ = skills.stopping_report;
        for (auto& move : skills.moves) {
            add(std::move(move));
        }
        add(std::move(skills.position_stream));
    }

    const motion::RobotModel& model() const { return model_; }
    joint_simulator::JointSimulator& arm() { return *arm_; }
    skill::testing::ManualExecutor& executor() { return *executor_; }
    std::shared_ptr<skill::Executor> sharedExecutor() { return executor_; }
    skill::Program& program(const std::string& name) { return *programs_.at(name); }
    void destroyProgram(const std::string& name) { programs_.erase(name); }
    const skill::Caller& caller() const { return caller_; }
    StreamReport::Figures streamFigures() const { return stream_report_->figures(); }
    /// The moves' report of how soon they would stand.
    std::optional<motion::StoppingEstimate> stoppingEstimate() const {
        return stopping_report_->read();
    }

    Result<void> write(const std::string& skill, const skill::ValueMap& values) {
        for (const auto& [name, value] : values) {
            METIER_TRY(program(skill).write(caller_, name, value));
        }
        return {};
    }

    /// Write, then Start, as a published client does.
    Result<void> start(const std::string& skill, const skill::ValueMap& values) {
        auto written = write(skill, values);
        return written ? program(skill).start(caller_) : written;
    }

    /// One cycle of the arm, with all that follows from it.
    void step() {
        arm_->step();
        executor_->advance(arm_->info().cycle);
    }

    /// Steps until `done`, at most 60 s of the arm's time; whether it is.
    bool stepUntil(const std::function<bool()>& done) {
        const auto most = static_cast<int>(60.0 / arm_->info().cycleSeconds());
        for (int i = 0; i < most && !done(); ++i) {
            step();
        }
        return done();
    }

    bool stepUntil(const std::string& skill, skill::State state) {
        return stepUntil([&] { return program(skill).state() == state; });
    }

    void steps(int count) {
        for (int i = 0; i < count; ++i) {
            step();
        }
    }

    motion::JointVector commanded() const {
        const auto state = arm_->state();
        return motion::JointVector::from(state.commanded_position.values()).value();
    }
    motion::Pose commandedPose() const { return model_.kinematics().forward(commanded()); }

private:
    void add(std::unique_ptr<skill::Skill> skill) {
        const auto name = skill->description().name;
        skill::ProgramOptions options;
        options.resource = resource_;
        programs_[name] = std::make_unique<skill::Program>(options, std::move(skill), executor_,
                                                           executor_->clock());
    }

    motion::RobotModel model_;
    // Shared with the Programs, as they ask for.
    std::shared_ptr<skill::testing::ManualExecutor> executor_;
    std::unique_ptr<joint_simulator::JointSimulator> arm_;
    std::shared_ptr<skill::Resource> resource_;
    std::shared_ptr<const StreamReport> stream_report_;      // shared with the skill that fills it
    std::shared_ptr<const StoppingReport> stopping_report_;  // likewise
    std::map<std::string, std::unique_ptr<skill::Program>> programs_;
    skill::Caller caller_{"session", "client", "user"};
};

inline const std::string kCartesianPtp = "CartesianPtpMoveSkill";
inline const std::string kCartesianLinear = "CartesianLinearMoveSkill";
inline const std::string kJointPtp = "JointPtpMoveSkill";
inline const std::string kJointLinear = "JointLinearMoveSkill";
inline const std::string kForceMove = "CartesianLinearForceMoveSkill";
inline const std::string kPositionStream = "PositionStreamSkill";

/// Distance of a point from the straight line through two others [m].
inline double distanceFromLine(const Eigen::Vector3d& point, const Eigen::Vector3d& from,
                               const Eigen::Vector3d& to) {
    return (point - from).cross((to - from).normalized()).norm();
}

}  // namespace metier::robot_skills
