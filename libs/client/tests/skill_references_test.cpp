// References of a metier server, as a client reads them.
#include "metier/client/skill_references.hpp"

#include <gmock/gmock.h>

#include "metier/opcua/server.hpp"
#include "metier/opcua_skill/skill_controller.hpp"
#include "metier/opcua_skill/skill_dictionary.hpp"
#include "metier/opcua_skill/used_skills.hpp"

namespace metier::client {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr std::string_view kRoboticsUri = "https://fortiss.org/UA/Robotics/";
constexpr std::uint32_t kPickPlaceSkillType = 20217;
const opcua::NodeId kHasDictionaryEntry{0, 17597U};

/// A server with objects in the place of skills.
class SkillReferencesOfAServer : public ::testing::Test {
protected:
    static std::unique_ptr<opcua::Server> create(std::vector<std::string> nodesets) {
        opcua::ServerOptions options;
        options.port = 0;
        options.nodesets = std::move(nodesets);
        return opcua::Server::create(std::move(options)).value();
    }

    opcua::NodeId add(const std::string& name) {
        opcua::ObjectSpec spec;
        spec.node.parent = place_.skills;
        spec.node.browse_name = {place_.skills.namespaceIndex(), name};
        return nodes().addObject(spec).value();
    }
    opcua::AddressSpace& nodes() { return server_->nodes(); }

    SkillReferences read(const opcua::NodeId& node) {
        EXPECT_TRUE(server_->start());
        const auto client = opcua::Client::connect(server_->endpointUrl()).value();
        return ReferenceReader::create(*client).value().read(node).value();
    }

    std::unique_ptr<opcua::Server> server_ = create({"device", "robotics", "metier"});
    opcua_skill::SkillController place_ =
        opcua_skill::publishSkillController(nodes(), "component", "").value();
};

TEST_F(SkillReferencesOfAServer, TellWhatATypeIsFor) {
    ASSERT_TRUE(opcua_skill::publishDictionary(nodes()));
    const opcua::NodeId type(nodes().namespaceIndex(std::string(kRoboticsUri)).value(),
                             kPickPlaceSkillType);
    const auto references = read(type);
    EXPECT_THAT(references.terms, ElementsAre("urn:metier:dictionary:pick-and-place"));
    EXPECT_THAT(references.uses, IsEmpty());
}

TEST_F(SkillReferencesOfAServer, TellWhatOneSkillIsFor) {
    ASSERT_TRUE(opcua_skill::publishDictionary(nodes()));
    const auto skill = add("StackSkill");
    const opcua::NodeId entry(nodes().namespaceIndex("urn:metier:skills").value(),
                              std::string("urn:metier:dictionary:sequence"));
    ASSERT_TRUE(nodes().addReference(skill, kHasDictionaryEntry, entry));
    EXPECT_THAT(read(skill).terms, ElementsAre("urn:metier:dictionary:sequence"));
}

TEST_F(SkillReferencesOfAServer, TellWhereUsedSkillsAre) {
    const auto skill = add("VisitSkill");
    const auto own = add("SwingSkill");
    ASSERT_TRUE(opcua_skill::publishUse(nodes(), skill, own));
    ASSERT_TRUE(opcua_skill::publishUse(
        nodes(), skill,
        opcua_skill::RemoteSkill{"ptp", "opc.tcp://arm:4840", "JointPtpMoveSkill",
                                 "JointPtpMoveSkillType", "IiwaController"}));
    const auto uses = read(skill).uses;
    ASSERT_THAT(uses, SizeIs(2));
    EXPECT_EQ(uses[0].endpoint_url, "");
    EXPECT_EQ(uses[0].node, own);
    EXPECT_EQ(uses[1].endpoint_url, "opc.tcp://arm:4840");
    EXPECT_EQ(uses[1].name, "JointPtpMoveSkill");
    EXPECT_EQ(uses[1].controller, "IiwaController");
}

TEST_F(SkillReferencesOfAServer, AreNoneWithoutTheModelOfMetier) {
    server_ = create({});
    const auto references = read(opcua::ids::kObjectsFolder);
    EXPECT_THAT(references.terms, IsEmpty());
    EXPECT_THAT(references.uses, IsEmpty());
}

}  // namespace
}  // namespace metier::client
