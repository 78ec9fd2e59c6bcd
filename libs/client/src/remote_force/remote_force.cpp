#include "metier/client/remote_force.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <set>
#include <utility>

#include "metier/client/kinematics_reader.hpp"
#include "metier/client/skill_finder.hpp"
#include "metier/opcua/client.hpp"
#include "metier/opcua_skill/values.hpp"
#include "questions.hpp"

namespace metier::client {

using composition::ForceListener;
using composition::MeasuredForce;
using opcua::Client;
using opcua::DataValue;
using opcua::NodeId;
using skill::Vector3;

namespace {

using namespace std::chrono_literals;

constexpr auto kSampling = 5ms;
constexpr std::uint32_t kQueue = 100;
constexpr auto kSilence = 2s;
constexpr auto kRetry = 500ms;
// A force that is Bad for so long is subscribed to again: its server may have ended that.
constexpr auto kLongestBad = 2s;

template <typename Number>
std::optional<Vector3> fromList(const opcua::Value& value) {
    const auto numbers = value.as<std::vector<Number>>();
    if (!numbers || numbers->size() != 3) {
        return std::nullopt;
    }
    const auto& list = *numbers;
    return Vector3{double(list[0]), double(list[1]), double(list[2])};
}

/// Errors: connection_lost (a Bad value), type_mismatch.
Result<Vector3> vectorOf(const DataValue& data, const std::string& name) {
    if (data.status.isBad() || data.value.isEmpty()) {
        return fail(Errc::connection_lost, fmt::format("{} is {}", name, data.status.name()));
    }
    if (const auto vector = data.value.as<opcua::ThreeDVector>()) {
        return Vector3{vector->x, vector->y, vector->z};
    }
    auto numbers = fromList<double>(data.value);
    numbers = numbers ? numbers : fromList<float>(data.value);
    if (!numbers) {
        return fail(Errc::type_mismatch,
                    fmt::format("{} is {}, not three numbers", name, data.value.typeName()));
    }
    return *numbers;
}

Result<Frame> frameOf(const DataValue& data, const std::string& name) {
    if (data.status.isBad() || data.value.isEmpty()) {
        return fail(Errc::connection_lost, fmt::format("{} is {}", name, data.status.name()));
    }
    auto frame = data.value.as<opcua::ThreeDFrame>();
    if (!frame) {
        return fail(Errc::type_mismatch, fmt::format("{}: {}", name, frame.error().message));
    }
    return *frame;
}

/// A Variable of a server, by the text of its NodeId.
/// Errors: invalid_argument, not_found (no such namespace).
Result<NodeId> nodeOf(Client& client, const std::string& text) {
    constexpr std::string_view kByUri = "nsu=";
    const auto end = text.find(';');
    if (!text.starts_with(kByUri) || end == std::string::npos) {
        return NodeId::parse(text);
    }
    const auto uri = text.substr(kByUri.size(), end - kByUri.size());
    METIER_ASSIGN(const auto index, client.namespaceIndex(uri));
    return NodeId::parse(fmt::format("ns={}{}", index, text.substr(end)));
}

/// Errors: invalid_argument, if it has EngineeringUnits that are not N.
Result<void> checkUnit(Client& client, const NodeId& force, const std::string& name) {
    Questions questions(client);
    METIER_ASSIGN(const auto references, questions.browse({.node = force, .node_classes = {}}));
    for (const auto& reference : references) {
        if (reference.browse_name.name != "EngineeringUnits") {
            continue;
        }
        METIER_ASSIGN(const auto value, questions.read(reference.target));
        const auto unit = value.as<opcua::EuInformation>();
        const auto symbol = unit ? opcua_skill::symbolOf(*unit) : std::string();
        if (!symbol.empty() && symbol != skill::kNewton.symbol) {
            return fail(Errc::invalid_argument, fmt::format("{} is in {}, not in N", name, symbol));
        }
    }
    return {};
}

/// Kinematics of the server's first arm.
Result<KinematicsNodes> armOf(Client& client) {
    METIER_ASSIGN(const auto skills, findSkills(client));
    for (const auto& skill : skills) {
        if (auto nodes = findKinematics(client, skill)) {
            return std::move(*nodes);
        }
    }
    return fail(Errc::not_found, "no arm with Kinematics");
}

struct Variables {
    NodeId force;
    NodeId torque;  ///< null: it is not measured
};

Result<Variables> variablesOf(Client& client, const RemoteForceOptions& options) {
    Variables variables;
    if (options.force.empty()) {
        METIER_ASSIGN(const auto arm, armOf(client));
        if (arm.flange_force.isNull()) {
            return fail(Errc::not_found, arm.device_name + " publishes no FlangeForce");
        }
        return Variables{arm.flange_force, arm.flange_torque};
    }
    METIER_ASSIGN(variables.force, nodeOf(client, options.force));
    METIER_TRY(checkUnit(client, variables.force, options.force));
    if (!options.torque.empty()) {
        METIER_ASSIGN(variables.torque, nodeOf(client, options.torque));
    }
    return variables;
}

Result<NodeId> poseOf(Client& client, const RemoteForceOptions& options) {
    if (!options.pose.empty()) {
        return nodeOf(client, options.pose);
    }
    METIER_ASSIGN(const auto arm, armOf(client));
    if (arm.actual_pose.isNull()) {
        return fail(Errc::not_found, arm.device_name + " publishes no ActualPose");
    }
    return arm.actual_pose;
}

Result<std::unique_ptr<Client>> connectTo(const RemoteForceOptions& options,
                                          const std::string& url) {
    opcua::ClientOptions client;
    client.application_name = options.application_name;
    client.security = options.security;
    client.session_timeout = kSilence;
    client.publishing_interval = kSampling;
    auto connected = Client::connect(url, client);
    if (!connected) {
        return fail(connected.error().code, fmt::format("{}: {}", url, connected.error().message));
    }
    return std::move(*connected);
}

}  // namespace

/// What is known of the force; the executor's thread.
class RemoteForce::State : public std::enable_shared_from_this<State> {
public:
    State(std::string name, bool turns, std::shared_ptr<skill::Executor> executor)
        : name_(std::move(name)), executor_(std::move(executor)) {
        if (turns) {
            pose_ = fail(Errc::resource_unavailable, name_ + ": no pose has come yet");
        }
    }

