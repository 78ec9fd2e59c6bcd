#include "metier/server/skill_survey.hpp"

#include <gmock/gmock.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <stdexcept>

#include "metier/opcua/server.hpp"
#include "metier/opcua_skill/skill_dictionary.hpp"

namespace metier::server {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

/// A server with the instances of an iiwa, whose skills do nothing here.
std::unique_ptr<opcua::Server> serveIiwa() {
    opcua::ServerOptions options;
    options.port = 0;
    options.nodesets = {"device", "robotics", "metier", "iiwa"};
    auto server = opcua::Server::create(std::move(options)).value();
    EXPECT_TRUE(opcua_skill::publishDictionary(server->nodes()));
    EXPECT_TRUE(server->start());
    return server;
}

/// Takes connections and says nothing, as a process that was stopped does.
class Mute {
public:
    Mute() : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        auto* generic = reinterpret_cast<sockaddr*>(&address);
        socklen_t size = sizeof address;
        if (::bind(socket_, generic, size) != 0 || ::listen(socket_, 5) != 0 ||
            ::getsockname(socket_, generic, &size) != 0) {
            throw std::runtime_error("no socket");
        }
        url_ = "opc.tcp://127.0.0.1:" + std::to_string(ntohs(address.sin_port));
    }
    ~Mute() { ::close(socket_); }
    Mute(const Mute&) = delete;
    Mute& operator=(const Mute&) = delete;

    const std::string& url() const { return url_; }

private:
    int socket_;
    std::string url_;
};

/// The servers of these tests have no security.
class SkillSurvey : public ::testing::Test {
protected:
    const Identity lab_ = Identity::create({.insecure_lab = true}, "survey", {}).value();
};

TEST_F(SkillSurvey, TellsTypesWithAllThatTheyAreDerivedFrom) {
    const auto server = serveIiwa();
    const auto servers = survey({{server->endpointUrl(), "iiwa", "test"}}, lab_);
    ASSERT_THAT(servers, SizeIs(1));
    ASSERT_TRUE(servers[0].skills) << servers[0].skills.error().message;
    EXPECT_FALSE(servers[0].skills->empty());
    for (const auto& skill : *servers[0].skills) {
        EXPECT_TRUE(isA(skill, skill.address.type_name));
        EXPECT_TRUE(isA(skill, "MoveSkill"));
        EXPECT_TRUE(isA(skill, "SkillType"));
        EXPECT_FALSE(isA(skill, "GraspGripperSkillType"));
    }
}

TEST_F(SkillSurvey, AsksAllAtTheSameTimeAndWaitsForNobodyLonger) {
    const auto server = serveIiwa();
    const Mute first;
    const Mute second;
    const Mute third;
    const auto begin = std::chrono::steady_clock::now();
    const auto servers = survey({{first.url(), "", ""},
                                 {server->endpointUrl(), "", ""},
                                 {second.url(), "", ""},
                                 {third.url(), "", ""},
                                 {"opc.tcp://127.0.0.1:1", "", ""}},
                                lab_, 5s);
    const auto took = std::chrono::steady_clock::now() - begin;
    ASSERT_THAT(servers, SizeIs(5));
    EXPECT_FALSE(servers[0].skills);
    EXPECT_TRUE(servers[1].skills) << servers[1].skills.error().message;
    EXPECT_FALSE(servers[2].skills);
    EXPECT_FALSE(servers[3].skills);
    EXPECT_FALSE(servers[4].skills);
    EXPECT_EQ(servers[2].server.url, second.url());
    EXPECT_LT(took, 15s) << "one after the other it would be longer";
}

TEST_F(SkillSurvey, OfNobodyIsEmpty) {
    EXPECT_THAT(survey({}, lab_), IsEmpty());
}

TEST_F(SkillSurvey, KnowsComposedSkillsByTheirName) {
    SurveyedSkill skill;
    skill.address.name = "VisitSkill";
    skill.types = {"SequenceSkillType", "SkillType"};
    EXPECT_TRUE(isA(skill, "VisitSkillType"));
    EXPECT_TRUE(isA(skill, "VisitSkill"));
    EXPECT_FALSE(isA(skill, "Visit"));
}

TEST_F(SkillSurvey, TellsWhatSkillsAreForByTheirTypes) {
    const auto server = serveIiwa();
    const auto servers = survey({{server->endpointUrl(), "iiwa", "test"}}, lab_);
    ASSERT_TRUE(servers[0].skills) << servers[0].skills.error().message;
    const auto& skills = *servers[0].skills;
    const auto line = std::find_if(skills.begin(), skills.end(), [](const auto& skill) {
        return skill.address.name == "CartesianLinearMoveSkill";
    });
    ASSERT_NE(line, skills.end());
    EXPECT_THAT(line->terms,
                ElementsAre("urn:metier:dictionary:move-straight", "urn:metier:dictionary:move"));
}

SurveyedSkill picker() {
    SurveyedSkill skill;
    skill.terms = {"urn:metier:dictionary:pick-and-place", "http://maker.com/terms#Stack_Parts",
                   "0112/2///61987#ABA565#009"};
    return skill;
}

TEST(TermOfASkill, IsNamedByItsWholeIdentifier) {
    EXPECT_EQ(termOf(picker(), "urn:metier:dictionary:pick-and-place"), picker().terms[0]);
    EXPECT_EQ(termOf(picker(), "URN:metier:dictionary:Pick-And-Place"), picker().terms[0]);
    EXPECT_EQ(termOf(picker(), "0112/2///61987#aba565#009"), picker().terms[2]);
}

TEST(TermOfASkill, IsNamedByItsLastPart) {
    for (const auto* wish : {"pick-and-place", "pick-place", "Pick_Place", "PICK AND PLACE"}) {
        EXPECT_EQ(termOf(picker(), wish), picker().terms[0]) << wish;
    }
    EXPECT_EQ(termOf(picker(), "stack-parts"), picker().terms[1]);
}

TEST(TermOfASkill, IsNotNamedByLess) {
    for (const auto* wish : {"", "-", "and", "pick", "place", "pickplace", "place-pick", "metier",
                             "dictionary:pick-place", "urn:other:pick-and-place"}) {
        EXPECT_EQ(termOf(picker(), wish), std::nullopt) << wish;
    }
}

}  // namespace
}  // namespace metier::server
