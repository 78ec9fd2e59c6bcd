#include "finding/discovered_servers.hpp"

#include <gmock/gmock.h>

namespace metier::server {
namespace {

using ::testing::ElementsAre;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::SizeIs;

DiscoveredServer server(const std::string& name, const std::vector<std::string>& skills) {
    DiscoveredServer result{{"opc.tcp://" + name, name, "test"}, {}};
    for (const auto& skill : skills) {
        client::SkillAddress address;
        address.name = skill;
        address.type_name = skill + "Type";
        result.offered.push_back({name, 0, std::move(address), {0.9, 3.0}});
    }
    return result;
}

composition::Use use(const std::string& alias, const std::string& type) {
    return {.alias = alias, .type = type};
}

std::vector<std::string> aliases(const Assignment& assignment) {
    std::vector<std::string> result;
    for (const auto& each : assignment.uses) {
        result.push_back(each.alias);
    }
    return result;
}

TEST(DiscoveredServers, KeepTogetherWhatOneServerCanDo) {
    const std::vector servers{server("a", {"Line"}), server("b", {"Ptp", "Line"}),
                              server("c", {"Grasp"})};
    const auto assigned =
        assign({use("ptp", "PtpType"), use("line", "LineType"), use("grip", "GraspType")}, servers);
    ASSERT_TRUE(assigned) << assigned.error().message;
    ASSERT_THAT(*assigned, SizeIs(2));
    EXPECT_EQ((*assigned)[0].server->found.name, "b");
    EXPECT_THAT(aliases((*assigned)[0]), ElementsAre("ptp", "line"));
    EXPECT_EQ((*assigned)[1].server->found.name, "c");
}

TEST(DiscoveredServers, AreTakenInTheirOrderWhereAllCanDoTheSame) {
    const std::vector servers{server("a", {"Ptp"}), server("b", {"Ptp"})};
    const auto assigned = assign({use("ptp", "PtpType")}, servers);
    ASSERT_TRUE(assigned);
    ASSERT_THAT(*assigned, SizeIs(1));
    EXPECT_EQ(assigned->front().server->found.name, "a");
}

TEST(DiscoveredServers, DoNotLackWhatOneOfThemOffersTwice) {
    const std::vector servers{server("a", {"Ptp", "Grasp", "Grasp"})};
    auto grip = use("grip", "GraspType");
    grip.optional = true;
    const auto assigned = assign({use("ptp", "PtpType"), grip}, servers);
    ASSERT_FALSE(assigned) << "its steps would be left out";
    EXPECT_THAT(assigned.error().message, HasSubstr("uses.grip: "));
}

TEST(DiscoveredServers, LackWhatNoneOfThemOffers) {
    const std::vector servers{server("a", {"Ptp"})};
    const auto assigned = assign({use("ptp", "PtpType"), use("grip", "GraspType")}, servers);
    ASSERT_FALSE(assigned);
    EXPECT_EQ(assigned.error().code, Errc::not_found);
    EXPECT_THAT(assigned.error().message, HasSubstr("uses.grip: no skill of type GraspType"));
}

TEST(DiscoveredServers, ServeAllUsesOfABindingOrNone) {
    const std::vector uses{use("ptp", "PtpType"), use("line", "LineType")};
    const auto both = chooseAll(uses, server("b", {"Ptp", "Line"}));
    ASSERT_TRUE(both);
    EXPECT_EQ(both->at("line").address.name, "Line");
    EXPECT_FALSE(chooseAll(uses, server("a", {"Ptp"})));
}

TEST(DiscoveredServers, MustReachFarEnough) {
    auto far = use("ptp", "PtpType");
    far.reach = 1.0;
    EXPECT_FALSE(chooseAll({far}, server("a", {"Ptp"})));
    far.reach = 0.5;
    EXPECT_TRUE(chooseAll({far}, server("a", {"Ptp"})));
}

TEST(DiscoveredServers, MustCarryEnough) {
    auto strong = use("ptp", "PtpType");
    strong.payload = 4.0;
    const auto refused = chooseAll({strong}, server("a", {"Ptp"}));
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message,
                HasSubstr("no skill of type PtpType with a payload of 4 kg; of that type there "
                          "are: Ptp (a, reach 0.900 m, payload 3 kg)"));
    strong.payload = 3.0;
    EXPECT_TRUE(chooseAll({strong}, server("a", {"Ptp"})));
}

}  // namespace
}  // namespace metier::server
