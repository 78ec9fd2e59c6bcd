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
struct CellCommand {
    std::vector<std::string> words;  ///< the program and its arguments
    /// For a process that chooses a free port: option by which a restart takes the same port again;
    /// empty: none is needed.
    std::string option_for_port{};
};

/// Addresses of the ready processes of a cell, by name.
struct CellAddresses {
    std::map<std::string, std::string> servers;  ///< opc.tcp://...
    std::map<std::string, std::string> controllers;
};

/// Commands that start the processes of a cell. Each prints a ready line once it serves
/// (ready_line.hpp), and ends at SIGTERM.
class CellCommands {
public:
    virtual ~CellCommands() = default;

    /// \param known the world, if the cell has one
    virtual CellCommand of(const cell::VirtualController& controller,
                           const CellAddresses& known) const = 0;
    /// \param known all virtual controllers, and the servers that this one uses
    virtual CellCommand of(const cell::ServerConfig& server, const CellAddresses& known) const = 0;
};

class CellMember;
enum class CellRank;

/// Consequence for a cell when one of its processes ends by itself.
enum class OnFailure {
    restart,   ///< it is started again; the others stay
    end_cell,  ///< the whole cell ends
};

/// The servers and virtual controllers of a cell as child processes of this one.
///
/// Threading: one thread, which lives as long as this.
class CellRunner {
public:
    struct Running {
        std::string name;
        std::string url;  ///< opc.tcp://..., as the server printed it
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
    CellRunner(CellRunner&&) noexcept;
    CellRunner& operator=(CellRunner&&) = delete;
    /// Ends every process: servers that use others first, virtual controllers last. Takes 6 s at
    /// most; a process that takes longer is killed.
    ~CellRunner();

    /// Servers in the order of their start. They keep their addresses after a restart.
    const std::vector<Running>& servers() const noexcept { return running_; }
    /// Addresses of the virtual controllers, by name.
    const std::map<std::string, std::string>& virtualControllers() const noexcept {
        return known_.controllers;
    }

    /// A process that ended by itself, where the cell ends with it.
    struct Ended {
        std::string name;
        std::string how;  ///< "ended with status 1"
    };
    /// Watches the processes until the descriptor becomes readable.
    /// \return nothing then; with OnFailure::end_cell the first process that ended
    std::optional<Ended> lookAfter(int wake_descriptor, OnFailure on_failure,
                                   const OnChange& on_change);

private:
    CellRunner();
    Result<void> startMember(std::unique_ptr<CellMember> member, int stop_descriptor);
    Result<void> startAll(const cell::CellConfig& cell, const CellCommands& commands,
                          int stop_descriptor, const OnReady& on_ready);
    std::optional<Ended> lookAtAll(OnFailure on_failure, const OnChange& on_change);
    /// Waits until there is something to check, or until the descriptor becomes readable.
    /// \return whether the descriptor became readable
    bool await(int wake_descriptor, SteadyTime deadline) const;
    void awaitEnds(CellRank least, SteadyTime deadline);

    std::vector<Running> running_;
    CellAddresses known_;
    std::vector<std::unique_ptr<CellMember>> members_;  // in the order of their start
};

}  // namespace metier::server
