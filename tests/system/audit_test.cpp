// Audit records of servers, and their protection against changes.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>

#include <csignal>
#include <fstream>
#include <sstream>

#include "discovered_cell.hpp"
#include "installation.hpp"
#include "metier/client/control_handle.hpp"
#include "metier/security/audit_log.hpp"
#include "server_events.hpp"
#include "small_disk.hpp"

namespace metier::system_tests {
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::HasSubstr;

std::filesystem::path emptyFolder() {
    const auto* name = ::testing::UnitTest::GetInstance()->current_test_info()->name();
    auto folder = std::filesystem::path(::testing::TempDir()) / "audit_system_test" / name;
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
    return folder;
}

std::string textOf(const std::filesystem::path& file) {
    std::ostringstream text;
    text << std::ifstream(file, std::ios::binary).rdbuf();
    return text.str();
}

class AuditedArm : public ::testing::Test {
protected:
    std::vector<std::string> serving() const {
        return {"--port", "0", "--state", folder_.string(), "--records", "off"};
    }
    std::filesystem::path log() const { return folder_ / "audit" / "iiwa-127.0.0.1-0.log"; }
    /// The first line with all of this, once there is one.
    std::string line(const std::vector<std::string>& texts) const {
        std::string found;
        const bool there = holdsSoon([&] {
            std::ifstream lines(log());
            for (std::string text; std::getline(lines, text);) {
                if (std::all_of(texts.begin(), texts.end(), [&](const std::string& part) {
                        return text.find(part) != std::string::npos;
                    })) {
                    found = text;
                    return true;
                }
            }
            return false;
        });
        EXPECT_TRUE(there) << fmt::format("no {} in\n{}", fmt::join(texts, ", "), textOf(log()));
        return found;
    }
    Finished verify() const { return runMetier({"audit", "verify", log().string()}); }
    static void beat(opcua::Client& client, const opcua::NodeId& controller, std::uint64_t epoch) {
        const auto metier = client.namespaceIndex("urn:metier:skills").value();
        const auto method = client.translate(controller, {{metier, "Heartbeat"}}).value();
        EXPECT_TRUE(client.call(controller, method, {opcua::Value::of(epoch)}));
    }
    /// Parameters of a move of axis 1 that takes some seconds.
    static skill::ValueMap longMove(const std::vector<double>& home) {
        auto target = home;
        target.front() += 1.0;
        return {{"TargetJointPosition", target}, {"SpeedOverride", 0.1}};
    }

