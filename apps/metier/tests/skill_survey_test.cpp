#include "skill_survey.hpp"

#include <gmock/gmock.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <stdexcept>

#include "metier/opcua/server.hpp"

namespace metier::app {
namespace {

using namespace std::chrono_literals;
using ::testing::IsEmpty;
using ::testing::SizeIs;

/// A server with the instances of an iiwa, whose skills do nothing here.
std::unique_ptr<opcua::Server> serveIiwa() {
    opcua::ServerOptions options;
    options.port = 0;
    options.nodesets = {"device", "robotics", "metier", "iiwa"};
    auto server = opcua::Server::create(std::move(options)).value();
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

TEST(SkillSurvey, TellsTypesWithAllThatTheyAreDerivedFrom) {
    const auto server = serveIiwa();
    const auto servers = survey({{server->endpointUrl(), "iiwa", "test"}},
                                [](const auto& skill) { return isA(skill, "MoveSkillType"); });
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

TEST(SkillSurvey, AsksAllAtTheSameTimeAndWaitsForNobodyLonger) {
    const auto server = serveIiwa();
    const Mute first;
    const Mute second;
    const auto begin = std::chrono::steady_clock::now();
    const auto servers = survey(
        {{first.url(), "", ""},
         {server->endpointUrl(), "", ""},
         {second.url(), "", ""},
         {"opc.tcp://127.0.0.1:1", "", ""}},
        [](const auto& /*skill*/) { return true; }, 3s);
    const auto took = std::chrono::steady_clock::now() - begin;
    ASSERT_THAT(servers, SizeIs(4));
    EXPECT_FALSE(servers[0].skills);
    EXPECT_TRUE(servers[1].skills) << servers[1].skills.error().message;
    EXPECT_FALSE(servers[2].skills);
    EXPECT_FALSE(servers[3].skills);
    EXPECT_EQ(servers[2].server.url, second.url());
    EXPECT_LT(took, 6s) << "one after the other it would be longer";
}

TEST(SkillSurvey, OfNobodyIsEmpty) {
    EXPECT_THAT(survey({}, [](const auto& /*skill*/) { return true; }), IsEmpty());
}

TEST(SkillSurvey, KnowsComposedSkillsByTheirName) {
    SurveyedSkill skill;
    skill.address.name = "VisitSkill";
    skill.types = {"SequenceSkillType", "SkillType"};
    EXPECT_TRUE(isA(skill, "VisitSkillType"));
    EXPECT_TRUE(isA(skill, "VisitSkill"));
    EXPECT_FALSE(isA(skill, "Visit"));
}

}  // namespace
}  // namespace metier::app