    const std::string& name() const noexcept { return name_; }

    Result<MeasuredForce> newest() const {
        METIER_ASSIGN(auto measured, force_);
        METIER_ASSIGN(measured.pose, pose_);
        measured.torque = torque_;
        return measured;
    }
    void add(ForceListener& listener) { listeners_.insert(&listener); }
    void remove(ForceListener& listener) { listeners_.erase(&listener); }

    /// Callback for the client's thread, which hands each value to take() on the executor's.
    std::function<void(const DataValue&)> taker(void (State::*take)(const DataValue&, SteadyTime)) {
        return [state = shared_from_this(), take](const DataValue& data) {
            const auto now = std::chrono::steady_clock::now();
            state->executor_->post([state, take, data, now] { ((*state).*take)(data, now); });
        };
    }

    void takeForce(const DataValue& data, SteadyTime now) {
        force_ = vectorOf(data, name_).map([now](const Vector3& newtons) {
            return MeasuredForce{.force = newtons, .received = now};
        });
        report();
    }
    void takeTorque(const DataValue& data, SteadyTime /*now*/) {
        const auto torque = vectorOf(data, name_);
        torque_ = torque ? std::optional(*torque) : std::nullopt;
    }
    void takePose(const DataValue& data, SteadyTime /*now*/) {
        pose_ = frameOf(data, "the pose of " + name_);
        report();
    }

private:
    void report() {
        const auto now = newest();
        if (!now && now.error().code == Errc::resource_unavailable) {
            return;  // of force and pose only one has come so far
        }
        for (auto* const listener : std::set(listeners_)) {
            if (!listeners_.contains(listener)) {
                continue;  // removed by one before it
            }
            if (now) {
                listener->onForce(*now);
            } else {
                listener->onForceLost(now.error());
            }
        }
    }

    const std::string name_;
    std::shared_ptr<skill::Executor> executor_;  // shared by what its thread owns
    Result<MeasuredForce> force_ =
        fail(Errc::resource_unavailable, name_ + ": no force has come yet");
    std::optional<Vector3> torque_;
    Result<Frame> pose_ = Frame{};
    std::set<ForceListener*> listeners_;
};

/// Subscriptions to the values; they end before their clients.
struct RemoteForce::Connections {
    std::unique_ptr<Client> of_arm;  ///< nullptr: the axes are those of the base frame
    std::unique_ptr<Client> of_sensor;
    std::vector<opcua::Subscription> subscriptions;

    Result<void> follow(Client& client, const NodeId& variable,
                        std::function<void(const DataValue&)> take) {
        METIER_ASSIGN(
            auto subscription,
            client.subscribeData(variable, {.sampling_interval = kSampling, .queue_size = kQueue},
                                 std::move(take)));
        subscriptions.push_back(std::move(subscription));
        return {};
    }

