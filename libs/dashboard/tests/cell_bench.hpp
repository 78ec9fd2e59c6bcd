#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "bench_server.hpp"
#include "commands.hpp"
#include "metier/base/clock.hpp"
#include "metier/motion/robot_model.hpp"
#include "metier/opcua_skill/live_figures.hpp"
#include "people.hpp"
#include "shown_tab.hpp"
#include "tabs.hpp"
#include "watches.hpp"

namespace metier::dashboard {

/// A skill that does what a test says. Threading: any.
class SkillByHand {
public:
    skill::SkillFunctions functions();

    /// The execution that was begun last.
    skill::ExecutionHandle execution() const;
    /// How Start, Suspend and Reset are answered from then on.
    void answerStart(Result<void> answer);
    void answerSuspend(Result<void> answer);
    /// \param first of so many calls of Reset are told that the device takes its time
    void answerReset(Result<void> answer, int first = 0);
    int resets() const;

private:
    mutable std::mutex mutex_;
    skill::ExecutionHandle execution_;
    Result<void> start_;
    Result<void> suspend_;
    Result<void> reset_;
    int slow_resets_ = 0;
    int resets_ = 0;
};

/// Measurements of an arm, and of its gripper if it has one.
struct Measured {
    opcua_skill::KinematicsState kinematics{
        {0.0, 0.0}, {}, opcua_skill::SafetyStateKind::normal, 0};
    std::optional<std::vector<double>> commanded{};
    std::optional<double> jitter{};
    std::optional<opcua_skill::FlangeWrench> wrench{};
    std::optional<opcua_skill::GripperFigures> gripper{};
};

/// A server in this process: an arm with two axes, its control and the skills MoveSkill and
/// TurnSkill. Throws if it cannot be made.
class ArmByHand {
public:
    /// \param stroke of a gripper that its controller has [m]; 0: it has none
    explicit ArmByHand(system_tests::BenchOptions options = {}, double stroke = 0.0);

    void serve() { bench_.serve(); }
    std::string url() const { return bench_.url(); }
    system_tests::BenchServer& bench() { return bench_; }
    SkillByHand& move() { return move_; }
    SkillByHand& turn() { return turn_; }
    void measure(const std::function<void(Measured&)>& change);
    /// Holds up the server's thread until the result goes, at most 30 s.
    std::shared_ptr<void> keepBusy();

private:
    Measured measured() const;

    mutable std::mutex mutex_;
    Measured measured_;
    SkillByHand move_;
    SkillByHand turn_;
    system_tests::BenchServer bench_;  // last: its thread uses everything above
};

/// The parts of a dashboard that speak to servers, a tab, and the person whose it is.
class CellBench : public ::testing::Test {
protected:
    explicit CellBench(Access access = Access::lab);
    void TearDown() override { watches_.end(); }

    /// Has a server watched, and waits until it is connected.
    void watch(const CellServer& server);
    void awaitConnected(const std::string& server);
    /// The key of a skill of a server that is connected.
    static std::string keyOf(const std::string& server, const std::string& skill) {
        return server + "/BenchController/" + skill;
    }
    /// Waits until the tab was told that the skill is in that state.
    nlohmann::json awaitState(const std::string& key, const std::string& state) {
        return shown_.awaitState(key, state);
    }
    std::shared_ptr<Person> anybody() { return people_.find(""); }
    Reply take(const std::string& server) {
        return commands_.control({{"tab", shown_.id()}, {"server", server}, {"action", "take"}},
                                 anybody());
    }
    static std::string errorOf(const Reply& reply) {
        return reply.status == 200 ? "none"
                                   : reply.body.at("error").at("message").get<std::string>();
    }

    ManualClock clock_;  // of log-ins and of the board
    Board board_{{{"name", "test"}}, clock_};
    opcua::ClientOptions client_options_;
    std::function<std::optional<Error>()> refuse_options_;  // may be empty
    Connector connector_;
    const std::vector<motion::RobotModel> models_;
    Watches watches_{board_, connector_, models_};
    People people_;
    Tabs tabs_{board_, watches_};
    Commands commands_{watches_, tabs_};
    ShownTab shown_{board_};
};

}  // namespace metier::dashboard
