// When threads run, who moves the arm, and how a program ends.
#include <gmock/gmock.h>

#include "fake_robot.hpp"

namespace metier::urscript {
namespace {

using testing::SizeIs;

constexpr const char* kMover = "thread mover():\nmovej([0, 0, 0, 0, 0, 0])\nend\n";

void steps(Interpreter& interpreter, int count) {
    for (int i = 0; i < count; ++i) {
        interpreter.step();
    }
}

TEST(UrscriptThread, TheOldestRunsFirstInEachCycle) {
    EXPECT_EQ(resultOf("result = \"\"\n"
                       "thread a():\nwhile True:\nresult = result + \"a\"\nsync()\nend\nend\n"
                       "thread b():\nwhile True:\nresult = result + \"b\"\nsync()\nend\nend\n"
                       "run b()\nrun a()\nresult = result + \"m\"\nsync()\n"
                       "result = result + \"m\"\nsync()"),
              "mbamba");
}

TEST(UrscriptThread, AThreadOfAThreadBeginsInTheSameCycle) {
    FakeRobot robot;
    Interpreter interpreter(
        parsed(within("depth = 0\nthread inner():\ndepth = depth + 1\nsync()\nend\n"
                      "thread outer():\nrun inner()\nsync()\nend\nrun outer()\nsleep(1)")),
        robot);
    interpreter.step();
    EXPECT_EQ(interpreter.variable("depth")->text(), "1");
    EXPECT_EQ(interpreter.threadCount(), 3U);
    interpreter.step();
    EXPECT_EQ(interpreter.threadCount(), 1U);
}

TEST(UrscriptThread, AThreadThatIsKilledBeforeItRanDoesNothing) {
    EXPECT_EQ(resultOf("result = 1\nthread t():\nresult = 2\nend\nkill run t()\nsync()"), "1");
}

TEST(UrscriptThread, KillingAThreadWakesTheOneThatWaitsForIt) {
    EXPECT_EQ(resultOf("thread forever():\nwhile True:\nsync()\nend\nend\n"
                       "thread killer():\nsync()\nkill h\nend\n"
                       "h = run forever()\nrun killer()\njoin h\nresult = 1"),
              "1");
}

TEST(UrscriptThread, ThreadsThatWereKilledMakeRoomForOthers) {
    EXPECT_EQ(resultOf("thread t():\nsleep(10)\nend\ni = 0\nwhile i < 100:\nh = run t()\nkill h\n"
                       "i = i + 1\nend\nresult = i"),
              "100");
}

TEST(UrscriptThread, AHandleNeverMeansALaterThread) {
    EXPECT_EQ(resultOf("result = 0\nthread t():\nend\nthread u():\nsync()\nresult = 1\nend\n"
                       "a = run t()\njoin a\nb = run u()\nkill a\njoin b"),
              "1");
}

TEST(UrscriptThread, AThreadThatJoinsItselfKeepsNobodyElseWaiting) {
    EXPECT_EQ(resultOf("result = 1\nh = 0\nthread t():\njoin h\nresult = 2\nend\nh = run t()\n"
                       "sync()\nsync()"),
              "1");
}

TEST(UrscriptThread, AReturnEndsOnlyItsThread) {
    EXPECT_EQ(resultOf("thread t():\nreturn 9\nend\nh = run t()\njoin h\nresult = 2"), "2");
    EXPECT_EQ(resultOf("result = 1\nthread t():\nsync()\nresult = 2\nend\nrun t()\nreturn 5\n"
                       "result = 3"),
              "1");  // the main thread's return ends the program
}

TEST(UrscriptThread, ACriticalSectionThatIsNeverLeftStopsNobody) {
    EXPECT_EQ(resultOf("thread t():\nenter_critical\nreturn\nend\nrun t()\nsync()\n"
                       "enter_critical\nresult = 1\nexit_critical\nexit_critical"),
              "1");
}

TEST(UrscriptThread, NobodyComesBetweenTwoStatementsThatDoNotWait) {
    EXPECT_EQ(resultOf("n = 0\nresult = 0\nthread t():\nwhile True:\nn = 0\nsync()\nend\nend\n"
                       "run t()\ni = 0\nwhile i < 5:\nenter_critical\nn = n + 1\nn = n + 1\n"
                       "result = result + n\nexit_critical\nsync()\ni = i + 1\nend"),
              "10");
}

TEST(UrscriptMotion, TheArmIsFreeForOthersWhenAMotionIsDone) {
    FakeRobot robot;
    robot.motion_cycles = 3;
    EXPECT_EQ(resultOf(kMover + std::string("h = run mover()\njoin h\n"
                                            "movej([1, 0, 0, 0, 0, 0])\nresult = 1"),
                       robot),
              "1");
    EXPECT_EQ(robot.abandoned, 0);
    EXPECT_THAT(robot.motions, SizeIs(2));
}

TEST(UrscriptMotion, KillingAThreadThatDoesNotMoveLeavesTheArmAlone) {
    FakeRobot robot;
    robot.motion_cycles = 10;
    EXPECT_EQ(resultOf(kMover + std::string("thread other():\nsleep(1)\nend\nm = run mover()\n"
                                            "h = run other()\nsync()\nkill h\njoin m\nresult = 1"),
                       robot),
              "1");
    EXPECT_EQ(robot.abandoned, 0);
}

TEST(UrscriptMotion, EveryEndOfAProgramAbandonsTheMotionOfItsThreads) {
    for (const std::string_view end : {"pass", "halt", "return", "x = 1 / 0"}) {
        FakeRobot robot;
        robot.motion_cycles = 100;
        resultOf(kMover + std::string("run mover()\nsync()\n").append(end), robot);
        EXPECT_EQ(robot.abandoned, 1) << end;
        EXPECT_THAT(robot.motions, SizeIs(1)) << end;
    }
}

TEST(UrscriptMotion, AMotionThatFailsOnItsWayEndsTheProgram) {
    FakeRobot robot;
    robot.motion_cycles = 100;
    Interpreter interpreter(parsed(within("sync()\nmovej([0, 0, 0, 0, 0, 0])\ntextmsg(1)")), robot);
    steps(interpreter, 3);
    ASSERT_EQ(interpreter.state(), RunState::running);
    robot.refusal = "protective stop";
    EXPECT_EQ(interpreter.step(), RunState::failed);
    EXPECT_EQ(interpreter.exception()->line, 3);
    EXPECT_EQ(interpreter.exception()->text, "protective stop");
    EXPECT_EQ(robot.abandoned, 1);
    EXPECT_THAT(robot.messages, SizeIs(0));
}

TEST(UrscriptMotion, ARefusedMotionDoesNotTakeTheArm) {
    FakeRobot robot;
    robot.refusal = "not now";
    EXPECT_EQ(resultOf("movej([0, 0, 0, 0, 0, 0])", robot), "2:1 not now");
    EXPECT_EQ(robot.abandoned, 0);
}

TEST(UrscriptInterpreter, AProgramThatNeverEndsRunsUntilItIsStopped) {
    FakeRobot robot;
    Interpreter interpreter(parsed(within("n = 0\nwhile True:\nn = n + 1\nsync()\nend")), robot);
    steps(interpreter, 5000);
    EXPECT_EQ(interpreter.state(), RunState::running);
    EXPECT_EQ(interpreter.variable("n")->text(), "5000");
    interpreter.stop();
    EXPECT_EQ(interpreter.step(), RunState::finished);
    EXPECT_EQ(interpreter.threadCount(), 0U);
    EXPECT_EQ(interpreter.variable("n")->text(), "5000");
    EXPECT_EQ(interpreter.exception(), std::nullopt);
}

TEST(UrscriptInterpreter, NothingRunsAfterAnException) {
    FakeRobot robot;
    Interpreter interpreter(
        parsed(
            within("thread t():\nwhile True:\ntextmsg(\"t\")\nsync()\nend\nend\nrun t()\nsync()\n"
                   "x = 1 / 0")),
        robot);
    steps(interpreter, 10);
    EXPECT_THAT(robot.messages, SizeIs(1));
    interpreter.stop();
    EXPECT_EQ(interpreter.state(), RunState::failed);
    EXPECT_EQ(interpreter.exception()->text, "division by zero");
    EXPECT_EQ(interpreter.threadCount(), 0U);
}

TEST(UrscriptInterpreter, ItsEndAbandonsTheMotion) {
    FakeRobot robot;
    robot.motion_cycles = 100;
    {
        Interpreter interpreter(parsed(within("movej([0, 0, 0, 0, 0, 0])")), robot);
        interpreter.step();
    }
    EXPECT_EQ(robot.abandoned, 1);
}

TEST(UrscriptInterpreter, AnotherProgramInItsPlaceAbandonsTheMotion) {
    FakeRobot robot;
    robot.motion_cycles = 100;
    Interpreter interpreter(parsed(within("movej([0, 0, 0, 0, 0, 0])")), robot);
    interpreter.step();
    interpreter = Interpreter(parsed("textmsg(2)\n"), robot);
    EXPECT_EQ(robot.abandoned, 1);
    EXPECT_EQ(interpreter.step(), RunState::finished);
    EXPECT_THAT(robot.messages, testing::ElementsAre("2"));
}

TEST(UrscriptInterpreter, OnlyGlobalVariablesCanBeSeenFromOutside) {
    FakeRobot robot;
    Interpreter interpreter(
        parsed(within("x = 1\nlocal y\ndef f(a):\nlocal b = a\nglobal c = b\nend\nf(3)")), robot);
    interpreter.step();
    EXPECT_EQ(interpreter.variable("x")->text(), "1");
    EXPECT_TRUE(interpreter.variable("y")->isNone());
    EXPECT_EQ(interpreter.variable("c")->text(), "3");
    EXPECT_EQ(interpreter.variable("a"), std::nullopt);
    EXPECT_EQ(interpreter.variable("b"), std::nullopt);
}

/// Why a secondary program with these statements fails; empty if it does not.
std::string secondaryFailure(std::string_view statements, FakeRobot& robot) {
    Interpreter interpreter(parsed("sec s():\n" + std::string(statements) + "\nend\n"), robot);
    interpreter.step();
    EXPECT_NE(interpreter.state(), RunState::running) << statements;
    return interpreter.exception() ? interpreter.exception()->text : "";
}

TEST(UrscriptSecondary, FailsWithEverythingThatWaits) {
    constexpr const char* kTakesTime = "a secondary program may not call what takes time";
    for (const std::string_view waits :
         {"sleep(0.1)", "popup(\"a\", blocking=True)", "socket_open(\"h\", 1)",
          "socket_read_line(\"s\")", "thread t():\nend\nh = run t()\njoin h"}) {
        FakeRobot robot;
        EXPECT_EQ(secondaryFailure(waits, robot), kTakesTime) << waits;
    }
    FakeRobot robot;
    EXPECT_EQ(secondaryFailure("freedrive_mode()\nspeedj([0, 0, 0, 0, 0, 0], 1)", robot),
              "a secondary program may not move the arm");
    EXPECT_TRUE(robot.motions.empty());
}

TEST(UrscriptSecondary, MayReadWhatIsThere) {
    FakeRobot robot;
    robot.socket.all["s"] = {SocketState::open, "", 1, "", "one\n"};
    EXPECT_EQ(secondaryFailure("textmsg(socket_read_line(\"s\"))\npopup(\"a\")", robot), "");
    EXPECT_THAT(robot.messages, testing::ElementsAre("one"));
}

TEST(UrscriptSecondary, ALoopWithoutEndIsAnException) {
    FakeRobot robot;
    EXPECT_THAT(secondaryFailure("while True:\npass\nend", robot),
                testing::StartsWith("infinite loop"));
}

}  // namespace
}  // namespace metier::urscript
