// Closed servers, which `metier serve` starts by default.
#include <gmock/gmock.h>

#include "discovered_cell.hpp"
#include "installation.hpp"
#include "metier/opcua/discovery.hpp"
#include "metier/security/security_folder.hpp"

namespace metier::system_tests {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class ClosedCell : public ::testing::Test {
protected:
    /// The server decides first, then the client.
    /// \param role of the client without a user; empty: none
    static void introduce(const Installation& server, const Installation& client,
                          const std::string& url, const std::string& role) {
        EXPECT_EQ(client.run({"list", url}).status, 1) << "nobody trusts anybody yet";
        std::vector<std::string> accept{"trust", "accept", client.thumbprintOf("command")};
        if (!role.empty()) {
            accept.insert(accept.end(), {"--role", role});
        }
        // The server keeps it to be decided on, a little later.
        EXPECT_TRUE(holdsSoon([&] { return server.run(accept).status == 0; }));
        EXPECT_EQ(client.run({"list", url}).status, 1) << "the client does not trust the server";
        const auto accepted = client.run({"trust", "accept", server.thumbprintOf("iiwa")});
        ASSERT_EQ(accepted.status, 0) << accepted.output;
    }

    const Installation here_{"here"};
    const Installation there_{"there"};
};

TEST_F(ClosedCell, WorksForWhoeverStartedIt) {
    const auto arm = here_.serve("iiwa");
    const auto moved = here_.run({"run", arm.url(), "JointPtpMoveSkill", "--set",
                                  "TargetJointPosition=0.1,0.1,0.1,0.1,0.1,0.1,0.1"});
    EXPECT_EQ(moved.status, 0) << moved.output;
    const auto endpoints = opcua::getEndpoints(arm.url()).value();
    ASSERT_EQ(endpoints.size(), 6U);
    for (const auto& endpoint : endpoints) {
        EXPECT_NE(endpoint.security_mode, opcua::EndpointDescription::SecurityMode::none);
    }
}

TEST_F(ClosedCell, ComposesOverSeveralServers) {
    const auto arm = here_.serve("ur5");
    const ServerProcess component(here_.command({"serve", simulatedCell().string(), "--server",
                                                 "ur5-move", "--port", "0", "--robot", arm.url()}));
    const auto moved = here_.run({"square", component.url(), "--laps", "1", "--svg",
                                  (here_.folder() / "square.svg").string()});
    EXPECT_EQ(moved.status, 0) << moved.output;
}

TEST_F(ClosedCell, RegistersAtAClosedDiscoveryServer) {
    const ServerProcess discovery(here_.command({"discovery", "--port", "0"}));
    const ServerProcess arm(here_.command({"serve", discoveredCell().string(), "--server", "iiwa-a",
                                           "--port", "0", "--discovery", discovery.url()}));
    EXPECT_TRUE(holdsSoon([&] {
        const auto found =
            here_.run({"find", "JointPtpMoveSkillType", "--discovery", discovery.url()});
        return found.status == 0 && found.output.find(arm.url()) != std::string::npos;
    }));
}

TEST_F(ClosedCell, RefusesTheLab) {
    const auto arm = here_.serve("iiwa");
    const auto refused = runMetier({"list", arm.url()});
    EXPECT_EQ(refused.status, 1);
    EXPECT_THAT(refused.output, HasSubstr("leave out --insecure-lab"));
}

TEST_F(ClosedCell, SpeaksToNoOpenServerUnlessItIsALab) {
    const ServerProcess lab("iiwa");
    const auto refused = here_.run({"list", lab.url()});
    EXPECT_EQ(refused.status, 1);
    EXPECT_THAT(refused.output, AllOf(HasSubstr("has no security"), HasSubstr("--insecure-lab")));
    EXPECT_EQ(here_.run({"halt", lab.url()}).status, 1);
    const auto found = here_.run({"find", "JointPtpMoveSkillType", "--at", lab.url()});
    EXPECT_THAT(found.output, HasSubstr("has no security"));
    const auto listed = here_.run({"--insecure-lab", "list", lab.url()});
    EXPECT_EQ(listed.status, 0) << listed.output;
}

TEST_F(ClosedCell, BelievesNoOpenServerWhereAClosedOneWas) {
    std::string url;
    std::string port;
    {
        const auto arm = here_.serve("iiwa", lastingPort());
        url = arm.url();
        port = arm.port();
        ASSERT_EQ(here_.run({"list", url}).status, 0);
    }
    const ServerProcess impostor("iiwa", {"--port", port});
    const auto refused = here_.run({"list", url});
    EXPECT_EQ(refused.status, 1);
    EXPECT_THAT(refused.output, HasSubstr("was closed before"));
    const auto in_a_lab = here_.run({"--insecure-lab", "list", url});
    EXPECT_EQ(in_a_lab.status, 1);
    EXPECT_THAT(in_a_lab.output,
                AllOf(HasSubstr("was closed before"), HasSubstr("metier trust forget " + url)));
    EXPECT_EQ(there_.run({"--insecure-lab", "list", url}).status, 0) << "who never knew it";
    EXPECT_EQ(here_.run({"trust", "forget", url}).status, 0);
    EXPECT_EQ(here_.run({"--insecure-lab", "list", url}).status, 0);
}

TEST_F(ClosedCell, BecomesALabByTheHandOfItsOwnUser) {
    std::string url;
    std::string port;
    {
        const auto arm = here_.serve("iiwa", lastingPort());
        url = arm.url();
        port = arm.port();
        ASSERT_EQ(here_.run({"list", url}).status, 0);
    }
    const ServerProcess lab(here_.command(
        {"--insecure-lab", "serve", simulatedCell().string(), "--server", "iiwa", "--port", port}));
    const auto listed = here_.run({"--insecure-lab", "list", url});
    EXPECT_EQ(listed.status, 0) << listed.output;
    EXPECT_EQ(here_.run({"list", url}).status, 1) << "which is to be said each time";
}

TEST_F(ClosedCell, IsReachedFromElsewhereOnceBothTrustEachOther) {
    const auto arm = here_.serve("iiwa");
    introduce(here_, there_, arm.url(), "Operator");
    const auto listed = there_.run({"list", arm.url()});
    EXPECT_EQ(listed.status, 0) << listed.output;
    EXPECT_THAT(listed.output, HasSubstr("JointPtpMoveSkill"));
}

TEST_F(ClosedCell, TellsAStrangerWhatIsToBeDone) {
    const auto arm = here_.serve("iiwa");
    const auto refused = there_.run({"list", arm.url()});
    const auto mine = there_.thumbprintOf("command");
    EXPECT_THAT(refused.output, HasSubstr("there, metier trust accept " + mine));
    EXPECT_TRUE(holdsSoon([&] { return here_.run({"trust", "accept", mine}).status == 0; }));
    const auto unknown = there_.run({"list", arm.url()});
    EXPECT_THAT(unknown.output,
                AllOf(HasSubstr(here_.thumbprintOf("iiwa")), HasSubstr("metier trust list")));
    ASSERT_EQ(there_.run({"trust", "accept", here_.thumbprintOf("iiwa")}).status, 0);
    const auto nameless = there_.run({"list", arm.url()});
    EXPECT_EQ(nameless.status, 1);
    EXPECT_THAT(nameless.output, HasSubstr("log in with --user"));
}

TEST_F(ClosedCell, LetsUsersDoWhatTheirRoleAllows) {
    const auto arm = here_.serve("iiwa");
    introduce(here_, there_, arm.url(), "");
    ASSERT_EQ(here_.run({"user", "add", "otto", "--role", "Observer"}, "otto's own").status, 0);
    ASSERT_EQ(here_.run({"user", "add", "anna"}, "anna's own").status, 0);
    const auto move = [&](const std::string& user, const std::string& password) {
        return there_.run({"--user", user, "run", arm.url(), "JointPtpMoveSkill", "--set",
                           "TargetJointPosition=0.1,0.1,0.1,0.1,0.1,0.1,0.1"},
                          password);
    };
    EXPECT_EQ(there_.run({"--user", "otto", "list", arm.url()}, "otto's own").status, 0);
    const auto denied = move("otto", "otto's own");
    EXPECT_EQ(denied.status, 1);
    EXPECT_THAT(denied.output, HasSubstr("BadUserAccessDenied"));
    EXPECT_EQ(move("anna", "anna's own").status, 0);
    const auto wrong = move("anna", "otto's own");
    EXPECT_EQ(wrong.status, 1);
    EXPECT_THAT(wrong.output, HasSubstr("a wrong name or password"));
    ASSERT_EQ(here_.run({"user", "remove", "anna"}).status, 0);
    EXPECT_EQ(move("anna", "anna's own").status, 1);
}

TEST_F(ClosedCell, EndsTheSessionsOfWhoIsTrustedNoLonger) {
    const auto arm = here_.serve("iiwa");
    introduce(here_, there_, arm.url(), "Operator");
    const auto client = opcua::Client::connect(arm.url(), there_.asCommand());
    ASSERT_TRUE(client) << client.error().message;
    const auto now = opcua::NodeId(0, 2258U);
    EXPECT_TRUE((*client)->read(now));
    ASSERT_EQ(here_.run({"trust", "reject", there_.thumbprintOf("command")}).status, 0);
    EXPECT_TRUE(holdsSoon([&] { return !(*client)->read(now); }));
    EXPECT_EQ(there_.run({"list", arm.url()}).status, 1);
    EXPECT_EQ(here_.run({"list", arm.url()}).status, 0) << "others stay";
}

TEST_F(ClosedCell, EndsTheSessionsOfUsersWhoseRightsChange) {
    const auto arm = here_.serve("iiwa");
    introduce(here_, there_, arm.url(), "");
    ASSERT_EQ(here_.run({"user", "add", "anna"}, "anna's own").status, 0);
    auto options = there_.asCommand();
    options.user = opcua::UserName{"anna", "anna's own"};
    const auto client = opcua::Client::connect(arm.url(), options);
    ASSERT_TRUE(client) << client.error().message;
    ASSERT_EQ(here_.run({"user", "remove", "anna"}).status, 0);
    EXPECT_TRUE(holdsSoon([&] { return !(*client)->read(opcua::NodeId(0, 2258U)); }));
}

TEST_F(ClosedCell, GoesOnWithARenewedCertificate) {
    const auto arm = here_.serve("iiwa");
    introduce(here_, there_, arm.url(), "Operator");
    const auto client = opcua::Client::connect(arm.url(), there_.asCommand());
    ASSERT_TRUE(client) << client.error().message;
    ASSERT_EQ(here_.run({"trust", "renew", "iiwa"}).status, 0);
    EXPECT_TRUE(holdsSoon([&] {
        const auto refused = there_.run({"list", arm.url()});
        return refused.output.find(here_.thumbprintOf("iiwa")) != std::string::npos;
    })) << "the new one is to be trusted";
    const auto accepted = there_.run({"trust", "accept", here_.thumbprintOf("iiwa")});
    ASSERT_EQ(accepted.status, 0) << accepted.output;
    EXPECT_EQ(there_.run({"list", arm.url()}).status, 0);
    EXPECT_EQ(here_.run({"list", arm.url()}).status, 0);
    EXPECT_TRUE((*client)->read(opcua::NodeId(0, 2258U))) << "what was open stays";
}

TEST_F(ClosedCell, WarnsAMonthBeforeACertificateEnds) {
    const auto folder = security::SecurityFolder::open(here_.folder()).value();
    const auto now = std::chrono::system_clock::now();
    const auto ending = security::makeIdentity({.application_name = "metier iiwa",
                                                .application_uri = "urn:test:metier:iiwa",
                                                .hosts = {"localhost"},
                                                .lifetime = std::chrono::days(29)},
                                               now);
    ASSERT_TRUE(security::saveIdentity(folder.identityFolder("iiwa"), *ending));
    auto serve =
        here_.command({"serve", simulatedCell().string(), "--server", "iiwa", "--port", "0"});
    auto server = link::ChildProcess::start(serve, link::ErrorOutput::with_output).value();
    std::string said;
    while (said.find("metier trust renew iiwa") == std::string::npos) {
        const auto line = server.readLine(inAMinute());
        ASSERT_TRUE(line) << said;
        said += *line + "\n";
    }
    EXPECT_THAT(said, HasSubstr("ends on " + security::dateText(now + std::chrono::days(29))));
    EXPECT_THAT(here_.run({"trust", "list"}).output, HasSubstr("renew it, iiwa"));
}

TEST_F(ClosedCell, SaysWhatALabIs) {
    auto server =
        link::ChildProcess::start(
            metierCommand({"serve", simulatedCell().string(), "--server", "iiwa", "--port", "0"}),
            link::ErrorOutput::with_output)
            .value();
    std::string said;
    while (said.find("INSECURE LAB") == std::string::npos) {
        const auto line = server.readLine(inAMinute());
        ASSERT_TRUE(line) << said;
        said += *line + "\n";
    }
    EXPECT_THAT(said, HasSubstr("no encryption"));
}

struct WrongRow {
    std::vector<std::string> arguments;
    std::string password;
    int status;
    std::string text;
};

TEST_F(ClosedCell, TakesUsersAndPasswordsOnlyIfTheyAreRight) {
    const std::vector<WrongRow> rows{
        {{"user", "add", "anna"}, "short", 2, "8 to 256 characters"},
        {{"user", "add", "an na"}, "long enough", 2, "a user's name has"},
        {{"user", "remove", "nobody"}, "", 1, "nobody"},
        {{"user", "password", "nobody"}, "long enough", 1, "no user 'nobody'"},
        {{"trust", "accept", "0123"}, "", 1, "no rejected certificate \"0123\""},
        {{"trust", "reject", "0123"}, "", 1, "no trusted certificate \"0123\""},
        {{"trust", "revoke", "/nonexistent"}, "", 1, "no such file: /nonexistent"},
        {{"trust", "renew", "nothing"}, "", 1, "nothing/identity.pem"}};
    for (const auto& row : rows) {
        const auto refused = here_.run(row.arguments, row.password);
        EXPECT_EQ(refused.status, row.status) << refused.output;
        EXPECT_THAT(refused.output, HasSubstr(row.text));
    }
    ASSERT_EQ(here_.run({"user", "add", "anna"}, "long enough").status, 0);
    EXPECT_NE(here_.run({"user", "add", "anna"}, "long enough").status, 0) << "twice";
    EXPECT_EQ(here_.run({"user", "list"}).output, "anna                     Operator\n");
    EXPECT_EQ(here_.run({"user", "password", "anna"}, "another one").status, 0);
}

}  // namespace
}  // namespace metier::system_tests
