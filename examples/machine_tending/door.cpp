// The door of a machine, with two skills: OpenDoorSkill and CloseDoorSkill. It can be suspended on
// its way and halts where it is.
#include <algorithm>
#include <chrono>
#include <memory>
#include <string>
#include <utility>

#include "metier/server/own_server.hpp"

namespace metier::example {
namespace {

using namespace std::chrono_literals;
using skill::ExecutionHandle;
using skill::ValueMap;
using skill::ValueType;

constexpr double kWidth = 0.6;  // [m]
constexpr auto kCycle = 10ms;

/// A door that slides. Threading: that of its executor.
class Door {
public:
    explicit Door(std::shared_ptr<skill::Executor> executor) : executor_(std::move(executor)) {}

    /// Slides to an opening [m], at a speed [m/s].
    void slide(double target, double speed, const ExecutionHandle& execution) {
        target_ = target;
        step_ = speed * std::chrono::duration<double>(kCycle).count();
        go(execution);
    }
    void go(const ExecutionHandle& execution) {
        cycle_ = executor_->after(kCycle, [this, execution] { cycle(execution); });
    }
    void rest(const ExecutionHandle& execution) {
        cycle_.cancel();
        execution.atRest();
    }
    void cut() noexcept { cycle_.cancel(); }

private:
    void cycle(const ExecutionHandle& execution) {
        opening_ += std::clamp(target_ - opening_, -step_, step_);
        execution.progress(opening_);
        if (opening_ == target_) {
            execution.finish({{"Opening", opening_}});
        } else {
            go(execution);
        }
    }

    std::shared_ptr<skill::Executor> executor_;
    skill::Timer cycle_;
    double opening_ = 0.0;  // [m]
    double target_ = 0.0;   // [m]
    double step_ = 0.0;     // [m] in a cycle
};

/// \param verb "Open" or "Close"
skill::SkillDescription doorSkill(const std::string& verb) {
    return {.name = verb + "DoorSkill",
            .type = verb + "DoorSkillType",
            .description = verb + "s the door of the machine.",
            .parameters = {{.name = "Speed",
                            .description = "Speed of the door.",
                            .type = ValueType::number,
                            .unit = skill::kMetrePerSecond,
                            .range = skill::Range{0.05, 2.0},
                            .default_value = 1.0}},
            .results = {{.name = "Opening",
                         .description = "Width to which the door is open.",
                         .type = ValueType::number,
                         .unit = skill::kMetre,
                         .place = skill::Place::final_result}}};
}

/// \param target width to which the door slides [m]
skill::SkillFunctions slideTo(double target, Door& door) {
    return {.start =
                [&door, target](const ValueMap& values, const ExecutionHandle& execution) {
                    door.slide(target, std::get<double>(values.at("Speed")), execution);
                },
            .suspend = [&door](const ExecutionHandle& execution) -> Result<void> {
                door.rest(execution);
                return {};
            },
            .resume = [&door](const ExecutionHandle& execution) -> Result<void> {
                door.go(execution);
                return {};
            },
            .halt = [&door](const ExecutionHandle& execution) { door.rest(execution); },
            .force_stop = [&door] { door.cut(); }};
}

}  // namespace
}  // namespace metier::example

int main(int argc, char** argv) {
    using namespace metier;
    using namespace metier::example;
    server::OwnServer own(argc, argv,
                          {.name = "door",
                           .description = "The door of a milling machine.",
                           .types = "urn:example:door",
                           .port = 48464});
    Door door(own.executor());
    // Shared by both skills: one at a time moves the door.
    const auto one_door = std::make_shared<skill::Resource>("the door");
    own.offer(doorSkill("Open"), slideTo(kWidth, door), {.terms = {"open"}, .resource = one_door});
    own.offer(doorSkill("Close"), slideTo(0.0, door), {.terms = {"close"}, .resource = one_door});
    return own.run();
}
