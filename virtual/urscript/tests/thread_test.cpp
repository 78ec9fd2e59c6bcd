#include <gmock/gmock.h>

#include "fake_robot.hpp"

namespace metier::urscript {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kCounting =
    "n = 0\n"
    "thread count():\n"
    "  while True:\n"
    "    n = n + 1\n"
    "    sync()\n"
    "  end\n"
    "end\n";

void steps(Interpreter& interpreter, int count) {
    for (int i = 0; i < count; ++i) {
        interpreter.step();
    }
}

TEST(UrscriptThread, EachThreadRunsOncePerCycle) {
    FakeRobot robot;
    Interpreter interpreter(
        parsed(within(std::string(kCounting) + "run count()\nrun count()\nsleep(10)")), robot);
    interpreter.step();
    EXPECT_EQ(interpreter.threadCount(), 3U);
    EXPECT_EQ(interpreter.variable("n")->text(), "2");
    steps(interpreter, 4);
    EXPECT_EQ(interpreter.variable("n")->text(), "10");
}

TEST(UrscriptThread, KillEndsAThread) {
    EXPECT_EQ(resultOf(std::string(kCounting) +
                       "t = run count()\nsync()\nsync()\nkill t\nsync()\nresult = n"),
              "2");
}

TEST(UrscriptThread, KillAndJoinOfWhatIsNoThreadDoNothing) {
    EXPECT_EQ(resultOf("t = 0\nkill t\njoin t\nkill 77\njoin 77\nresult = 1"), "1");
    EXPECT_EQ(resultOf("kill \"a\""), "2:1 a thread's handle is an int, not string");
}

TEST(UrscriptThread, JoinWaitsUntilTheThreadHasEnded) {
    EXPECT_EQ(resultOf("result = 0\nthread t():\nsync()\nsync()\nresult = 5\nend\n"
                       "h = run t()\njoin h\nresult = result + 1"),
              "6");
}

TEST(UrscriptThread, AThreadMayEndItself) {
    EXPECT_EQ(resultOf("h = 0\nresult = 1\nthread t():\nkill h\nresult = 2\nend\n"
                       "h = run t()\njoin h"),
              "1");
}

TEST(UrscriptThread, TheEndOfTheProgramEndsItsThreads) {
    FakeRobot robot;
    Interpreter interpreter(parsed(within(std::string(kCounting) + "run count()\nsync()")), robot);
    interpreter.step();
    EXPECT_EQ(interpreter.step(), RunState::finished);
    EXPECT_EQ(interpreter.threadCount(), 0U);
}

TEST(UrscriptThread, HaltInAThreadEndsTheProgram) {
    FakeRobot robot;
    Interpreter interpreter(parsed(within("thread t():\nhalt\nend\nrun t()\nsleep(10)")), robot);
    EXPECT_EQ(interpreter.step(), RunState::finished);
    EXPECT_EQ(interpreter.exception(), std::nullopt);
}

TEST(UrscriptThread, AnExceptionInAThreadEndsTheProgram) {
    EXPECT_EQ(resultOf("thread t():\nsync()\nx = 1 / 0\nend\nrun t()\nsleep(10)"),
              "4:7 division by zero");
}

TEST(UrscriptThread, CriticalSectionsMayContainWhatTakesTime) {
    EXPECT_EQ(resultOf("result = 0\nthread t():\nenter_critical\nsync()\nresult = result + 1\n"
                       "exit_critical\nend\nh = run t()\nenter_critical\nsync()\nsync()\n"
                       "result = result * 10\nexit_critical()\njoin h"),
              "10");
}

TEST(UrscriptThread, LocalsOfThreadsAreTheirOwn) {
    EXPECT_EQ(resultOf("result = []\nsum = 0\nthread t():\nmine = 0\nwhile mine < 3:\n"
                       "mine = mine + 1\nsync()\nend\nsum = sum + mine\nend\n"
                       "a = run t()\nb = run t()\njoin a\njoin b\nresult = sum"),
              "6");
}

TEST(UrscriptThread, TooManyThreadsAreAnException) {
    EXPECT_EQ(resultOf("thread t():\nsleep(1)\nend\nwhile True:\nrun t()\nend"),
              "6:1 more than 64 threads");
}

TEST(UrscriptThread, ALoopWithoutSyncIsAnException) {
    EXPECT_EQ(resultOf("x = 0\nwhile True:\n  x = x + 1\nend").substr(0, 1), "4");
    EXPECT_THAT(resultOf("while True:\n  pass\nend"), HasSubstr("infinite loop"));
    EXPECT_EQ(resultOf("i = 0\nwhile i < 5000:\n  i = i + 1\nend\nresult = i"), "5000");
}

TEST(UrscriptThread, WorkOfAllThreadsCountsTogether) {
    FakeRobot robot;
    RunLimits limits;
    limits.instructions_per_cycle = 100;
    Interpreter interpreter(
        parsed(within("thread t():\nwhile True:\ni = 0\nwhile i < 5:\ni = i + 1\nend\nsync()\nend\n"
                      "end\nrun t()\nsync()\nrun t()\nsleep(1)")),
        robot, limits);
    EXPECT_EQ(interpreter.step(), RunState::running);
    EXPECT_EQ(interpreter.step(), RunState::failed);
}

TEST(UrscriptThread, SleepLastsWholeCycles) {
    FakeRobot robot;
    Interpreter interpreter(parsed(within("sleep(0.02)\nresult = 1")), robot);
    steps(interpreter, 3);
    EXPECT_EQ(interpreter.state(), RunState::running);  // 2.5 cycles of 8 ms
    EXPECT_EQ(interpreter.step(), RunState::finished);
}

TEST(UrscriptThread, LineFollowsTheMainThread) {
    FakeRobot robot;
    Interpreter interpreter(parsed("def a():\nthread t():\nsleep(1)\nend\nrun t()\nsync()\nsync()\n"
                                   "end\n"),
                            robot);
    interpreter.step();
    EXPECT_EQ(interpreter.line(), 6);
    interpreter.step();
    EXPECT_EQ(interpreter.line(), 7);
}

TEST(UrscriptSecondary, EndsInItsFirstCycle) {
    FakeRobot robot;
    Interpreter interpreter(parsed("sec s():\nset_tool_voltage(24)\nend\n"), robot);
    EXPECT_EQ(interpreter.step(), RunState::finished);
    EXPECT_EQ(robot.lastCommand<SetToolVoltage>().voltage, 24);
}

TEST(UrscriptSecondary, NeitherMovesNorWaits) {
    FakeRobot robot;
    Interpreter moves(parsed("sec s():\nstopj(2)\nend\n"), robot);
    EXPECT_EQ(moves.step(), RunState::failed);
    EXPECT_EQ(moves.exception()->text, "a secondary program may not move the arm");
    Interpreter waits(parsed("sec s():\nsync()\nend\n"), robot);
    EXPECT_EQ(waits.step(), RunState::failed);
    EXPECT_EQ(waits.exception()->text, "a secondary program may not call what takes time");
}

TEST(UrscriptInterpreter, StopEndsAProgramAndItsMotion) {
    FakeRobot robot;
    robot.motion_cycles = 100;
    Interpreter interpreter(parsed(within("movej([0,0,0,0,0,0])")), robot);
    interpreter.step();
    interpreter.stop();
    EXPECT_EQ(interpreter.state(), RunState::finished);
    EXPECT_EQ(robot.abandoned, 1);
    EXPECT_EQ(interpreter.step(), RunState::finished);
}

TEST(UrscriptInterpreter, AProgramRunsAnyNumberOfTimes) {
    const Program program = parsed(within("textmsg(\"x\", 1)"));
    FakeRobot robot;
    Interpreter first(program, robot);
    Interpreter second(program, robot);
    first.step();
    second.step();
    EXPECT_THAT(robot.messages, ElementsAre("x1", "x1"));
}

}  // namespace
}  // namespace metier::urscript
