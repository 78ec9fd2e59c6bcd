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

/// The servers of a cell as child processes of this one; they end with it.
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

    /// Starts the arms, then what builds on them, and waits until each is ready.
    /// \param ports_free  every server takes a free port instead of its configured one
    /// Errors: what the first server that did not become ready in 30 s had to say.
    enum class Ports { configured, free };
    static Result<CellRunner> start(const configuration::CellConfig& cell, Ports ports,
                                    const OnReady& on_ready);

    const std::vector<Running>& servers() const noexcept { return running_; }

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

    std::vector<Running> running_;
    std::vector<process::ChildProcess> processes_;
};

}  // namespace metier::app
