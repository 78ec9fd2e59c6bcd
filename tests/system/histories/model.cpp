#include "model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace metier::system_tests {

using skill::OwnerLossAction;
using skill::Reason;
using skill::State;
using skill::SubState;

namespace {

constexpr const char* kGood = "Good";
constexpr const char* kLocked = "BadLocked";
constexpr const char* kInvalidState = "BadInvalidState";
constexpr const char* kOutOfRange = "BadOutOfRange";
constexpr const char* kMissing = "BadInvalidArgument";

SubState subStateOf(State state, Reason reason) {
    switch (state) {
        case State::ready:
            return SubState::ready_not_configured;
        case State::running:
            return SubState::executing;
        case State::suspended:
            return SubState::none;
        case State::halted:
            break;
    }
    switch (reason) {
        case Reason::by_client:
            return SubState::halted_by_client;
        case Reason::force_exceeded:
            return SubState::halted_force;
        case Reason::owner_lost:
            return SubState::halted_owner_lost;
        case Reason::device_lost:
            return SubState::halted_device_lost;
        default:
            return SubState::halted_error;
    }
}

}  // namespace

std::string numberText(double number) {
    return fmt::format("{}", number);
}

std::string eventLine(State from, State to, Reason reason, const std::string& execution) {
    return fmt::format("event {}To{} {} {}", toString(from), toString(to), toString(reason),
                       execution);
}

std::string SkillLine::toString(std::size_t skill) const {
    return fmt::format("{}: {}/{} target {} speed {} result {}", skillName(skill), state, sub_state,
                       target, speed, result);
}

Model::Model(const std::array<std::string, kSkills>& results) {
    for (std::size_t i = 0; i < kSkills; ++i) {
        skills_.at(i).result = results.at(i);
        skills_.at(i).isFirst = i == 0;
    }
}

std::string Model::take(const Step& step) {
    auto& skill = skills_.at(step.skill);
    if (step.act <= Act::write_null) {
        return write(skill, sessions_.at(step.client), step);
    }
    if (step.act <= Act::reset || step.act == Act::get_execution) {
        return command(skill, step);
    }
    if (step.act <= Act::break_lock) {
        return control(step);
    }
    happen(skill, step);
    return kGood;
}

std::vector<std::string> Model::seen() {
    std::vector<std::string> lines;
    for (std::size_t i = 0; i < kSkills; ++i) {
        auto& skill = skills_.at(i);
        const SkillLine line{std::string(toString(skill.state)),
                             std::string(toString(skill.sub_state)),
                             skill.target ? numberText(*skill.target) : "none",
                             numberText(skill.speed), skill.result};
        lines.push_back(line.toString(i));
        for (auto& event : std::exchange(skill.events, {})) {
            lines.push_back(fmt::format("{} {}", skillName(i), event));
        }
    }
    const auto name_of = [](const std::optional<Session>& session) {
        return session ? clientName(*session % kClients) : "";
    };
    lines.push_back(fmt::format("control of \"{}\", locked {}",
                                name_of(leased_ ? leased_ : locked_), locked_.has_value()));
    return lines;
}

std::string Model::command(SkillModel& skill, const Step& step) {
    const auto session = sessions_.at(step.client);
    switch (step.act) {
        case Act::start:
            return start(skill, session);
        case Act::start_with:
            return startWith(skill, step.client, step.value);
        case Act::check:
            return check(skill, session, step.value);
        case Act::suspend:
            return suspend(skill, session);
        case Act::resume:
            return resume(skill, session);
        case Act::halt:
            return halt(skill, now_);
        case Act::reset:
            return reset(skill, session);
        default:
            return execution(skill, StartChoice(step.value).name);
    }
}

bool Model::mayCommand(Session session) const {
    return !stale_.contains(session) && isFree(session);
}

bool Model::isFree(Session session) const {
    return (!leased_ || leased_ == session) && (!locked_ || locked_ == session);
}

bool Model::isBusy() const {
    return std::any_of(skills_.begin(), skills_.end(),
                       [](const SkillModel& skill) { return skill.hasWork(); });
}

std::string Model::refusalOfWrite(const SkillModel& skill, Session session) const {
    if (skill.state != State::ready) {
        return kInvalidState;
    }
    return mayCommand(session) && (!skill.bound || skill.bound == session) ? kGood : kLocked;
}

std::string Model::write(SkillModel& skill, Session session, const Step& step) {
    if (step.act == Act::write_wrong_type) {
        return "BadTypeMismatch";
    }
    if (auto refusal = refusalOfWrite(skill, session); refusal != kGood) {
        return refusal;
    }
    const double hundredth = static_cast<double>(step.value % 100) / 100;
    switch (step.act) {
        case Act::write_target:
            skill.target = hundredth - 1;
            break;
        case Act::write_speed:
            skill.speed = hundredth;
            break;
        case Act::write_null:
            skill.speed = 0.5;
            break;
        default:
            return kOutOfRange;
    }
    skill.bound = session;
    skill.bound_until = now_ + Times::kConfiguration;
    skill.sub_state = SubState::ready_configured;
    return kGood;
}

std::string Model::refusalOfStart(const SkillModel& skill, Session session) const {
    if (auto refusal = refusalOfWrite(skill, session); refusal != kGood) {
        return refusal;
    }
    return isBusy() ? "BadResourceUnavailable" : kGood;
}

