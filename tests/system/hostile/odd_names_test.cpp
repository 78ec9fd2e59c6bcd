// Names of servers, clients and skills come from outside: they must not reach a terminal or a log
// unchanged.
#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "../bench_server.hpp"
#include "../metier_program.hpp"
#include "metier/client/control_handle.hpp"
#include "metier/client/skill_finder.hpp"
#include "metier/client/skill_handle.hpp"
#include "metier/opcua/text.hpp"

namespace metier::hostile {
namespace {

using namespace system_tests;
using ::testing::HasSubstr;

/// An invalid sequence, a terminal's escape, a bell, a turn of the direction of writing.
const std::string kOdd = "Odd\xff\xfe\x1b[2J\x1b]0;title\x07\xe2\x80\xae name";
const std::string kShown = opcua::sanitise(kOdd);

bool isPrintable(std::string text) {
    std::erase(text, '\n');
    return opcua::sanitise(text) == text;
}

class OddNames : public ::testing::Test {
protected:
    OddNames() {
        skill::SkillFunctions functions;
        functions.check = [](const skill::ValueMap&) -> Result<void> {
            return fail(Errc::invalid_argument, kOdd);
        };
        functions.reset = []() -> Result<void> { return fail(Errc::device_fault, kOdd); };
        server_.addSkill(benchDescription(kOdd), std::move(functions));
        server_.serve();
    }
    std::string printed(std::vector<std::string> arguments) const {
        arguments.insert(arguments.begin() + 1, server_.url());
        const auto ended = runMetier(arguments);
        EXPECT_TRUE(isPrintable(ended.output)) << opcua::sanitise(ended.output);
        return ended.output;
    }

    BenchServer server_{{.application_name = kOdd}};
};

TEST_F(OddNames, AreNotPrintedByList) {
    EXPECT_THAT(printed({"list"}), HasSubstr(kShown));
    EXPECT_THAT(printed({"list", "--json"}), HasSubstr("\"skill\""));
}

TEST_F(OddNames, AreNotPrintedByFind) {
    const auto ended = runMetier({"find", "JointPtpMoveSkill", "--at", server_.url()});
    EXPECT_TRUE(isPrintable(ended.output)) << opcua::sanitise(ended.output);
    EXPECT_THAT(ended.output, HasSubstr(kShown));
}

TEST_F(OddNames, AreNotPrintedByRun) {
    EXPECT_THAT(printed({"run", kShown, "--fields"}), HasSubstr(kShown));
    EXPECT_THAT(printed({"run", kShown}), HasSubstr("metier: "));
    EXPECT_THAT(printed({"run", "Other"}), HasSubstr(kShown));
}

TEST_F(OddNames, AreNotPrintedByHaltAndReset) {
    EXPECT_THAT(printed({"halt"}), HasSubstr(kShown));
    EXPECT_THAT(printed({"reset", kShown}), HasSubstr("metier: "));
}

TEST_F(OddNames, AreNotPrintedByWatch) {
    auto watching = link::ChildProcess::start(
        metierCommand({"watch", server_.url(), "--count", "1"}), link::ErrorOutput::with_output);
    ASSERT_TRUE(watching) << watching.error().message;
    const auto begun = watching->readLine(inAMinute());
    ASSERT_TRUE(begun) << begun.error().message;
    EXPECT_THAT(*begun, HasSubstr("watching"));
    printed({"halt"});
    const auto line = watching->readLine(inAMinute());
    ASSERT_TRUE(line) << line.error().message;
    EXPECT_TRUE(isPrintable(*line)) << opcua::sanitise(*line);
    EXPECT_THAT(*line, HasSubstr(kShown));
}

// A client's own name is shown to others, and logged.
TEST_F(OddNames, OfAClientAreNotToldToOthers) {
    const auto odd = connectAs(server_.url(), kOdd);
    const auto other = connectAs(server_.url(), "other");
    const auto& controller = server_.system().controller;
    const auto control =
        client::ControlHandle::acquire(*odd, controller, {.lease = std::chrono::seconds(30)});
    ASSERT_TRUE(control) << control.error().message;
    const auto refused = client::ControlHandle::acquire(*other, controller, {});
    ASSERT_FALSE(refused);
    EXPECT_TRUE(isPrintable(refused.error().message)) << opcua::sanitise(refused.error().message);
    EXPECT_THAT(refused.error().message, HasSubstr(kShown));
}

}  // namespace
}  // namespace metier::hostile
