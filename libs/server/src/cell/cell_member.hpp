#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"
#include "metier/link/child_process.hpp"
#include "metier/link/restart_pause.hpp"
#include "metier/server/cell_runner.hpp"

namespace metier::server {

/// Order in which the processes of a cell start: each uses only those before it. They end in the
/// opposite order.
enum class CellRank { world, controller, device, move, synchronized, composition };

/// One process of a cell: a server or a virtual controller.
///
/// It has a process group of its own, so that a terminal reaches it only through its owner. When
/// the owner dies it gets a signal to end, and brakes its device.
/// Threading: one thread, which lives as long as the process.
class CellMember {
public:
    struct Plan {
        std::string name;
        CellRank rank = CellRank::device;
        CellCommand command;
    };
    enum class Event { none, ready, ended };

    explicit CellMember(Plan plan);

    const std::string& name() const noexcept { return plan_.name; }
    CellRank rank() const noexcept { return plan_.rank; }
    /// As its ready line says; empty before the first.
    const std::string& address() const noexcept { return address_; }
    /// Description of its last end, for a person.
    const std::string& howItEnded() const noexcept { return how_; }
    bool hasProcess() const noexcept { return process_.has_value(); }

    /// Starts the process; look() says when it is ready.
    /// Errors: not_found.
    Result<void> begin(SteadyTime now);
    /// Event since the last look. Does not wait.
    Event look(SteadyTime now);
    /// Lets begin() be called by look() after a pause, which grows with every end.
    /// \return the pause
    std::chrono::milliseconds beginLater(SteadyTime now);

    /// Descriptors that become readable when something happened; -1 for none.
    int outputDescriptor() const noexcept;
    int endDescriptor() const noexcept;
    /// Time when look() must be called although no descriptor is readable.
    std::optional<SteadyTime> lookAgainAt() const noexcept;

    void signal(int number) noexcept;
    /// Takes beginLater() back.
    void stayDown() noexcept { begin_at_.reset(); }

private:
    Event lookWhileStarting(SteadyTime now);
    Event end(std::string how);
    Event endedByItself();

    Plan plan_;
    std::optional<link::ChildProcess> process_;
    std::string address_;
    bool ready_ = false;
    SteadyTime begun_{};
    std::optional<SteadyTime> begin_at_;
    link::RestartPause pause_;
    std::string how_;
};

}  // namespace metier::server
