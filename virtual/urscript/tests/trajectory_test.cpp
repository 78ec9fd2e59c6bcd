#include <gmock/gmock.h>

#include "fake_robot.hpp"

namespace metier::urscript {
namespace {

// A thread that reads points from a socket and drives splines through them.
constexpr const char* kTrajectory = R"(
def trajectory():
  global points_left = 2
  global spline_qd = [0, 0, 0, 0, 0, 0]
  SCALE = 1000000

  def spline(end_q, end_qd, time, is_last=False):
    local start_q = get_joint_positions()
    if time <= 0.0:
      return False
    end
    local c2 = (-3 * start_q + end_q * 3 - spline_qd * 2 * time - end_qd * time) / pow(time, 2)
    local c3 = (2 * start_q - 2 * end_q + spline_qd * time + end_qd * time) / pow(time, 3)
    runSpline(spline_qd, c2, c3, time)
    return True and (is_last == False)
  end

  def runSpline(c1, c2, c3, total):
    local done = 0.0
    while (total - done) > get_steptime() * 0.5:
      done = done + get_steptime()
      local last_qd = spline_qd
      spline_qd = c1 + 2.0 * done * c2 + 3.0 * pow(done, 2) * c3
      speedj(spline_qd, largest((spline_qd - last_qd) / get_steptime()), get_steptime())
    end
  end

  def largest(list):
    local length = get_list_length(list)
    local max = norm(list[0])
    local i = 1
    while i < length:
      if norm(list[i]) > max:
        max = norm(list[i])
      end
      i = i + 1
    end
    return max
  end

  thread follow():
    while points_left > 0:
      local raw = socket_read_binary_integer(8, "points", 0.5)
      points_left = points_left - 1
      if raw[0] > 0:
        local q = [raw[1], raw[2], raw[3], raw[4], raw[5], raw[6]] / SCALE
        if raw[8] == 0:
          movej(q, t = raw[7] / SCALE, r = 0.0)
        else:
          spline(q, [0, 0, 0, 0, 0, 0], raw[7] / SCALE, points_left == 0)
        end
      else:
        textmsg("no point")
      end
    end
    socket_send_int(0, "points")
  end

  follower = 0
  kill follower
  follower = run follow()
  join follower
end
)";

TEST(UrscriptPrograms, ATrajectoryOfPointsIsDrivenThrough) {
    FakeRobot robot;
    FakeSockets::Socket& points = robot.socket.all["points"];
    points.state = SocketState::open;
    const auto append = [&](std::initializer_list<unsigned> words) {
        for (const unsigned word : words) {
            for (const unsigned shift : {24U, 16U, 8U, 0U}) {
                points.received += static_cast<char>(word >> shift & 0xFFU);
            }
        }
    };
    append({500'000, 0, 0, 0, 0, 0, 2'000'000, 0});
    append({100'000, 0, 0, 0, 0, 0, 800'000, 1});
    Interpreter interpreter(parsed(kTrajectory), robot);
    double travelled = 0.0;
    for (int i = 0; i < 300 && interpreter.step() == RunState::running; ++i) {
        if (const auto* speed = std::get_if<SpeedJ>(&robot.motions.back())) {
            travelled += speed->velocity[0] * robot.step_time;
        }
    }
    EXPECT_EQ(interpreter.state(), RunState::finished);
    EXPECT_EQ(interpreter.exception(), std::nullopt);
    EXPECT_EQ(std::get<MoveJ>(robot.motions.front()).time, 2.0);
    EXPECT_EQ(robot.motions.size(), 101U);  // one move, and 0.8 s of cycles
    EXPECT_NEAR(travelled, 0.1, 1e-3);
    EXPECT_NEAR(robot.lastMotion<SpeedJ>().velocity[0], 0.0, 1e-9);
    EXPECT_EQ(points.sent, std::string(4, '\0'));
}

}  // namespace
}  // namespace metier::urscript