    const std::filesystem::path folder_ = emptyFolder();
};

TEST_F(AuditedArm, KeepsWhoStartedWhoHaltedAndWhoHadControl) {
    auto server = std::make_unique<ServerProcess>("iiwa", serving());
    const auto owner = connectTo(server->url());
    const auto other = connectTo(server->url());
    ServerEvents events(*other, opcua::ids::kAuditEventType);
    auto skill = openSkill(*owner, "JointPtpMoveSkill");
    auto same = openSkill(*other, "JointPtpMoveSkill");
    const auto home = jointPosition(*owner, skill);
    {
        const auto control = client::ControlHandle::acquire(
            *owner, skill.address().controller()->node, {.lease = 30s});
        ASSERT_TRUE(control) << control.error().message;
        const auto started =
            skill.startWith({.execution_id = "audited", .parameters = longMove(home)});
        ASSERT_TRUE(started) << started.error().message;
        EXPECT_EQ(same.suspend().error().code, Errc::locked);
        ASSERT_TRUE(same.halt());
        ASSERT_TRUE(same.awaitState(skill::State::halted, inAMinute()));
        beat(*owner, skill.address().controller()->node, control->epoch());
    }
    for (const auto* call :
         {"AcquireControl of", "StartWith of JointPtpMoveSkill", "Suspend of JointPtpMoveSkill",
          "Halt of JointPtpMoveSkill", "ReleaseControl of"}) {
        EXPECT_NE(events.next(call), "") << call;
    }
    line({R"("event":"AcquireControl")", R"("status":"Good")"});
    line({R"("event":"StartWith")", R"("object":"JointPtpMoveSkill")", R"("inputs":"audited; )"});
    line({R"("event":"Suspend")", R"("status":"BadLocked")", "has control"});
    line({R"("event":"Halt")", R"("status":"Good")", R"("role":"Engineer")", R"("session":"ns=)"});
    line({R"("event":"ReleaseControl")"});
    EXPECT_EQ(textOf(log()).find("Heartbeat"), std::string::npos);
    server.reset();
    EXPECT_THAT(verify().output, HasSubstr("last chain value "));
    const auto shown = runMetier({"audit", "show", "--state", folder_.string(), "--event", "Halt"});
    EXPECT_THAT(shown.output, AllOf(HasSubstr(" Halt "), HasSubstr("object=JointPtpMoveSkill")));
    EXPECT_EQ(shown.output.find("Suspend"), std::string::npos);
}

TEST_F(AuditedArm, KeepsWhatTheServerDidForAnOwnerThatWasLost) {
    const ServerProcess server("iiwa", serving());
    const auto watcher = connectTo(server.url());
    ServerEvents events(*watcher, opcua::ids::kAuditEventType);
    auto skill = openSkill(*watcher, "JointPtpMoveSkill");
    auto target = jointPosition(*watcher, skill);
    target.front() += 1.0;
    auto run = link::ChildProcess::start(
                   metierCommand({"run", server.url(), "JointPtpMoveSkill", "--set",
                                  fmt::format("TargetJointPosition={}", fmt::join(target, ",")),
                                  "--set", "SpeedOverride=0.1", "--lease", "2s"}))
                   .value();
    ASSERT_TRUE(skill.awaitState(skill::State::running, inAMinute()));
    run.signal(SIGKILL);
    ASSERT_TRUE(skill.awaitState(skill::State::halted, inAMinute()));
    EXPECT_THAT(events.next("ControlLost"), HasSubstr("by the server: no heartbeat of"));
    EXPECT_THAT(events.next("Halted of JointPtpMoveSkill"), HasSubstr("OwnerLost"));
    line({R"("event":"ControlLost")", "no heartbeat of", R"("session":"server")"});
    line({R"("event":"Halted")", R"("object":"JointPtpMoveSkill")", "OwnerLost: no heartbeat"});
}

TEST_F(AuditedArm, TellsWhichLineOfItsLogWasChanged) {
    {
        const ServerProcess server("iiwa", serving());
        for (int i = 0; i < 3; ++i) {
            EXPECT_EQ(runMetier({"halt", server.url()}).status, 0);
        }
    }
    const auto whole = verify();
    EXPECT_EQ(whole.status, 0) << whole.output;
    auto text = textOf(log());
    const auto second = text.find('\n') + 1;
    const auto at = text.find("\"time\":\"2", second) + 8;
    ASSERT_LT(at, text.find('\n', second));
    text[at] = '3';
    std::ofstream(log(), std::ios::binary) << text;
    const auto changed = verify();
    EXPECT_EQ(changed.status, 1);
    EXPECT_THAT(changed.output, HasSubstr(log().string() + ":2: is not as it was written"));
    EXPECT_EQ(runMetier({"audit", "verify", "--state", folder_.string()}).status, 1);
    EXPECT_EQ(runMetier({"audit", "verify", "/none"}).status, 1);
    EXPECT_EQ(runMetier({"audit", "verify"}).status, 2);
}

TEST_F(AuditedArm, ShowsByItsPublishedAnchorThatTheEndOfItsLogWasCutOff) {
    std::string anchor;
    {
        const ServerProcess server("iiwa", serving());
        EXPECT_EQ(runMetier({"halt", server.url()}).status, 0);
        const auto log_has_all = [&] {
            const auto told = runMetier({"audit", "anchor", server.url()});
            EXPECT_EQ(told.status, 0) << told.output;
            anchor = told.output.substr(0, told.output.find(' '));
            const auto text = textOf(log());
            return text.find(anchor, text.find('\n') + 1) != std::string::npos &&
                   runMetier({"audit", "verify", log().string(), "--anchor", anchor}).status == 0;
        };
        EXPECT_TRUE(holdsSoon(log_has_all)) << anchor << " of the Halt, which is not the first";
    }
    EXPECT_EQ(anchor.size(), 64U);
    const auto newest = runMetier({"audit", "anchor", "--state", folder_.string()});
    EXPECT_THAT(newest.output, HasSubstr(" " + log().string()));
    const auto text = textOf(log());
    const auto first_end = text.find('\n') + 1;
    ASSERT_NE(text.find(anchor, first_end), std::string::npos);
    std::ofstream(log(), std::ios::binary) << text.substr(0, first_end);
    EXPECT_EQ(verify().status, 0) << "what is left is as it was written";
    const auto cut = runMetier({"audit", "verify", log().string(), "--anchor", anchor});
    EXPECT_EQ(cut.status, 1);
    EXPECT_THAT(cut.output, HasSubstr("lines were cut off at the end"));
    EXPECT_EQ(runMetier({"audit", "verify", log().string(), "--anchor", "beef"}).status, 2);
}

// Uses a connection with metier's default security.
TEST_F(AuditedArm, KeepsWhoWasDeniedWhat) {
    const Installation here("here");
    ASSERT_EQ(here.run({"user", "add", "otto", "--role", "Observer"}, "otto's own").status, 0);
    ASSERT_EQ(here.run({"user", "add", "erna", "--role", "Engineer"}, "erna's own").status, 0);
    auto command = here.command({"serve", simulatedCell().string(), "--server", "iiwa"});
    const auto where = serving();
    command.insert(command.end(), where.begin(), where.end());
    const ServerProcess server(command);
    auto options = here.asCommand();
    options.user = opcua::UserName{"erna", "erna's own"};
    const auto erna = opcua::Client::connect(server.url(), options);
    ASSERT_TRUE(erna) << erna.error().message;
    ServerEvents hers(**erna, opcua::ids::kAuditEventType);
    options.user = opcua::UserName{"otto", "otto's own"};
    const auto otto = opcua::Client::connect(server.url(), options);
    ASSERT_TRUE(otto) << otto.error().message;
    ServerEvents his(**otto, opcua::ids::kAuditEventType);
    auto skill = openSkill(**otto, "JointPtpMoveSkill");
    EXPECT_EQ(skill.halt().error().status, opcua::status::kBadUserAccessDenied);
    options.user = opcua::UserName{"erna", "otto's own"};
    ASSERT_FALSE(opcua::Client::connect(server.url(), options));

    EXPECT_THAT(hers.next("Halt of JointPtpMoveSkill"),
                AllOf(HasSubstr("by otto (Observer)"), HasSubstr("BadUserAccessDenied")));
    EXPECT_THAT(hers.next("LoginRefused"), HasSubstr("erna"));
    EXPECT_FALSE(his.anyWaiting()) << "who only observes reads nothing of what others do";
    line({R"("event":"Denied")", R"("user":"otto")", R"("role":"Observer")", R"("method":"Halt")",
          R"("object":"JointPtpMoveSkill")",
          fmt::format(R"("thumbprint":"{}")", here.thumbprintOf("command"))});
    line({R"("event":"LoginRefused")", R"("user":"erna")", R"("status":"BadUserAccessDenied")"});
    EXPECT_EQ(verify().status, 0);
}

TEST_F(AuditedArm, MovesOnWhileTheDiskIsFullAndSaysSo) {
    const auto disk = SmallDisk::mount(folder_);
    if (disk == nullptr) {
        GTEST_SKIP() << kNoSmallDisk;
    }
    const ServerProcess server("iiwa", serving());
    const auto client = connectTo(server.url());
    ServerEvents alarms(*client, opcua::ids::kSystemEventType);
    auto skill = openSkill(*client, "JointPtpMoveSkill");
    const auto home = jointPosition(*client, skill);
    ASSERT_TRUE(skill.startWith({.execution_id = "one", .parameters = longMove(home)}));
    line({R"("event":"StartWith")"});
    disk->fill();
    constexpr int kCalls = 40;  // more than the rest of a page of the disk holds
    for (int i = 0; i < kCalls; ++i) {
        EXPECT_EQ(skill.start().error().code, Errc::invalid_state) << "it is Running";
    }
    EXPECT_THAT(alarms.next("the audit log"),
                AllOf(HasSubstr("cannot be written"), HasSubstr("No space left on device")));
    const auto ended = skill.awaitState(skill::State::ready, inAMinute());
    EXPECT_TRUE(ended) << ended.error().message << ": " << skill.reasonText();
    EXPECT_NEAR(jointPosition(*client, skill).front(), home.front() + 1.0, 1e-3);
    disk->makeRoom();
    EXPECT_THAT(alarms.next("the audit log"), HasSubstr("is written again"));
    const auto text = textOf(log());
    std::size_t refused = 0;
    for (auto at = text.find("BadInvalidState"); at != std::string::npos;
         at = text.find("BadInvalidState", at + 1)) {
        ++refused;
    }
    EXPECT_EQ(refused, static_cast<std::size_t>(kCalls)) << "nothing is lost";
    EXPECT_EQ(verify().status, 0);
}

}  // namespace
}  // namespace metier::system_tests
