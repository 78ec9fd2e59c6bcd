// A program that clients command by RTDE registers: with functions inside, threads that move the
// arm, and answers in registers.
#include <gmock/gmock.h>

#include "robot_fixture.hpp"

namespace metier::virtual_ur {
namespace {

using testing::DoubleNear;
using testing::Each;
using testing::ElementsAre;
using testing::Pointwise;

// In the shape of ur_rtde's rtde_control.script, in our own words.
constexpr std::string_view kCommands = R"(def commanded():
    global first = 24
    global goal = p[0, 0, 0, 0, 0, 0]
    global goal_speed = 0.1
    global goal_acceleration = 0.5
    global goal_blend = 0
    global chasing = 0
    global chase_thrd = 0
    global joint_thrd = 0
    global move_thrd = 0
    global force_thrd = 0
    global selection = [0, 0, 0, 0, 0, 0]

    def number(index):
        return read_input_float_register(index + first)
    end

    def pose_from_registers(index):
        pose = p[0, 0, 0, 0, 0, 0]
        pose[0] = number(index + 0)
        pose[1] = number(index + 1)
        pose[2] = number(index + 2)
        pose[3] = number(index + 3)
        pose[4] = number(index + 4)
        pose[5] = number(index + 5)
        return pose
    end

    def tell_six(six):
        i = 0
        while i < 6:
            write_output_float_register(i + first, six[i])
            i = i + 1
        end
    end

    def scaled(p, factor):
        p[0] = p[0] * factor
        return p
    end

    thread chase_thread():
        while (True):
            servoc(goal, a=goal_acceleration, v=goal_speed, r=goal_blend)
        end
    end

    thread move_thread():
        while (True):
            movel(goal, a=goal_acceleration, v=goal_speed)
            enter_critical
            move_thrd = 0
            exit_critical
            break
        end
    end

    thread force_thread():
        while (True):
            force_mode(goal, selection, [0, 0, 0, 0, 0, 0], 2, [0, 0, 0, 0, 0, 0])
            sync()
        end
    end

    def obey():
        cmd = read_input_integer_register(first)

        if cmd == 1:
            async = read_input_integer_register(first + 1)
            textmsg("async: ", async)
            enter_critical
            goal = pose_from_registers(0)
            exit_critical
            if async == 1:
                move_thrd = run move_thread()
            else:
                movel(goal, a=goal_acceleration, v=goal_speed)
            end
        elif cmd == 2:
            enter_critical
            goal = pose_from_registers(0)
            exit_critical
            if chasing == 0:
                chasing = 1
                if chase_thrd == 0:
                    global chase_thrd = run chase_thread()
                end
            end
        elif cmd == 3:
            enter_critical
            chasing = 0
            kill joint_thrd
            kill chase_thrd
            chase_thrd = 0
            exit_critical
            stopl(2)
        elif cmd == 4:
            waypoint = get_target_waypoint()
            tell_six(waypoint)
        elif cmd == 5:
            type = read_input_integer_register(first + 1)
            if type == 0:
                safe = is_within_safety_limits(pose_from_registers(0))
            else:
                p = pose_from_registers(0)
                safe = is_within_safety_limits([p[0], p[1], p[2], p[3], p[4], p[5]])
            end
            if safe == True:
                write_output_integer_register(first + 1, 1)
            else:
                write_output_integer_register(first + 1, 0)
            end
        elif cmd == 6:
            set_payload(1.5, get_target_payload_cog())
            textmsg(get_target_payload())
            tell_six(get_target_payload_inertia())
            write_output_integer_register(first + 1, get_freedrive_status())
        elif cmd == 7:
            textmsg("protective_stop")
            protective_stop()
            textmsg("protective_stop done")
        elif cmd == 8:
            selection[2] = 1
            if force_thrd == 0:
                global force_thrd = run force_thread()
            end
        elif cmd == 9:
            kill force_thrd
            force_thrd = 0
            end_force_mode()
            p = pose_trans(scaled(get_forward_kin(), 2), pose_inv(get_tcp_offset()))
            textmsg(p)
            write_output_float_register(first, time_of(p))
        end
        return cmd != 255
    end

