// NodeRoles of skill types, as any client reads them.
#include "metier/opcua_skill/skill_dictionary.hpp"

#include <gmock/gmock.h>

#include "served_skills.hpp"

namespace metier::opcua_skill::testing {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

const opcua::NodeId kDictionaries{0, 17594U};
const opcua::NodeId kHasDictionaryEntry{0, 17597U};
const opcua::NodeId kUriDictionaryEntryType{0, 17600U};

class SkillDictionary : public ServedSkills {
protected:
    SkillDictionary() {
        const auto published = publishDictionary(server().nodes());
        if (!published) {
            throw std::runtime_error(published.error().message);
        }
        serve();
    }

    opcua::NodeId inRobotics(std::uint32_t id) const {
        return {client_->namespaceIndex("https://fortiss.org/UA/Robotics/").value(), id};
    }

    std::unique_ptr<opcua::Client> client_;
};

TEST_F(SkillDictionary, TellsWhatATypeIsFor) {
    client_ = connect();
    constexpr std::uint32_t kPickPlaceSkillType = 20217;
    const auto entries = client_->browse(
        {.node = inRobotics(kPickPlaceSkillType), .reference_type = kHasDictionaryEntry});
    ASSERT_TRUE(entries) << entries.error().message;
    ASSERT_THAT(*entries, SizeIs(1));
    const auto& entry = entries->front();
    EXPECT_EQ(entry.browse_name.name, "urn:metier:dictionary:pick-and-place");
    EXPECT_EQ(entry.display_name.text, "pick-and-place");
    EXPECT_EQ(entry.type_definition, kUriDictionaryEntryType);
}

TEST_F(SkillDictionary, LeadsFromEachEntryToATypeThatIsThere) {
    client_ = connect();
    const auto folders = client_->browse({.node = kDictionaries}).value();
    ASSERT_THAT(folders, SizeIs(1));
    const auto entries = client_->browse({.node = folders.front().target}).value();
    EXPECT_THAT(entries, SizeIs(11));
    for (const auto& entry : entries) {
        const auto types = client_->browse({.node = entry.target,
                                            .reference_type = kHasDictionaryEntry,
                                            .direction = opcua::BrowseQuery::Direction::inverse});
        ASSERT_TRUE(types);
        EXPECT_THAT(*types, ::testing::Not(IsEmpty())) << entry.display_name.text;
    }
}

}  // namespace
}  // namespace metier::opcua_skill::testing
