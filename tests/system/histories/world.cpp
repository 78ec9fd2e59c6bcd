#include "world.hpp"

#include <fmt/format.h>

#include <stdexcept>
#include <utility>

namespace metier::system_tests {

using skill::Reason;
using skill::State;

namespace {

constexpr const char* kMetierUri = "urn:metier:skills";
constexpr const char* kDiUri = "http://opcfoundation.org/UA/DI/";
constexpr const char* kDeviceUri = "https://fortiss.org/UA/Device/";
constexpr std::chrono::seconds kPatience{30};
constexpr std::uint64_t kStaleEpoch = 77;
constexpr std::size_t kRelayed = kClients - 1;

template <typename T>
std::string replyOf(const opcua::Answer<T>& answer) {
    return answer ? "Good" : answer.error().status.name();
}

std::chrono::milliseconds tens(std::uint32_t value) {
    return std::chrono::milliseconds(10) * (value % 1'024);
}

std::string textOf(const opcua::DataValue& value) {
    return value.value.as<opcua::LocalizedText>().value_or(opcua::LocalizedText{}).text;
}

std::string numberOf(const opcua::Value& value) {
    if (const auto numbers = value.as<std::vector<double>>(); numbers && numbers->size() == 2) {
        return numbers->front() == numbers->back() ? numberText(numbers->front()) : "mixed";
    }
    const auto number = value.as<double>();
    return number ? numberText(*number) : "none";
}

opcua::Value targetOf(double radians) {
    return opcua::Value::of(std::vector{radians, radians});
}

opcua::ServerLimits limits() {
    opcua::ServerLimits limits;
    limits.sessions = 60'000;  // a session whose connection was cut stays
    limits.secure_channels = limits.sessions;
    limits.session_timeout = std::chrono::hours(48);
    return limits;
}

}  // namespace

/// Counts the events that the onlooker must get.
class World::Emitted final : public skill::ProgramObserver {
public:
    void onTransition(const skill::TransitionEvent&) override { ++count; }

