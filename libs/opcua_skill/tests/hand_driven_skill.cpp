#include "hand_driven_skill.hpp"

#include <algorithm>
#include <utility>

namespace metier::opcua_skill::testing {

namespace {

constexpr std::chrono::seconds kLongestAnswer{30};

class HandDrivenWork final : public skill::ExecutionWork {
public:
    explicit HandDrivenWork(std::shared_ptr<Hand> hand) : hand_(std::move(hand)) {}
    void start(skill::ExecutionHandle execution) override { hand_->started(std::move(execution)); }
    Result<void> suspend() override { return tell("suspend"); }
    Result<void> resume() override { return tell("resume"); }
    void halt() override { hand_->told("halt"); }
    void forceStop() noexcept override { hand_->told("forceStop"); }
    Result<void> input(std::string_view parameter, const skill::LiveValue& live) override {
        const auto time = live.meant_for.value_or(UtcTime{}).time_since_epoch();
        return tell(std::string(parameter) + "=" + skill::toString(live.value) + " at " +
                    std::to_string(std::chrono::duration_cast<std::chrono::seconds>(time).count()));
    }

private:
    Result<void> tell(const std::string& what) {
        hand_->told(what);
        return {};
    }

    std::shared_ptr<Hand> hand_;  // shared with the skill and the test
};

skill::Field field(std::string name, skill::ValueType type, skill::Unit unit,
                   skill::Value default_value) {
    skill::Field result;
    result.name = std::move(name);
    result.description = result.name + " of the test.";
    result.type = type;
    result.unit = unit;
    result.default_value = std::move(default_value);
    return result;
}

std::vector<double> zeros(std::size_t size) {
    return std::vector<double>(size);
}

}  // namespace

skill::ExecutionHandle Hand::execution() const {
    const std::lock_guard lock(mutex_);
    return execution_;
}

skill::ValueMap Hand::snapshot() const {
    const std::lock_guard lock(mutex_);
    return snapshot_;
}

bool Hand::await(const std::string& what) {
    std::unique_lock lock(mutex_);
    const auto find = [&] { return std::find(reported_.begin(), reported_.end(), what); };
    if (!changed_.wait_for(lock, kLongestAnswer, [&] { return find() != reported_.end(); })) {
        return false;
    }
    reported_.erase(find());
    return true;
}

void Hand::refuseStart(Error error) {
    const std::lock_guard lock(mutex_);
    start_answer_ = fail(std::move(error));
}

void Hand::refuseReset(Error error) {
    const std::lock_guard lock(mutex_);
    reset_answer_ = fail(std::move(error));
}

void Hand::allowReset() {
    const std::lock_guard lock(mutex_);
    reset_answer_ = {};
}

void Hand::told(const std::string& what) {
    {
        const std::lock_guard lock(mutex_);
        reported_.push_back(what);
    }
    changed_.notify_all();
}

void Hand::started(skill::ExecutionHandle execution) {
    {
        const std::lock_guard lock(mutex_);
        execution_ = std::move(execution);
    }
    told("start");
}

Result<void> Hand::prepared(const skill::ValueMap& snapshot) {
    const std::lock_guard lock(mutex_);
    snapshot_ = snapshot;
    return start_answer_;
}

void Hand::keepChecks() {
    const std::lock_guard lock(mutex_);
    keeps_checks_ = true;
}

skill::ArmPositions Hand::checkedStarts() const {
    const std::lock_guard lock(mutex_);
    return starts_;
}

void Hand::answerCheck(Result<skill::CheckReport> report) {
    skill::CheckDone done;
    {
        const std::lock_guard lock(mutex_);
        done = std::move(check_done_);
    }
    done(std::move(report));
}

bool Hand::checked(const skill::ArmPositions& starts, const skill::CheckDone& done) {
    {
        const std::lock_guard lock(mutex_);
        if (!keeps_checks_) {
            return false;
        }
        starts_ = starts;
        check_done_ = done;
    }
    told("check");
    return true;
}

Result<void> Hand::mayReset() const {
    const std::lock_guard lock(mutex_);
    return reset_answer_;
}

Result<std::unique_ptr<skill::ExecutionWork>> HandDrivenSkill::prepare(
    const skill::ValueMap& snapshot) {
    METIER_TRY(hand_->prepared(snapshot));
    return std::make_unique<HandDrivenWork>(hand_);
}

void HandDrivenSkill::checkFrom(const skill::ArmPositions& starts, const skill::ValueMap& snapshot,
                                skill::CheckDone done) {
    if (!hand_->checked(starts, done)) {
        done(check(snapshot));
    }
}

Result<void> HandDrivenSkill::reset() {
    auto answer = hand_->mayReset();
    hand_->told("reset");
    return answer;
}

skill::SkillDescription jointMoveDescription() {
    skill::SkillDescription description;
    description.name = "JointPtpMoveSkill";
    description.type = "JointPtpMoveSkillType";
    description.description = "Moves the arm of the test.";
    description.on_owner_loss = skill::OwnerLossAction::halt;
    auto target = field("TargetJointPosition", skill::ValueType::numbers, skill::kRadian, {});
    target.range = skill::Range{-3.0, 3.0};
    target.length = skill::LengthLimit{2, 2};
    auto velocity =
        field("MaxVelocity", skill::ValueType::numbers, skill::kRadianPerSecond, zeros(2));
    velocity.range = skill::Range{0.0, 2.5};
    auto override_factor = field("SpeedOverride", skill::ValueType::number, skill::kOne, 1.0);
    override_factor.range = skill::Range{0.0, 1.0};
    override_factor.place = skill::Place::options;
    description.parameters = {
        target, velocity,
        field("MaxAcceleration", skill::ValueType::numbers, skill::kRadianPerSecondSquared,
              zeros(2)),
        field("ToolFrame", skill::ValueType::text, skill::kOne, std::string()), override_factor};
    description.results = {
        field("Duration", skill::ValueType::number, skill::kSecond, {}),
        field("ReachedJointPosition", skill::ValueType::numbers, skill::kRadian, {})};
    return description;
}

skill::SkillDescription linearMoveDescription() {
    skill::SkillDescription description;
    description.name = "CartesianLinearMoveSkill";
    description.type = "CartesianLinearMoveSkillType";
    description.parameters = {
        field("TargetPosition", skill::ValueType::frame, skill::kMetre, {}),
        field("AxisBounds", skill::ValueType::ranges, skill::kRadian, std::vector<skill::Range>()),
        field("MaxVelocity", skill::ValueType::numbers, skill::kMetrePerSecond, zeros(6)),
        field("MaxAcceleration", skill::ValueType::numbers, skill::kMetrePerSecondSquared,
              zeros(6)),
        field("ToolFrame", skill::ValueType::text, skill::kOne, std::string())};
    description.results = {field("ReachedPose", skill::ValueType::frame, skill::kMetre, {})};
    return description;
}

skill::SkillDescription streamDescription() {
    skill::SkillDescription description;
    description.name = "PositionStreamSkill";
    description.type = "PositionStreamSkillType";
    auto target = field("TargetJointPosition", skill::ValueType::numbers, skill::kRadian, zeros(2));
    target.input = skill::Input::live;
    description.parameters = {target};
    description.results = {field("SetPoints", skill::ValueType::uint64, skill::kOne, {})};
    return description;
}

}  // namespace metier::opcua_skill::testing
