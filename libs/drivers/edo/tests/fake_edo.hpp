#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace metier::edo_driver::testing {

/// Ways in which a robot can misbehave. All off: it obeys.
struct FakeFaults {
    bool drop_init = false;
    bool drop_reset = false;
    bool drop_moves = false;
    bool drop_set_points = false;
    bool refuse_control = false;       ///< answers 1
    bool grant_without_doing = false;  ///< answers 0 and goes on as before
    bool keep_control = false;         ///< answers 0 to a giving back and does nothing
    bool mute_services = false;
    bool mute_joints = false;
    bool mute_machine = false;
    bool mute_algorithm = false;
    bool null_positions = false;
    bool brakes_stay_closed = false;  ///< a reset ends in BRAKED again
    bool restless = false;            ///< reports velocities of joints that stand still
    bool believes_in_jaws = false;    ///< jaws that are blocked move on, as it thinks
    bool drop_cancels = false;
    int move_feedback = 0;  ///< instead of received: a negative type
};

/// A rosbridge server in front of an e.DO, as far as the tests need it: a state machine, joints
/// that follow set-points at once, jaws that a part stops. Written from the protocol's description
/// (docs/protocols/edo.md). Units are those of the wire.
///
/// Threading: one thread.
class FakeEdo {
public:
    using Send = std::function<void(std::string)>;

    FakeEdo(std::string version, Send send)
        : software(std::move(version)), send_(std::move(send)) {}

    void receive(std::string_view text);
    /// 10 ms of the robot.
    void tick();
    /// As after a power cycle.
    void restart();
    void brake(std::uint32_t bits);

    bool classic() const;

    std::string software;
    FakeFaults faults;
    std::size_t joint_count = 7;
    std::array<double, 7> joints{0, 10, 90, 0, 80, 0, 40};  ///< [deg], [mm]
    std::array<double, 7> currents{};
    double part = -1.0;       ///< jaws stop there [mm]; none if negative
    double jaw_speed = 40.0;  ///< [mm/s]
    double longest_step = 0;  ///< largest change of an axis by one set-point [deg]
    std::uint8_t state = 2;
    std::uint32_t opcode = 0;
    bool uncalibrated = false;
    bool control_taken = false;
    int switched_off_state = 9;       ///< value of /algorithm_state, in older software
    bool tells_switched_off = false;  ///< although older software does not
    int set_points = 0;
    int set_points_while_not_taken = 0;
    std::vector<std::string> received;  ///< everything but set-points

    int count(std::string_view part_of_text) const;

private:
    void onPublish(const std::string& topic, const void* message);
    void onCall(const std::string& id, const std::string& service, int mode);
    void onSetPoint(const std::vector<double>& positions);
    void finishCommand();
    void moveJaws();
    void publish(std::string_view topic, const std::string& message);
    void publishJoints();
    int algorithmState() const;

    Send send_;
    std::array<double, 7> last_ = joints;
    std::uint64_t ticks_ = 0;
    int command_ticks_ = 0;
    std::uint8_t command_result_ = 0;
    double jaw_target_ = 40.0;
    bool moving_ = false;
};

}  // namespace metier::edo_driver::testing
