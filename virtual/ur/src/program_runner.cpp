#include "program_runner.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <utility>

namespace metier::virtual_ur {

namespace {

using urscript::Program;
using urscript::ProgramKind;
using urscript::RunState;

// A program comes to a pause, and out of it, in this time [s].
constexpr double kPauseTime = 0.25;
// Sums of shares are not exact.
constexpr double kTimeRounding = 1e-9;
constexpr std::size_t kMostSecondary = 64;
// Largest part of a script's line in a message [bytes].
constexpr std::size_t kLongestShownLine = 200;

struct Place {
    int line = 1;
    int column = 1;
    std::string_view text;
};

/// "line L, column C: why" of a parser's error.
Place placeOf(std::string_view message) {
    Place place{1, 1, message};
    const auto number = [&](std::string_view before, int& value) {
        const auto at = message.find(before);
        if (at != std::string_view::npos) {
            const auto* first = message.data() + at + before.size();
            std::from_chars(first, message.data() + message.size(), value);
        }
    };
    number("line ", place.line);
    number("column ", place.column);
    const auto colon = message.find(": ");
    if (message.starts_with("line ") && colon != std::string_view::npos) {
        place.text = message.substr(colon + 2);
    }
    return place;
}

/// Text between the first two quotation marks.
std::string_view quoted(std::string_view text) {
    text.remove_prefix(std::min(text.find('\''), text.size() - 1) + 1);
    return text.substr(0, text.find('\''));
}

/// \param number from 1; empty if the text has no such line
std::string_view lineOf(std::string_view text, int number) {
    for (; number > 1; --number) {
        const auto end = text.find('\n');
        text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    }
    text = text.substr(0, text.find('\n'));
    return text.ends_with('\r') ? text.substr(0, text.size() - 1) : text;
}

/// Text of the maker for a script that is no program.
/// Source: README.md, what is simulated.
std::string inMakersWords(const Error& error, const Place& place, std::string_view script) {
    if (error.code == Errc::not_found) {
        return fmt::format("compile_error_name_not_found:{}:", quoted(place.text));
    }
    return fmt::format("syntax_error_on_line:{}:{}:", place.line,
                       lineOf(script, place.line).substr(0, kLongestShownLine));
}

}  // namespace

ProgramRunner::ProgramRunner(ScriptRobot& robot, const RobotState& state,
                             std::function<void(Bytes)> tell)
    : robot_(robot), robot_state_(state), tell_(std::move(tell)) {}

void ProgramRunner::run(std::string_view text) {
    auto program = Program::parse(text);
    if (!program) {
        const auto place = placeOf(program.error().message);
        tell_(textMessage(timeOf(robot_state_), program.error().message));
        tell_(runtimeExceptionMessage(timeOf(robot_state_), place.line, place.column,
                                      inMakersWords(program.error(), place, text)));
        return;
    }
    if (program->kind() == ProgramKind::secondary) {
        if (secondary_.size() < kMostSecondary) {
            secondary_.push_back(*std::move(program));
        }
        return;
    }
    start(*std::move(program));
}

void ProgramRunner::start(Program program) {
    if (primary_) {
        primary_->stop();
        end();
    }
    primary_.emplace(std::move(program), robot_);
    runtime_ = RuntimeState::playing;
    share_ = 1.0;
    due_ = 1.0;
    held_for_safety_ = false;
    tellKey("PROGRAM_XXX_STARTED");
}

void ProgramRunner::end() {
    tellKey("PROGRAM_XXX_STOPPED");
    primary_.reset();
    robot_.abandonMotion();
    robot_.endProgram();
    runtime_ = RuntimeState::stopping;
    held_for_safety_ = false;
}

Result<void> ProgramRunner::load(const std::filesystem::path& file, std::string name) {
    std::ifstream stream(file);
    if (!stream) {
        return fail(Errc::not_found, file.string());
    }
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    METIER_ASSIGN(auto program, Program::parse(text));
    stop();
    loaded_ = std::move(program);
    loaded_name_ = std::move(name);
    return {};
}

Result<void> ProgramRunner::play() {
    if (primary_) {
        if (runtime_ == RuntimeState::paused || runtime_ == RuntimeState::pausing) {
            runtime_ = RuntimeState::resuming;
            if (std::exchange(held_for_safety_, false)) {
                robot_.resumeMotion();
            }
        }
        return {};
    }
    if (!loaded_) {
        return fail(Errc::invalid_state, "no program is loaded");
    }
    start(*loaded_);
    return {};
}

void ProgramRunner::pause() {
    if (runtime_ == RuntimeState::playing || runtime_ == RuntimeState::resuming) {
        runtime_ = RuntimeState::pausing;
    }
}

void ProgramRunner::stop() {
    if (primary_) {
        primary_->stop();
        end();
    }
}

void ProgramRunner::holdForSafety() {
    if (primary_) {
        runtime_ = RuntimeState::pausing;
        held_for_safety_ = true;
        share_ = 0.0;
    }
}

void ProgramRunner::step(bool standing) {
    const double change = robot_.stepTime() / kPauseTime;
    switch (runtime_) {
        case RuntimeState::pausing:
            share_ = std::max(0.0, share_ - change);
            break;
        case RuntimeState::resuming:
            share_ = std::min(1.0, share_ + change);
            break;
        default:
            break;
    }
    stepPrograms();
    advance(standing);
}

void ProgramRunner::advance(bool standing) {
    if (runtime_ == RuntimeState::pausing && share_ == 0.0 && standing) {
        runtime_ = RuntimeState::paused;
    } else if (runtime_ == RuntimeState::resuming && share_ == 1.0) {
        runtime_ = RuntimeState::playing;
    } else if (runtime_ == RuntimeState::stopping && standing && !primary_) {
        runtime_ = RuntimeState::stopped;
        share_ = 1.0;
    }
}

void ProgramRunner::stepPrograms() {
    robot_.beginCycle();
    if (primary_ && runtime_ != RuntimeState::paused) {
        const auto wanted = robot_.watch();
        if (wanted == "stop") {
            stop();
        } else if (wanted == "pause") {
            pause();
        }
    }
    if (primary_ && share_ > 0.0 && runtime_ != RuntimeState::paused) {
        due_ += share_ * robot_state_.speed_slider;
        if (due_ >= 1.0 - kTimeRounding) {
            due_ = std::max(0.0, due_ - 1.0);
            stepPrimary();
        }
    }
    stepSecondary();
    robot_.endCycle();
}

void ProgramRunner::stepPrimary() {
    const auto run_state = primary_->step();
    if (run_state == RunState::running) {
        return;
    }
    if (run_state == RunState::failed) {
        tellException(*primary_);
    }
    end();
}

void ProgramRunner::stepSecondary() {
    while (!secondary_.empty()) {
        urscript::Interpreter interpreter(secondary_.front(), robot_);
        secondary_.pop_front();
        if (interpreter.step() == RunState::failed) {
            tellException(interpreter);
        }
    }
}

std::uint32_t ProgramRunner::line() const {
    return primary_ ? static_cast<std::uint32_t>(std::max(0, primary_->line())) : 0;
}

void ProgramRunner::tellKey(std::string_view title) {
    tell_(keyMessage(timeOf(robot_state_), title, primary_->program().name()));
}

void ProgramRunner::tellException(const urscript::Interpreter& interpreter) {
    if (const auto& exception = interpreter.exception()) {
        tell_(runtimeExceptionMessage(timeOf(robot_state_), exception->line, exception->column,
                                      exception->text));
    }
}

}  // namespace metier::virtual_ur