    /// Connects, finds the Variables and subscribes.
    static Result<std::unique_ptr<Connections>> open(const RemoteForceOptions& options,
                                                     State& state,
                                                     const std::shared_ptr<Watch>& watch);
};

/// What ends the subscriptions, for the thread that makes them anew.
class RemoteForce::Watch {
public:
    /// Any thread.
    void noteLoss() {
        const std::lock_guard lock(mutex_);
        lost_ = true;
        changed_.notify_all();
    }
    /// Any thread.
    void noteValue(bool bad) {
        const std::lock_guard lock(mutex_);
        if (!bad) {
            bad_since_.reset();
        } else if (!bad_since_) {
            bad_since_ = std::chrono::steady_clock::now();
        }
        changed_.notify_all();
    }
    /// Waits until the subscriptions must be made anew, or a stop.
    void await(const std::stop_token& stop) {
        std::unique_lock lock(mutex_);
        while (!stop.stop_requested() && !lost_) {
            if (!bad_since_) {
                changed_.wait(lock, stop, [this] { return lost_ || bad_since_; });
                continue;
            }
            const auto due = *bad_since_ + kLongestBad;
            lost_ = !changed_.wait_until(lock, stop, due, [this] {
                return lost_ || !bad_since_;
            }) && !stop.stop_requested();
        }
    }
    /// Waits for a while, or until a stop.
    void pause(const std::stop_token& stop) {
        std::unique_lock lock(mutex_);
        changed_.wait_for(lock, stop, kRetry, [] { return false; });
        lost_ = false;
        bad_since_.reset();
    }

private:
    std::mutex mutex_;
    std::condition_variable_any changed_;
    bool lost_ = false;
    std::optional<SteadyTime> bad_since_;  // of the force
};

Result<std::unique_ptr<RemoteForce::Connections>> RemoteForce::Connections::open(
    const RemoteForceOptions& options, State& state, const std::shared_ptr<Watch>& watch) {
    auto connections = std::make_unique<Connections>();
    METIER_ASSIGN(connections->of_sensor, connectTo(options, options.url));
    auto& sensor = *connections->of_sensor;
    sensor.onConnectionLost([watch](const opcua::Failure& /*why*/) { watch->noteLoss(); });
    METIER_ASSIGN(const auto variables, variablesOf(sensor, options));
    if (!options.arm_url.empty()) {
        METIER_ASSIGN(connections->of_arm, connectTo(options, options.arm_url));
        auto& arm = *connections->of_arm;
        arm.onConnectionLost([watch](const opcua::Failure& /*why*/) { watch->noteLoss(); });
        METIER_ASSIGN(const auto pose, poseOf(arm, options));
        METIER_TRY(connections->follow(arm, pose, state.taker(&State::takePose)));
    }
    if (!variables.torque.isNull()) {
        METIER_TRY(connections->follow(sensor, variables.torque, state.taker(&State::takeTorque)));
    }
    METIER_TRY(
        connections->follow(sensor, variables.force,
                            [watch, take = state.taker(&State::takeForce)](const DataValue& data) {
                                watch->noteValue(data.status.isBad());
                                take(data);
                            }));
    return connections;
}

Result<std::shared_ptr<RemoteForce>> RemoteForce::connect(
    RemoteForceOptions options, std::shared_ptr<skill::Executor> executor) {
    const auto name = fmt::format("{} of {}", options.force.empty() ? "FlangeForce" : options.force,
                                  options.server_name);
    auto state = std::make_shared<State>(name, !options.arm_url.empty(), std::move(executor));
    auto watch = std::make_shared<Watch>();
    METIER_ASSIGN(auto connections, Connections::open(options, *state, watch));
    return std::shared_ptr<RemoteForce>(new RemoteForce(std::move(options), std::move(state),
                                                        std::move(watch), std::move(connections)));
}

RemoteForce::RemoteForce(RemoteForceOptions options, std::shared_ptr<State> state,
                         std::shared_ptr<Watch> watch, std::unique_ptr<Connections> connections)
    : options_(std::move(options)),
      state_(std::move(state)),
      watch_(std::move(watch)),
      connections_(std::move(connections)),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

RemoteForce::~RemoteForce() {
    thread_.request_stop();
    thread_ = {};
}

void RemoteForce::run(const std::stop_token& stop) {
    for (;;) {
        watch_->await(stop);
        connections_.reset();
        watch_->pause(stop);
        if (stop.stop_requested()) {
            return;
        }
        auto again = Connections::open(options_, *state_, watch_);
        if (again) {
            connections_ = std::move(*again);
            spdlog::warn("{}: connected again", state_->name());
        } else {
            spdlog::debug("{}: {}", state_->name(), again.error().message);
            watch_->noteLoss();
        }
    }
}

const std::string& RemoteForce::name() const {
    return state_->name();
}

Result<MeasuredForce> RemoteForce::newest() const {
    return state_->newest();
}

void RemoteForce::add(ForceListener& listener) {
    state_->add(listener);
}

void RemoteForce::remove(ForceListener& listener) {
    state_->remove(listener);
}

}  // namespace metier::client
