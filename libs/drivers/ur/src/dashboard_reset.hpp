#pragma once

#include <functional>
#include <stop_token>
#include <string>

#include "controller_state.hpp"
#include "dashboard.hpp"
#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"
#include "safety_reporter.hpp"
#include "ur_settings.hpp"

namespace metier::ur_driver {

/// The newest data package. Trivially copyable.
struct Observation {
    ControllerState state;
    bool connected = false;
    bool standing = false;
};

/// Takes the steps at the dashboard that need no person, so that the arm may move again.
///
/// Threading: one thread; calls wait for as long as the controller needs.
class DashboardReset {
public:
    struct Peer {
        std::string name;  ///< name of the device
        std::string host;
    };

    /// \param newest any thread; does not wait
    DashboardReset(Peer peer, const UrSettings& settings, std::function<Observation()> newest,
                   SafetyReporter& reporter);

    /// Unlocks a protective stop, closes popups, ends a paused program, powers on if the settings
    /// allow it, and forgets why the driver stopped.
    /// Errors: device_fault, connection_lost, timeout: the text says what a person has to do.
    Result<void> run(const std::stop_token& stop);

    /// Stops the program at the dashboard. Errors: connection_lost, timeout, device_fault.
    Result<void> stopProgram();

private:
    Result<void> leaveSafetyStop(const std::stop_token& stop);
    Result<void> unlock(const std::stop_token& stop);
    Result<void> powerOn(const std::stop_token& stop);
    Result<void> endPausedProgram(const std::stop_token& stop);
    Result<void> checkSlider() const;
    Result<dashboard::Client> dial() const;
    /// Errors: timeout with `what`.
    Result<void> await(const std::function<bool(const ControllerState&)>& reached,
                       std::chrono::nanoseconds time, const std::string& what,
                       const std::stop_token& stop) const;
    /// Gives a command; any failure of it is a device_fault.
    Result<void> command(dashboard::Client& client, std::string_view text,
                         std::string_view expected) const;
    tl::unexpected<Error> refuse(const std::string& why) const;

    const Peer peer_;
    const UrSettings settings_;
    const std::function<Observation()> newest_;
    SafetyReporter& reporter_;
};

}  // namespace metier::ur_driver
