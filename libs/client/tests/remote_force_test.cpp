#include "metier/client/remote_force.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>

#include "metier/skill/testing/manual_executor.hpp"
#include "served_nodes.hpp"

namespace metier::client {
namespace {

using composition::MeasuredForce;
using opcua::Value;
using skill::Vector3;
using ::testing::HasSubstr;
using testing::ServedNodes;

class Listener final : public composition::ForceListener {
public:
    void onForce(const MeasuredForce& measured) override { last = measured.force; }
    void onForceLost(const Error& why) override { lost = why.message; }

    Vector3 last{};
    std::string lost;
};

class RemoteForceTest : public ::testing::Test {
protected:
    opcua::NodeId add(const Value& value) {
        return served_->variable(opcua::ids::kObjectsFolder, "Force", value);
    }
    Result<std::shared_ptr<RemoteForce>> connect(const std::string& node,
                                                 const std::string& pose = {}) {
        RemoteForceOptions options;
        options.server_name = "press";
        options.url = served_->url();
        options.force = node;
        if (!pose.empty()) {
            options.arm_url = served_->url();
            options.pose = pose;
        }
        return RemoteForce::connect(std::move(options), executor_);
    }
    /// Waits for the first force, or for its error other than that none has come.
    Result<MeasuredForce> firstOf(const RemoteForce& force) {
        const auto isKnown = [&] {
            const auto now = force.newest();
            return now || now.error().code != Errc::resource_unavailable;
        };
        EXPECT_TRUE(executor_->runUntil(isKnown));
        return force.newest();
    }

    std::shared_ptr<skill::testing::ManualExecutor> executor_ =
        std::make_shared<skill::testing::ManualExecutor>();
    std::unique_ptr<ServedNodes> served_ = std::make_unique<ServedNodes>(
        std::vector<std::string>{}, std::vector<std::string>{"urn:lab"});
};

TEST_F(RemoteForceTest, TakesAnyThreeNumbers) {
    for (const auto& value :
         {Value::of(std::vector<double>{1, 2, 3}), Value::of(std::vector<float>{1, 2, 3}),
          Value::of(opcua::ThreeDVector{1, 2, 3})}) {
        served_ = std::make_unique<ServedNodes>();
        const auto force = connect(add(value).toString());
        ASSERT_TRUE(force) << force.error().message;
        const auto first = firstOf(**force);
        ASSERT_TRUE(first) << first.error().message;
        EXPECT_EQ(first->force, (Vector3{1, 2, 3}));
        EXPECT_FALSE(first->torque);
    }
}

TEST_F(RemoteForceTest, KnowsNoForceOfAnotherShape) {
    for (const auto& value : {Value::of("1, 2, 3"), Value::of(std::vector<double>{1, 2})}) {
        served_ = std::make_unique<ServedNodes>();
        const auto force = connect(add(value).toString());
        ASSERT_TRUE(force) << force.error().message;
        const auto first = firstOf(**force);
        ASSERT_FALSE(first);
        EXPECT_EQ(first.error().code, Errc::type_mismatch);
        EXPECT_THAT(first.error().message, HasSubstr("not three numbers"));
    }
}

TEST_F(RemoteForceTest, FindsAVariableByTheUriOfItsNamespace) {
    const auto node =
        served_->nodes().addVariable({.node = {{2, "Force"},
                                               opcua::ids::kObjectsFolder,
                                               opcua::ids::kHasComponent,
                                               {2, "Force"}},
                                      .value_rank = 1,
                                      .array_dimensions = {0},
                                      .value = Value::of(std::vector<double>{0, 0, 7})});
    ASSERT_TRUE(node) << node.error().message;
    const auto force = connect("nsu=urn:lab;s=Force");
    ASSERT_TRUE(force) << force.error().message;
    EXPECT_EQ(firstOf(**force)->force.z, 7);

    const auto nowhere = connect("nsu=urn:nobody;s=Force");
    ASSERT_FALSE(nowhere);
    EXPECT_THAT(nowhere.error().message, HasSubstr("urn:nobody"));
}

TEST_F(RemoteForceTest, HasThePoseOfTheSensor) {
    const auto node = add(Value::of(std::vector<double>{0, 0, 7}));
    const auto pose = served_->variable(opcua::ids::kObjectsFolder, "Pose",
                                        Value::of(opcua::ThreeDFrame{0.5, 0, 0.4, 3.1, 0, 0}));
    const auto force = connect(node.toString(), pose.toString());
    ASSERT_TRUE(force) << force.error().message;
    const auto first = firstOf(**force);
    ASSERT_TRUE(first) << first.error().message;
    EXPECT_EQ(first->pose, (Frame{0.5, 0, 0.4, 3.1, 0, 0}));
}

TEST_F(RemoteForceTest, IsNotKnownWithoutThePose) {
    const auto node = add(Value::of(std::vector<double>{0, 0, 7}));
    const auto pose = served_->variable(opcua::ids::kObjectsFolder, "Pose", Value::of(3.0));
    const auto force = connect(node.toString(), pose.toString());
    ASSERT_TRUE(force) << force.error().message;
    EXPECT_EQ(firstOf(**force).error().code, Errc::type_mismatch);
}

TEST_F(RemoteForceTest, ReportsEachForceAndItsLoss) {
    const auto node = served_->nodes().addVariable(
        {.node = {{}, opcua::ids::kObjectsFolder, opcua::ids::kHasComponent, {1, "Force"}},
         .value_rank = 1,
         .array_dimensions = {0},
         .value = Value::of(std::vector<double>{0, 0, 0}),
         .access = opcua::Access::read_write});
    ASSERT_TRUE(node) << node.error().message;
    const auto force = connect(node->toString());
    ASSERT_TRUE(force) << force.error().message;
    Listener listener;
    Listener removed;
    (*force)->add(listener);
    (*force)->add(removed);
    (*force)->remove(removed);
    ASSERT_TRUE(served_->client().write(*node, Value::of(std::vector<double>{0, 0, 9})));
    EXPECT_TRUE(executor_->runUntil([&] { return listener.last.z == 9; }));
    const auto port = served_->port();
    served_.reset();
    EXPECT_TRUE(executor_->runUntil([&] { return !listener.lost.empty(); }));
    EXPECT_FALSE((*force)->newest());
    served_ = std::make_unique<ServedNodes>(std::vector<std::string>{},
                                            std::vector<std::string>{"urn:lab"}, port);
    const auto same = add(Value::of(std::vector<double>{0, 0, 4}));
    EXPECT_EQ(same, *node);
    ASSERT_FALSE(served_->url().empty());
    EXPECT_TRUE(executor_->runUntil([&] { return listener.last.z == 4; })) << "it comes back";
    EXPECT_EQ(removed.last, Vector3{});
    EXPECT_EQ(removed.lost, "");
}

TEST_F(RemoteForceTest, IsNotThereWithoutItsServer) {
    RemoteForceOptions options;
    options.server_name = "press";
    options.url = "opc.tcp://127.0.0.1:1";
    options.force = "i=2258";
    const auto force = RemoteForce::connect(std::move(options), executor_);
    ASSERT_FALSE(force);
    EXPECT_EQ(force.error().code, Errc::connection_lost);
    EXPECT_THAT(force.error().message, HasSubstr("opc.tcp://127.0.0.1:1"));
}

}  // namespace
}  // namespace metier::client
