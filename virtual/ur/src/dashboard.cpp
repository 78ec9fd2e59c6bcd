#include "dashboard.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "metier/base/text.hpp"

namespace metier::virtual_ur {

namespace {

constexpr std::string_view kLocalControl =
    "Command is not allowed due to safety reasons. You might need to enable Remote Control";
constexpr std::size_t kMostEchoed = 200;

/// A file's name within the folder of programs, which a client may give whole: as on the
/// controller, or in URSim.
std::string_view withinPrograms(std::string_view file) {
    for (const std::string_view folder : {"/ursim/programs/", "/programs/"}) {
        if (file.starts_with(folder)) {
            return file.substr(folder.size());
        }
    }
    return file;
}

std::string_view yesNo(bool value) {
    return value ? "true" : "false";
}

std::string answerOr(const Result<void>& result, std::string_view good, std::string_view bad) {
    return std::string(result ? good : bad);
}

/// Effect of a command, with the series if only one has it.
enum class Use : std::uint8_t { asks, asks_cb3, asks_e_series, changes };

}  // namespace

/// One thing a client can ask for.
struct Dashboard::Command {
    std::string_view name;
    Use use;
    std::string (*answer)(Dashboard&, std::string_view argument);
};

Dashboard::Dashboard(Robot& robot, std::function<void(std::string)> log)
    : robot_(robot), log_(std::move(log)) {}

// Names, answers and series of everything that takes a line.
const std::vector<Dashboard::Command> Dashboard::kCommands{
    {"running", Use::asks,
     [](Dashboard& d, std::string_view) {
         const auto state = d.robot_.programs().state();
         const bool running = state == RuntimeState::playing || state == RuntimeState::resuming;
         return fmt::format("Program running: {}", yesNo(running));
     }},
    {"robotmode", Use::asks,
     [](Dashboard& d, std::string_view) {
         return "Robotmode: " + toText(d.robot_.modes().robotMode());
     }},
    {"safetymode", Use::asks,
     [](Dashboard& d, std::string_view) {
         return "Safetymode: " + toText(d.robot_.modes().safetyMode());
     }},
    {"safetystatus", Use::asks_e_series,
     [](Dashboard& d, std::string_view) {
         return "Safetystatus: " + toText(d.robot_.modes().safetyMode());
     }},
    {"programState", Use::asks, [](Dashboard& d, std::string_view) { return d.programState(); }},
    {"PolyscopeVersion", Use::asks,
     [](Dashboard& d, std::string_view) {
         return fmt::format("URSoftware {} ({})", d.softwareVersion(),
                            d.robot_.options().description.build_date.substr(0, 10));
     }},
    {"version", Use::asks_e_series,
     [](Dashboard& d, std::string_view) { return d.softwareVersion(); }},
    {"power on", Use::changes,
     [](Dashboard& d, std::string_view) {
         return answerOr(d.robot_.powerOn(), "Powering on", "Failed to execute: power on");
     }},
    {"power off", Use::changes,
     [](Dashboard& d, std::string_view) {
         d.robot_.powerOff();
         return std::string("Powering off");
     }},
    {"brake release", Use::changes,
     [](Dashboard& d, std::string_view) {
         return answerOr(d.robot_.releaseBrakes(), "Brake releasing",
                         "Failed to execute: brake release");
     }},
    {"play", Use::changes,
     [](Dashboard& d, std::string_view) {
         return answerOr(d.robot_.play(), "Starting program", "Failed to execute: play");
     }},
    {"pause", Use::changes, [](Dashboard& d, std::string_view) { return d.pause(); }},
    {"stop", Use::changes,
     [](Dashboard& d, std::string_view) {
         d.robot_.programs().stop();
         return std::string("Stopped");
     }},
    {"load installation", Use::changes,
     [](Dashboard&, std::string_view file) {
         return fmt::format("{}: {}", file.empty() ? "File not found" : "Loading installation",
                            file.substr(0, kMostEchoed));
     }},
    {"load", Use::changes, [](Dashboard& d, std::string_view file) { return d.load(file); }},
    {"get loaded program", Use::asks,
     [](Dashboard& d, std::string_view) {
         return d.robot_.programs().loaded() ? "Loaded program: " + d.robot_.programs().loadedName()
                                             : std::string("No program loaded");
     }},
    {"isProgramSaved", Use::asks,
     [](Dashboard& d, std::string_view) { return "true " + d.robot_.programs().loadedName(); }},
    {"popup", Use::asks,
     [](Dashboard& d, std::string_view text) {
         d.robot_.showPopup(std::string(text));
         return std::string("showing popup");
     }},
    {"close popup", Use::asks,
     [](Dashboard& d, std::string_view) {
         d.robot_.closePopup();
         return std::string("closing popup");
     }},
    {"close safety popup", Use::asks,
     [](Dashboard&, std::string_view) { return std::string("closing safety popup"); }},
    {"unlock protective stop", Use::changes,
     [](Dashboard& d, std::string_view) { return d.unlock(); }},
    {"restart safety", Use::changes,
     [](Dashboard& d, std::string_view) {
         d.robot_.restartSafety();
         return std::string("Restarting safety");
     }},
    {"is in remote control", Use::asks_e_series,
     [](Dashboard& d, std::string_view) {
         return std::string(yesNo(d.robot_.control() == Control::remote));
     }},
    {"get robot model", Use::asks,
     [](Dashboard& d, std::string_view) { return d.robot_.options().robot_model; }},
    {"get serial number", Use::asks,
     [](Dashboard& d, std::string_view) { return d.robot_.options().serial_number; }},
    {"addToLog", Use::asks, [](Dashboard& d, std::string_view text) { return d.addToLog(text); }},
    {"set operational mode", Use::asks_e_series,
     [](Dashboard& d, std::string_view mode) { return d.setOperationalMode(mode); }},
    {"get operational mode", Use::asks_e_series,
     [](Dashboard& d, std::string_view) { return d.operational_mode_; }},
    {"clear operational mode", Use::asks_e_series,
     [](Dashboard& d, std::string_view) {
         return fmt::format(
             "No longer controlling the operational mode. Current operational mode: '{}'.",
             std::exchange(d.operational_mode_, "NONE"));
     }},
    {"setUserRole", Use::asks_cb3,
     [](Dashboard& d, std::string_view role) { return d.setUserRole(role); }},
    {"getUserRole", Use::asks_cb3, [](Dashboard& d, std::string_view) { return d.user_role_; }},
    {"saveLog", Use::asks,
     [](Dashboard&, std::string_view) { return std::string("Log saved to disk"); }},
    {"generate flight report", Use::asks,
     [](Dashboard& d, std::string_view) {
         return fmt::format("Flight Report generated with id:{}", ++d.flight_reports_);
     }},
    {"generate support file", Use::asks,
     [](Dashboard& d, std::string_view folder) { return d.generateSupportFile(folder); }},
};

Dashboard::Answer Dashboard::answer(std::string_view line) {
    const auto asked = trimmed(line);
    if (asked == "quit") {
        return {"Disconnected", Answer::Then::disconnect};
    }
    if (asked == "shutdown") {
        robot_.powerOff();
        return {"Shutting down", Answer::Then::disconnect};
    }
    const bool e_series = robot_.options().description.series == Series::e_series;
    for (const auto& command : kCommands) {
        const bool named =
            asked.starts_with(command.name) &&
            (asked.size() == command.name.size() || asked[command.name.size()] == ' ');
        if (!named || command.use == (e_series ? Use::asks_cb3 : Use::asks_e_series)) {
            continue;
        }
        if (command.use == Use::changes && !robot_.commandsAllowed()) {
            return {std::string(kLocalControl)};
        }
        return {command.answer(*this, trimmed(asked.substr(command.name.size())))};
    }
    return {fmt::format("could not understand: \"{}\"", asked.substr(0, kMostEchoed))};
}

std::string Dashboard::load(std::string_view file) {
    const std::filesystem::path name{std::string(withinPrograms(file))};
    const auto& folder = robot_.options().programs;
    const bool plain = !file.empty() && !name.is_absolute() &&
                       std::find(name.begin(), name.end(), "..") == name.end();
    auto script = folder / name;
    script.replace_extension(".script");
    std::error_code ignored;
    if (folder.empty() || !plain || !std::filesystem::is_regular_file(script, ignored)) {
        return fmt::format("File not found: {}", file.substr(0, kMostEchoed));
    }
    const auto loaded = robot_.programs().load(script, name.filename().string());
    return fmt::format("{}: {}", loaded ? "Loading program" : "Error while loading program", file);
}

std::string Dashboard::pause() {
    const auto state = robot_.programs().state();
    if (state == RuntimeState::stopped || state == RuntimeState::stopping) {
        return "Failed to execute: pause";
    }
    robot_.programs().pause();
    return "Pausing program";
}

std::string Dashboard::unlock() {
    const auto unlocked = robot_.unlock();
    return unlocked ? "Protective stop releasing" : unlocked.error().message;
}

std::string Dashboard::addToLog(std::string_view text) {
    if (text.empty()) {
        return "No log message to add";
    }
    log_(std::string(text.substr(0, kMostEchoed)));
    return "Added log message";
}

std::string Dashboard::setOperationalMode(std::string_view mode) {
    if (mode != "manual" && mode != "automatic") {
        return "Failed setting operational mode";
    }
    operational_mode_ = mode == "manual" ? "MANUAL" : "AUTOMATIC";
    return fmt::format("Operational mode {} is set", operational_mode_);
}

std::string Dashboard::setUserRole(std::string_view role) {
    constexpr std::array kRoles{"PROGRAMMER", "OPERATOR", "NONE", "LOCKED", "RESTRICTED"};
    const auto wanted = inUpperCase(role);
    if (std::find(kRoles.begin(), kRoles.end(), wanted) == kRoles.end()) {
        return fmt::format("Failed setting user role: {}", role.substr(0, kMostEchoed));
    }
    user_role_ = wanted;
    return fmt::format("Setting user role: {}", role);
}

std::string Dashboard::generateSupportFile(std::string_view folder) const {
    const auto file = std::filesystem::path(std::string(folder.substr(0, kMostEchoed))) /
                      ("ursupport_" + robot_.options().serial_number + ".zip");
    return "Completed successfully:" + file.string();
}

std::string Dashboard::programState() const {
    std::string_view state = "PLAYING";
    switch (robot_.programs().state()) {
        case RuntimeState::stopping:
        case RuntimeState::stopped:
            state = "STOPPED";
            break;
        case RuntimeState::pausing:
        case RuntimeState::paused:
            state = "PAUSED";
            break;
        default:
            break;
    }
    return fmt::format("{} {}", state, robot_.programs().loadedName());
}

std::string Dashboard::softwareVersion() const {
    const auto& version = robot_.options().description.version;
    return fmt::format("{}.{}.{}.{}", version.major, version.minor, version.bugfix, version.build);
}

}  // namespace metier::virtual_ur
