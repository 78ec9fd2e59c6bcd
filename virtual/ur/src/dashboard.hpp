#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "robot.hpp"

namespace metier::virtual_ur {

/// Port 29999: lines of text, each with one line as answer.
///
/// Threading: the thread of the robot.
class Dashboard {
public:
    static constexpr std::string_view kGreeting = "Connected: Universal Robots Dashboard Server";

    /// \param robot outlives the dashboard
    /// \param log   gets what a client adds to the log
    Dashboard(Robot& robot, std::function<void(std::string)> log);

    struct Answer {
        std::string line;
        enum class Then : std::uint8_t { go_on, disconnect } then = Then::go_on;
    };
    /// \param line without its line end; any text
    Answer answer(std::string_view line);

private:
    struct Command;
    static const std::vector<Command> kCommands;

    std::string load(std::string_view file);
    std::string pause();
    std::string unlock();
    std::string addToLog(std::string_view text);
    std::string setOperationalMode(std::string_view mode);
    std::string setUserRole(std::string_view role);
    std::string generateSupportFile(std::string_view folder) const;
    std::string programState() const;
    std::string softwareVersion() const;

    Robot& robot_;
    std::function<void(std::string)> log_;
    std::string operational_mode_ = "NONE";
    std::string user_role_ = "PROGRAMMER";
    unsigned flight_reports_ = 0;  // number of reports made
};

}  // namespace metier::virtual_ur
