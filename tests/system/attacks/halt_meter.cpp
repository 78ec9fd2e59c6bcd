#include "halt_meter.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace metier::system_tests {
namespace {

using std::chrono::steady_clock;

constexpr const char* kSkill = "Guarded";

double millisecondsBetween(SteadyTime begin, SteadyTime end) {
    return std::chrono::duration<double, std::milli>(end - begin).count();
}

}  // namespace

Durations summaryOf(std::vector<double> milliseconds) {
    if (milliseconds.empty()) {
        return {};
    }
    std::sort(milliseconds.begin(), milliseconds.end());
    const auto at = [&](double part) {
        return milliseconds[static_cast<std::size_t>(part *
                                                     static_cast<double>(milliseconds.size() - 1))];
    };
    constexpr double kMedian = 0.5;
    constexpr double kPercentile = 0.99;
    return {milliseconds.size(), at(kMedian), at(kPercentile), milliseconds.back()};
}

HaltMeter::HaltMeter(BenchServer& server) : server_(server) {
    skill::SkillDescription description;
    description.name = kSkill;
    description.type = "PositionStreamSkillType";
    skill::SkillFunctions functions;
    // Runs until it is halted
    functions.start = [](const skill::ValueMap&, const skill::ExecutionHandle&) {};
    functions.halt = [this](const skill::ExecutionHandle& execution) {
        told_ = steady_clock::now();
        execution.atRest();
    };
    server_.addSkill(std::move(description), std::move(functions));
}

void HaltMeter::connect(const opcua::ClientOptions& options) {
    operator_ = orThrow(opcua::Client::connect(server_.url(), options));
}

std::string HaltMeter::call(const char* method) {
    const auto answer = operator_->call(server_.node(kSkill), server_.node(kSkill, method));
    return answer ? std::string() : fmt::format("{}: {}", method, answer.error().message);
}

HaltTimes HaltMeter::measure(std::chrono::milliseconds time) {
    const auto end = steady_clock::now() + time;
    std::vector<double> answered;
    std::vector<double> commanded;
    HaltTimes times;
    while (times.defect.empty() && steady_clock::now() < end) {
        times.defect = call("Start");
        if (!times.defect.empty()) {
            break;
        }
        const auto begin = steady_clock::now();
        times.defect = call("Halt");
        answered.push_back(millisecondsBetween(begin, steady_clock::now()));
        const auto told = told_.load();
        if (told < begin && times.defect.empty()) {
            times.defect = "Halt was answered, and the skill was not told";
        }
        commanded.push_back(millisecondsBetween(begin, told));
        if (times.defect.empty()) {
            times.defect = call("Reset");
        }
    }
    times.answered = summaryOf(std::move(answered));
    times.commanded = summaryOf(std::move(commanded));
    return times;
}

}  // namespace metier::system_tests
