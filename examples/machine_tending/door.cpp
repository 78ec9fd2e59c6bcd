// The door of a machine, with two skills: OpenDoorSkill and CloseDoorSkill. It can be suspended on
// its way and halts where it is.
#include <algorithm>
#include <chrono>
#include <memory>
#include <string>
#include <utility>

#include "metier/skill/lambda_skill.hpp"
#include "skill_program.hpp"

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

    /// Errors: invalid_state: the other of its skills moves it.
    Result<void> mayBegin() const {
        return taken_ ? fail(Errc::invalid_state, "the door is on its way already")
                      : Result<void>();
    }
    /// Slides to an opening [m], at a speed [m/s].
    void slide(double target, double speed, const ExecutionHandle& execution) {
        taken_ = true;
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
    void halt(const ExecutionHandle& execution) {
        taken_ = false;
        rest(execution);
    }
    void cut() noexcept {
        taken_ = false;
        cycle_.cancel();
    }

private:
    void cycle(const ExecutionHandle& execution) {
        opening_ += std::clamp(target_ - opening_, -step_, step_);
        execution.progress(opening_);
        if (opening_ == target_) {
            taken_ = false;
            execution.finish({{"Opening", opening_}});
        } else {
            go(execution);
        }
    }

    std::shared_ptr<skill::Executor> executor_;
    skill::Timer cycle_;
    bool taken_ = false;    // by an execution, which may be suspended
    double opening_ = 0.0;  // [m]
    double target_ = 0.0;   // [m]
    double step_ = 0.0;     // [m] in a cycle
};

/// \param verb "Open" or "Close"
Offered doorSkill(const std::shared_ptr<Door>& door, const std::string& verb, double target) {
    skill::SkillDescription description{
        .name = verb + "DoorSkill",
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
    skill::SkillFunctions functions{
        .check = [door](const ValueMap&) { return door->mayBegin(); },
        .start =
            [door, target](const ValueMap& values, const ExecutionHandle& execution) {
                door->slide(target, std::get<double>(values.at("Speed")), execution);
            },
        .suspend = [door](const ExecutionHandle& execution) -> Result<void> {
            door->rest(execution);
            return {};
        },
        .resume = [door](const ExecutionHandle& execution) -> Result<void> {
            door->go(execution);
            return {};
        },
        .halt = [door](const ExecutionHandle& execution) { door->halt(execution); },
        .force_stop = [door] { door->cut(); }};
    return {std::make_unique<skill::LambdaSkill>(std::move(description), std::move(functions)),
            {target > 0.0 ? "open" : "close"}};
}

std::vector<Offered> skillsOf(std::shared_ptr<skill::Executor> executor) {
    const auto door = std::make_shared<Door>(std::move(executor));
    std::vector<Offered> offered;
    offered.push_back(doorSkill(door, "Open", kWidth));
    offered.push_back(doorSkill(door, "Close", 0.0));
    return offered;
}

}  // namespace
}  // namespace metier::example

int main(int argc, char** argv) {
    using namespace metier::example;
    return serve({"door", "The door of a milling machine.", "urn:example:door", skillsOf}, argc,
                 argv);
}
