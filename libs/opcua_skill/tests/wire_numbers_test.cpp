// Numbers of enumerations here and in the Metier NodeSet.
#include <gmock/gmock.h>

#include "metier/nodesets/ids.hpp"
#include "metier/opcua/client.hpp"
#include "metier/opcua/server.hpp"
#include "metier/opcua_skill/namespaces.hpp"
#include "metier/opcua_skill/safety_state_kind.hpp"
#include "metier/opcua_skill/wire_numbers.hpp"
#include "metier/skill/state.hpp"

namespace metier::opcua_skill::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::StartsWith;

class NamesOfEnumerations : public ::testing::Test {
protected:
    NamesOfEnumerations() {
        opcua::ServerOptions options;
        options.port = 0;
        options.nodesets = {"device", "robotics", "metier"};
        server_ = opcua::Server::create(options).value();
        EXPECT_TRUE(server_->start());
        client_ = opcua::Client::connect(server_->endpointUrl(), {}).value();
    }

    /// Names in the order of their numbers, from 0.
    std::vector<std::string> namesAt(std::uint32_t enum_strings,
                                     std::string_view uri = kMetierUri) {
        std::vector<std::string> names;
        const auto value = client_->read({client_->namespaceIndex(uri).value(), enum_strings});
        EXPECT_TRUE(value);
        const auto texts = value->as<std::vector<opcua::LocalizedText>>();
        EXPECT_TRUE(texts);
        for (const auto& text : *texts) {
            names.push_back(text.text);
        }
        return names;
    }

    std::unique_ptr<opcua::Server> server_;
    std::unique_ptr<opcua::Client> client_;
};

TEST_F(NamesOfEnumerations, OfSafetyStatesAreThoseOfTheNodeSet) {
    const auto published = namesAt(nodesets::skills::kSafetyStateKind_EnumStrings);
    ASSERT_EQ(published.size(), static_cast<std::size_t>(SafetyStateKind::fault) + 1);
    for (std::size_t number = 0; number < published.size(); ++number) {
        EXPECT_EQ(nameOf(SafetyStateKind(number)), published[number]) << number;
    }
    EXPECT_EQ(nameOf(SafetyStateKind::protective_stop), "ProtectiveStop");
    EXPECT_EQ(nameOf(SafetyStateKind(-1)), "Unknown");
    EXPECT_EQ(nameOf(SafetyStateKind(6)), "Unknown");
}

TEST_F(NamesOfEnumerations, OfReactionsToTheLossOfAnOwnerAreInTheOrderOfTheirNumbers) {
    EXPECT_THAT(namesAt(nodesets::skills::kOwnerLossAction_EnumStrings),
                ElementsAre("SkillDefault", "Halt", "Suspend", "Continue"));
    using Action = skill::OwnerLossAction;
    EXPECT_EQ(static_cast<int>(Action::skill_default), 0);
    EXPECT_EQ(static_cast<int>(Action::halt), 1);
    EXPECT_EQ(static_cast<int>(Action::suspend), 2);
    EXPECT_EQ(static_cast<int>(Action::keep_going), 3);
}

TEST_F(NamesOfEnumerations, OfReasonsAreThoseOfTheNodeSet) {
    const auto published =
        namesAt(nodesets::device::kSkillTransitionReason_EnumStrings, kDeviceUri);
    ASSERT_EQ(published.size(), static_cast<std::size_t>(skill::Reason::limit_violated) + 1);
    for (std::size_t number = 0; number < published.size(); ++number) {
        // "Force" and "Limit" of the NodeSet are the longer ForceExceeded and LimitViolated here.
        EXPECT_THAT(std::string(toString(skill::Reason(number))), StartsWith(published[number]));
    }
}

TEST_F(NamesOfEnumerations, OfStatesAndTransitionsAreThoseOfProgramStateMachineType) {
    const auto nameOf = [this](const opcua::NodeId& node) {
        const auto name = client_->read(node, opcua::AttributeId::browse_name);
        return name ? name->as<opcua::QualifiedName>()->name : name.error().message;
    };
    for (const auto state : {skill::State::halted, skill::State::ready, skill::State::running,
                             skill::State::suspended}) {
        EXPECT_EQ(nameOf(stateId(state)), toString(state));
    }
    for (std::uint32_t number = 1; number <= 9; ++number) {
        const auto transition = static_cast<skill::TransitionNumber>(number);
        EXPECT_EQ(nameOf(transitionId(transition)), toString(transition));
    }
}

}  // namespace
}  // namespace metier::opcua_skill::testing
