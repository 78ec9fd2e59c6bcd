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
class ChildProcess {
public:
    /// Starts the program; does not wait for it. Its standard output goes to readLine().
    /// \param command program (a path, or a name found in PATH) and its arguments, not empty
    /// Errors: not_found if the program cannot be started.
    static Result<ChildProcess> start(const std::vector<std::string>& command,
                                      const ChildOptions& options);
    static Result<ChildProcess> start(const std::vector<std::string>& command,
                                      ErrorOutput error_output = ErrorOutput::inherited) {
        return start(command, ChildOptions{.error_output = error_output});
    }

    ChildProcess(ChildProcess&& other) noexcept;
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
    /// Errors: timeout at the deadline, connection_lost when the child closed its output.
    Result<std::string> readLine(SteadyTime deadline);

    /// Waits for the child's end; returns nothing if it still runs at the deadline.
    /// \return its exit status, or 128 + the number of the signal that ended it
    std::optional<int> waitUntil(SteadyTime deadline);
    /// Reports whether the child still runs; does not wait.
    bool running() { return !waitUntil(SteadyTime{}).has_value(); }

    /// Sends a signal, such as SIGTERM; does nothing if the child has ended already.
    void signal(int number) noexcept;

private:
    ChildProcess(pid_t pid, int output, int handle) : pid_(pid), output_(output), handle_(handle) {}
    void release() noexcept;
    Result<void> readMore(SteadyTime deadline);

    pid_t pid_;
    int output_;
    int handle_;  // pidfd: becomes readable when the child ends
    std::string buffered_;
    std::optional<int> exit_status_;
};

}  // namespace metier::link
