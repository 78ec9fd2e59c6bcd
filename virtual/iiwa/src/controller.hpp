#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "metier/virtual_controller/controller.hpp"
#include "metier/virtual_controller/cycle_timer.hpp"
#include "metier/virtual_controller/standing_time.hpp"
#include "metier/virtual_controller/tcp_dialer.hpp"
#include "robot_application.hpp"

namespace metier::virtual_iiwa {

/// Options from the settings (README.md).
struct Options {
    std::string pc_address;
    std::uint16_t pc_port = 12225;
    Precision precision = Precision::single_precision;
    bool redial = true;
    double redial_delay = 1.0;    ///< [s]
    double answer_delay = 0.002;  ///< [s]
    double force_noise = 0.0;     ///< standard deviation [N], [Nm]
    double torque_noise = 0.0;    ///< standard deviation of the axes' torque [Nm]
    motion::JointVector start;    ///< joint position when power comes [rad]
};

/// A Sunrise cabinet whose robot application connects to the PC.
class IiwaController final : public virtual_controller::Controller {
public:
    static Result<std::unique_ptr<IiwaController>> start(
        const virtual_controller::ControllerRequest& request);

    std::vector<virtual_controller::InjectionHelp> injections() const override;
    Result<void> inject(const virtual_controller::Injection& injection) override;
    nlohmann::ordered_json state() const override;
    void restart() override;

private:
    IiwaController(const virtual_controller::ControllerRequest& request, Options options);

    Result<void> makeDialer(const virtual_controller::ControllerRequest& request);
    void connected(virtual_controller::TcpPeer& peer);
    void received(std::span<const std::byte> bytes);
    void takeCommands();
    void answer();
    void endApplication();
    /// Errors: invalid_argument, no mode of a cabinet.
    Result<void> selectMode(const std::string& mode);
    void redialLater();
    void cycle();
    void stepArm();
    void stepAnswer();

    const Options options_;
    virtual_controller::WorldLink& world_;
    Cabinet cabinet_;
    double time_ = 0.0;  ///< the cabinet's own, by its cycles [s]
    std::optional<RobotApplication> application_;
    virtual_controller::TcpPeer* pc_ = nullptr;
    std::vector<std::byte> received_;  // not yet read by the application
    std::optional<RobotApplication::Answer> due_;
    int answer_cycles_ = 0;  // cycles until the answer is sent
    int redial_cycles_ = 0;  // cycles until the next connection attempt; 0: none
    bool silent_ = false;
    std::uint64_t answers_ = 0;
    std::string last_failure_;
    std::mt19937 random_{1};
    std::normal_distribution<double> normal_;
    std::unique_ptr<virtual_controller::TcpDialer> dialer_;
    virtual_controller::StandingTime standing_;
    virtual_controller::CycleTimer timer_;
};

}  // namespace metier::virtual_iiwa