    std::atomic<std::size_t> count{0};
};

World::World()
    : time_(std::make_shared<HandTime>()),
      bench_({.limits = limits(), .clock = &time_->clock(), .executor = [this](auto& server) {
                  time_->runOn(server);
                  return time_;
              }}) {
    auto resource = std::make_shared<skill::Resource>("the bench");
    for (std::size_t i = 0; i < kSkills; ++i) {
        auto description = benchDescription(std::string(skillName(i)));
        description.on_owner_loss =
            i == 0 ? skill::OwnerLossAction::halt : skill::OwnerLossAction::keep_going;
        auto& side = sides_.at(i);
        side.program = &bench_.addSkill(
            std::move(description), functionsOf(side, i == 0),
            {.resource = resource,
             .configuration_timeout = std::chrono::milliseconds(Times::kConfiguration),
             .rest_deadline = std::chrono::milliseconds(Times::kRestDeadline)});
        side.emitted = std::make_unique<Emitted>();
        side.program->attach(*side.emitted);
    }
    findNodes();
    bench_.serve();
    relay_ = std::make_unique<testing::TcpRelay>(bench_.port());
    for (std::size_t i = 0; i < kClients; ++i) {
        connect(i);
    }
    onlooker_ = connectAs(bench_.url(), "onlooker");
    for (auto& side : sides_) {
        subscribe(side);
    }
}

World::~World() {
    for (auto& side : sides_) {
        side.subscription = {};
    }
}

skill::SkillFunctions World::functionsOf(Side& side, bool may_be_suspended) {
    skill::SkillFunctions functions;
    functions.start = [&side](const skill::ValueMap& given,
                              const skill::ExecutionHandle& execution) {
        side.execution = execution;
        side.speed = std::get<double>(given.at("SpeedOverride"));
    };
    if (may_be_suspended) {
        functions.suspend = [](const skill::ExecutionHandle&) { return Result<void>(); };
        functions.resume = [](const skill::ExecutionHandle&) { return Result<void>(); };
    }
    functions.halt = [](const skill::ExecutionHandle&) {};
    functions.reset = [&side]() -> Result<void> {
        return side.fault_stays ? fail(Errc::device_fault, "the button is pressed")
                                : Result<void>();
    };
    return functions;
}

void World::findNodes() {
    for (std::size_t i = 0; i < kSkills; ++i) {
        const auto at = [&](const char* path) { return bench_.node(skillName(i), path); };
        sides_.at(i).nodes = {.skill = at(""),
                              .target = at("ParameterSet/TargetJointPosition"),
                              .speed = at("Options/SpeedOverride"),
                              .start = at("Start"),
                              .start_with = at("StartWith"),
                              .check = at("Check"),
                              .suspend = at("Suspend"),
                              .resume = at("Resume"),
                              .halt = at("Halt"),
                              .reset = at("Reset"),
                              .get_execution = at("GetExecution")};
        for (const char* path :
             {"CurrentState", "ReadySubStates/CurrentState", "RunningSubStates/CurrentState",
              "HaltedSubStates/CurrentState", "ParameterSet/TargetJointPosition",
              "Options/SpeedOverride", "FinalResultData/Duration"}) {
            looked_at_.push_back({at(path)});
        }
    }
    looked_at_.push_back({bench_.controllerNode(kMetierUri, {"ControlOwner"})});
    lock_ = bench_.controllerNode(kDiUri, {"Lock"});
    looked_at_.push_back({bench_.controllerNode(kDiUri, {"Lock", "Locked"})});
    control_nodes_ = {{Act::acquire, bench_.controllerNode(kMetierUri, {"AcquireControl"})},
                      {Act::heartbeat, bench_.controllerNode(kMetierUri, {"Heartbeat"})},
                      {Act::release, bench_.controllerNode(kMetierUri, {"ReleaseControl"})},
                      {Act::init_lock, bench_.controllerNode(kDiUri, {"Lock", "InitLock"})},
                      {Act::renew_lock, bench_.controllerNode(kDiUri, {"Lock", "RenewLock"})},
                      {Act::exit_lock, bench_.controllerNode(kDiUri, {"Lock", "ExitLock"})},
                      {Act::break_lock, bench_.controllerNode(kDiUri, {"Lock", "BreakLock"})}};
}

void World::connect(std::size_t client) {
    clients_.at(client).reset();
    clients_.at(client) = connectAs(client == kRelayed ? relay_->url() : bench_.url(),
                                    std::string(clientName(client)));
}

void World::subscribe(Side& side) {
    const auto device = orThrow(onlooker_->namespaceIndex(kDeviceUri));
    opcua::EventFilter filter;
    filter.fields = {
        {{0, "Transition"}, {0, "Number"}}, {{device, "Reason"}}, {{device, "ExecutionId"}}};
    filter.of_type = opcua::ids::kProgramTransitionEventType;
    side.subscription = orThrow(onlooker_->subscribeEvents(
        side.nodes.skill, filter,
        [this, &side](const opcua::EventNotice& notice) { hear(side, notice); }));
}

void World::hear(Side& side, const opcua::EventNotice& notice) {
    const std::lock_guard lock(mutex_);
    ++side.heard_count;
    changed_.notify_all();
    if (notice.kind != opcua::EventNotice::Kind::event) {
        side.heard.emplace_back("events were lost");
        return;
    }
    const auto number = notice.fields[0].as<std::uint32_t>().value_or(0);
    if (number < 1 || number > 9) {
        side.heard.push_back(fmt::format("event with transition {}", number));
        return;
    }
    const auto transition = static_cast<skill::TransitionNumber>(number);
    const auto reason = static_cast<Reason>(notice.fields[1].as<std::int32_t>().value_or(-1));
    side.heard.push_back(eventLine(fromState(transition), toState(transition), reason,
                                   nameOf(notice.fields[2].as<std::string>().value_or("lost"))));
}

/// The number in fullName(), "?" for a name that the server gave, "-" for none.
std::string World::nameOf(const std::string& execution_id) const {
    if (execution_id.empty()) {
        return "-";
    }
    const auto begin = fmt::format("h{}/", history_);
    return execution_id.starts_with(begin) ? execution_id.substr(begin.size()) : "?";
}

std::string World::fullName(std::uint32_t name) const {
    return name == 0 ? std::string() : fmt::format("h{}/{}", history_, name);
}

std::array<std::string, kSkills> World::beginAnew() {
    bench_.onServer([this] {
        time_->advance(std::chrono::hours(1));
        for (auto& side : sides_) {
            side.fault_stays = false;
            side.execution.fail(Reason::error, "the history is over");
        }
    });
    bench_.onServer([this] {
        for (auto& side : sides_) {
            if (side.program->state() != State::ready) {
                orThrow(side.program->reset({}));
            }
        }
    });
    for (std::size_t client = 0; client < kClients; ++client) {
        // A session whose lease ran out commands again once it has had the lock.
        for (const auto act : {Act::init_lock, Act::exit_lock}) {
            Step step;
            step.client = client;
            step.act = act;
            control(step);
        }
    }
    seen();
    epochs_.fill(0);
    const std::lock_guard lock(mutex_);
    ++history_;
    std::array<std::string, kSkills> results;
    for (std::size_t i = 0; i < kSkills; ++i) {
        // Without a value before the first execution.
        const auto duration =
            orThrow(onlooker_->readMany({{bench_.node(skillName(i), "FinalResultData/Duration")}}));
        results.at(i) = numberOf(duration.at(0).value);
    }
    return results;
}

std::vector<std::string> World::seen() {
    const auto values = orThrow(onlooker_->readMany(looked_at_));
    std::vector<std::string> lines;
    std::unique_lock lock(mutex_);
    for (std::size_t i = 0; i < kSkills; ++i) {
        auto& side = sides_.at(i);
        lines.push_back(lineOf(i, values));
        changed_.wait_for(lock, kPatience, [&] { return side.heard_count >= side.emitted->count; });
        for (const auto& event : std::exchange(side.heard, {})) {
            lines.push_back(fmt::format("{} {}", skillName(i), event));
        }
    }
    const auto& owner = values.at(values.size() - 2).value;
    const auto& locked = values.back().value;
    lines.push_back(fmt::format("control of \"{}\", locked {}",
                                owner.as<std::string>().value_or("?"),
                                locked.as<bool>().value_or(false)));
    return lines;
}

std::string World::lineOf(std::size_t skill, const std::vector<opcua::DataValue>& values) const {
    const auto* value = &values.at(skill * (looked_at_.size() - 2) / kSkills);
    SkillLine line{
        .state = textOf(value[0]), .sub_state = {}, .target = {}, .speed = {}, .result = {}};
    for (int sub_states = 1; sub_states <= 3; ++sub_states) {
        if (value[sub_states].status.isGood()) {
            line.sub_state += textOf(value[sub_states]);
        }
    }
    line.sub_state = line.sub_state.empty() ? "None" : line.sub_state;
    line.target = numberOf(value[4].value);
    line.speed = numberOf(value[5].value);
    line.result = numberOf(value[6].value);
    return line.toString(skill);
}

std::string World::take(const Step& step) {
    auto& client = *clients_.at(step.client);
    if (step.act <= Act::write_null) {
        return write(client, sides_.at(step.skill), step);
    }
    if (step.act <= Act::reset || step.act == Act::get_execution) {
        return command(step);
    }
    if (step.act <= Act::break_lock) {
        return control(step);
    }
    happen(step);
    return "Good";
}

std::string World::write(opcua::Client& client, const Side& side, const Step& step) {
    const double hundredth = static_cast<double>(step.value % 100) / 100;
    switch (step.act) {
        case Act::write_target:
            return replyOf(client.write(side.nodes.target, targetOf(hundredth - 1)));
        case Act::write_speed:
            return replyOf(client.write(side.nodes.speed, opcua::Value::of(hundredth)));
        case Act::write_badly:
            return replyOf(client.write(side.nodes.speed, opcua::Value::of(hundredth + 1.01)));
        case Act::write_wrong_type:
            return replyOf(client.write(side.nodes.speed, opcua::Value::of("fast")));
        default:
            return replyOf(client.write(side.nodes.speed, opcua::Value()));
    }
}

std::string World::command(const Step& step) {
    auto& client = *clients_.at(step.client);
    const auto& side = sides_.at(step.skill);
    const auto& nodes = side.nodes;
    switch (step.act) {
        case Act::start:
            return replyOf(client.call(nodes.skill, nodes.start));
        case Act::start_with:
            return startWith(step);
        case Act::check:
            return check(client, side, step);
        case Act::suspend:
            return replyOf(client.call(nodes.skill, nodes.suspend));
        case Act::resume:
            return replyOf(client.call(nodes.skill, nodes.resume));
        case Act::halt:
            return replyOf(client.call(nodes.skill, nodes.halt));
        case Act::reset:
            return replyOf(client.call(nodes.skill, nodes.reset));
        default:
            return execution(client, side, StartChoice(step.value).name);
    }
}

std::vector<opcua::KeyValue> World::parametersOf(const StartChoice& choice) {
    std::vector<opcua::KeyValue> pairs{{{0, "SpeedOverride"}, opcua::Value::of(choice.speed)}};
    if (choice.with_target) {
        pairs.push_back({{0, "TargetJointPosition"}, targetOf(0.25)});
    }
    return pairs;
}

std::string World::startWith(const Step& step) {
    const StartChoice choice(step.value);
    const auto epoch = choice.epoch == StartChoice::Epoch::none  ? 0
                       : choice.epoch == StartChoice::Epoch::own ? epochs_.at(step.client)
                                                                 : kStaleEpoch;
    UtcTime deadline;
    if (choice.deadline != StartChoice::Deadline::none) {
        const bool passed = choice.deadline == StartChoice::Deadline::passed;
        deadline = time_->clock().utcNow() + std::chrono::milliseconds(passed ? -1 : 1);
    }
    const auto& nodes = sides_.at(step.skill).nodes;
    const auto answer =
        clients_.at(step.client)
            ->call(nodes.skill, nodes.start_with,
                   {opcua::Value::of(fullName(choice.name)), opcua::Value::of(parametersOf(choice)),
                    opcua::Value::of(static_cast<std::int32_t>(choice.on_owner_loss)),
                    opcua::Value::of(epoch), opcua::Value::of(deadline)});
    return answer ? fmt::format("Good {}", nameOf(answer->outputs.at(0).as<std::string>().value()))
                  : answer.error().status.name();
}

std::string World::check(opcua::Client& client, const Side& side, const Step& step) {
    const auto answer = client.call(side.nodes.skill, side.nodes.check,
                                    {opcua::Value::of(parametersOf(StartChoice(step.value)))});
    if (!answer) {
        return answer.error().status.name();
    }
    return answer->outputs.at(0).as<bool>().value() ? "Good possible" : "Good not possible";
}

std::string World::execution(opcua::Client& client, const Side& side, std::uint32_t name) {
    const auto answer =
        client.call(side.nodes.skill, side.nodes.get_execution, {opcua::Value::of(fullName(name))});
    if (!answer) {
        return answer.error().status.name();
    }
    const auto state = answer->outputs.at(0).as<std::uint32_t>().value();
    const auto reason = answer->outputs.at(1).as<std::int32_t>().value();
    return fmt::format("Good {} {}", toString(static_cast<State>(state)),
                       toString(static_cast<Reason>(reason)));
}

std::string World::control(const Step& step) {
    auto& client = *clients_.at(step.client);
    const auto& controller = bench_.system().controller;
    const auto& method = control_nodes_.at(step.act);
    auto& epoch = epochs_.at(step.client);
    if (step.act == Act::acquire) {
        const auto answer =
            client.call(controller, method,
                        {opcua::Value::of(static_cast<std::uint32_t>(Times::kLease)),
                         opcua::Value::of(static_cast<std::int32_t>(step.value % 4))});
        epoch = answer ? answer->outputs.at(0).as<std::uint64_t>().value() : epoch;
        return replyOf(answer);
    }
    if (step.act == Act::heartbeat || step.act == Act::release) {
        return replyOf(client.call(controller, method, {opcua::Value::of(epoch)}));
    }
    std::vector<opcua::Value> inputs;
    if (step.act == Act::init_lock) {
        inputs.push_back(opcua::Value::of("history"));
    }
    const auto answer = client.call(lock_, method, std::move(inputs));
    return answer ? fmt::format("Good {}", answer->outputs.at(0).as<std::int32_t>().value())
                  : answer.error().status.name();
}

void World::happen(const Step& step) {
    auto& side = sides_.at(step.skill);
    switch (step.act) {
        case Act::close_session:
            static_cast<void>(clients_.at(step.client)->close());
            return connect(step.client);
        case Act::cut_connection:
            relay_->interrupt();
            return connect(step.client);
        case Act::fault_stays:
        case Act::fault_is_gone:
            side.fault_stays = step.act == Act::fault_stays;
            return;
        default:
            break;
    }
    bench_.onServer([&] {
        switch (step.act) {
            case Act::at_rest:
                return side.execution.atRest();
            case Act::finish:
                return side.execution.finish({{"Duration", side.speed}});
            case Act::force_exceeded:
                return side.execution.fail(Reason::force_exceeded, "31 N over 30 N");
            case Act::device_lost:
                return side.program->deviceLost("the cable was pulled");
            default:
                return time_->advance(tens(step.value));
        }
    });
}

}  // namespace metier::system_tests
