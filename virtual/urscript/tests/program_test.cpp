// Whole programs in the shape of those that clients send.
#include <gmock/gmock.h>

#include <algorithm>
#include <chrono>

#include "fake_robot.hpp"

namespace metier::urscript {
namespace {

using testing::ElementsAre;

// As a client of RTDE registers sends it.
constexpr const char* kRegisterLoop =
    "def follow():\n"
    "\tq = get_actual_joint_positions()\n"
    "\trtde_set_watchdog(\"input_int_register_0\", 1, \"pause\")\n"
    "\twhile (1 == read_input_integer_register(0)):\n"
    "\t\tq[0] = read_input_float_register(0)\n"
    "\t\tq[1] = read_input_float_register(1)\n"
    "\t\tservoj(q, 0, 0, 0.008, 0.03, 2000)\n"
    "\tend\n"
    "end\n";

TEST(UrscriptPrograms, ARegisterLoopFollowsTheRegistersEachCycle) {
    FakeRobot robot;
    robot.input_integers[0] = 1;
    robot.now.actual_joint_position[5] = 0.6;
    Interpreter interpreter(parsed(kRegisterLoop), robot);
    for (int cycle = 0; cycle < 100; ++cycle) {
        robot.input_floats[0] = 0.01 * cycle;
        ASSERT_EQ(interpreter.step(), RunState::running);
        ASSERT_EQ(robot.motions.size(), static_cast<std::size_t>(cycle + 1));
        EXPECT_EQ(robot.lastMotion<ServoJ>().joint_position[0], 0.01 * cycle);
    }
    EXPECT_EQ(robot.lastMotion<ServoJ>().joint_position[5], 0.6);
    EXPECT_EQ(robot.lastCommand<RtdeWatchdog>().variable, "input_int_register_0");
    robot.input_integers[0] = 0;
    EXPECT_EQ(interpreter.step(), RunState::finished);
    EXPECT_EQ(interpreter.exception(), std::nullopt);
}

// A program that dials back and is commanded by eight integers per cycle.
constexpr const char* kReverseSocket = R"(
def remote():
  steptime = get_steptime()
  SCALE = 1000000
  MODE_STOPPED = -2
  MODE_IDLE = 0
  MODE_SERVO = 1
  MODE_SPEED = 2

  global fresh = False
  global target = get_joint_positions()
  global speed = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
  global extrapolated = 0
  global mode = MODE_IDLE
  mover = 0

  def isSlowEnough(from, to, time):
    local i = 0
    while i < 6:
      local needed = norm(to[i] - from[i]) / time
      if needed > 20.0:
        local text = str_cat(
          str_cat("joint ", i), str_cat(
            " needs ", needed))
        popup(text, title="speed", blocking=False, warning=True)
        return False
      end
      i = i + 1
    end
    return True
  end

  def connect(host, port, name, attempts=5, pause=0.2):
    attempt = 0
    while attempt < attempts:
      if socket_open(host, port, name):
        return True
      end
      sleep(pause)
      attempt = attempt + 1
    end
    return False
  end

  def extrapolate():
    target = target + get_target_joint_speeds() * steptime
    return target
  end

  thread servo():
    while mode == MODE_SERVO:
      enter_critical
      if fresh:
        q = target
        fresh = False
      else:
        extrapolated = extrapolated + 1
        q = extrapolate()
      end
      servoj(q, t=steptime, lookahead_time=0.03, gain=2000)
      exit_critical
    end
    stopj(4.0)
  end

  thread speeding():
    while mode == MODE_SPEED:
      qd = speed
      speedj(qd, 40.0, steptime)
    end
    stopj(4.0)
  end

  thread commands():
    while mode > MODE_STOPPED:
      raw = socket_read_binary_integer(2, "command", 0)
      if raw[0] > 0:
        if raw[1] == 0:
          zero_ftsensor()
        elif raw[1] == 1 or
          raw[1] == 2:
          set_tool_voltage(raw[2] / SCALE)
        end
      end
    end
  end

  connected = connect("127.0.0.1", 50003, "trajectory") and connect("127.0.0.1", 50004, "command")
  if not (connected and connect("127.0.0.1", 50001, "reverse")):
    popup("not connected", error=True, blocking=True)
    halt
  end
  timeout = 0.0
  worker = run commands()
  while mode > MODE_STOPPED:
    enter_critical
    words = socket_read_binary_integer(8, "reverse", timeout)
    if words[0] > 0:
      timeout = words[1] / 1000.0
      if mode != words[8]:
        mode = words[8]
        join mover
        if mode == MODE_SERVO:
          target = get_joint_positions()
          mover = run servo()
        elif mode == MODE_SPEED:
          mover = run speeding()
        end
      end
      values = [words[2] / SCALE, words[3] / SCALE, words[4] / SCALE, words[5] / SCALE, words[6] / SCALE, words[7] / SCALE]
      if mode == MODE_SERVO and isSlowEnough(target, values, steptime):
        target = values
        fresh = True
      elif mode == MODE_SPEED:
        speed = values
      end
    else:
      textmsg("timed out after ", timeout)
      mode = MODE_STOPPED
      kill mover
      kill worker
      stopj(4.0)
      halt
    end
    exit_critical
  end
  join mover
  kill worker
  socket_close("reverse")
end
)";

/// A peer of that program, who plays the cycles and what it sends.
class ReverseSocket : public testing::Test {
protected:
    void send(int timeout_ms, double first_joint, int mode) {
        const int scaled = static_cast<int>(first_joint * 1e6);
        for (const int word : {timeout_ms, scaled, 0, 0, 0, 0, 0, mode}) {
            append("reverse", word);
        }
    }

