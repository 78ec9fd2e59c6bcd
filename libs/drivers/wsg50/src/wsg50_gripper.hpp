#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "conversation.hpp"
#include "metier/device/driver.hpp"
#include "metier/device/gripper.hpp"

namespace metier::wsg50_driver {

/// Options of the driver for one gripper.
struct Wsg50Options {
    std::string name;
    std::string host;
    std::uint16_t port = 1000;
    ConversationOptions conversation;
    double speed = 0.1;         ///< speed of moves and releases without a requested speed [m/s]
    double grasp_speed = 0.05;  ///< speed of grasps without a requested speed [m/s]
    /// Width of the part for grasps without a requested width [m]; empty: any width.
    std::optional<double> part_width{};
    std::optional<double> force{};  ///< limit of motions that ask for none [N]; not set: as found
    std::optional<double> open_width{};  ///< width of releases without a requested width [m];
                                         ///< empty: the stroke
};

/// Reads `settings`: port, update_period, silence_periods, speed, grasp_speed, part_width, force,
/// open_width, acceleration, motion_timeout, acknowledge_on_connect, home_on_connect.
/// Errors: invalid_argument for all that is wrong.
Result<Wsg50Options> readOptions(const device::OpenRequest& request);

/// A Weiss WSG 50 gripper over TCP. Connects, and connects again, by itself.
///
/// A fault that the gripper shows stays until resetFault(), which acknowledges it and, if the
/// gripper is not referenced, homes it. info() holds the usual limits until the first connection.
class Wsg50Gripper final : public device::Gripper {
public:
    explicit Wsg50Gripper(Wsg50Options options);
    /// Stops a motion and takes leave of the gripper, so that it does not fall into a fault.
    ~Wsg50Gripper() override;
    Wsg50Gripper(const Wsg50Gripper&) = delete;
    Wsg50Gripper& operator=(const Wsg50Gripper&) = delete;

    const device::GripperInfo& info() const noexcept override;
    device::GripperState state() const noexcept override;
    device::Safety safety() const override;
    Result<void> grasp(const device::GripperRequest& request, Done done) override;
    Result<void> release(const device::GripperRequest& request, Done done) override;
    Result<void> move(const device::GripperRequest& request, Done done) override;
    void stop() noexcept override;
    Result<void> resetFault() override;
    device::Registration onSafetyChange(SafetyCallback callback) override;

private:
    class Session;

    std::unique_ptr<Session> session_;
};

}  // namespace metier::wsg50_driver
