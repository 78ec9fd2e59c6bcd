#include "metrics/program_meter.hpp"

#include <chrono>
#include <optional>
#include <utility>

namespace metier::server {

using skill::Method;
using skill::TransitionNumber;

namespace {

/// The enumerator of that name; nothing for a name that is none.
std::optional<Method> methodOf(std::string_view name) {
    for (const auto method : {Method::start, Method::suspend, Method::resume, Method::halt,
                              Method::reset, Method::start_with}) {
        if (toString(method) == name) {
            return method;
        }
    }
    return std::nullopt;
}

}  // namespace

ProgramMeter::ProgramMeter(skill::Program& program)
    : program_(program), skill_(program.description().name), state_(program.state()) {
    program_.attach(*this);
}

ProgramMeter::~ProgramMeter() {
    program_.detach(*this);
}

void ProgramMeter::onTransition(const skill::TransitionEvent& event) {
    state_ = event.to;
    switch (event.number) {
        case TransitionNumber::ready_to_running:
            ++starts_;
            started_ = std::chrono::steady_clock::now();
            runs_ = true;
            break;
        case TransitionNumber::running_to_suspended:
            ++suspends_;
            break;
        case TransitionNumber::running_to_ready:
            ++finished_;
            ended();
            break;
        case TransitionNumber::running_to_halted:
        case TransitionNumber::suspended_to_halted:
            ++halts_.at(static_cast<std::size_t>(event.reason));
            ended();
            break;
        case TransitionNumber::suspended_to_ready:
            ended();
            break;
        case TransitionNumber::halted_to_ready:
        case TransitionNumber::suspended_to_running:
        case TransitionNumber::ready_to_halted:
            break;
    }
}

void ProgramMeter::ended() {
    if (std::exchange(runs_, false)) {
        const std::chrono::duration<double> took = std::chrono::steady_clock::now() - started_;
        durations_.add(took.count());
    }
}

void ProgramMeter::onDiagnostic(const skill::Diagnostic& diagnostic) {
    if (diagnostic.last_method_status) {
        return;
    }
    if (const auto method = methodOf(diagnostic.last_method_call)) {
        ++refusals_.at(static_cast<std::size_t>(*method));
    }
}

}  // namespace metier::server
