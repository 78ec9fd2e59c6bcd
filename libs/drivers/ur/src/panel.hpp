#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <thread>

#include "dashboard_reset.hpp"
#include "metier/base/queue.hpp"
#include "metier/device/reset_slot.hpp"
#include "metier/link/tcp_link.hpp"
#include "servoj_script.hpp"
#include "streamer.hpp"

namespace metier::ur_driver {

/// A job that takes long and is therefore done on a thread of its own.
struct PanelJob {
    enum class Kind : std::uint8_t { upload, stop_program };
    Kind kind{};
    std::int32_t token = 0;  ///< token of the script to upload
};

using PanelJobs = Queue<PanelJob>;

/// Uploads scripts and stands in for a person at the pendant, one job after another.
class Panel {
public:
    /// \param refused called with the token of a script that could not be uploaded, after the
    ///                reporter has got the reason
    /// \param newest  returns the newest data package of the controller
    struct Parts {
        PanelJobs& jobs;
        device::ResetSlot& resets;
        SafetyReporter& reporter;
        std::function<void(std::int32_t token)> refused;
        std::function<Observation()> newest;
    };

    Panel(Parts parts, DashboardReset::Peer peer, const UrSettings& settings);

private:
    void run(const std::stop_token& stop);
    void handle(const PanelJob& job);
    Result<void> upload(std::int32_t token);
    Result<void> checkRemoteControl() const;
    void drain();

    const Parts parts_;
    const DashboardReset::Peer peer_;
    const UrSettings settings_;
    DashboardReset dashboard_reset_;
    /// Kept open and read for a while: a close with unread bytes could discard the script.
    std::optional<link::TcpLink> script_link_;
    SteadyTime close_script_link_{};
    std::jthread thread_;
};

}  // namespace metier::ur_driver
