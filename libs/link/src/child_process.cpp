#include "metier/link/child_process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>  // NOLINT(modernize-deprecated-headers): kill() is POSIX, not in <csignal>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include "poll_until.hpp"

namespace metier::link {
namespace {

using namespace std::chrono_literals;

constexpr auto kGrace = 2s;
constexpr int kSignalBase = 128;

/// Waits until the descriptor is readable; false at the deadline. A deadline in the past looks
/// once.
bool waitReadable(int descriptor, SteadyTime deadline) {
    return pollUntil(descriptor, POLLIN, deadline, "a child process").has_value();
}

/// What a child that becomes a program has of its parent.
struct OfParent {
    pid_t owner = 0;   ///< the parent
    int output = -1;   ///< pipe for what the program prints
    int failure = -1;  ///< pipe for the error if there is no such program
};

/// Runs in the child between fork and exec: only async-signal-safe calls.
[[noreturn]] void becomeProgram(char* const* arguments, const ChildOptions& options,
                                const OfParent& parent) {
    if (options.group == Group::own) {
        setpgid(0, 0);
    }
    prctl(PR_SET_PDEATHSIG, options.on_owners_death);
    if (getppid() != parent.owner) {  // it died before the kernel knew whom to signal
        _exit(kSignalBase + options.on_owners_death);
    }
    dup2(parent.output, STDOUT_FILENO);
    if (options.error_output == ErrorOutput::with_output) {
        dup2(parent.output, STDERR_FILENO);
    }
    sigset_t none;
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, nullptr);
    execvp(arguments[0], arguments);
    const int error = errno;
    [[maybe_unused]] const auto written = write(parent.failure, &error, sizeof error);
    _exit(127);
}

struct Pipe {
    int read_end = -1;
    int write_end = -1;
};

Result<Pipe> makePipe() {
    std::array<int, 2> ends{};
    if (pipe2(ends.data(), O_CLOEXEC) != 0) {
        return fail(Errc::resource_unavailable, fmt::format("pipe: {}", std::strerror(errno)));
    }
    return Pipe{ends[0], ends[1]};
}

}  // namespace

Result<ChildProcess> ChildProcess::start(const std::vector<std::string>& command,
                                         const ChildOptions& options) {
    auto output = makePipe();
    auto failure = makePipe();
    if (!output || !failure) {
        return fail(output ? failure.error() : output.error());
    }
    std::vector<std::string> copies(command);
    std::vector<char*> arguments;
    for (auto& argument : copies) {
        arguments.push_back(argument.data());
    }
    arguments.push_back(nullptr);
    const pid_t owner = getpid();
    const pid_t pid = fork();
    if (pid == 0) {
        becomeProgram(arguments.data(), options, {owner, output->write_end, failure->write_end});
    }
    close(output->write_end);
    close(failure->write_end);
    int error = pid < 0 ? errno : 0;
    if (pid > 0 && read(failure->read_end, &error, sizeof error) < 0) {
        error = errno;
    }
    close(failure->read_end);
    if (error != 0) {
        close(output->read_end);
        if (pid > 0) {
            waitpid(pid, nullptr, 0);
        }
        return fail(Errc::not_found, fmt::format("{}: {}", command.front(), std::strerror(error)));
    }
    const auto handle = static_cast<int>(syscall(SYS_pidfd_open, pid, 0));
    return ChildProcess(pid, output->read_end, handle);
}

ChildProcess::ChildProcess(ChildProcess&& other) noexcept
    : pid_(std::exchange(other.pid_, -1)),
      output_(std::exchange(other.output_, -1)),
      handle_(std::exchange(other.handle_, -1)),
      buffered_(std::move(other.buffered_)),
      exit_status_(other.exit_status_) {}

ChildProcess& ChildProcess::operator=(ChildProcess&& other) noexcept {
    if (this != &other) {
        release();
        pid_ = std::exchange(other.pid_, -1);
        output_ = std::exchange(other.output_, -1);
        handle_ = std::exchange(other.handle_, -1);
        buffered_ = std::move(other.buffered_);
        exit_status_ = other.exit_status_;
    }
    return *this;
}

ChildProcess::~ChildProcess() {
    release();
}

void ChildProcess::release() noexcept {
    if (pid_ > 0 && !exit_status_) {
        signal(SIGTERM);
        if (!waitUntil(std::chrono::steady_clock::now() + kGrace)) {
            signal(SIGKILL);
            waitpid(pid_, nullptr, 0);
        }
    }
    pid_ = -1;
    if (output_ >= 0) {
        close(std::exchange(output_, -1));
    }
    if (handle_ >= 0) {
        close(std::exchange(handle_, -1));
    }
}

Result<void> ChildProcess::readMore(SteadyTime deadline) {
    if (output_ < 0) {
        return fail(Errc::connection_lost, "the program closed its output");
    }
    if (!waitReadable(output_, deadline)) {
        return fail(Errc::timeout, "the program printed no further line in time");
    }
    std::array<char, 4096> chunk{};
    const auto count = read(output_, chunk.data(), chunk.size());
    if (count <= 0) {
        close(std::exchange(output_, -1));
        return fail(Errc::connection_lost, "the program closed its output");
    }
    buffered_.append(chunk.data(), static_cast<std::size_t>(count));
    return {};
}

Result<std::string> ChildProcess::readLine(SteadyTime deadline) {
    for (;;) {
        const auto end = buffered_.find('\n');
        if (end != std::string::npos) {
            auto line = buffered_.substr(0, end);
            buffered_.erase(0, end + 1);
            return line;
        }
        METIER_TRY(readMore(deadline));
    }
}

std::optional<int> ChildProcess::waitUntil(SteadyTime deadline) {
    if (exit_status_ || pid_ <= 0) {
        return exit_status_;
    }
    if (!waitReadable(handle_, deadline)) {
        return std::nullopt;
    }
    int status = 0;
    if (waitpid(pid_, &status, 0) == pid_) {
        exit_status_ = WIFSIGNALED(status) ? kSignalBase + WTERMSIG(status) : WEXITSTATUS(status);
    }
    return exit_status_;
}

void ChildProcess::signal(int number) noexcept {
    if (pid_ > 0 && !exit_status_) {
        kill(pid_, number);
    }
}

}  // namespace metier::link
