#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "metier/base/clock.hpp"
#include "metier/client/skill_handle.hpp"
#include "metier/link/child_process.hpp"
#include "metier/opcua/client.hpp"

namespace metier::system_tests {

/// Longest wait for a process: it starts on a machine that is busy with other tests.
inline SteadyTime inAMinute() {
    return std::chrono::steady_clock::now() + std::chrono::seconds(60);
}

/// The command line of the `metier` that was built with these tests, as an insecure lab.
std::vector<std::string> metierCommand(const std::vector<std::string>& arguments);

/// A run of `metier` that came to its end.
struct Finished {
    int status = -1;  ///< exit status; 128 + signal
    std::string output;
};

enum class Errors { left_out, with_output };

/// Runs a command to its end. Throws at a deadline of a minute.
Finished runToEnd(const std::vector<std::string>& command, Errors errors = Errors::with_output);
/// The same of metierCommand().
Finished runMetier(const std::vector<std::string>& arguments, Errors errors = Errors::with_output);

/// The demo's cell file: three arms and a gripper with their virtual controllers.
std::filesystem::path demoCell();
/// A cell file with the arms of the demo, simulated without controllers and wires.
std::filesystem::path simulatedCell();
/// A cell file of tests/system/devices: one device, or few, on virtual controllers.
std::filesystem::path deviceCell(const std::string& name);

/// A port on loopback that nobody listens on, for a server that is ended and comes back, or for one
/// that takes its place: unlike a port that the system chooses, other tests get it for nothing else
/// meanwhile. Another one at each call.
std::string lastingPort();

/// A file of the source tree.
std::string sourceText(const std::filesystem::path& file);

/// One server of the simulated cell in a process of its own.
class ServerProcess {
public:
    /// \param more arguments of `metier serve`, such as a port; without it a free one
    /// \param cell another cell file
    /// Errors: throws unless it serves within a minute.
    explicit ServerProcess(const std::string& name,
                           const std::vector<std::string>& more = {"--port", "0"},
                           const std::filesystem::path& cell = simulatedCell());
    /// \param command that prints a ready line once it serves
    explicit ServerProcess(const std::vector<std::string>& command);

    const std::string& url() const noexcept { return url_; }
    std::string port() const { return url_.substr(url_.rfind(':') + 1); }
    /// Ends it as a crash does.
    void kill();
    void signal(int number) { process_.signal(number); }

private:
    link::ChildProcess process_;
    std::string url_;
};

/// A client of that server. Throws if it cannot connect.
std::unique_ptr<opcua::Client> connectTo(const std::string& url);
/// The skill of that name. Throws if there is none.
client::SkillHandle openSkill(opcua::Client& client, const std::string& name);
/// Measured joint positions [rad] of the arm that a skill moves.
std::vector<double> jointPosition(opcua::Client& client, const client::SkillHandle& skill);
/// Waits until that arm is elsewhere. Throws if it stays there for a minute.
void awaitMotion(opcua::Client& client, const client::SkillHandle& skill,
                 const std::vector<double>& from);

}  // namespace metier::system_tests
