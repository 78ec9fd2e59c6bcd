#pragma once

#include <array>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "metier/cell/settings.hpp"
#include "metier/link/tcp_link.hpp"
#include "reserved_port.hpp"
#include "wire_bytes.hpp"

namespace metier::ur_driver {

/// As much of a UR controller as the driver talks to, on four loopback ports, with everything that
/// can go wrong. Written from docs/protocols/ur.md with an encoding of its own.
///
/// The arm follows exactly, one cycle late. A cycle takes 8 ms, or longer where the computer is
/// late: cycles that are past are not made up for, and while a program moves the arm, the
/// controller is at most three cycles ahead of the set-points.
class FakeController {
public:
    /// Properties and faults of the controller; change them with set().
    struct Knobs {
        // the arm
        std::int32_t robot_mode = 7;
        std::int32_t safety_mode = 1;
        double slider = 1.0;
        double scaling = 1.0;
        bool follows = true;        ///< target_q follows what the script took
        bool takes = true;          ///< the script reads the registers
        bool starts = true;         ///< an uploaded script starts
        bool obeys = true;          ///< the script ends when its token is gone
        bool pause_on_stop = true;  ///< a safety stop pauses the program
        std::int32_t runtime = 1;   ///< runtime_state
        double coasting = 0.0;      ///< speed of axis 1, independent of the script [rad/s]
        // RTDE
        bool accepts_version = true;
        bool accepts_start = true;
        bool silent = false;  ///< answers nothing, sends no data
        bool answers_recipes = true;
        std::uint32_t major = 3;
        std::set<std::string> unknown;
        std::set<std::string> in_use;
        std::vector<std::byte> garbage;          ///< sent once instead of a data package
        int skip_cycles = 0;                     ///< so many data packages are left out
        std::vector<std::byte> instead_of_data;  ///< sent in each cycle, if it is not empty
        char answers_start_as = 'S';             ///< type of the answer to a start
        // dashboard
        std::string remote_control = "true";
        std::string unlock_reply = "Protective stop releasing";
        bool unlocks = true;  ///< does what it answered
        bool powers_on = true;
        bool stops = true;
        std::string power_reply = "Powering on";
        std::string brake_reply = "Brake releasing";
        std::string stop_reply = "Stopped";
        bool mute = false;  ///< greets, but answers nothing
        // primary
        std::array<double, 6> a{0, -0.425, -0.39225, 0, 0, 0};
        double max_velocity = 3.3416;
    };

    FakeController();
    /// \param knobs before anyone can connect
    explicit FakeController(const Knobs& knobs);
    ~FakeController();

    /// The settings of a driver that finds it, with time-outs for a busy machine.
    std::map<std::string, cell::Settings::Value> settings() const;

    void set(const std::function<void(Knobs&)>& change);
    /// Waits until it is so, looked at in every cycle; false if that took 10 s.
    bool await(const std::function<bool()>& reached);

    /// Breaks all connections; nobody can connect again before listen().
    void switchOff();
    void listen();
    /// Sends an error to every client of the primary interface.
    void sayError(std::int32_t code, std::int32_t argument, const std::string& text);
    void breakRtde();

    int uploads() const;
    std::string script() const;
    std::array<double, 6> target() const;
    bool programRuns() const;
    /// Bytes of the set-point package that came last.
    std::vector<std::byte> lastInput() const;
    std::vector<std::string> commands() const;
    bool paused() const;

private:
    using Serve = void (FakeController::*)(link::TcpLink&, const std::stop_token&);

    void accept(std::size_t index, Serve serve, const std::stop_token& stop);
    void serveRtde(link::TcpLink& link, const std::stop_token& stop);
    void servePrimary(link::TcpLink& link, const std::stop_token& stop);
    void serveScript(link::TcpLink& link, const std::stop_token& stop);
    void serveDashboard(link::TcpLink& link, const std::stop_token& stop);

    std::vector<std::byte> answerAll(std::vector<std::byte>& received);
    std::vector<std::byte> answer(std::uint8_t type, const std::vector<std::byte>& payload);
    std::vector<std::byte> setUp(const std::string& names, std::size_t skip, bool outputs);
    void takeInput(const std::vector<std::byte>& payload);
    bool ahead() const;
    void step();
    /// A data package, if it is time for one and no more than a few are unanswered.
    std::vector<std::byte> dueData(SteadyTime& tick);
    void runScript();
    std::vector<std::byte> dataPackage();
    std::string obey(const std::string& command);

    static constexpr std::size_t kPorts = 4;  // rtde, primary, script, dashboard

    mutable std::mutex mutex_;
    std::condition_variable cycled_;
    Knobs knobs_;
    std::array<std::unique_ptr<link::TcpListener>, kPorts> listeners_;
    const std::array<ReservedPort, kPorts> ports_{};  // also while it is switched off
    std::uint64_t generation_ = 0;                    // a new one breaks every connection
    std::uint64_t rtde_generation_ = 0;

    std::vector<std::string> outputs_;
    bool streaming_ = false;
    int unanswered_ = 0;  // data packages since the last set-point
    double timestamp_ = 100.0;
    std::array<double, 6> q_{0.1, -1.3, 1.7, -2.0, -1.5, 0.2};
    std::array<double, 6> actual_ = q_;
    std::array<double, 6> velocity_{};
    std::int32_t token_register_ = 0;
    std::int32_t counter_register_ = 0;
    std::array<double, 6> position_register_{};
    std::int32_t out_token_ = 0;
    std::int32_t out_counter_ = 0;
    std::int32_t script_token_ = 0;
    int script_silence_ = 0;
    int uploads_ = 0;
    std::string script_;
    std::vector<std::byte> last_input_;
    std::vector<std::vector<std::byte>> to_say_;
    std::vector<std::string> commands_;

    std::vector<std::jthread> threads_;  // end before what they use
};

}  // namespace metier::ur_driver
