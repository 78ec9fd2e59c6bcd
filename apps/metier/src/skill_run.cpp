#include "skill_run.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>
#include <utility>

#include "metier/base/random.hpp"
#include "metier/client/control_handle.hpp"
#include "metier/client/skill_handle.hpp"
#include "metier/skill/json.hpp"
#include "printable.hpp"
#include "run_record.hpp"

namespace metier::app {
namespace {

using client::SkillHandle;

constexpr std::size_t kIdDigits = 32;

void printResult(const skill::ValueMap& result, bool as_json) {
    if (as_json) {
        fmt::print("{}\n", skill::toJson(result).dump(2, ' ', false,
                                                      nlohmann::json::error_handler_t::replace));
        return;
    }
    fmt::print("done\n");
    for (const auto& [name, value] : result) {
        fmt::print("  {:<22} {}\n", name, printable(skill::toString(value)));
    }
}

/// Ctrl-C halts the skill; the run then ends with the Halted that follows.
class HaltOnSignal {
public:
    HaltOnSignal(const link::StopSignal& signal, opcua::Client& client, client::SkillAddress skill)
        : thread_([&signal, &client, skill = std::move(skill)](const std::stop_token& stop) {
              while (!stop.stop_requested()) {
                  if (signal.waitUntil(std::chrono::steady_clock::now() + kLook)) {
                      halt(client, skill);
                      return;
                  }
              }
          }) {}

private:
    static constexpr std::chrono::milliseconds kLook{100};

    static void halt(opcua::Client& client, const client::SkillAddress& skill) {
        const auto method = client::findMethod(client, skill, skill::Method::halt);
        if (!method && method.error().status == opcua::status::kBadNoMatch) {
            fmt::print(stderr, "metier: {} has no Halt: it goes on\n", printable(skill.name));
            client.close();
            return;
        }
        const auto called = method
                                ? client.call(skill.node, *method)
                                : opcua::Answer<opcua::CallResult>(tl::unexpected(method.error()));
        if (called) {
            return;
        }
        fmt::print(stderr, "metier: Halt: {}\n", printable(called.error().message));
        if (called.error().delivery != opcua::Failure::Delivery::answered) {
            client.close();  // the user does not wait for the connection: the run ends as unknown
        }
    }

    std::jthread thread_;
};

/// Prints the transitions of a skill, and adds them to the record, if there is one.
void showTransitions(SkillHandle& skill, const std::shared_ptr<RunRecord>& record) {
    skill.onTransition([record](const skill::TransitionEvent& event) {
        fmt::print(stderr, "{} to {}{}{}\n", toString(event.from), toString(event.to),
                   event.reason_text.empty() ? "" : ": ", event.reason_text);
        if (record != nullptr) {
            record->add(event);
        }
    });
}

struct OwnedRun {
    const std::string& id;
    const skill::ValueMap& values;
    SteadyTime deadline;
    const OwnerOptions& owner;
};

/// Runs the skill as the command line says, under a lease, with a choice for the loss of this
/// client; with an id, so that its end is learnt whatever the network does.
opcua::Answer<skill::ValueMap> runOwned(SkillHandle& skill, opcua::Client& client,
                                        const OwnedRun& run) {
    std::optional<client::ControlHandle> control;
    if (run.owner.lease_ms != 0) {
        const auto* controller = skill.address().controller();
        METIER_ASSIGN(control,
                      client::ControlHandle::acquire(
                          client, controller == nullptr ? opcua::NodeId() : controller->node,
                          {.lease = run.owner.lease(), .on_loss = run.owner.action()}));
    }
    return skill.runWith({.execution_id = run.id,
                          .parameters = run.values,
                          .on_owner_loss = run.owner.action(),
                          .epoch = control ? control->epoch() : 0},
                         run.deadline);
}

}  // namespace

Exit runSkill(const link::StopSignal& signal, OpenSkill& open, const skill::ValueMap& values,
              const SkillRun& run) {
    auto& skill = open.skill;
    // An id of ours only where the run is recorded here: after a Start with a given id, runWith()
    // asks the server for the record of that id.
    auto id = skill.knowsExecutions() ? std::string() : randomHex(kIdDigits);
    auto record = RunRecord::begin(run.records, open, {.execution_id = id, .parameters = values});
    if (!record) {
        fmt::print(stderr, "metier: {}\n", printable(record.error().message));
        return Exit::usage;
    }
    showTransitions(skill, *record);
    const HaltOnSignal halt_on_signal(signal, *open.client, skill.address());
    const auto result =
        runOwned(skill, *open.client, {id, values, deadlineIn(run.timeout), run.owner});
    const auto exit = result ? Exit::success : reportOutcome(result.error());
    if (result) {
        printResult(*result, run.json);
        std::fflush(stdout);
    }
    if (*record != nullptr) {
        skill.onTransition({});
        // A server that did not answer is not asked again.
        const bool answers =
            result || result.error().delivery == opcua::Failure::Delivery::answered;
        const auto state =
            answers ? skill.state().value_or(skill::State::running) : skill::State::running;
        (*record)->end(result, {state, signal.came()});
    }
    return exit;
}

}  // namespace metier::app