std::string Model::start(SkillModel& skill, Session session) {
    if (auto refusal = refusalOfStart(skill, session); refusal != kGood) {
        return refusal;
    }
    if (!skill.target) {
        return kMissing;
    }
    begin(skill, session, 0, skill.speed);
    return kGood;
}

std::string Model::refusalOfValues(const StartChoice& choice) {
    if (choice.speed > 1) {
        return kOutOfRange;
    }
    return choice.with_target ? kGood : kMissing;
}

std::string Model::startWith(SkillModel& skill, std::size_t client, std::uint32_t value) {
    const StartChoice choice(value);
    const auto session = sessions_.at(client);
    if (choice.name != 0 && skill.records.contains(choice.name)) {
        return fmt::format("Good {}", choice.name);
    }
    if (skill.state != State::ready) {
        return kInvalidState;
    }
    if (!mayCommand(session)) {
        return kLocked;
    }
    if (choice.deadline == StartChoice::Deadline::passed) {
        return "BadTimeout";
    }
    const bool stale =
        choice.epoch == StartChoice::Epoch::others ||
        (choice.epoch == StartChoice::Epoch::own && epochs_.at(client) != 0 && !holdsLease(client));
    if (stale) {
        return kLocked;
    }
    if (auto refusal = refusalOfStart(skill, session); refusal != kGood) {
        return refusal;
    }
    if (auto refusal = refusalOfValues(choice); refusal != kGood) {
        return refusal;
    }
    begin(skill, session, choice.name, choice.speed);
    skill.on_owner_loss = static_cast<OwnerLossAction>(choice.on_owner_loss);
    return choice.name == 0 ? "Good ?" : fmt::format("Good {}", choice.name);
}

std::string Model::check(const SkillModel& skill, Session session, std::uint32_t value) const {
    const bool possible =
        refusalOfStart(skill, session) == kGood && refusalOfValues(StartChoice(value)) == kGood;
    return possible ? "Good possible" : "Good not possible";
}

std::string Model::suspend(SkillModel& skill, Session session) {
    if (skill.sub_state != SubState::executing) {
        return kInvalidState;
    }
    if (!mayCommand(session)) {
        return kLocked;
    }
    if (!skill.isFirst) {
        return "BadNotSupported";
    }
    skill.suspending = Reason::by_client;
    stop(skill, now_);
    return kGood;
}

std::string Model::resume(SkillModel& skill, Session session) {
    if (skill.state != State::suspended) {
        return kInvalidState;
    }
    if (!mayCommand(session)) {
        return kLocked;
    }
    const bool done = std::exchange(skill.done, false);
    if (!done && !skill.owner) {
        skill.owner = session;
    }
    go(skill, State::running, Reason::by_client);
    if (done) {
        finish(skill);
    }
    return kGood;
}

std::string Model::halt(SkillModel& skill, std::int64_t now) {
    if (skill.state == State::halted) {
        return kInvalidState;
    }
    if (skill.state != State::running) {
        go(skill, State::halted, Reason::by_client);
    } else if (!skill.halting) {
        brake(skill, Reason::by_client, now);
    }
    return kGood;
}

std::string Model::reset(SkillModel& skill, Session session) {
    if (skill.state != State::halted && skill.state != State::suspended) {
        return kInvalidState;
    }
    if (!mayCommand(session)) {
        return kLocked;
    }
    if (skill.state == State::halted && skill.fault_stays) {
        return "BadDeviceFailure";
    }
    go(skill, State::ready, Reason::by_client);
    return kGood;
}

std::string Model::execution(const SkillModel& skill, std::uint32_t name) {
    const auto found = skill.records.find(name);
    return found == skill.records.end() ? "BadNotFound"
                                        : fmt::format("Good {} {}", toString(found->second.state),
                                                      toString(found->second.reason));
}

void Model::begin(SkillModel& skill, Session session, std::uint32_t name, double speed) {
    skill.name = name;
    skill.started_speed = speed;
    skill.owner = session;
    skill.on_owner_loss = OwnerLossAction::skill_default;
    go(skill, State::running, Reason::by_client);
}

void Model::go(SkillModel& skill, State to, Reason reason) {
    const bool in_execution = skill.hasWork() || to == State::running;
    const auto name = !in_execution ? "-" : skill.name == 0 ? "?" : std::to_string(skill.name);
    skill.events.push_back(eventLine(skill.state, to, reason, name));
    if (in_execution && skill.name != 0) {
        skill.records[skill.name] = {to, reason};
    }
    skill.state = to;
    skill.sub_state = subStateOf(to, reason);
    skill.rest_until.reset();
    skill.halting.reset();
    skill.done = false;
    skill.bound.reset();
    skill.target.reset();
    skill.speed = 0.5;
}

void Model::stop(SkillModel& skill, std::int64_t now) {
    skill.sub_state = SubState::stopping;
    skill.rest_until = now + Times::kRestDeadline;
}

void Model::brake(SkillModel& skill, Reason reason, std::int64_t now) {
    skill.halting = reason;
    stop(skill, now);
}

void Model::endConfiguration(SkillModel& skill) {
    skill.bound.reset();
    skill.target.reset();
    skill.speed = 0.5;
    skill.sub_state = SubState::ready_not_configured;
}

}  // namespace metier::system_tests
