#include "run_record.hpp"

#include <fmt/format.h>

#include <chrono>
#include <utility>

#include "metier/link/stop_signal.hpp"
#include "printable.hpp"

namespace metier::app {

using composition::UsedSkillEnd;
using skill::Reason;
using skill::State;

namespace {

constexpr std::chrono::seconds kLongestWrite{5};
constexpr std::chrono::seconds kLongestEnd{10};  // of the program, if the store hangs

/// A server of another maker names no executions: what became of one follows from the state of its
/// skill and from the kind of the failure.
UsedSkillEnd endOf(const opcua::Answer<skill::ValueMap>& outcome, const RunRecord::Over& over) {
    using Kind = UsedSkillEnd::Kind;
    if (outcome) {
        return {Kind::finished, *outcome};
    }
    const auto& failure = outcome.error();
    const bool late = failure.code == Errc::timeout;
    const bool unknown = failure.delivery != opcua::Failure::Delivery::answered ||
                         failure.code == Errc::execution_lost ||
                         (late && over.state != State::halted);
    if (unknown) {
        return {Kind::lost, {}, Reason::none, failure.message};
    }
    if (failure.code == Errc::cancelled || late || over.halted_here) {
        return {Kind::halted, {}, Reason::by_client, failure.message};
    }
    const bool halted = failure.code == Errc::device_fault && over.state == State::halted;
    return {halted ? Kind::halted : Kind::refused, {}, Reason::error, failure.message};
}

}  // namespace

Result<std::shared_ptr<RunRecord>> RunRecord::begin(const std::string& records,
                                                    const OpenSkill& skill,
                                                    const skill::StartRequest& request) {
    const auto lacks = skill.skill.lacks();
    if (records.empty() || records == "off" || lacks.empty()) {
        return std::shared_ptr<RunRecord>();
    }
    METIER_ASSIGN(auto recorder,
                  server::openForeignStore(records, "run", [](const std::string& problem) {
                      fmt::print(stderr, "metier: {}\n", printable(problem));
                  }));
    const auto& address = skill.skill.address();
    return std::shared_ptr<RunRecord>(
        new RunRecord(std::move(recorder), {skill.url, address.controllerName(), address.name},
                      request, client::textOf(lacks)));
}

RunRecord::RunRecord(std::unique_ptr<records::Recorder> recorder, const server::ForeignPlace& place,
                     const skill::StartRequest& request, const std::string& lacks)
    : recorder_(std::move(recorder)),
      execution_(std::make_shared<server::ForeignRecords>(*recorder_), place, request, lacks) {}

void RunRecord::add(const skill::TransitionEvent& event) {
    const bool rests = event.from == State::running && event.to == State::suspended;
    const bool goes_on = event.from == State::suspended && event.to == State::running;
    if (rests || goes_on) {
        const std::lock_guard lock(mutex_);
        execution_.add(event.from, event.to);
    }
}

void RunRecord::end(const opcua::Answer<skill::ValueMap>& outcome, const Over& over) {
    {
        const std::lock_guard lock(mutex_);
        execution_.end(endOf(outcome, over));
    }
    if (!recorder_->flush(std::chrono::steady_clock::now() + kLongestWrite)) {
        fmt::print(stderr,
                   "metier: the run is not recorded: the store has not answered within {} s\n",
                   kLongestWrite.count());
        link::StopSignal::endWithin(kLongestEnd);
    }
}

}  // namespace metier::app
