// Live values on their way from a server to the tabs that show them.
#include <gmock/gmock.h>

#include <functional>
#include <string>

#include "cell_bench.hpp"
#include "ticker.hpp"

namespace metier::dashboard {
namespace {

using nlohmann::json;
using opcua_skill::SafetyStateKind;

/// An arm, and a tab that is sent what its link notes.
class LiveBench : public CellBench {
protected:
    LiveBench() {
        arm_.serve();
        ticker_.run(true);
    }
    void TearDown() override {
        ticker_.run(false);
        CellBench::TearDown();
    }
    /// Waits until that value was sent as it is wanted; one message may have several.
    void awaitLive(const char* path, const std::function<bool(const json&)>& wanted) {
        const json::json_pointer at(path);
        const auto isWanted = [&] { return sent_.contains(at) && wanted(sent_.at(at)); };
        if (!isWanted()) {
            shown_.await("live", [&](const json& live) {
                sent_.merge_patch(live);
                return isWanted();
            });
        }
    }
    void awaitLive(const char* path, const json& value) {
        awaitLive(path, [&](const json& told) { return told == value; });
    }

    ArmByHand arm_{{}, 0.11};
    Ticker ticker_{board_};
    json sent_ = json::object();
};

/// The arm is watched, by the thread of its watch.
class LiveLink : public LiveBench {
protected:
    LiveLink() {
        watch({.name = "arm", .url = arm_.url()});
        watches_.showLive(true);
    }
};

/// The test is the thread that makes the link.
class LinkByHand : public LiveBench {
protected:
    std::shared_ptr<ServerLink> link_ =
        system_tests::orThrow(ServerLink::open({.server = {.name = "arm", .url = arm_.url()},
                                                .server_at = [](const auto&) { return ""; },
                                                .models = models_,
                                                .board = board_},
                                               client_options_, [](const opcua::Failure&) {}));
};

TEST_F(LiveLink, ShowsWhatAnArmMeasures) {
    awaitLive("/arms/arm/q", json::array({0.0, 0.0}));
    awaitLive("/arms/arm/safety", "Normal");
    arm_.measure([](Measured& now) {
        now.kinematics.joint_position = {0.5, -0.25};
        now.kinematics.safety_state = SafetyStateKind::protective_stop;
        now.kinematics.missed_cycles = 7;
    });
    awaitLive("/arms/arm/q", json::array({0.5, -0.25}));
    awaitLive("/arms/arm/safety", "ProtectiveStop");
    awaitLive("/arms/arm/missed", 7);
}

TEST_F(LiveLink, ShowsWhatTheServerHasOnceItHasIt) {
    awaitLive("/arms/arm/q", json::array({0.0, 0.0}));
    EXPECT_FALSE(board_.cell().contains("c"));
    arm_.measure([](Measured& now) {
        now.commanded = {{0.1, 0.2}};
        now.jitter = 0.00025;
        now.wrench = opcua_skill::FlangeWrench{{1, 2, 3}, {4, 5, 6}};
    });
    awaitLive("/arms/arm/c", json::array({0.1, 0.2}));
    awaitLive("/arms/arm/jitter", 0.00025);
    awaitLive("/arms/arm/f", json::array({1, 2, 3, 4, 5, 6}));
}

TEST_F(LiveLink, ShowsAGripper) {
    arm_.measure([](Measured& now) {
        now.gripper = opcua_skill::GripperFigures{0.0512345678, 12.0, true};
    });
    awaitLive("/grippers/arm/width", 0.051235);
    awaitLive("/grippers/arm/held", true);
    awaitLive("/grippers/arm/force", 12.0);
}

TEST_F(LiveLink, ShowsWhoHasControlAndForHowLong) {
    const auto client = system_tests::connectAs(arm_.url(), "another client");
    const auto controller = arm_.bench().system().controller;
    const auto method = arm_.bench().controllerNode("urn:metier:skills", {"AcquireControl"});
    ASSERT_TRUE(
        client->call(controller, method,
                     {opcua::Value::of(std::uint32_t{60'000}), opcua::Value::of(std::int32_t{0})}));
    const auto leased = shown_.await("control", [](const json& told) {
        return told.at("owner") == "another client" && told.contains("lease_ms");
    });
    EXPECT_EQ(leased.at("mine"), false);
    EXPECT_GT(leased.at("lease_ms"), 10'000.0);
    EXPECT_GT(leased.at("until"), 0.0);
    ASSERT_TRUE(client->close());
    const auto free = shown_.await("control", [](const json& told) {
        return told.at("owner") == "" && !told.contains("lease_ms");
    });
    EXPECT_EQ(free.at("key"), "arm/BenchController");
}

TEST_F(LiveLink, ShowsWhatASkillIsDoing) {
    ASSERT_EQ(take("arm").status, 200);
    const auto key = keyOf("arm", "MoveSkill");
    const auto started = commands_.start(
        {{"tab", shown_.id()}, {"key", key}, {"parameters", {{"TargetJointPosition", {0, 0}}}}},
        anybody());
    ASSERT_EQ(started.status, 200) << errorOf(started);
    shown_.await("skill", [](const json& told) {
        return told.at("state") == "Running" && told.at("sub_state") == "Executing";
    });
    arm_.move().execution().finish({{"Duration", 1.0}});
    EXPECT_EQ(awaitState(key, "Ready").at("sub_state"), "") << "that of Running is over";
}

TEST_F(LinkByHand, ShowsNothingMoreOnceNobodyLooks) {
    link_->showLive(true);
    awaitLive("/arms/arm/q", json::array({0.0, 0.0}));
    link_->showLive(false);
    arm_.measure([](Measured& now) { now.kinematics.joint_position = {1.0, 1.0}; });
    const auto client = system_tests::connectAs(arm_.url(), "another client");
    auto told = std::make_shared<std::promise<void>>();
    const auto nodes = client::findKinematics(*client, link_->skills().front().address).value();
    const auto subscription = client::subscribeJointPosition(
        *client, nodes, std::chrono::milliseconds(10),
        [told, once = false](const std::vector<double>& joints) mutable {
            if (joints.front() == 1.0 && !std::exchange(once, true)) {
                told->set_value();
            }
        });
    ASSERT_EQ(told->get_future().wait_for(std::chrono::seconds(30)), std::future_status::ready);
    json all;
    board_.changeLive([&](LiveValues& live) { all = live.all({}); });
    EXPECT_EQ(all.at("arms").at("arm").at("q"), json::array({0.0, 0.0}));
    link_->showLive(true);
    awaitLive("/arms/arm/q", json::array({1.0, 1.0}));
}

}  // namespace
}  // namespace metier::dashboard
