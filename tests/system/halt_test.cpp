// The command `metier halt` against a skill that comes to rest when the test says so.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <chrono>
#include <future>

#include "hostile/raw_socket.hpp"
#include "metier_program.hpp"
#include "served_skills.hpp"

namespace metier::system_tests {
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr auto kLongest = 60s;

class HaltCommand : public opcua_skill::testing::ServedSkills {
protected:
    HaltCommand() : move_(add(opcua_skill::testing::jointMoveDescription())) {
        serve();
        client_ = connect();
        EXPECT_EQ(opcua_skill::testing::write(*client_, move_, "ParameterSet/TargetJointPosition",
                                              opcua::Value::of(std::vector<double>{0.1, 0.2})),
                  "Good");
        EXPECT_EQ(opcua_skill::testing::call(*client_, move_, "Start"), "Good");
        EXPECT_TRUE(move_.hand->await("start"));
    }
    Finished halt(const std::string& timeout) {
        return runMetier({"halt", server().endpointUrl(), "--timeout", timeout});
    }

    opcua_skill::testing::ServedSkill move_;
    std::unique_ptr<opcua::Client> client_;
};

TEST_F(HaltCommand, SaysThatASkillStillBrakes) {
    const auto halted = halt("0.1");
    EXPECT_EQ(halted.status, 1);
    EXPECT_THAT(halted.output, AllOf(HasSubstr("JointPtpMoveSkill: still halting after 0.1 s"),
                                     Not(HasSubstr(" halted"))));
}

TEST_F(HaltCommand, SaysHaltedAtStandstill) {
    auto halted = std::async(std::launch::async, [this] { return halt("60"); });
    ASSERT_TRUE(move_.hand->await("halt"));
    move_.hand->execution().atRest();
    EXPECT_EQ(halted.get().status, 0);
    EXPECT_EQ(opcua_skill::testing::read(*client_, move_, "CurrentState/Number"), "11");
    const auto again = halt("60");
    EXPECT_EQ(again.status, 0);
    EXPECT_THAT(again.output, HasSubstr(" is halted"));
}

TEST_F(HaltCommand, HaltsServersBesideOneThatSaysNothing) {
    const hostile::RawListener silent;
    const auto silent_url = fmt::format("opc.tcp://127.0.0.1:{}", silent.port());
    auto halted = std::async(std::launch::async, [&] {
        return runMetier({"halt", silent_url, server().endpointUrl(), "--timeout", "60"});
    });
    auto waiting = silent.accept(kLongest);
    ASSERT_TRUE(waiting.isOpen());
    ASSERT_TRUE(move_.hand->await("halt"));
    std::string hello;
    waiting.receive(hello, 0ms);
    EXPECT_TRUE(waiting.isOpen()) << "the silent server had been given up before";
    move_.hand->execution().atRest();
    const auto finished = halted.get();
    EXPECT_EQ(finished.status, 1);
    EXPECT_THAT(finished.output,
                AllOf(HasSubstr("JointPtpMoveSkill"), HasSubstr(" halted"), HasSubstr(silent_url)));
}

}  // namespace
}  // namespace metier::system_tests