    void append(const std::string& socket, int word) {
        for (const int shift : {24, 16, 8, 0}) {
            robot_.socket.all[socket].received +=
                static_cast<char>(static_cast<unsigned>(word) >> shift & 0xFFU);
        }
    }

    void cycles(int count) {
        for (int i = 0; i < count; ++i) {
            interpreter_.step();
        }
    }

    double lastServo() { return robot_.lastMotion<ServoJ>().joint_position[0]; }

    FakeRobot robot_;
    Interpreter interpreter_{parsed(kReverseSocket), robot_};
};

TEST_F(ReverseSocket, ConnectsInOrderAndWaitsForTheFirstMessage) {
    cycles(500);
    EXPECT_EQ(interpreter_.state(), RunState::running);
    EXPECT_EQ(robot_.socket.all.size(), 3U);
    EXPECT_TRUE(robot_.motions.empty());
}

TEST_F(ReverseSocket, TriesAgainAndTellsThatItCouldNotConnect) {
    robot_.socket.first_state = SocketState::closed;
    cycles(200);
    EXPECT_EQ(interpreter_.state(), RunState::running);
    EXPECT_EQ(robot_.popups.back().text, "not connected");
    robot_.popup_open = false;
    cycles(1);
    EXPECT_EQ(interpreter_.state(), RunState::finished);
}

TEST_F(ReverseSocket, ServesEachMessageInTheCycleInWhichItComes) {
    cycles(5);
    for (int i = 1; i <= 50; ++i) {
        send(20, 0.01 * i, 1);
        cycles(1);
        ASSERT_NEAR(lastServo(), 0.01 * i, 1e-9);
    }
    EXPECT_EQ(interpreter_.variable("extrapolated")->text(), "0");
    EXPECT_TRUE(robot_.popups.empty());
}

TEST_F(ReverseSocket, ExtrapolatesWhenOneMessageIsMissing) {
    cycles(5);
    send(40, 0.1, 1);
    cycles(1);
    robot_.now.target_joint_velocity[0] = 1.0;
    cycles(1);
    EXPECT_NEAR(lastServo(), 0.108, 1e-9);
    EXPECT_EQ(interpreter_.variable("extrapolated")->text(), "1");
    send(40, 0.116, 1);
    cycles(1);
    EXPECT_NEAR(lastServo(), 0.116, 1e-9);
}

TEST_F(ReverseSocket, StopsAndEndsWhenMessagesStayAway) {
    cycles(5);
    send(40, 0.1, 1);
    cycles(20);
    EXPECT_EQ(interpreter_.state(), RunState::finished);
    EXPECT_EQ(interpreter_.exception(), std::nullopt);
    EXPECT_EQ(robot_.lastMotion<StopJ>().acceleration, 4.0);
    EXPECT_THAT(robot_.messages, ElementsAre("timed out after 0.04"));
}

TEST_F(ReverseSocket, ChangesTheModeThroughAStop) {
    cycles(5);
    send(200, 0.1, 1);
    cycles(3);
    send(200, 0.5, 2);
    cycles(5);
    EXPECT_EQ(robot_.lastMotion<SpeedJ>().velocity[0], 0.5);
    EXPECT_TRUE(std::holds_alternative<StopJ>(robot_.motions[robot_.motions.size() - 2]) ||
                std::holds_alternative<StopJ>(robot_.motions[robot_.motions.size() - 4]));
    send(200, 0.0, -2);
    cycles(5);
    EXPECT_EQ(interpreter_.state(), RunState::finished);
    EXPECT_EQ(robot_.socket.state("reverse"), SocketState::closed);
}

TEST_F(ReverseSocket, RefusesWhatIsTooFastWithAPopup) {
    cycles(5);
    send(200, 0.1, 1);
    cycles(1);
    send(200, 3.0, 1);
    cycles(1);
    EXPECT_EQ(robot_.popups.back().text, "joint 0 needs 362.5");
    EXPECT_NEAR(lastServo(), 0.1, 1e-9);
}

TEST_F(ReverseSocket, AnswersCommandsBesideTheMotion) {
    cycles(5);
    append("command", 2);
    append("command", 24'000'000);
    send(200, 0.1, 1);
    cycles(2);
    EXPECT_EQ(robot_.lastCommand<SetToolVoltage>().voltage, 24);
}

TEST_F(ReverseSocket, EndsWhenTheSocketCloses) {
    cycles(5);
    send(0, 0.0, 0);
    cycles(5);
    robot_.socket.all["reverse"].state = SocketState::closed;
    cycles(3);
    EXPECT_EQ(interpreter_.state(), RunState::finished);
}

TEST(UrscriptSpeed, AThousandInstructionsTakeFarLessThanAMillisecond) {
    FakeRobot robot;
    Interpreter interpreter(
        parsed(within("x = 0\nwhile True:\ni = 0\nwhile i < 100:\nx = x + i * 0.5\ni = i + 1\nend\n"
                      "sync()\nend")),
        robot);
    constexpr int kCycles = 200;                      // cycles of about 1300 instructions
    auto shortest = std::chrono::nanoseconds::max();  // not held up by other work of the machine
    for (int i = 0; i < kCycles; ++i) {
        const auto begin = std::chrono::steady_clock::now();
        ASSERT_EQ(interpreter.step(), RunState::running);
        shortest =
            std::min<std::chrono::nanoseconds>(shortest, std::chrono::steady_clock::now() - begin);
    }
    const double us = std::chrono::duration<double, std::micro>(shortest).count();
    RecordProperty("microseconds_per_cycle", std::to_string(us));
    EXPECT_LT(us, 1000.0);
}

}  // namespace
}  // namespace metier::urscript
