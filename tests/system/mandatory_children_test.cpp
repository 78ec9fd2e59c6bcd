// Mandatory children of types, in the instances that servers show.
#include <gmock/gmock.h>

#include "metier/opcua/server.hpp"
#include "metier_program.hpp"
#include "model_walk.hpp"
#include "running_cell.hpp"

namespace metier::system_tests {
namespace {

using opcua::NodeId;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

NodeId deviceSet(opcua::Client& client) {
    return {client.namespaceIndex("http://opcfoundation.org/UA/DI/").value(), 5001U};
}

/// A server of one NodeSet, which nothing serves.
class ServedNodeset {
public:
    explicit ServedNodeset(const std::string& name) {
        opcua::ServerOptions options;
        options.port = 0;
        options.nodesets = {name};
        server_ = std::move(opcua::Server::create(options).value());
    }
    opcua::AddressSpace& nodes() { return server_->nodes(); }
    std::vector<std::string> missing() {
        if (auto started = server_->start(); !started) {
            throw std::runtime_error(started.error().message);
        }
        const auto client = connectTo(server_->endpointUrl());
        return ModelWalk(*client).missingBelow(deviceSet(*client));
    }

private:
    std::unique_ptr<opcua::Server> server_;
};

class MandatoryChildrenOf : public ::testing::TestWithParam<const char*> {};

TEST_P(MandatoryChildrenOf, ANodeSetAreThere) {
    EXPECT_THAT(ServedNodeset(GetParam()).missing(), IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(All, MandatoryChildrenOf,
                         ::testing::Values("iiwa", "edo", "universal_robots", "wsg50"),
                         [](const auto& one) { return std::string(one.param); });

TEST(MandatoryChildren, ThatAreMissingAreNamedWithTheirPlaces) {
    ServedNodeset served("edo");
    auto& nodes = served.nodes();
    const auto edo = nodes.namespaceIndex("https://fortiss.org/UA/edo/").value();
    const auto robotics = nodes.namespaceIndex("http://opcfoundation.org/UA/Robotics/").value();
    const auto di = nodes.namespaceIndex("http://opcfoundation.org/UA/DI/").value();
    const auto arm =
        nodes
            .find(NodeId(di, 5001U),
                  opcua::BrowsePath{{edo, "EdoSystem"}, {robotics, "MotionDevices"}, {edo, "Edo"}})
            .value();
    const auto remove = [&](const opcua::BrowsePath& path) {
        ASSERT_TRUE(nodes.deleteNode(nodes.find(arm, path).value()));
    };
    remove({{robotics, "PowerTrains"}, {edo, "PowerTrain_3"}, {edo, "Motor"}});
    remove(
        {{robotics, "Axes"}, {edo, "Axis_2"}, {di, "ParameterSet"}, {robotics, "ActualPosition"}});
    const auto missing = served.missing();
    EXPECT_THAT(missing, Contains("/EdoSystem/MotionDevices/Edo/PowerTrains/PowerTrain_3 lacks "
                                  "<MotorIdentifier>"));
    EXPECT_THAT(missing, Contains(AllOf(HasSubstr("/Axis_2"), EndsWith("lacks ActualPosition"))));
}

// An arm knows the mass of the load at its flange, and nothing else of it.
TEST(OptionalChildren, HaveNoValueThatNobodyKnows) {
    const ServerProcess arm("iiwa");
    const auto client = connectTo(arm.url());
    const auto iiwa = client->namespaceIndex("https://fortiss.org/UA/iiwa/").value();
    const auto robotics = client->namespaceIndex("http://opcfoundation.org/UA/Robotics/").value();
    const auto status = [&](const std::vector<opcua::QualifiedName>& below) {
        std::vector<opcua::QualifiedName> path{{iiwa, "IiwaSystem"},
                                               {robotics, "MotionDevices"},
                                               {iiwa, "Iiwa"},
                                               {robotics, "FlangeLoad"}};
        path.insert(path.end(), below.begin(), below.end());
        const auto node = client->translate(deviceSet(*client), path);
        EXPECT_TRUE(node) << below.back().name;
        const auto value = client->read(node.value_or(NodeId()));
        return value ? "Good" : value.error().status.name();
    };
    EXPECT_EQ(status({{robotics, "Mass"}}), "Good");
    EXPECT_EQ(status({{robotics, "CenterOfMass"}}), "BadNoData");
    EXPECT_EQ(status({{robotics, "CenterOfMass"}, {0, "CartesianCoordinates"}, {0, "X"}}),
              "BadNoData");
    EXPECT_EQ(status({{robotics, "Inertia"}}), "BadNoData");
}

TEST(MandatoryChildren, AreThereInEveryInstanceOfTheDemosServers) {
    const RunningCell cell(demoCell());
    for (const auto& [name, url] : cell.urls()) {
        const auto client = connectTo(url);
        ModelWalk walk(*client);
        EXPECT_THAT(walk.missingBelow(deviceSet(*client)), IsEmpty()) << name;
        EXPECT_GT(walk.instances(), 100U) << name;
    }
}

}  // namespace
}  // namespace metier::system_tests
