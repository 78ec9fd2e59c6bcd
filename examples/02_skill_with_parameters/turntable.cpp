// A turntable and its skill: parameters with units and ranges in a struct, a check of what is
// possible now, a result, progress in the events, Suspend and Halt. The table is simulated.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "metier/server/own_server.hpp"
#include "metier/skill/typed_skill.hpp"

using namespace metier;
using namespace std::chrono_literals;

namespace {

constexpr double kCable = 2.0 * std::numbers::pi;  // [rad], furthest to both sides of zero
constexpr auto kCycle = 10ms;

/// The table. Threading: the server's thread.
struct Turntable {
    std::shared_ptr<skill::Executor> executor;  // shared with the server and its timers
    double angle = 0.0;                         // [rad]
};

/// Parameters of the skill.
struct Turn {
    double angle = 0.0;  // [rad], from where the table stands
    double speed = 0.0;  // [rad/s]
};

/// Result of the skill.
struct Turned {
    double angle = 0.0;  // [rad]
};

skill::FieldList<Turn> turnFields() {
    return skill::FieldList<Turn>()
        .add(&Turn::angle, {.name = "Angle",
                            .description = "Angle by which the table turns.",
                            .unit = skill::kRadian,
                            .range = skill::Range{-kCable, kCable}})
        .add(&Turn::speed, {.name = "Speed",
                            .description = "Speed of the table.",
                            .unit = skill::kRadianPerSecond,
                            .range = skill::Range{0.01, 2.0},
                            .default_value = 0.5});
}

skill::FieldList<Turned> turnedFields() {
    return skill::FieldList<Turned>().add(&Turned::angle,
                                          {.name = "TableAngle",
                                           .description = "Angle at which the table stands.",
                                           .unit = skill::kRadian});
}

/// One turn of the table. The table stands still without it: the timer ends with this.
class TurnWork final : public skill::ExecutionWork {
public:
    TurnWork(Turntable& table, const Turn& turn, const skill::FieldList<Turned>& results)
        : table_(table),
          results_(results),
          target_(table.angle + turn.angle),
          step_(turn.speed * std::chrono::duration<double>(kCycle).count()) {}

    void start(skill::ExecutionHandle execution) override {
        execution_ = std::move(execution);
        turn();
    }
    Result<void> suspend() override {
        rest();
        return {};
    }
    Result<void> resume() override {
        turn();
        return {};
    }
    void halt() override { rest(); }
    void forceStop() noexcept override { cycle_.cancel(); }

private:
    void turn() {
        cycle_ = table_.executor->after(kCycle, [this] { cycle(); });
    }
    void rest() {
        cycle_.cancel();
        execution_.atRest();
    }
    void cycle() {
        table_.angle += std::clamp(target_ - table_.angle, -step_, step_);
        execution_.progress(table_.angle);
        if (table_.angle == target_) {
            execution_.finish(results_.write({table_.angle}));
        } else {
            turn();
        }
    }

    Turntable& table_;
    const skill::FieldList<Turned>& results_;
    const double target_;  // [rad]
    const double step_;    // [rad] in a cycle
    skill::ExecutionHandle execution_;
    skill::Timer cycle_;
};

class TurnTableSkill final : public skill::TypedSkill<Turn, Turned> {
public:
    explicit TurnTableSkill(Turntable& table)
        : TypedSkill({.name = "TurnTableSkill",
                      .type = "TurnTableSkillType",
                      .description = "Turns the table by an angle."},
                     turnFields(), turnedFields()),
          table_(table) {}

private:
    Result<std::unique_ptr<skill::ExecutionWork>> plan(const Turn& turn) override {
        if (const auto target = table_.angle + turn.angle; std::abs(target) > kCable) {
            return fail(Errc::out_of_range,
                        fmt::format("the table would stand at {:.2f} rad, and its cable ends at "
                                    "{:.2f} rad",
                                    target, kCable));
        }
        return std::make_unique<TurnWork>(table_, turn, results());
    }

    Result<skill::CheckReport> assess(const Turn& turn) override {
        METIER_TRY(plan(turn));
        return skill::CheckReport{.planned_duration = std::abs(turn.angle) / turn.speed};
    }

    Turntable& table_;
};

}  // namespace

int main(int argc, char** argv) {
    server::OwnServer own(argc, argv,
                          {.name = "turntable",
                           .description = "A turntable in front of an arm.",
                           .types = "urn:example:turntable",
                           .port = 48492});
    Turntable table{own.executor()};
    own.offer(std::make_unique<TurnTableSkill>(table), {.terms = {"turn"}});
    return own.run();
}