    def time_of(p):
        time = norm(pose_sub(p, p))
        if time > 0.001:
            return time
        end
        return get_steptime()
    end

    force_mode_set_gain_scaling(0.5)
    force_mode_set_damping(0.025)
    keep_running = True
    busy = False
    while keep_running:
        if read_input_integer_register(first) == 0:
            busy = False
            write_output_integer_register(first, 1)
        elif not busy:
            keep_running = obey()
            write_output_integer_register(first, 2)
            busy = True
        end
        sync()
    end
end
)";

/// A robot on which the program runs.
class RegisterCommands : public testing::Test {
protected:
    RegisterCommands() {
        table_.robot.takeScript(kCommands);
        table_.cycles(2);
    }

    /// Gives a command with six numbers and waits until it was obeyed.
    bool command(std::int32_t number, const Vector6& six = {}, std::int32_t detail = 0) {
        auto inputs = table_.robot.rtdeInputs();
        inputs.registers.integers[kFirst] = 0;
        const auto& told = state().outputs.integers[kFirst];
        if (!table_.until([&] { return told == 1; }, 1.0)) {
            return false;
        }
        inputs.registers.integers[kFirst] = number;
        inputs.registers.integers[kFirst + 1] = detail;
        std::copy(six.begin(), six.end(), inputs.registers.numbers.begin() + kFirst);
        return table_.until([&] { return told == 2; }, 10.0);
    }
    Vector6 toldSix() const {
        Vector6 six{};
        std::copy_n(state().outputs.numbers.begin() + kFirst, six.size(), six.begin());
        return six;
    }
    /// The tool pose now, moved by so much along x of the base [m].
    Vector6 beside(double x) const {
        auto pose = state().target_tcp_pose;
        pose[0] += x;
        return pose;
    }
    const RobotState& state() const { return table_.robot.state(); }

