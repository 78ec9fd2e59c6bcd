// The Methods that the stack brings with its own nodes.
#include <gmock/gmock.h>

#include "bare_client.hpp"
#include "metier/opcua/client.hpp"

namespace metier::opcua {
namespace {

using testing::makeServer;

class StackMethodsTest : public ::testing::Test {
protected:
    StackMethodsTest() {
        EXPECT_TRUE(server_->start());
        client_ = Client::connect(server_->endpointUrl()).value();
    }
    StatusCode call(const NodeId& object, const NodeId& method, const Value& input) {
        const auto answer = client_->call(object, method, {input});
        return answer ? status::kGood : answer.error().status;
    }

    const std::unique_ptr<Server> server_ = makeServer();
    std::unique_ptr<Client> client_;
    const NodeId get_monitored_items_{0, 11492U};
    const NodeId resend_data_{0, 12873U};
};

// The stack took an empty array for the NodeId, and read at address 1.
TEST_F(StackMethodsTest, AreClosedIfTheyAddOrDeleteNodes) {
    const auto sets = client_->translate({0, 14443U}, {{0, "PublishedDataSets"}});
    ASSERT_TRUE(sets) << sets.error().message;
    const auto remove = client_->translate(*sets, {{0, "RemovePublishedDataSet"}});
    ASSERT_TRUE(remove) << remove.error().message;
    EXPECT_TRUE(call(*sets, *remove, Value::of(std::vector<NodeId>())).isBad());
    EXPECT_TRUE(call(*sets, *remove, Value::of(NodeId(0, 1U))).isBad());
    EXPECT_FALSE(client_->readUserExecutable(*remove).value());
    EXPECT_TRUE(client_->read({0, 2258U})) << "the server lives";
}

TEST_F(StackMethodsTest, TakeNoArrayForAScalar) {
    const auto none = Value::of(std::vector<std::uint32_t>());
    EXPECT_TRUE(call(ids::kServer, get_monitored_items_, none).isBad());
    EXPECT_TRUE(call(ids::kServer, resend_data_, none).isBad());
    EXPECT_TRUE(client_->read({0, 2258U})) << "the server lives";
}

// The stack took what lies behind a smaller node for the mark of an asynchronous Method, and never
// answered.
TEST_F(StackMethodsTest, AreNoOtherNodes) {
    const NodeId objects(0, 85U);
    for (const auto& other : {objects, NodeId(0, 58U), NodeId(0, 47U), NodeId(0, 22U),
                              NodeId(0, 63U), NodeId(0, 2258U), NodeId(0, 7'654'321U)}) {
        const auto answer = client_->call(objects, other, {});
        ASSERT_FALSE(answer) << other.toString();
        EXPECT_EQ(answer.error().status, status::kBadMethodInvalid) << answer.error().message;
    }
}

TEST_F(StackMethodsTest, TellOfTheSubscriptionsOfTheSession) {
    const auto subscription =
        client_->subscribeData({0, 2258U}, {}, [](const DataValue& /*value*/) {});
    ASSERT_TRUE(subscription) << subscription.error().message;
    const auto unknown = StatusCode(0x80280000);  // BadSubscriptionIdInvalid
    EXPECT_EQ(call(ids::kServer, get_monitored_items_, Value::of(std::uint32_t{0})), unknown);
    bool known = false;
    for (std::uint32_t id = 1; id < 1'000 && !known; ++id) {
        known = call(ids::kServer, get_monitored_items_, Value::of(id)) == status::kGood &&
                call(ids::kServer, resend_data_, Value::of(id)) == status::kGood;
    }
    EXPECT_TRUE(known);
}

}  // namespace
}  // namespace metier::opcua
