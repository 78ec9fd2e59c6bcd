#include <gmock/gmock.h>

#include "fake_robot.hpp"
#include "socket_reading.hpp"

namespace metier::urscript {
namespace {

using testing::HasSubstr;

/// Runs statements on a robot whose socket "s" is open and has received `bytes`.
std::string withReceived(std::string_view statements, std::string bytes) {
    FakeRobot robot;
    robot.socket.all["s"] = {SocketState::open, "host", 1, "", std::move(bytes)};
    return resultOf(statements, robot);
}

std::string sentBy(std::string_view statements) {
    FakeRobot robot;
    robot.socket.all["s"] = {SocketState::open, "host", 1, "", ""};
    resultOf(statements, robot);
    return robot.socket.all["s"].sent;
}

TEST(UrscriptSocket, OpenTellsWhetherItWorked) {
    FakeRobot robot;
    EXPECT_EQ(resultOf("result = socket_open(\"10.0.0.1\", 50001, \"reverse\")", robot), "True");
    EXPECT_EQ(robot.socket.all["reverse"].host, "10.0.0.1");
    EXPECT_EQ(robot.socket.all["reverse"].port, 50001);
    robot.socket.first_state = SocketState::closed;
    EXPECT_EQ(resultOf("result = socket_open(\"10.0.0.1\", 50001)", robot), "False");
    EXPECT_THAT(resultOf("socket_open(\"10.0.0.1\", 0)", robot), HasSubstr("port 0 is not"));
}

TEST(UrscriptSocket, OpenGivesUpAfterTwoSeconds) {
    FakeRobot robot;
    robot.socket.first_state = SocketState::opening;
    Interpreter interpreter(parsed(within("result = socket_open(\"10.0.0.1\", 1, \"s\")")), robot);
    int cycles = 0;
    while (interpreter.step() == RunState::running) {
        ++cycles;
    }
    EXPECT_EQ(cycles, 250);
    EXPECT_EQ(interpreter.variable("result")->text(), "False");
    EXPECT_EQ(robot.socket.state("s"), SocketState::closed);
}

TEST(UrscriptSocket, ReadsBigEndianIntegers) {
    EXPECT_EQ(withReceived("result = socket_read_binary_integer(2, \"s\", 0.1)",
                           std::string("\x00\x00\x00\x64\xff\xff\xff\xfe", 8)),
              "[2, 100, -2]");
    EXPECT_EQ(withReceived("result = socket_read_byte_list(3, \"s\", 0.1)",
                           std::string("\x01\x02\xff", 3)),
              "[3, 1, 2, 255]");
}

TEST(UrscriptSocket, AReadThatFailsTellsHowManyItMissed) {
    EXPECT_EQ(withReceived("result = socket_read_binary_integer(3, \"s\", 0.02)", "abc"),
              "[0, -1, -1, -1]");
    EXPECT_EQ(withReceived("result = socket_read_ascii_float(2, \"s\", 0.02)", "(1"),
              "[0, nan, nan]");
    EXPECT_EQ(withReceived("result = socket_read_line(\"s\", 0.02)", "abc"), "");
    EXPECT_EQ(withReceived("result = socket_read_binary_integer(1, \"closed\", 0)", ""), "[0, -1]");
    EXPECT_THAT(withReceived("socket_read_binary_integer(31, \"s\")", ""),
                HasSubstr("number 31 is not from 1 to 30"));
}

TEST(UrscriptSocket, AReadTakesNoTimeIfAllIsThere) {
    FakeRobot robot;
    robot.socket.all["s"] = {SocketState::open, "", 1, "", std::string(80, '\0')};
    Interpreter interpreter(parsed(within("i = 0\nwhile i < 10:\n"
                                          "socket_read_binary_integer(2, \"s\", 0)\ni = i + 1\n"
                                          "end")),
                            robot);
    EXPECT_EQ(interpreter.step(), RunState::finished);
}

TEST(UrscriptSocket, AReadWithoutTimeoutWaitsForBytesOrTheEnd) {
    FakeRobot robot;
    robot.socket.all["s"] = {SocketState::open, "", 1, "", ""};
    Interpreter interpreter(parsed(within("result = socket_read_binary_integer(1, \"s\", 0)\n"
                                          "result = socket_read_binary_integer(1, \"s\", -1)")),
                            robot);
    for (int i = 0; i < 1000; ++i) {
        ASSERT_EQ(interpreter.step(), RunState::running);
    }
    robot.socket.all["s"].received = std::string("\x00\x00\x00\x07", 4);
    ASSERT_EQ(interpreter.step(), RunState::running);
    EXPECT_EQ(interpreter.variable("result")->text(), "[1, 7]");
    robot.socket.all["s"].state = SocketState::closed;
    EXPECT_EQ(interpreter.step(), RunState::finished);
    EXPECT_EQ(interpreter.variable("result")->text(), "[0, -1]");
}

TEST(UrscriptSocket, TheTimeoutCountsCycles) {
    FakeRobot robot;
    robot.socket.all["s"] = {SocketState::open, "", 1, "", ""};
    Interpreter interpreter(parsed(within("socket_read_binary_integer(1, \"s\", 0.04)")), robot);
    int cycles = 0;
    while (interpreter.step() == RunState::running) {
        ++cycles;
    }
    EXPECT_EQ(cycles, 5);
}

TEST(UrscriptSocket, ReadsFloatsLinesAndText) {
    EXPECT_EQ(withReceived("result = socket_read_ascii_float(4, \"s\")",
                           "( 1.414 , 3.14159, 1.616, 0.0 )\n"),
              "[4, 1.414, 3.14159, 1.616, 0]");
    EXPECT_EQ(withReceived("result = socket_read_ascii_float(2, \"s\")", "(1,2,3)"),
              "[0, nan, nan]");
    EXPECT_EQ(withReceived("result = socket_read_ascii_float(2, \"s\")", "(1,x)"), "[0, nan, nan]");
    EXPECT_EQ(withReceived("a = socket_read_line(\"s\")\nresult = str_cat(a, socket_read_line("
                           "\"s\"))",
                           "one\r\ntwo\n"),
              "onetwo");
    EXPECT_EQ(withReceived("a = socket_read_string(\"s\", prefix=\">\", suffix=\"<\")\n"
                           "result = str_cat(a, socket_read_string(\"s\", \">\", \"<\"))",
                           "xx>hello<>world<"),
              "helloworld");
    EXPECT_EQ(withReceived("result = socket_read_string(\"s\", suffix=\"\\n\", "
                           "interpret_escape=True)",
                           "one\ntwo"),
              "one");
    EXPECT_EQ(withReceived("result = socket_read_string(\"s\")", "all there is"), "all there is");
}

TEST(UrscriptSocket, SendsNumbersAndText) {
    EXPECT_EQ(sentBy("socket_send_int(-2, \"s\")"), "\xff\xff\xff\xfe");
    EXPECT_EQ(sentBy("socket_send_byte(10, \"s\")"), "\n");
    EXPECT_EQ(sentBy("socket_send_line(\"hello\", \"s\")"), "hello\n");
    EXPECT_EQ(sentBy("socket_send_string(1.5, \"s\")"), "1.5");
    EXPECT_EQ(sentBy("socket_set_var(\"POS_Y\", 2200, \"s\")"), "SET POS_Y 2200\n");
    EXPECT_EQ(resultOf("result = socket_send_int(1, \"closed\")"), "False");
}

TEST(UrscriptSocket, AsksForVariables) {
    EXPECT_EQ(sentBy("socket_get_var(\"POS_X\", \"s\")"), "GET POS_X\n");
    EXPECT_EQ(withReceived("result = socket_get_var(\"POS_X\", \"s\")", "POS_X 12\n"), "12");
    EXPECT_EQ(withReceived("result = socket_get_var(\"POS_X\", \"s\")", "OTHER 12\n"), "0");
    EXPECT_EQ(withReceived("result = socket_get_var(\"POS_X\", \"s\")", ""), "0");
}

TEST(UrscriptSocket, CloseForgetsASocket) {
    EXPECT_EQ(withReceived("socket_close(\"s\")\nresult = socket_send_int(1, \"s\")", ""), "False");
}

TEST(UrscriptSocket, AReadTakesOnlyItsOwnBytes) {
    EXPECT_EQ(withReceived("a = socket_read_line(\"s\")\nb = socket_read_byte_list(1, \"s\")\n"
                           "result = [a, b[1], socket_read_string(\"s\")]",
                           "one\nAtwo"),
              "[one, 65, two]");
}

TEST(UrscriptSocket, WhatCameBeforeThePeerClosedIsStillRead) {
    FakeRobot robot;
    robot.socket.all["s"] = {SocketState::closed, "", 1, "", "late\n"};
    EXPECT_EQ(resultOf("a = socket_read_line(\"s\")\nresult = [a, socket_read_line(\"s\")]", robot),
              "[late, ]");
}

TEST(UrscriptSocket, ALineMayComeInPieces) {
    FakeRobot robot;
    robot.socket.all["s"] = {SocketState::open, "", 1, "", ""};
    Interpreter interpreter(parsed(within("result = socket_read_line(\"s\", 1)")), robot);
    for (const char c : std::string_view("pieces\r")) {
        robot.socket.all["s"].received += c;
        ASSERT_EQ(interpreter.step(), RunState::running);
    }
    robot.socket.all["s"].received += '\n';
    EXPECT_EQ(interpreter.step(), RunState::finished);
    EXPECT_EQ(interpreter.variable("result")->text(), "pieces");
}

TEST(UrscriptSocket, WithoutANameItIsTheFirstSocket) {
    FakeRobot robot;
    robot.socket.first_received = "x\n";
    EXPECT_EQ(resultOf("socket_open(\"h\", 1)\nresult = socket_read_line()", robot), "x");
    EXPECT_EQ(robot.socket.state("socket_0"), SocketState::open);
    resultOf("socket_close()", robot);
    EXPECT_TRUE(robot.socket.all.empty());
}

TEST(UrscriptSocket, ThreadsMayWaitForDifferentSockets) {
    FakeRobot robot;
    robot.socket.all["a"] = {SocketState::open, "", 1, "", ""};
    robot.socket.all["b"] = {SocketState::open, "", 1, "", ""};
    Interpreter interpreter(
        parsed(within(
            "result = \"\"\nthread t():\nline = socket_read_line(\"a\", 0)\nresult = result + "
            "line\n"
            "end\nrun t()\nmine = socket_read_line(\"b\", 0)\nresult = result + mine\nsleep(1)")),
        robot);
    interpreter.step();
    robot.socket.all["a"].received = "first\n";
    interpreter.step();
    robot.socket.all["b"].received = "second\n";
    interpreter.step();
    EXPECT_EQ(interpreter.variable("result")->text(), "firstsecond");
}

TEST(UrscriptSocketReading, NumbersThatAreNotWhatWasAskedForAreAFailure) {
    for (const std::string_view bytes :
         {"()", "(1)", "(1,)", "(,1)", "(1,2,)", "(1 2)", "(1,1e999)", "(1,2"}) {
        const auto floats = extractFloats(bytes, 2);
        EXPECT_TRUE(!floats || floats->value.text() == "[0, nan, nan]") << bytes;
    }
    EXPECT_EQ(extractFloats("(1,-2e3)", 2)->value.text(), "[2, 1, -2000]");
    EXPECT_EQ(extractVariable("POS 1 2\n", "POS")->value.text(), "0");
    EXPECT_EQ(extractVariable("POS 3000000000\n", "POS")->value.text(), "0");
    EXPECT_FALSE(extractVariable("POS 1", "POS"));
}

TEST(UrscriptSocketReading, ALongTextIsCutAndItsRestDropped) {
    const auto text = extractText(">" + std::string(2000, 'x') + "<next", ">", "<");
    EXPECT_EQ(text->value.get<std::string>()->size(), 1024U);
    EXPECT_EQ(text->used, 2002U);
}

TEST(UrscriptSocketReading, NeedsAllBytesBeforeItTakesAny) {
    EXPECT_FALSE(extractIntegers("abc", 1, 4));
    EXPECT_FALSE(extractFloats("1, 2)", 2));
    EXPECT_FALSE(extractFloats("(1, 2", 2));
    EXPECT_EQ(extractFloats("junk (1)rest", 1)->used, 8U);
    EXPECT_FALSE(extractText("", "", ""));
    EXPECT_FALSE(extractText("no prefix", ">", ""));
    EXPECT_EQ(unescaped("a\\n\\t\\q\\"), "a\n\t\\q\\");
}

}  // namespace
}  // namespace metier::urscript
