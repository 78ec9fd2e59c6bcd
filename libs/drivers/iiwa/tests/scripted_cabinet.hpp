#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "metier/link/tcp_link.hpp"
#include "metier/motion/robot_model.hpp"

namespace metier::iiwa_driver {

inline motion::RobotModel iiwa7() {
    return motion::RobotModel::load(std::string(METIER_MODELS_DIR) + "/iiwa7.toml").value();
}

/// Replacement of a cabinet's robot application in tests: connects, reads one command at a time,
/// answers each with one state. Written from the protocol's description alone.
class ScriptedCabinet {
public:
    using Numbers = std::array<double, 8>;

    /// Behaviour from now on. Changed by change().
    struct Behaviour {
        bool ready = true;
        bool ready_while_moving = true;
        std::set<int> refused{};      ///< codes that are not executed
        bool ignores_moves = false;   ///< executes them without moving, in silence
        bool does_not_start = false;  ///< a motion stays active, the arm stands
        int error_of_next_move = 0;   ///< noted, for ever
        double contact_after =
            std::numeric_limits<double>::infinity();  ///< way until a contact [rad]
        double contact_force = 50.0;                  ///< along z of the flange [N]
        double tool_length = 0.0;                     ///< length of an attached tool, along z [m]
        int dies_at = -1;                             ///< closes instead of answering this code
        double speed = 2.0;                           ///< speed of every axis [rad/s]
        /// Changes the bytes of the next answers.
        std::function<void(std::vector<std::byte>&)> tamper{};
    };

    struct Options {
        bool double_precision = false;
        std::chrono::milliseconds delay{0};  ///< delay of each answer
        Behaviour behaviour{};               ///< at first
    };

    ScriptedCabinet(std::uint16_t port, const Options& options);
    explicit ScriptedCabinet(std::uint16_t port);
    ~ScriptedCabinet();
    ScriptedCabinet(const ScriptedCabinet&) = delete;
    ScriptedCabinet& operator=(const ScriptedCabinet&) = delete;

    void change(const std::function<void(Behaviour&)>& how);
    /// Every command so far but those that only ask for the state.
    std::vector<Numbers> commands() const;
    /// The codes of commands().
    std::vector<int> codes() const;
    motion::JointVector position() const;
    bool moving() const;
    /// Why the application ended; empty while it runs.
    std::string ended() const;
    /// Cuts the connection.
    void die();

    static constexpr std::array kHome{0.0, 0.5, 0.0, -1.5, 0.0, 1.0, 0.0};

private:
    using Clock = std::chrono::steady_clock;

    void run(const std::stop_token& stop);
    /// Whether it goes on.
    bool serveOne();
    void execute(const Numbers& command);
    bool executeMove(const Numbers& command);
    void startTo(const motion::JointVector& target);
    void advance();
    std::vector<std::byte> state(bool executed) const;
    std::array<double, 6> pose() const;
    void end(std::string why);

    const Options options_;
    const motion::RobotModel model_ = iiwa7();
    link::TcpLink link_;

    mutable std::mutex mutex_;
    Behaviour behaviour_;
    std::vector<Numbers> commands_;
    std::string ended_;
    motion::JointVector position_;
    motion::JointVector target_;
    motion::JointVector velocity_;
    double way_ = 0.0;
    bool active_ = false;
    bool condition_met_ = false;
    std::array<double, 3> thresholds_{};
    int motion_type_ = 21;
    int interface_ = 31;
    int last_error_ = -10;
    bool executed_ = false;
    Clock::time_point advanced_ = Clock::now();

    std::jthread thread_;
};

}  // namespace metier::iiwa_driver
