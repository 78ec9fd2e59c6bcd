// The pose of a robot's base in the world, which clients write.
#include "metier/opcua_skill/base_placement.hpp"

#include <gmock/gmock.h>

#include <limits>
#include <vector>

#include "metier/opcua/client.hpp"
#include "metier/opcua_skill/values.hpp"

namespace metier::opcua_skill::testing {
namespace {

using opcua::Value;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::SizeIs;

/// A server of one arm whose audit is kept.
class BasePlacement : public ::testing::Test {
protected:
    BasePlacement() {
        opcua::ServerOptions options;
        options.port = 0;
        options.nodesets = {"device", "robotics", "metier"};
        options.namespaces = {"urn:test"};
        options.on_audit = [this](const opcua::AuditRecord& record) {
            if (record.kind == opcua::AuditKind::acted) {
                acts_.push_back(record);
            }
        };
        server_ = opcua::Server::create(options).value();
        auto& nodes = server_->nodes();
        const auto system =
            publishMotionDeviceSystem(nodes, {"Test",
                                              "An arm of the test.",
                                              "metier",
                                              "two axes",
                                              {"A1", "A2"},
                                              nodes.namespaceIndex("urn:test").value()})
                .value();
        const auto served = serveBasePlacement(*server_, system);
        EXPECT_TRUE(served) << served.error().message;
        EXPECT_TRUE(server_->start());
        client_ = opcua::Client::connect(server_->endpointUrl(), {}).value();
        const auto di = client_->namespaceIndex("http://opcfoundation.org/UA/DI/").value();
        const auto robotics = client_->namespaceIndex("https://fortiss.org/UA/Robotics/").value();
        pose_ = client_
                    ->translate(system.motion_device,
                                {{di, "ParameterSet"}, {robotics, "WorldToRobotBase"}})
                    .value();
    }

    opcua::NodeId part(const std::vector<opcua::QualifiedName>& path) {
        return client_->translate(pose_, path).value();
    }
    std::string write(const opcua::NodeId& node, const Value& value) {
        const auto answer = client_->write(node, value);
        return answer ? "Good" : answer.error().status.name();
    }
    opcua::ThreeDFrame pose() {
        return client_->read(pose_).value().as<opcua::ThreeDFrame>().value();
    }
    /// Audit records so far.
    std::vector<opcua::AuditRecord> acts() {
        std::vector<opcua::AuditRecord> noted;
        EXPECT_TRUE(server_->call([&] { noted = acts_; }));
        return noted;
    }

    std::vector<opcua::AuditRecord> acts_;  // used on the server's thread
    std::unique_ptr<opcua::Server> server_;
    std::unique_ptr<opcua::Client> client_;
    opcua::NodeId pose_;
};

TEST_F(BasePlacement, IsReadAsItWasWrittenAsAWholeAndByItsParts) {
    EXPECT_EQ(pose(), opcua::ThreeDFrame{});
    EXPECT_EQ(write(pose_, Value::of(opcua::ThreeDFrame{1, 2, 3, 0.1, 0.2, 0.3})), "Good");
    const auto x = part({{0, "CartesianCoordinates"}, {0, "X"}});
    EXPECT_EQ(client_->read(x).value(), Value::of(1.0));
    EXPECT_EQ(client_->read(part({{0, "Orientation"}})).value(),
              Value::of(opcua::ThreeDOrientation{0.1, 0.2, 0.3}));
    EXPECT_EQ(write(x, Value::of(-1.5)), "BadNotWritable");
}

TEST_F(BasePlacement, RefusesWhatIsNotFiniteOrOutOfRange) {
    const opcua::ThreeDFrame before{1, 2, 3, 0.1, 0.2, 0.3};
    ASSERT_EQ(write(pose_, Value::of(before)), "Good");
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(write(pose_, Value::of(opcua::ThreeDFrame{nan, 2, 3, 0, 0, 0})), "BadOutOfRange");
    EXPECT_EQ(write(pose_, Value::of(opcua::ThreeDFrame{1e300, 2, 3, 0, 0, 0})), "BadOutOfRange");
    EXPECT_EQ(write(pose_, Value()), "BadOutOfRange");
    EXPECT_EQ(write(pose_, Value::of(opcua::ThreeDFrame{1000.5, 2, 3, 0, 0, 0})), "BadOutOfRange");
    EXPECT_EQ(write(pose_, Value::of(opcua::ThreeDFrame{1, 2, 3, 0, 7, 0})), "BadOutOfRange");
    EXPECT_EQ(write(pose_, Value::of(opcua::ThreeDFrame{1, 2, 3, 0, 0, 6.3})), "BadOutOfRange");
    EXPECT_EQ(pose(), before);
}

TEST_F(BasePlacement, WritesAreAudited) {
    ASSERT_EQ(write(pose_, Value::of(opcua::ThreeDFrame{1, 2, 3, 0, 0, 0})), "Good");
    ASSERT_EQ(write(pose_, Value::of(opcua::ThreeDFrame{1e300, 2, 3, 0, 0, 0})), "BadOutOfRange");
    const auto noted = acts();
    ASSERT_THAT(noted, SizeIs(2));
    EXPECT_EQ(noted[0].event, "Write");
    EXPECT_EQ(noted[0].object, pose_);
    EXPECT_EQ(noted[0].object_name, "WorldToRobotBase");
    EXPECT_THAT(noted[0].text, HasSubstr("somebody (Engineer) of"));
    EXPECT_THAT(noted[0].text, HasSubstr(" wrote "));
    EXPECT_THAT(noted[1].text, AllOf(HasSubstr("was refused"), HasSubstr("1e+300 is outside")));
}

}  // namespace
}  // namespace metier::opcua_skill::testing
