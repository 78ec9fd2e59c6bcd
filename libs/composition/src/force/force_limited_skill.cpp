#include "metier/composition/force_limited_skill.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "metier/composition/wrapped_used_skill.hpp"
#include "metier/motion/frame.hpp"

namespace metier::composition {
namespace {

using namespace std::chrono_literals;
using skill::Reason;
using skill::Vector3;

// Shorter than a composed skill waits for used skills to come to rest.
constexpr auto kLongestSkillReset = 4s;
// As a composed skill waits for them.
constexpr auto kLongestHalt = 6s;
constexpr auto kPause = 100ms;

const std::string kMaxForce = "MaxForce";
const std::string kHaltOnForce = "HaltOnForce";

skill::SkillDescription describe(skill::SkillDescription of_move) {
    auto parameters = of_move.parameters.toVector();
    parameters.push_back({.name = kMaxForce,
                          .description = "Force along each axis of the base frame that ends the "
                                         "move; 0: no limit along this axis",
                          .type = skill::ValueType::vector3,
                          .unit = skill::kNewton,
                          .range = skill::Range{0.0, 10'000.0}});
    parameters.push_back({.name = kHaltOnForce,
                          .description = "Whether a force over its limit is an error",
                          .type = skill::ValueType::boolean,
                          .default_value = false});
    of_move.parameters = std::move(parameters);
    auto results = of_move.results.toVector();
    for (auto& result : results) {
        result.optional = true;
    }
    const auto add = [&results](std::string name, std::string description, skill::ValueType type,
                                skill::Unit unit) {
        results.push_back({.name = std::move(name),
                           .description = std::move(description),
                           .type = type,
                           .unit = unit,
                           .optional = true,
                           .place = skill::Place::final_result});
    };
    using enum skill::ValueType;
    add("ContactForce", "Force at the end, in the base frame", vector3, skill::kNewton);
    add("ContactTorque", "Torque at the end, in the base frame", vector3, skill::kNewtonMetre);
    add("ForcesExceeded", "Force that ended the move; zero: the target was reached", vector3,
        skill::kNewton);
    add("ForcesMax", "Largest force along each axis, without sign", vector3, skill::kNewton);
    add("ReactionTime", "From the last force within its limits until the move began to brake",
        number, skill::kSecond);
    add("StoppingTime", "From the last force within its limits until the move stood", number,
        skill::kSecond);
    of_move.results = std::move(results);
    return of_move;
}

bool isFinite(const Vector3& vector) {
    return std::isfinite(vector.x) && std::isfinite(vector.y) && std::isfinite(vector.z);
}

Vector3 turned(const Vector3& vector, const Frame& sensor) {
    const auto pose = motion::toPose(sensor);
    const Eigen::Vector3d in_base = pose.rotation * Eigen::Vector3d(vector.x, vector.y, vector.z);
    return {in_base.x(), in_base.y(), in_base.z()};
}

/// The force in the base frame.
/// Errors: device_fault, if it is not finite.
Result<Vector3> inBase(const MeasuredForce& measured, const std::string& name) {
    const auto force = turned(measured.force, measured.pose);
    return isFinite(force) ? Result<Vector3>(force)
                           : fail(Errc::device_fault, name + " is not finite");
}

Vector3 largest(const Vector3& a, const Vector3& b) {
    return {std::max(a.x, std::abs(b.x)), std::max(a.y, std::abs(b.y)),
            std::max(a.z, std::abs(b.z))};
}

bool exceeds(const Vector3& force, const Vector3& limits) {
    const auto over = [](double value, double limit) {
        return limit > 0 && std::abs(value) > limit;
    };
    return over(force.x, limits.x) || over(force.y, limits.y) || over(force.z, limits.z);
}

std::string textOf(const Vector3& force) {
    return fmt::format("[{:.1f}, {:.1f}, {:.1f}] N", force.x, force.y, force.z);
}

/// Parameters that the move itself does not have.
struct ForceParameters {
    Vector3 limits{};
    bool halt_on_force = false;
};

/// Takes the own parameters out of those of an execution.
/// Errors: invalid_argument, out_of_range.
Result<ForceParameters> takeFrom(skill::ValueMap& parameters) {
    ForceParameters taken;
    if (const auto node = parameters.extract(kHaltOnForce); !node.empty()) {
        const auto* halts = std::get_if<bool>(&node.mapped());
        taken.halt_on_force = halts != nullptr && *halts;
    }
    const auto node = parameters.extract(kMaxForce);
    const auto* limits = node.empty() ? nullptr : std::get_if<Vector3>(&node.mapped());
    if (limits == nullptr) {
        return fail(Errc::invalid_argument, kMaxForce + " needs a value");
    }
    if (!isFinite(*limits) || std::min({limits->x, limits->y, limits->z}) < 0) {
        return fail(Errc::out_of_range,
                    fmt::format("{} {}: a limit is below 0 N", kMaxForce, textOf(*limits)));
    }
    if (*limits == Vector3{}) {
        return fail(Errc::out_of_range, kMaxForce + ": no axis has a limit over 0 N");
    }
    taken.limits = *limits;
    return taken;
}

class ForceLimitedSkill final : public WrappedUsedSkill, private ForceListener {
public:
    ForceLimitedSkill(std::unique_ptr<UsedSkill> move, std::shared_ptr<ForceSource> source,
                      std::shared_ptr<skill::Executor> executor, const Clock& clock)
        : WrappedUsedSkill(std::move(move)),
          source_(std::move(source)),
          executor_(std::move(executor)),
          clock_(clock),
          description_(describe(used().description())) {}
    ~ForceLimitedSkill() override { source_->remove(*this); }
    ForceLimitedSkill(const ForceLimitedSkill&) = delete;
    ForceLimitedSkill& operator=(const ForceLimitedSkill&) = delete;

    const skill::SkillDescription& description() const override { return description_; }
    Result<void> available() const override {
        METIER_TRY(used().available());
        METIER_TRY(forceNow());
        return {};
    }
    /// What it halted itself may be reset.
    bool leftOver() const override { return halted_here_ || used().leftOver(); }

    void check(const skill::CheckRequest& request, skill::CheckDone done) override;
    void begin(skill::StartRequest request, UsedSkillListener& listener) override;
    Result<void> suspend() override {
        return stage_ == Stage::moves ? used().suspend() : Result<void>();
    }
    Result<void> resume() override {
        return stage_ == Stage::moves ? used().resume() : Result<void>();
    }
    void halt() override;
    void release() override;

private:
    enum class Stage {
        idle,      ///< nothing is under way
        moves,     ///< the move runs or is suspended
        is_reset,  ///< a force ended the move, which is reset
        ends,      ///< its end is known and will be reported
    };

    void onForce(const MeasuredForce& measured) override;
    void onForceLost(const Error& why) override;
    void onStopping(const UsedSkillStop& stop) override;
    void onRefused(skill::Method method, const Error& error) override;
    void onReset(const Result<void>& outcome) override;
    void onEnd(UsedSkillEnd end) override;

    /// Errors: no force is known, or it is not finite.
    Result<Vector3> forceNow() const;
    /// Notes a force of the base frame. \return whether it is over a limit
    bool note(const Vector3& force, const MeasuredForce& measured);
    void haltMove();
    void haltTimePassed();
    /// Whether an end is that of our own Halt, and not a fault or another client's Halt meanwhile.
    bool isOurHalt(const UsedSkillEnd& end) const;
    void askReset();
    void resetRefused(const Error& error);
    /// Reports the end of the execution.
    void report(UsedSkillEnd end);
    /// Reports the end in a later turn, since a function of this is being called.
    void reportSoon(UsedSkillEnd end);
    UsedSkillEnd endByForce(skill::ValueMap of_move) const;
    void addForces(skill::ValueMap& results) const;

    std::shared_ptr<ForceSource> source_;        // shared by the moves that it ends
    std::shared_ptr<skill::Executor> executor_;  // shared by what its thread owns
    const Clock& clock_;
    const skill::SkillDescription description_;

    Stage stage_ = Stage::idle;
    bool halted_here_ = false;  // a force or its loss halted the move, and nothing has reset it
    skill::Timer later_;
    // Of the execution under way.
    ForceParameters parameters_;
    Vector3 contact_force_;
    std::optional<Vector3> contact_torque_;
    Vector3 forces_max_;
    SteadyTime last_within_{};
    std::optional<Vector3> exceeded_;
    std::optional<Error> lost_;
    bool halted_by_listener_ = false;
    bool halted_by_others_ = false;
    std::string refusal_;  // of the last Halt
    skill::Timer halt_limit_;
    std::optional<SteadyTime> braking_since_;
    std::optional<SteadyTime> stood_at_;
    UsedSkillEnd end_;  // to be reported after the Reset
    SteadyTime reset_limit_{};
};

void ForceLimitedSkill::check(const skill::CheckRequest& request, skill::CheckDone done) {
    auto of_move = request;
    const auto taken = takeFrom(of_move.parameters);
    auto refusal = taken ? std::nullopt : std::optional(taken.error());
    used().check(of_move, [refusal = std::move(refusal),
                           done = std::move(done)](Result<skill::CheckReport> report) {
        if (refusal) {
            report = skill::CheckReport{.possible = false,
                                        .reason = refusal->message,
                                        .code = std::string(toString(refusal->code)),
                                        .first_failing_fraction = 0.0};
        }
        done(std::move(report));
    });
}

Result<Vector3> ForceLimitedSkill::forceNow() const {
    METIER_ASSIGN(const auto measured, source_->newest());
    return inBase(measured, source_->name());
}

void ForceLimitedSkill::begin(skill::StartRequest request, UsedSkillListener& listener) {
    listener_ = &listener;
    const auto taken = takeFrom(request.parameters);
    const auto measured = source_->newest();
    const auto force = measured.and_then(
        [this](const MeasuredForce& now) { return inBase(now, source_->name()); });
    if (!taken || !force) {
        reportSoon({UsedSkillEnd::Kind::refused,
                    {},
                    Reason::error,
                    taken ? force.error().message : taken.error().message});
        return;
    }
    parameters_ = *taken;
    forces_max_ = {};
    last_within_ = measured->received;
    exceeded_.reset();
    lost_.reset();
    braking_since_.reset();
    stood_at_.reset();
    refusal_.clear();
    halted_by_listener_ = halted_by_others_ = false;
    if (note(*force, *measured)) {
        reportSoon(endByForce({}));
        return;
    }
    stage_ = Stage::moves;
    halted_here_ = false;
    source_->add(*this);
    WrappedUsedSkill::begin(std::move(request), listener);
}

void ForceLimitedSkill::halt() {
    halted_by_listener_ = true;
    if (stage_ == Stage::moves) {
        used().halt();
    } else if (stage_ == Stage::is_reset) {
        reportSoon({UsedSkillEnd::Kind::halted, {}, Reason::by_client, {}});
    }
}

void ForceLimitedSkill::release() {
    stage_ = Stage::idle;
    later_.cancel();
    halt_limit_.cancel();
    source_->remove(*this);
    WrappedUsedSkill::release();
}

bool ForceLimitedSkill::note(const Vector3& force, const MeasuredForce& measured) {
    contact_force_ = force;
    contact_torque_.reset();
    if (measured.torque) {
        contact_torque_ = turned(*measured.torque, measured.pose);
    }
    forces_max_ = largest(forces_max_, force);
    if (!exceeds(force, parameters_.limits)) {
        return false;
    }
    exceeded_ = force;
    return true;
}

void ForceLimitedSkill::onForce(const MeasuredForce& measured) {
    if (stage_ != Stage::moves) {
        return;
    }
    const auto force = inBase(measured, source_->name());
    if (!force) {
        onForceLost(force.error());
    } else if (exceeded_ || lost_ || halted_by_others_) {
        forces_max_ = largest(forces_max_, *force);  // it still brakes
    } else if (note(*force, measured)) {
        haltMove();
    } else {
        last_within_ = measured.received;
    }
}

void ForceLimitedSkill::onForceLost(const Error& why) {
    if (stage_ == Stage::moves && !exceeded_ && !lost_ && !halted_by_others_) {
        lost_ = why;
        haltMove();
    }
}

void ForceLimitedSkill::haltMove() {
    halt_limit_ = executor_->after(kLongestHalt, [this] { haltTimePassed(); });
    used().halt();
}

void ForceLimitedSkill::haltTimePassed() {
    source_->remove(*this);
    used().release();
    report({UsedSkillEnd::Kind::halted,
            {},
            Reason::error,
            fmt::format("did not end within {} s after Halt{}", kLongestHalt.count(),
                        refusal_.empty() ? std::string() : fmt::format(" ({})", refusal_))});
}

void ForceLimitedSkill::onStopping(const UsedSkillStop& stop) {
    const bool to_halted = stop.to == skill::State::halted;
    if (to_halted && (exceeded_ || lost_)) {
        braking_since_ = clock_.now();
        return;
    }
    halted_by_others_ = halted_by_others_ || to_halted;
    WrappedUsedSkill::onStopping(stop);
}

void ForceLimitedSkill::onRefused(skill::Method method, const Error& error) {
    if (method == skill::Method::halt && (exceeded_ || lost_)) {
        refusal_ = error.message;
        later_ = executor_->after(kPause, [this] {
            if (stage_ == Stage::moves) {
                used().halt();
            }
        });
    }
    WrappedUsedSkill::onRefused(method, error);
}

/// A server of another maker gives no reason.
bool ForceLimitedSkill::isOurHalt(const UsedSkillEnd& end) const {
    const bool unnamed = end.reason == Reason::none || end.reason == Reason::error;
    return (exceeded_ || lost_) && !halted_by_listener_ &&
           (end.reason == Reason::by_client || (unnamed && !used().lacks().empty()));
}

void ForceLimitedSkill::onEnd(UsedSkillEnd end) {
    source_->remove(*this);
    halt_limit_.cancel();
    later_.cancel();
    stood_at_ = clock_.now();
    const bool finished = end.kind == UsedSkillEnd::Kind::finished;
    const bool ours = end.kind == UsedSkillEnd::Kind::halted && isOurHalt(end);
    // Our Halt may still reach a move that has reached its target meanwhile.
    halted_here_ = ours || (finished && (exceeded_ || lost_));
    if (ours && exceeded_ && !parameters_.halt_on_force) {
        end_ = endByForce({});
        stage_ = Stage::is_reset;
        reset_limit_ = clock_.now() + kLongestSkillReset;
        askReset();
    } else if ((ours || finished) && exceeded_) {
        report(endByForce(std::move(end.result)));
    } else if (ours) {
        report({UsedSkillEnd::Kind::halted,
                {},
                Reason::device_lost,
                fmt::format("the force is not known any more: {}", lost_->message)});
    } else {
        if (finished) {
            addForces(end.result);
        }
        report(std::move(end));
    }
}

void ForceLimitedSkill::askReset() {
    if (const auto asked = used().reset(*this); !asked) {
        resetRefused(asked.error());
    }
}

void ForceLimitedSkill::onReset(const Result<void>& outcome) {
    halted_here_ = halted_here_ && !outcome;
    if (stage_ != Stage::is_reset) {
        WrappedUsedSkill::onReset(outcome);
    } else if (outcome) {
        report(std::move(end_));
    } else {
        resetRefused(outcome.error());
    }
}

/// An arm that has yet to come to rest, or a device that takes longer than its server waits, is
/// asked again. What stays Halted is reset when it is used next.
void ForceLimitedSkill::resetRefused(const Error& error) {
    const bool again = (error.code == Errc::timeout || error.code == Errc::resource_unavailable) &&
                       clock_.now() < reset_limit_;
    if (again) {
        later_ = executor_->after(kPause, [this] { askReset(); });
    } else {
        reportSoon(std::move(end_));
    }
}

void ForceLimitedSkill::report(UsedSkillEnd end) {
    stage_ = Stage::idle;
    WrappedUsedSkill::onEnd(std::move(end));
}

void ForceLimitedSkill::reportSoon(UsedSkillEnd end) {
    stage_ = Stage::ends;
    later_ =
        executor_->after(0ns, [this, end = std::move(end)]() mutable { report(std::move(end)); });
}

UsedSkillEnd ForceLimitedSkill::endByForce(skill::ValueMap of_move) const {
    if (parameters_.halt_on_force) {
        return {UsedSkillEnd::Kind::halted,
                {},
                Reason::force_exceeded,
                fmt::format("the contact force {} in the base frame is over its limit {}",
                            textOf(*exceeded_), textOf(parameters_.limits))};
    }
    addForces(of_move);
    return {UsedSkillEnd::Kind::finished, std::move(of_move)};
}

void ForceLimitedSkill::addForces(skill::ValueMap& results) const {
    results["ContactForce"] = contact_force_;
    if (contact_torque_) {
        results["ContactTorque"] = *contact_torque_;
    }
    results["ForcesExceeded"] = exceeded_.value_or(Vector3{});
    results["ForcesMax"] = forces_max_;
    if (exceeded_ && stood_at_) {
        const auto since = [this](SteadyTime time) {
            return std::chrono::duration<double>(time - last_within_).count();
        };
        results["ReactionTime"] = since(braking_since_.value_or(*stood_at_));
        results["StoppingTime"] = since(*stood_at_);
    }
}

}  // namespace

std::unique_ptr<UsedSkill> limitForce(std::unique_ptr<UsedSkill> move,
                                      std::shared_ptr<ForceSource> source,
                                      std::shared_ptr<skill::Executor> executor,
                                      const Clock& clock) {
    return std::make_unique<ForceLimitedSkill>(std::move(move), std::move(source),
                                               std::move(executor), clock);
}

}  // namespace metier::composition
