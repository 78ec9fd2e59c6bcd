#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"
#include "metier/configuration/cell.hpp"
#include "metier/process/child_process.hpp"

namespace metier::app {

/// The servers and virtual controllers of a cell as child processes of this one; they end with it.
///
/// Threading: one thread.
class CellRunner {
public:
    struct Running {
        std::string name;
        std::string url;  ///< opc.tcp://..., as the server told it
    };
    /// Called when a server is ready, for progress on the terminal.
    using OnReady = std::function<void(const Running&)>;

    /// Starts the virtual controllers, the devices' servers, then what builds on them, and waits
    /// until each is ready.
    /// \param ports  free: every server takes a free port instead of its configured one, every
    ///              virtual controller a free address of this machine
    /// Errors: what the first server that did not become ready in 30 s had to say.
    enum class Ports { configured, free };
    static Result<CellRunner> start(const configuration::CellConfig& cell, Ports ports,
                                    const OnReady& on_ready);

    const std::vector<Running>& servers() const noexcept { return running_; }
    /// Addresses of the virtual controllers, by name.
    const std::map<std::string, std::string>& virtualControllers() const noexcept {
        return virtual_addresses_;
    }

    /// Waits for a server to end or for the descriptor to become readable.
    /// \return the name and exit status of a server that ended; nothing if it was the descriptor
    struct Ended {
        std::string name;
        int status = 0;
    };
    std::optional<Ended> waitForEnd(int wake_descriptor);

private:
    CellRunner() = default;
    Result<void> startServer(const configuration::CellConfig& cell,
                             const configuration::ServerConfig& server, Ports ports);
    Result<void> startVirtual(const configuration::CellConfig& cell,
                              const configuration::VirtualController& controller, Ports ports);
    /// \return the address that the child tells when it is ready
    Result<std::string> startChild(const std::string& name,
                                   const std::vector<std::string>& command);

    std::vector<Running> running_;
    std::map<std::string, std::string> virtual_addresses_;  // by name
    std::vector<std::string> names_;                        // of the processes
    std::vector<process::ChildProcess> processes_;
};

}  // namespace metier::app
