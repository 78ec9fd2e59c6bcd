// Bad input for a robot's server in a process of its own: each one is refused with its StatusCode
// and a text with value, limit and unit, the arm stays, and the skill can be used afterwards.
#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <ostream>

#include "metier_program.hpp"

namespace metier::system_tests {
namespace {

using skill::State;
using ::testing::HasSubstr;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
const std::vector<double> kHome{0.0, 0.5235987755982988, 0.0, -1.5707963267948966,
                                0.0, 1.0471975511965976, 0.0};

/// Parameters that are refused, in the write or at Start.
struct BadInput {
    const char* name;
    const char* skill;
    skill::ValueMap values;
    const char* status;
    std::vector<std::string> text;
};

void PrintTo(const BadInput& input, std::ostream* out) {
    *out << input.name;
}

/// All tests use one server, as its clients do.
class Robot : public ::testing::Test {
protected:
    static void SetUpTestSuite() { server_ = std::make_unique<ServerProcess>("iiwa"); }
    static void TearDownTestSuite() { server_.reset(); }

    /// A small move and back: the skill and the arm are fit.
    void expectThatItMoves() {
        auto handle = openSkill(*client_, "JointPtpMoveSkill");
        auto target = kHome;
        target.back() = 0.05;
        for (const auto& joints : {target, kHome}) {
            const auto moved = handle.run({{"TargetJointPosition", joints}}, inAMinute());
            ASSERT_TRUE(moved) << moved.error().message;
        }
    }

    // Owned by the suite: a server takes a moment to start.
    static inline std::unique_ptr<ServerProcess> server_;
    std::unique_ptr<opcua::Client> client_ = connectTo(server_->url());
};

class RefusingRobot : public Robot, public ::testing::WithParamInterface<BadInput> {};

TEST_P(RefusingRobot, RefusesItWithItsTextAndStaysWhereItIs) {
    auto handle = openSkill(*client_, GetParam().skill);
    const auto before = jointPosition(*client_, handle);
    const auto refused = handle.run(GetParam().values, inAMinute());
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().status.name(), GetParam().status);
    for (const auto& part : GetParam().text) {
        EXPECT_THAT(refused.error().message, HasSubstr(part));
    }
    EXPECT_EQ(*handle.state(), State::ready);
    EXPECT_EQ(jointPosition(*client_, handle), before);
    for (const auto& [name, value] : GetParam().values) {
        EXPECT_TRUE(handle.set(name, {}));
    }
    expectThatItMoves();
}

INSTANTIATE_TEST_SUITE_P(
    BadInput, RefusingRobot,
    ::testing::Values(
        BadInput{"UnreachablePose",
                 "CartesianPtpMoveSkill",
                 {{"TargetPosition", skill::Frame{2.5, 0.0, 0.5, 0, 0, 0}}},
                 "BadOutOfRange",
                 {"2.5", " m"}},
        BadInput{"LineOutOfReach",
                 "CartesianLinearMoveSkill",
                 {{"TargetPosition", skill::Frame{1.5, 0.0, 0.0, 0, 0, 0}},
                  {"Relative", std::int32_t{1}}},
                 "BadOutOfRange",
                 {}},
        BadInput{"UnknownToolFrame",
                 "CartesianPtpMoveSkill",
                 {{"ToolFrame", std::string("drill")}},
                 "BadNotFound",
                 {"ToolFrame", "drill", "flange"}},
        BadInput{"PoseThatIsNotANumber",
                 "CartesianPtpMoveSkill",
                 {{"TargetPosition", skill::Frame{0.5, kNan, 0.5, 0, 0, 0}}},
                 "BadOutOfRange",
                 {"TargetPosition.y: nan is not finite"}},
        BadInput{"JointThatIsNotANumber",
                 "JointPtpMoveSkill",
                 {{"TargetJointPosition", std::vector{0.0, 0.0, 0.0, kNan, 0.0, 0.0, 0.0}}},
                 "BadOutOfRange",
                 {"TargetJointPosition[3]: nan rad is not finite"}},
        BadInput{"JointOverItsLimit",
                 "JointPtpMoveSkill",
                 {{"TargetJointPosition", std::vector{3.5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0}}},
                 "BadOutOfRange",
                 {"3.5", "2.96", "rad"}},
        BadInput{"TooFewJoints",
                 "JointPtpMoveSkill",
                 {{"TargetJointPosition", std::vector<double>(6, 0.0)}},
                 "BadOutOfRange",
                 {"TargetJointPosition: 6 elements are fewer than 7"}},
        BadInput{"WrongType",
                 "JointPtpMoveSkill",
                 {{"TargetJointPosition", std::string("home")}},
                 "BadTypeMismatch",
                 {"TargetJointPosition", "Double[]", "String"}},
        BadInput{"TooMuchSpeed",
                 "JointPtpMoveSkill",
                 {{"SpeedOverride", 1.5}},
                 "BadOutOfRange",
                 {"SpeedOverride: 1.5 is over the limit 1"}},
        BadInput{"NoTarget",
                 "CartesianLinearMoveSkill",
                 {},
                 "BadInvalidArgument",
                 {"a value is needed for TargetPosition"}}),
    [](const auto& test) { return std::string(test.param.name); });

TEST_F(Robot, RefusesASecondMotionWhileOneRuns) {
    auto moving = openSkill(*client_, "JointPtpMoveSkill");
    auto second = openSkill(*client_, "CartesianLinearMoveSkill");
    auto target = kHome;
    target.front() = 1.0;
    ASSERT_TRUE(moving.set("TargetJointPosition", target));
    ASSERT_TRUE(moving.start());
    ASSERT_TRUE(second.set("Relative", std::int32_t{1}));
    ASSERT_TRUE(second.set("TargetPosition", skill::Frame{.z = 0.01}));
    const auto refused = second.start();
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().status, opcua::status::kBadResourceUnavailable);
    EXPECT_THAT(second.reasonText(), HasSubstr("in use by JointPtpMoveSkill"));
    ASSERT_TRUE(moving.halt());
    ASSERT_TRUE(moving.awaitState(State::halted, inAMinute()));
    ASSERT_TRUE(moving.reset());
    ASSERT_TRUE(second.set("TargetPosition", {}));
    ASSERT_TRUE(second.set("Relative", {}));
    expectThatItMoves();
}

}  // namespace
}  // namespace metier::system_tests
