#pragma once

#include <chrono>
#include <csignal>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "metier/base/clock.hpp"
#include "metier/link/child_process.hpp"
#include "metier_program.hpp"

namespace metier::system_tests {

/// A `metier serve` that printed its ready line.
struct StartedServer {
    link::ChildProcess process;
    std::string url;
};

/// An arm's server and its virtual controller, which are not children of one `metier up`: that
/// would end the one with the other.
class DyingServer {
public:
    /// \param arm of its file in tests/system/deaths
    /// Throws unless both are ready within a minute.
    explicit DyingServer(const std::string& arm);
    /// Also of a server that is stopped.
    ~DyingServer() { server_.process.signal(SIGCONT); }
    DyingServer(const DyingServer&) = delete;
    DyingServer& operator=(const DyingServer&) = delete;

    const std::string& url() const { return server_.url; }
    const std::string& controllerAddress() const { return address_; }
    pid_t pid() const { return server_.process.pid(); }
    /// Duration of the first start.
    std::chrono::steady_clock::duration startedIn() const { return started_in_; }

    /// Sends a signal to the server. After SIGKILL it returns when the process has ended.
    void signal(int number);
    /// The same server for the same robot on the same port, which was killed before.
    void startAgain();
    /// A server with move skills over the arm's position stream.
    StartedServer startStreamer() const;
    /// A second server for the same robot, until it gives up.
    Finished runSecond(const std::vector<std::string>& more) const;

    /// Waits until the controller moves the arm for some time.
    bool awaitMotion() const;

    struct Rest {
        SteadyTime moved_last;
        std::chrono::nanoseconds longest_cycle;  ///< of the controller, in its last motion
        std::vector<double> position;            ///< [rad]
    };
    /// Waits until the arm has been standing for so long.
    Rest awaitRest(std::chrono::milliseconds least = std::chrono::milliseconds(300)) const;
    /// The next line of the server's log with this text; throws after a minute.
    std::string awaitLogLine(const std::string& text);

private:
    StartedServer start(const std::string& server, const std::vector<std::string>& more) const;
    /// As `metier virtual state` prints it.
    nlohmann::json state() const;

    std::string file_;
    std::string address_;
    link::ChildProcess controller_;
    SteadyTime begun_;
    StartedServer server_;
    std::chrono::steady_clock::duration started_in_;
};

}  // namespace metier::system_tests
