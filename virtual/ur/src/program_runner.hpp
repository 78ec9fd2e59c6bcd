#pragma once

#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "metier/urscript/interpreter.hpp"
#include "primary_packages.hpp"
#include "script_robot.hpp"

namespace metier::virtual_ur {

/// The program that runs, those that run beside it for one cycle, and the one that is loaded.
///
/// Threading: one thread, the cycle.
class ProgramRunner {
public:
    /// \param robot outlives the runner
    /// \param tell  receives the messages for the primary port
    ProgramRunner(ScriptRobot& robot, const RobotState& state, std::function<void(Bytes)> tell);

    /// Takes a script from a script port; errors in it are reported at the primary port.
    void run(std::string_view text);

    // Requests of the dashboard.
    /// \param file a script; `name` is its displayed name
    /// Errors: not_found, invalid_argument (not a program).
    Result<void> load(const std::filesystem::path& file, std::string name);
    /// Begins the loaded program or goes on. Errors: invalid_state if there is none.
    Result<void> play();
    void pause();
    void stop();

    /// The controller stopped the arm: a program that runs is paused at once.
    void holdForSafety();
    /// One cycle.
    /// \param standing whether the arm stands
    void step(bool standing);

    RuntimeState state() const { return runtime_; }
    /// Share of the time that passes for the program now: less while it pauses and resumes.
    double timeShare() const { return share_; }
    /// Name for the dashboard; "<unnamed>" if nothing is loaded.
    const std::string& loadedName() const { return loaded_name_; }
    bool loaded() const { return loaded_.has_value(); }
    std::uint32_t line() const;

private:
    void start(urscript::Program program);
    void end();
    void stepPrograms();
    void stepPrimary();
    void stepSecondary();
    void advance(bool standing);
    void tellKey(std::string_view title);
    void tellException(const urscript::Interpreter& interpreter);

    ScriptRobot& robot_;
    const RobotState& robot_state_;
    std::function<void(Bytes)> tell_;
    std::optional<urscript::Interpreter> primary_;
    std::deque<urscript::Program> secondary_;
    std::optional<urscript::Program> loaded_;
    std::string loaded_name_ = "<unnamed>";
    RuntimeState runtime_ = RuntimeState::stopped;
    double share_ = 1.0;
    double due_ = 1.0;  // part of a cycle of the program that is due
    bool held_for_safety_ = false;
};

}  // namespace metier::virtual_ur
