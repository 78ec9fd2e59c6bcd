#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"
#include "metier/cell/cell.hpp"

namespace metier::server {

/// Command that starts a process.
/// Given to link::ChildProcess as it is: no shell reads it.
struct CellCommand {
    /// Program (a path, or a name found in PATH) and its arguments; not empty.
    std::vector<std::string> words;
    /// For a process that chooses a free port: option by which a restart takes the same port again;
    /// empty: none is needed.
    std::string option_for_port{};
};

/// Addresses of the ready processes of a cell, by name.
struct CellAddresses {
    /// Servers by name: "opc.tcp://...".
    std::map<std::string, std::string> servers;
    /// Virtual controllers by name: IP address.
    std::map<std::string, std::string> controllers;
};

/// Commands that start the processes of a cell. Each prints a ready line once it serves
/// (ready_line.hpp), and ends at SIGTERM.
class CellCommands {
public:
    virtual ~CellCommands() = default;

    /// Command that starts a virtual controller.
    /// \param known the world, if the cell has one
    virtual CellCommand of(const cell::VirtualController& controller,
                           const CellAddresses& known) const = 0;
    /// Command that starts a server.
    /// \param known all virtual controllers, and the servers that this one uses
    virtual CellCommand of(const cell::ServerConfig& server, const CellAddresses& known) const = 0;
};

class CellMember;
enum class CellRank;

/// Consequence for a cell when one of its processes ends by itself.
enum class OnFailure {
    /// It is started again, after a pause; the others stay.
    restart,
    /// The whole cell ends.
    end_cell,
};

/// The servers and virtual controllers of a cell as child processes of this one:
///
///     auto cell = CellRunner::start(config, commands, stop.descriptor(), printReady);
///     cell->lookAfter(stop.descriptor(), OnFailure::restart, print);
///
/// Threading: one thread, which lives as long as this.
class CellRunner {
public:
    /// A server that is ready.
    struct Running {
        /// Name in the cell file.
        std::string name;
        /// Address as the server printed it: "opc.tcp://...".
        std::string url;
    };
    /// Called when a server is ready, for progress on the terminal.
    using OnReady = std::function<void(const Running&)>;
    /// Called with a line for a person when a process has ended or is back.
    using OnChange = std::function<void(const std::string& text)>;

    /// Starts the virtual controllers, the devices' servers, then the servers that use them, and
    /// waits until each is ready.
    /// \param commands used only while this runs
    /// \param stop_descriptor ends the start when it becomes readable; -1: none
    /// Errors: the output of the first server that was not ready within 30 s; cancelled.
    static Result<CellRunner> start(const cell::CellConfig& cell, const CellCommands& commands,
                                    int stop_descriptor, const OnReady& on_ready);
    /// The moved-from object has no processes.
    CellRunner(CellRunner&&) noexcept;
    CellRunner& operator=(CellRunner&&) = delete;
    /// Ends every process: servers that use others first, virtual controllers last. Waits 6 s at
    /// most; a process that takes longer is killed.
    ~CellRunner();

    /// Servers in the order of their start. They keep their addresses after a restart.
    const std::vector<Running>& servers() const noexcept { return running_; }
    /// Addresses of the virtual controllers, by name; valid as long as this.
    const std::map<std::string, std::string>& virtualControllers() const noexcept {
        return known_.controllers;
    }

    /// A process that ended by itself, where the cell ends with it.
    struct Ended {
        /// Name in the cell file.
        std::string name;
        /// Way in which it ended: "ended with status 1".
        std::string how;
    };
    /// Watches the processes until the descriptor becomes readable; waits.
    /// \param wake_descriptor for example that of a link::StopSignal
    /// \return nothing then; with OnFailure::end_cell the first process that ended
    std::optional<Ended> lookAfter(int wake_descriptor, OnFailure on_failure,
                                   const OnChange& on_change);

private:
    CellRunner();
    Result<void> startMember(std::unique_ptr<CellMember> member, int stop_descriptor);
    Result<void> startAll(const cell::CellConfig& cell, const CellCommands& commands,
                          int stop_descriptor, const OnReady& on_ready);
    /// Checks each process, without waiting.
    std::optional<Ended> lookAtAll(OnFailure on_failure, const OnChange& on_change);
    /// Waits until there is something to check, or until the descriptor becomes readable.
    /// \return whether the descriptor became readable
    bool await(int wake_descriptor, SteadyTime deadline) const;
    /// Waits for the ends of the processes of this rank and above, until the deadline.
    void awaitEnds(CellRank least, SteadyTime deadline);

    std::vector<Running> running_;
    CellAddresses known_;
    std::vector<std::unique_ptr<CellMember>> members_;  // in the order of their start
};

}  // namespace metier::server
