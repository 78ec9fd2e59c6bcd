#pragma once

#include <sys/types.h>

#include <chrono>
#include <csignal>
#include <optional>
#include <string>
#include <vector>

#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"

namespace metier::link {

/// Destination of a child's standard error: that of the owner, or the child's standard output.
enum class ErrorOutput { inherited, with_output };

/// Process group of a child. A terminal sends Ctrl-C, Ctrl-Z and its hang-up to the owner's group,
/// but not to a group of the child's own.
enum class Group { owners, own };

/// Options of a child's start; the defaults suit most children.
struct ChildOptions {
    /// Destination of the child's standard error.
    ErrorOutput error_output = ErrorOutput::inherited;
    /// Process group of the child.
    Group group = Group::owners;
    /// Signal that the kernel sends to the child when its owner dies. A signal other than SIGKILL
    /// lets the child end in its own way; the child itself must then see that it ends in time.
    int on_owners_death = SIGKILL;
};

/// A program that runs as a child process and does not outlive its owner: the destructor ends it,
/// and the kernel signals it when the owner dies, even by kill -9.
///
///     auto server = ChildProcess::start({"metier", "serve", "cell.toml"});
///     auto ready = server->readLine(deadline);
///
/// Threading: one thread, which must live as long as the child: the kernel takes the thread that
/// started the child for its owner.
///
/// No signal is blocked in the child at its start, whatever this thread blocks.
class ChildProcess {
public:
    /// Starts the program; does not wait for it. Its standard output goes to readLine().
    /// Returns once the program runs, or could not: a wrong path is an error here, not a later end.
    /// \param command program (a path, or a name found in PATH) and its arguments, not empty
    /// Errors: not_found if the program cannot be started.
    static Result<ChildProcess> start(const std::vector<std::string>& command,
                                      const ChildOptions& options);
    static Result<ChildProcess> start(const std::vector<std::string>& command,
                                      ErrorOutput error_output = ErrorOutput::inherited) {
        return start(command, ChildOptions{.error_output = error_output});
    }

    /// The moved-from object has no child; it may only be destroyed or assigned to.
    ChildProcess(ChildProcess&& other) noexcept;
    /// Ends the child that this object had before, as the destructor does.
    ChildProcess& operator=(ChildProcess&& other) noexcept;
    /// Ends the child: SIGTERM, and SIGKILL after 2 s. Waits for its end.
    ~ChildProcess();

    /// Process id of the child; another process may get it once the child has ended.
    pid_t pid() const noexcept { return pid_; }
    /// File descriptor of the child's standard output, for poll(); -1 once it is closed.
    int outputDescriptor() const noexcept { return output_; }
    /// File descriptor that becomes readable when the child ends, for poll().
    int endDescriptor() const noexcept { return handle_; }

    /// The next line of the child's standard output, without its newline. Waits until the deadline.
    /// Text after the last newline is lost when the child closes its output. A child that prints
    /// more than the pipe holds, 64 kB by default, stops until lines are read.
    /// Errors: timeout at the deadline, connection_lost when the child closed its output.
    Result<std::string> readLine(SteadyTime deadline);

    /// Waits for the child's end; returns nothing if it still runs at the deadline.
    /// May be called again, also after the end; a deadline that is over only looks.
    /// \return its exit status, or 128 + the number of the signal that ended it
    std::optional<int> waitUntil(SteadyTime deadline);
    /// Reports whether the child still runs; does not wait.
    bool running() { return !waitUntil(SteadyTime{}).has_value(); }

    /// Sends a signal, such as SIGTERM; does nothing if the child has ended already.
    void signal(int number) noexcept;

private:
    ChildProcess(pid_t pid, int output, int handle) : pid_(pid), output_(output), handle_(handle) {}
    /// Ends the child and closes the descriptors; nothing to do after a move.
    void release() noexcept;
    Result<void> readMore(SteadyTime deadline);

    pid_t pid_;
    int output_;
    int handle_;  // pidfd: becomes readable when the child ends
    // Output that was read and is not a whole line yet.
    std::string buffered_;
    std::optional<int> exit_status_;
};

}  // namespace metier::link
