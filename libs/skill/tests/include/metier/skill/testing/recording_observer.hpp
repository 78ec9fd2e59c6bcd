#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "metier/skill/program_observer.hpp"
#include "metier/skill/skill.hpp"

namespace metier::skill::testing {

/// Keeps all notifications of a Program, in their order.
class RecordingObserver final : public ProgramObserver {
public:
    void onTransition(const TransitionEvent& event) override {
        events.push_back(event);
        add(std::string(toString(event.number)));
    }
    void onSubState(SubState sub_state, std::string_view step) override {
        add("sub-state " + std::string(toString(sub_state)) +
            (step.empty() ? "" : " at " + std::string(step)));
    }
    void onProgress(const Value& intermediate) override {
        add("progress " + toString(intermediate));
    }
    void onDiagnostic(const Diagnostic& diagnostic) override {
        add("diagnostic " + diagnostic.last_method_call);
    }

    void onStopping(const StoppingEvent& event) override { stops.push_back(event); }
    void onStarted(const StartedExecution& child) override { children.push_back(child); }
    void onCheck(const Caller& caller, const ValueMap& parameters,
                 const CheckReport& report) override {
        checks.push_back({caller, parameters, report});
    }

    /// The names of the transitions so far.
    std::vector<std::string> transitions() const {
        std::vector<std::string> names;
        for (const auto& event : events) {
            names.emplace_back(toString(event.number));
        }
        return names;
    }

    void clear() {
        log.clear();
        events.clear();
    }

    std::vector<std::string> log;
    std::vector<TransitionEvent> events;
    std::vector<StoppingEvent> stops;
    std::vector<StartedExecution> children;
    struct Check {
        Caller caller;
        ValueMap parameters;
        CheckReport report;
    };
    std::vector<Check> checks;
    /// Called with each entry of the log, if set.
    std::function<void(const std::string&)> on_entry;

private:
    void add(std::string entry) {
        log.push_back(std::move(entry));
        if (on_entry) {
            on_entry(log.back());
        }
    }
};

}  // namespace metier::skill::testing
