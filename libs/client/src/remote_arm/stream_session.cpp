#include "remote_arm/stream_session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <utility>

namespace metier::client {
namespace {

using namespace std::chrono_literals;
using device::SafetyState;

constexpr const char* kStreamType = "PositionStreamSkillType";
constexpr const char* kTarget = "TargetJointPosition";
constexpr const char* kEndOfStream = "EndOfStream";
constexpr auto kConnectTimeout = 2s;
constexpr auto kPublishingInterval = 10ms;
constexpr auto kSafetyInterval = 20ms;
// A change of the measured arm between two samples that counts as motion [rad].
constexpr double kMotion = 1e-5;

Result<client::SkillAddress> findStream(opcua::Client& client) {
    METIER_ASSIGN(const auto skills, client::findSkills(client));
    for (const auto& skill : skills) {
        if (skill.type_name == kStreamType) {
            return skill;
        }
    }
    return fail(Errc::not_found, "the server has no PositionStreamSkill");
}

SafetyState safetyFrom(opcua_skill::SafetyStateKind kind) {
    using Kind = opcua_skill::SafetyStateKind;
    switch (kind) {
        case Kind::normal:
        case Kind::reduced:
            return SafetyState::normal;
        case Kind::protective_stop:
            return SafetyState::protective_stop;
        case Kind::emergency_stop:
            return SafetyState::emergency_stop;
        case Kind::fault:
            return SafetyState::fault;
        case Kind::unknown:
            break;
    }
    return SafetyState::disconnected;
}

/// Whether the skill was halted for what is wrong with its device.
bool isOfTheRobot(const skill::TransitionEvent& event) {
    return event.to == skill::State::halted &&
           (event.reason == skill::Reason::error || event.reason == skill::Reason::device_lost);
}

}  // namespace

Result<std::unique_ptr<StreamSession>> StreamSession::open(const RemoteArmOptions& remote,
                                                           std::shared_ptr<WakeUp> wake_up) {
    opcua::ClientOptions options;
    options.application_name = "metier move component";
    options.connect_timeout = kConnectTimeout;
    options.publishing_interval = kPublishingInterval;
    options.security = remote.security;
    METIER_ASSIGN(auto client, opcua::Client::connect(remote.url, options));
    METIER_ASSIGN(auto address, findStream(*client));
    METIER_ASSIGN(auto nodes, client::findKinematics(*client, address));
    METIER_ASSIGN(auto kinematics, client::readKinematics(*client, nodes));
    if (kinematics.axisCount() > device::kMaxAxes || kinematics.cycle_time <= 0) {
        return fail(Errc::not_supported,
                    fmt::format("an arm of {} axes, at most {}; cycle {} s", kinematics.axisCount(),
                                device::kMaxAxes, kinematics.cycle_time));
    }
    METIER_ASSIGN(auto stream, client::SkillHandle::open(*client, std::move(address)));
    std::unique_ptr<StreamSession> session(
        new StreamSession(std::move(client), std::move(nodes), std::move(kinematics),
                          std::move(stream), std::move(wake_up)));
    METIER_TRY(session->subscribe());
    return session;
}

StreamSession::StreamSession(std::unique_ptr<opcua::Client> client, client::KinematicsNodes nodes,
                             opcua_skill::KinematicsData kinematics, client::SkillHandle stream,
                             std::shared_ptr<WakeUp> wake_up)
    : client_(std::move(client)),
      nodes_(std::move(nodes)),
      kinematics_(std::move(kinematics)),
      stream_(std::move(stream)),
      takes_end_(skill::findField(stream_.parameters(), kEndOfStream) != nullptr) {
    notes_->wake_up = std::move(wake_up);
}

void StreamSession::Notes::notePosition(const device::JointArray& position) {
    note([&](Observed& seen) {
        seen.sampled = std::chrono::steady_clock::now();
        if (device::largestDifference(seen.position, position) > kMotion) {
            seen.moved = seen.sampled;
        }
        seen.position = position;
    });
}

void StreamSession::Notes::noteBroken(const std::string& why) {
    note([&](Observed& seen) {
        if (seen.broken.empty()) {
            seen.broken = why;
        }
    });
}

void StreamSession::Notes::noteAnswer(const opcua::Answer<>& answer) {
    // A stream that ended meanwhile refuses; its transition has the reason.
    if (answer || answer.error().status == opcua::status::kBadInvalidState) {
        return;
    }
    if (answer.error().code == Errc::connection_lost || answer.error().code == Errc::timeout) {
        noteBroken(answer.error().message);
        return;
    }
    note([&](Observed& seen) { seen.refused = answer.error().message; });
}

void StreamSession::Notes::noteTransition(const skill::TransitionEvent& event) {
    note([&](Observed& seen) {
        if (event.from == skill::State::running) {
            seen.stream_end = event;
        }
        seen.words = isOfTheRobot(event) ? event.reason_text : "";
    });
}

void StreamSession::Notes::noteSafety(device::SafetyState safety) {
    note([&](Observed& seen) {
        if (seen.safety != safety) {
            seen.safety = safety;
            seen.safety_since = std::chrono::steady_clock::now();
        }
    });
}

/// A robot that was stopped before says why in the state of its stream skill alone.
void StreamSession::subscribeTransitions() {
    stream_.onTransition(
        [notes = notes_](const skill::TransitionEvent& event) { notes->noteTransition(event); });
    if (stream_.state() == skill::State::halted) {
        auto words = stream_.reasonText();
        notes_->note([&](Observed& seen) { seen.words = std::move(words); });
    }
}

Result<void> StreamSession::subscribe() {
    client_->onConnectionLost(
        [notes = notes_](const opcua::Failure& failure) { notes->noteBroken(failure.message); });
    subscribeTransitions();
    const auto interval = std::chrono::milliseconds(
        static_cast<std::int64_t>(std::max(kinematics_.cycle_time * 1000.0, 5.0)));
    METIER_ASSIGN(joints_, client::subscribeJointPosition(
                               *client_, nodes_, interval,
                               [notes = notes_,
                                axes = kinematics_.axisCount()](const std::vector<double>& values) {
                                   if (values.size() == axes) {
                                       notes->notePosition(device::JointArray(values));
                                   }
                               }));
    METIER_ASSIGN(const auto now, client::readJointPosition(*client_, nodes_));
    if (now.size() != kinematics_.axisCount()) {
        return fail(Errc::type_mismatch, "ActualJointPosition has another length");
    }
    notes_->notePosition(device::JointArray(now));
    return subscribeState();
}

Result<void> StreamSession::subscribeState() {
    METIER_ASSIGN(
        safety_,
        client_->subscribeData(
            nodes_.safety_state, {.sampling_interval = kSafetyInterval},
            [notes = notes_](const opcua::DataValue& value) {
                if (value.value.isEmpty()) {  // the connection or the subscription has ended
                    notes->noteBroken(fmt::format("the safety state is not told any more ({})",
                                                  value.status.name()));
                    return;
                }
                const auto kind = value.value.as<std::int32_t>();
                notes->noteSafety(kind ? safetyFrom(opcua_skill::SafetyStateKind(*kind))
                                       : SafetyState::disconnected);
            }));
    METIER_ASSIGN(missed_cycles_,
                  client_->subscribeData(
                      nodes_.missed_cycles, {.sampling_interval = kSafetyInterval},
                      [notes = notes_](const opcua::DataValue& value) {
                          if (const auto cycles = value.value.as<std::uint64_t>()) {
                              notes->note([&](Observed& seen) { seen.missed_cycles = *cycles; });
                          }
                      }));
    return subscribeStandstill();
}

Result<void> StreamSession::subscribeStandstill() {
    if (nodes_.standstill.isNull()) {
        return {};
    }
    METIER_ASSIGN(standstill_, client_->subscribeData(
                                   nodes_.standstill, {.sampling_interval = kPublishingInterval},
                                   [notes = notes_](const opcua::DataValue& value) {
                                       const auto stands = value.value.as<bool>();
                                       notes->note([&](Observed& seen) {
                                           seen.standstill = stands.value_or(false);
                                       });
                                   }));
    return {};
}

StreamSession::Observed StreamSession::observed() const {
    const std::lock_guard lock(notes_->mutex);
    return notes_->observed;
}

Result<void> StreamSession::startStream(const skill::ParentExecution& parent) {
    notes_->note([](Observed& seen) {
        seen.stream_end.reset();
        seen.refused.clear();
    });
    if (!parent.id.empty() && stream_.takesParents()) {
        METIER_TRY(stream_.startWith({.parent = parent}));
    } else {
        METIER_TRY(stream_.start());
    }
    return {};
}

void StreamSession::send(const device::JointArray& set_point, UtcTime meant_for) {
    write(kTarget, std::vector<double>(set_point.begin(), set_point.end()), meant_for);
}

bool StreamSession::endStream() {
    if (takes_end_) {
        write(kEndOfStream, true, std::chrono::system_clock::now());
    }
    return takes_end_;
}

void StreamSession::write(std::string_view parameter, const skill::Value& value,
                          UtcTime meant_for) {
    const auto sent = stream_.setAsync(
        parameter, value, meant_for,
        [notes = notes_](const opcua::Answer<>& answer) { notes->noteAnswer(answer); });
    if (!sent) {
        notes_->noteBroken(sent.error().message);
    }
}

}  // namespace metier::client
