// Robots, servers and records that a command line names.
#include <gmock/gmock.h>

#include "motion_picture.hpp"
#include "recorded.hpp"
#include "robot_argument.hpp"
#include "servers.hpp"

namespace metier::app {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsSupersetOf;

TEST(RobotArgument, IsANameOrAFile) {
    EXPECT_THAT(robotNames(), IsSupersetOf({"edo", "iiwa14", "iiwa7", "ur5", "ur5e"}));
    EXPECT_EQ(loadRobot("ur5").value().name(), "ur5");
    EXPECT_EQ(loadRobot(METIER_MODELS_DIR "/edo.toml").value().axisCount(), 6U);
    EXPECT_TRUE(isRobot("iiwa7"));
    EXPECT_TRUE(isRobot("./mine.toml"));
    EXPECT_FALSE(isRobot("UR5"));
    EXPECT_FALSE(isRobot(""));
}

TEST(RobotArgument, ANameThatIsNoneIsRefusedWithThoseThatThereAre) {
    for (const char* name : {"UR5", "ur", "", "ur5 ", "..", "ur5\n"}) {
        const auto refused = loadRobot(name);
        ASSERT_FALSE(refused) << name;
        EXPECT_EQ(refused.error().code, Errc::invalid_argument) << name;
        EXPECT_THAT(refused.error().message,
                    AllOf(HasSubstr("no robot '" + std::string(name) + "'"), HasSubstr("edo, "),
                          HasSubstr("or the file of a model")));
    }
}

TEST(RobotArgument, AFileThatIsNotThereOrNoModelIsNamed) {
    EXPECT_THAT(loadRobot("/nonexistent/arm.toml").error().message,
                HasSubstr("/nonexistent/arm.toml"));
    EXPECT_FALSE(loadRobot("/"));
    EXPECT_EQ(loadAllRobots().value().size(), robotNames().size());
}

TEST(ServerChoices, NeedAServerOrACellIfNoneIsFound) {
    const auto nothing = addressesOf({.discovery = {"opc.tcp://127.0.0.1:1"}});
    ASSERT_FALSE(nothing);
    EXPECT_EQ(nothing.error().code, Errc::not_found);
    EXPECT_THAT(nothing.error().message, HasSubstr("--cell FILE"));
    EXPECT_THAT(addressesOf({{"opc.tcp://a:1", "opc.tcp://b:2"}, ""}).value(),
                ElementsAre("opc.tcp://a:1", "opc.tcp://b:2"));
    EXPECT_THAT(addressesOf({{"opc.tcp://a:1"}, "/nonexistent/cell.toml"}).error().message,
                HasSubstr("/nonexistent/cell.toml"));
}

TEST(ConnectionText, SaysWhatHasBecomeOfTheConnection) {
    using Kind = opcua::ConnectionChange::Kind;
    opcua::ConnectionChange change;
    change.why.message = "silent for 5 s";
    EXPECT_EQ(textOf(change), "connection lost: silent for 5 s; reconnecting");
    change.kind = Kind::given_up;
    EXPECT_EQ(textOf(change), "connection given up: silent for 5 s");
    change.kind = Kind::back;
    change.server_restarted = true;
    EXPECT_EQ(textOf(change), "connection back; server restarted: yes");
}

TEST(Outcome, HasAnExitStatusOfItsOwnIfNobodyKnowsIt) {
    opcua::Failure failure;
    failure.message = "no\x1b[2J answer";
    ::testing::internal::CaptureStderr();
    EXPECT_EQ(reportOutcome(failure), Exit::failed);
    failure.delivery = opcua::Failure::Delivery::unknown;
    EXPECT_EQ(reportOutcome(failure), Exit::unknown);
    failure.code = Errc::execution_lost;
    EXPECT_EQ(reportOutcome(failure), Exit::execution_lost);
    EXPECT_EQ(report({Errc::invalid_argument, "wrong"}), Exit::usage);
    EXPECT_EQ(exitOf(asUsage(Result<Exit>(fail(Errc::not_found, "missing")))), Exit::usage);
    EXPECT_EQ(exitOf(fail(Errc::not_found, "missing")), Exit::failed);
    EXPECT_EQ(exitOf(Exit::unknown), Exit::unknown);
    const auto printed = ::testing::internal::GetCapturedStderr();
    EXPECT_THAT(printed, HasSubstr("metier: missing\n"));
    EXPECT_EQ(printed.find('\x1b'), std::string::npos);
}

/// Five positions of an arm whose axes stand.
path_evaluation::MotionRecord standing(std::size_t axes) {
    path_evaluation::MotionRecord record;
    for (std::size_t i = 0; i < path_evaluation::kFewestRecorded; ++i) {
        record.push_back({100.0 + 0.1 * static_cast<double>(i), motion::JointVector(axes)});
    }
    return record;
}

TEST(MotionPicture, IsOfTheRobotsAxesAndTools) {
    const auto model = loadRobot("ur5").value();
    const auto drawn = recordedMotion(model, standing(6), "a.csv", "").value();
    EXPECT_EQ(drawn.note, "a.csv, 5 positions, 0.400 s");
    EXPECT_EQ(drawn.tool_positions.size(), 5U);
    EXPECT_EQ(recordedMotion(model, standing(7), "a.csv", "").error().message,
              "a.csv: 7 joint positions, ur5 has 6 axes");
    const auto tool = recordedMotion(model, standing(6), "a.csv", "no such tool");
    ASSERT_FALSE(tool);
    EXPECT_EQ(tool.error().code, Errc::invalid_argument);
    EXPECT_THAT(tool.error().message, HasSubstr("no such tool"));
}

TEST(MotionPicture, AFileThatCannotBeWrittenIsAnErrorOfTheCommandLine) {
    const auto model = loadRobot("ur5").value();
    const auto drawn = recordedMotion(model, standing(6), "a.csv", "").value();
    ::testing::internal::CaptureStderr();
    EXPECT_EQ(exitOf(drawInto("/nonexistent/picture.svg", model, "", drawn)), Exit::usage);
    EXPECT_THAT(::testing::internal::GetCapturedStderr(),
                HasSubstr("/nonexistent/picture.svg: cannot be written"));
    EXPECT_EQ(exitOf(drawInto("/dev/full", model, "", drawn)), Exit::usage)
        << "a disk that is full";
}

TEST(RecordedRobot, IsTheProductOrTheLongestNameThatFits) {
    records::ExecutionRow row;
    row.number = 12;
    row.server_name = "cell-ur5e-left";
    EXPECT_EQ(robotOf(row, "").value().name(), "ur5e") << "not ur5";
    EXPECT_EQ(robotOf(row, "edo").value().name(), "edo");
    row.server_name = "press";
    const auto unknown = robotOf(row, "");
    ASSERT_FALSE(unknown);
    EXPECT_EQ(unknown.error().code, Errc::invalid_argument);
    EXPECT_THAT(unknown.error().message, AllOf(HasSubstr("execution 12"), HasSubstr("'press'"),
                                               HasSubstr("--robot: edo, ")));
    EXPECT_FALSE(robotOf(row, "no such robot"));
}

TEST(RecordsArgument, TakesNoPassword) {
    std::string url = "postgresql://user:secret@host/database";
    const auto refusal = withoutPassword()(url);
    EXPECT_THAT(refusal, HasSubstr("~/.pgpass"));
    EXPECT_EQ(refusal.find("secret"), std::string::npos);
    url = "postgresql://user@host/database";
    EXPECT_EQ(withoutPassword()(url), "");
    url = "/tmp/a:b@c.db";
    EXPECT_EQ(withoutPassword()(url), "") << "a file";
}

}  // namespace
}  // namespace metier::app
