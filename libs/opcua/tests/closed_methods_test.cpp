// Methods that types declare and nothing implements.
#include <gmock/gmock.h>

#include <deque>
#include <set>

#include "bare_client.hpp"

namespace metier::opcua {
namespace {

using testing::BareClient;
using testing::makeServer;
using testing::testOptions;

ServerOptions robotOptions() {
    auto options = testOptions();
    options.nodesets = {"edo"};
    return options;
}

class ClosedMethods : public ::testing::Test {
protected:
    ClosedMethods() : server_(makeServer(robotOptions())), nodes_(server_->nodes()) {}

    void serve() {
        ASSERT_TRUE(server_->start());
        ASSERT_EQ(client_.connect(server_->endpointUrl()), status::kGood);
    }

    NodeId robotics(std::uint32_t number) const {
        return {nodes_.namespaceIndex("https://fortiss.org/UA/Robotics/").value(), number};
    }
    /// The arm of the NodeSet.
    NodeId arm() const {
        const auto edo = nodes_.namespaceIndex("https://fortiss.org/UA/edo/").value();
        const auto di = nodes_.namespaceIndex("http://opcfoundation.org/UA/DI/").value();
        const auto robotics =
            nodes_.namespaceIndex("http://opcfoundation.org/UA/Robotics/").value();
        return nodes_
            .find(ids::kObjectsFolder, BrowsePath{{di, "DeviceSet"},
                                                  {edo, "EdoSystem"},
                                                  {robotics, "MotionDevices"},
                                                  {edo, "Edo"}})
            .value();
    }

    struct Found {
        NodeId object;
        NodeId method;
    };
    /// Methods below a node, each with the node that has it.
    std::vector<Found> methodsBelow(const NodeId& root) const {
        std::vector<Found> methods;
        std::set<NodeId> seen{root};
        for (std::deque<NodeId> open{root}; !open.empty(); open.pop_front()) {
            const auto children = nodes_.browse(open.front()).value();
            for (const auto& child : children) {
                if (child.node_class == NodeClass::method) {
                    methods.push_back({open.front(), child.target});
                } else if (seen.insert(child.target).second) {
                    open.push_back(child.target);
                }
            }
        }
        return methods;
    }

    static Result<std::vector<Value>> nothing(const CallContext&, std::span<const Value>) {
        return std::vector<Value>();
    }

    const std::unique_ptr<Server> server_;
    AddressSpace& nodes_;
    BareClient client_;
    const NodeId tool_set_ = robotics(16077);
    const NodeId tool_clear_ = robotics(16079);
};

TEST_F(ClosedMethods, OfACompiledTypeAreNotExecutable) {
    serve();
    for (const auto& method : {tool_set_, tool_clear_}) {
        EXPECT_EQ(client_.readExecutable(method), false);
        EXPECT_EQ(client_.readUserExecutable(method), false);
    }
}

TEST_F(ClosedMethods, OfACompiledInstanceRefuseTheCall) {
    const auto methods = methodsBelow(arm());
    serve();
    ASSERT_EQ(methods.size(), 2U);
    for (const auto& [object, method] : methods) {
        EXPECT_EQ(client_.readExecutable(method), false);
        EXPECT_EQ(client_.call(object, method, {}).status.name(), "BadNotExecutable");
    }
}

TEST_F(ClosedMethods, OfTheWholeServerAreExecutableOnlyWithWork) {
    const auto methods = methodsBelow(NodeId(0, 84U));  // the root
    serve();
    std::size_t closed = 0;
    for (const auto& [object, method] : methods) {
        if (client_.readExecutable(method) == false) {
            ++closed;
            EXPECT_EQ(client_.readUserExecutable(method), false) << method.toString();
        }
        // A wrong number of arguments, or no right to call: but there is something to call.
        EXPECT_NE(client_.call(object, method, {}).status.name(), "BadInternalError")
            << method.toString();
    }
    EXPECT_GT(closed, 50U);
}

TEST_F(ClosedMethods, OpenWithWorkAndCloseWithoutIt) {
    const auto object = arm();
    const auto method =
        nodes_.find(object, {tool_clear_.namespaceIndex(), "FlangeToolClear"}).value();
    ASSERT_TRUE(nodes_.setMethod(method, nothing));
    serve();
    EXPECT_EQ(client_.readExecutable(method), true);
    EXPECT_EQ(client_.readUserExecutable(method), true);
    EXPECT_EQ(client_.call(object, method, {}).status, status::kGood);
    ASSERT_TRUE(server_->call([&] { return nodes_.setMethod(method, nullptr); }));
    EXPECT_EQ(client_.readExecutable(method), false);
    EXPECT_EQ(client_.call(object, method, {}).status.name(), "BadNotExecutable");
}

TEST_F(ClosedMethods, OfANewObjectWaitForWork) {
    const NodeId stop =
        nodes_.addMethod({.node = {.parent = arm(), .browse_name = {2, "Stop"}}}).value();
    serve();
    EXPECT_EQ(client_.readExecutable(stop), false);
    ASSERT_TRUE(server_->call([&] { return nodes_.setMethod(stop, nothing); }));
    EXPECT_EQ(client_.readExecutable(stop), true);
}

}  // namespace
}  // namespace metier::opcua