    static constexpr std::size_t kFirst = 24;
    RobotOnTable table_{"ur5e"};
};

TEST_F(RegisterCommands, RunUntilTheyAreEnded) {
    ASSERT_EQ(state().runtime_state, RuntimeState::playing);
    EXPECT_TRUE(command(8));
    EXPECT_TRUE(command(9));
    EXPECT_NEAR(toldSix()[0], 0.002, 1e-9);
    EXPECT_TRUE(command(255));
    EXPECT_TRUE(table_.runtimeBecomes(RuntimeState::stopped));
    EXPECT_FALSE(table_.wasReported(10, ""));  // a runtime exception
}

TEST_F(RegisterCommands, ServocDrivesTheToolToAPoseThatChanges) {
    const auto start = state().target_tcp_pose;
    ASSERT_TRUE(command(2, beside(0.1)));
    double fastest = 0.0;
    for (int i = 0; i < 300; ++i) {
        table_.cycles(1);
        fastest = std::max(fastest, state().target_tcp_speed[0]);
    }
    EXPECT_NEAR(fastest, 0.1, 1e-3);
    auto turned = start;
    turned[0] += 0.02;
    turned[1] += 0.05;
    ASSERT_TRUE(command(2, turned));
    ASSERT_TRUE(table_.until([&] { return state().target_qd == Vector6{}; }, 5.0));
    EXPECT_THAT(state().target_tcp_pose, Pointwise(DoubleNear(1e-6), turned));
    EXPECT_EQ(state().safety_mode, SafetyMode::normal);
    ASSERT_TRUE(command(3));
    EXPECT_EQ(state().runtime_state, RuntimeState::playing);
}

TEST_F(RegisterCommands, ServocThatIsStoppedOnItsWayComesToRest) {
    ASSERT_TRUE(command(2, beside(0.2)));
    table_.seconds(0.5);
    EXPECT_GT(state().target_tcp_speed[0], 0.05);
    ASSERT_TRUE(command(3));
    EXPECT_EQ(state().target_qd, Vector6{});
    EXPECT_EQ(state().safety_mode, SafetyMode::normal);
}

TEST_F(RegisterCommands, TheTargetWaypointIsThatOfTheMoveOrThePoseOfTheTool) {
    ASSERT_TRUE(command(4));
    EXPECT_THAT(toldSix(), Pointwise(DoubleNear(1e-9), state().target_tcp_pose));
    const auto goal = beside(0.1);
    ASSERT_TRUE(command(1, goal, 1));
    table_.cycles(10);
    ASSERT_TRUE(command(4));
    EXPECT_THAT(toldSix(), Pointwise(DoubleNear(1e-9), goal));
    EXPECT_LT(state().target_tcp_pose[0], goal[0] - 0.05);
    ASSERT_TRUE(table_.until([&] { return state().target_tcp_pose[0] > goal[0] - 1e-6; }));
}

TEST_F(RegisterCommands, PosesAndJointsAreWithinTheLimitsOrNot) {
    const auto& told = state().outputs.integers[kFirst + 1];
    ASSERT_TRUE(command(5, beside(0.05), 0));
    EXPECT_EQ(told, 1);
    ASSERT_TRUE(command(5, beside(3.0), 0));
    EXPECT_EQ(told, 0);
    ASSERT_TRUE(command(5, state().target_q, 1));
    EXPECT_EQ(told, 1);
    auto far = state().target_q;
    far[3] = -7.0;
    ASSERT_TRUE(command(5, far, 1));
    EXPECT_EQ(told, 0);
}

TEST_F(RegisterCommands, ThePayloadAndItsInertiaAreToldBack) {
    table_.robot.takeScript(
        "sec p():\n  set_target_payload(1, [0, 0, 0.1], [1, 2, 3, 0, 0, 0.5])\nend\n");
    table_.cycles(1);
    ASSERT_TRUE(command(6));
    EXPECT_THAT(toldSix(), ElementsAre(1, 2, 3, 0, 0, 0.5));
    EXPECT_EQ(state().payload, 1.5);
    EXPECT_THAT(state().payload_cog, ElementsAre(0, 0, 0.1));
    EXPECT_EQ(state().outputs.integers[kFirst + 1], 0);
}

TEST_F(RegisterCommands, AProtectiveStopThatTheProgramAsksForPausesIt) {
    ASSERT_TRUE(command(2, beside(0.2)));
    table_.seconds(0.5);
    (void)command(7);
    EXPECT_EQ(state().safety_mode, SafetyMode::protective_stop);
    ASSERT_TRUE(table_.runtimeBecomes(RuntimeState::paused));
    EXPECT_THAT(state().target_qd, Each(0.0));
    EXPECT_TRUE(table_.wasReported(6, "Protective stop: the program asked for it"));
}

TEST(SecondaryProgram, MayAskForAProtectiveStop) {
    RobotOnTable table("ur5", {{"unlock_delay", 0.0}});
    table.robot.takeScript("def p():\n  speedj([0.5, 0, 0, 0, 0, 0], 2, 20)\nend\n");
    table.seconds(0.5);
    table.robot.takeScript("sec s():\n  protective_stop()\nend\n");
    table.cycles(1);
    EXPECT_EQ(table.robot.state().safety_mode, SafetyMode::protective_stop);
    ASSERT_TRUE(table.runtimeBecomes(RuntimeState::paused));
    ASSERT_TRUE(table.robot.unlock());
    table.cycles(1);
    ASSERT_TRUE(table.robot.play());
    ASSERT_TRUE(table.runtimeBecomes(RuntimeState::playing));
}

// As URCL's tests cause one.
TEST(ALine, MayAskForAProtectiveStop) {
    RobotOnTable table;
    table.robot.takeScript("protective_stop()\n");
    table.cycles(1);
    EXPECT_EQ(table.robot.state().safety_mode, SafetyMode::protective_stop);
    ASSERT_TRUE(table.runtimeBecomes(RuntimeState::stopped));
}

TEST(Powerdown, EndsTheProgramThatAsksForIt) {
    RobotOnTable table;
    table.robot.takeScript("def p():\n  powerdown()\n  while True:\n    sync()\n  end\nend\n");
    table.cycles(1);
    EXPECT_TRUE(table.wasReported(7, "PROGRAM_XXX_STOPPEDp"));
    ASSERT_TRUE(
        table.until([&] { return table.robot.state().robot_mode == RobotMode::power_off; }, 1.0));
    EXPECT_EQ(table.robot.state().runtime_state, RuntimeState::stopped);
}

}  // namespace
}  // namespace metier::virtual_ur
