#include "remote_arm/stream_session.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <future>
#include <utility>

namespace metier::client {
namespace {

using namespace std::chrono_literals;
using device::SafetyState;

constexpr const char* kStreamType = "PositionStreamSkillType";
constexpr const char* kEndOfStream = "EndOfStream";
constexpr auto kConnectTimeout = 2s;
constexpr auto kPublishingInterval = 10ms;
constexpr auto kSafetyInterval = 20ms;
// Longest time until a stream of another maker that was halted stands.
constexpr auto kLongestHalt = 3s;
// Age of a set-point without an answer from which on no further one is sent to another maker's arm.
constexpr auto kLongestUnanswered = 100ms;

/// The only stream skill of a server, or of one of its controllers; also of a type below: the
/// published type is abstract.
Result<client::SkillAddress> findStream(opcua::Client& client, const std::string& controller) {
    METIER_ASSIGN(const auto skills, client::findSkills(client));
    std::vector<client::SkillAddress> streams;
    std::vector<std::string> names;
    for (const auto& skill : skills) {
        const bool wanted = controller.empty() || skill.controllerName() == controller;
        if (skill.servesAs(kStreamType) && wanted) {
            names.push_back(fmt::format("{} of {}", skill.name, skill.controllerName()));
            streams.push_back(skill);
        }
    }
    if (streams.empty()) {
        return fail(Errc::not_found,
                    fmt::format("the server has no PositionStreamSkill{}{}",
                                controller.empty() ? "" : " of controller ", controller));
    }
    if (streams.size() > 1) {
        return fail(Errc::invalid_argument,
                    fmt::format("the server has several streams: {}; choose one by controller",
                                fmt::join(names, ", ")));
    }
    return std::move(streams.front());
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

StreamTarget targetFor(const PublishedArm& arm, const std::optional<GivenArm>& given) {
    StreamTarget target;
    target.places = arm.places;
    if (given) {
        target.pose_at = given->pose_at;
    }
    return target;
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
    METIER_ASSIGN(auto address, findStream(*client, remote.controller));
    METIER_ASSIGN(auto arm, findArm(*client, address, remote.given));
    METIER_ASSIGN(auto stream, client::SkillHandle::open(*client, address));
    std::optional<ForeignStream> foreign;
    if (!stream.knowsExecutions()) {
        METIER_ASSIGN(foreign, findForeignStream(*client, address, targetFor(arm, remote.given)));
    }
    std::unique_ptr<StreamSession> session(new StreamSession(std::move(client), std::move(arm),
                                                             std::move(stream), std::move(foreign),
                                                             std::move(wake_up)));
    METIER_TRY(session->subscribe());
    return session;
}

StreamSession::StreamSession(std::unique_ptr<opcua::Client> client, PublishedArm arm,
                             client::SkillHandle stream, std::optional<ForeignStream> foreign,
                             std::shared_ptr<WakeUp> wake_up)
    : client_(std::move(client)),
      arm_(std::move(arm)),
      stream_(std::move(stream)),
      notes_(std::make_shared<Notes>(std::move(wake_up))),
      foreign_(foreign.has_value()),
      target_(foreign ? foreign->target : targetFor(arm_, {})),
      poll_(std::make_unique<ArmPoll>(
          *client_, arm_, foreign ? std::optional(foreign->program) : std::nullopt, notes_)) {}

std::vector<Lack> StreamSession::lacks() const {
    // The lock of a device is not taken for a stream.
    auto lacks = foreign_ ? std::vector{Lack::atomic_start, Lack::dead_man} : std::vector<Lack>();
    const auto of_arm = arm_.lacks();
    lacks.insert(lacks.end(), of_arm.begin(), of_arm.end());
    if (poll_->hasUnknownStops()) {
        lacks.push_back(Lack::safety_state);
    }
    return lacks;
}

/// A robot that was stopped before says why in the state of its stream skill alone.
void StreamSession::subscribeTransitions() {
    stream_.onTransition([notes = notes_, foreign = foreign_](const skill::TransitionEvent& event) {
        notes->note([&](Observed& seen) {
            if (!foreign && event.from == skill::State::running) {
                seen.stream_end = event;
            }
            // Another maker's event has no reason: its message is the best there is.
            const bool has_words = foreign ? event.to == skill::State::halted : isOfTheRobot(event);
            seen.words = has_words ? event.reason_text : "";
        });
    });
    if (stream_.state() == skill::State::halted) {
        auto words = stream_.reasonText();
        notes_->note([&](Observed& seen) { seen.words = std::move(words); });
    }
}

Result<void> StreamSession::subscribe() {
    client_->onConnectionLost(
        [notes = notes_](const opcua::Failure& failure) { notes->noteBroken(failure.message); });
    subscribeTransitions();
    METIER_TRY(poll_->askAndWait());
    if (!arm_.nodes) {
        return {};
    }
    METIER_TRY(subscribePosition(*arm_.nodes));
    METIER_TRY(subscribeState(*arm_.nodes));
    return subscribeStandstill(*arm_.nodes);
}

Result<void> StreamSession::subscribePosition(const KinematicsNodes& nodes) {
    const auto axes = arm_.kinematics.axisCount();
    const auto interval = std::chrono::milliseconds(
        static_cast<std::int64_t>(std::max(arm_.kinematics.cycle_time * 1000.0, 5.0)));
    METIER_ASSIGN(joints_, client::subscribeJointPosition(
                               *client_, nodes, interval,
                               [notes = notes_, axes](const std::vector<double>& values) {
                                   if (values.size() == axes) {
                                       notes->notePosition(device::JointArray(values));
                                   }
                               }));
    METIER_ASSIGN(const auto now, client::readJointPosition(*client_, nodes));
    if (now.size() != axes) {
        return fail(Errc::type_mismatch, "ActualJointPosition has another length");
    }
    notes_->notePosition(device::JointArray(now));
    return {};
}

Result<void> StreamSession::subscribeState(const KinematicsNodes& nodes) {
    METIER_ASSIGN(
        safety_,
        client_->subscribeData(
            nodes.safety_state, {.sampling_interval = kSafetyInterval},
            [notes = notes_](const opcua::DataValue& value) {
                if (value.value.isEmpty()) {  // the connection or the subscription has ended
                    notes->noteBroken(fmt::format("the safety state is not published any more ({})",
                                                  value.status.name()));
                    return;
                }
                const auto kind = value.value.as<std::int32_t>();
                notes->noteSafety(kind ? safetyFrom(opcua_skill::SafetyStateKind(*kind))
                                       : SafetyState::disconnected);
            }));
    METIER_ASSIGN(missed_cycles_,
                  client_->subscribeData(
                      nodes.missed_cycles, {.sampling_interval = kSafetyInterval},
                      [notes = notes_](const opcua::DataValue& value) {
                          if (const auto cycles = value.value.as<std::uint64_t>()) {
                              notes->note([&](Observed& seen) { seen.missed_cycles = *cycles; });
                          }
                      }));
    return {};
}

Result<void> StreamSession::subscribeStandstill(const KinematicsNodes& nodes) {
    if (nodes.standstill.isNull()) {
        return {};
    }
    METIER_ASSIGN(standstill_, client_->subscribeData(
                                   nodes.standstill, {.sampling_interval = kPublishingInterval},
                                   [notes = notes_](const opcua::DataValue& value) {
                                       const auto stands = value.value.as<bool>();
                                       notes->note([&](Observed& seen) {
                                           seen.standstill = stands.value_or(false);
                                       });
                                   }));
    return {};
}

Result<void> StreamSession::startStream(const skill::ParentExecution& parent,
                                        const device::JointArray& first) {
    if (foreign_) {
        METIER_TRY(presetTarget(first));
    }
    notes_->note([this](Observed& seen) {
        seen.stream_end.reset();
        seen.refused.clear();
        if (foreign_) {
            seen.words.clear();
        }
    });
    if (!parent.id.empty() && stream_.takesParents()) {
        METIER_TRY(stream_.startWith({.parent = parent}));
    } else if (const auto started = stream_.start(); !started) {
        if (foreign_ && started.error().delivery == opcua::Failure::Delivery::unknown) {
            static_cast<void>(haltStream());  // it may run, and nobody else would end it
        }
        return fail(started.error());
    }
    if (foreign_) {
        notes_->noteCommanded(skill::State::running);
    }
    return {};
}

/// Writes the place where the arm stands: the parameter still has the last set-point of the stream
/// before, to which the arm would go at its Start. A server may refuse SourceTimestamps.
Result<void> StreamSession::presetTarget(const device::JointArray& first) {
    const auto value = target_.valueOf(first);
    // Shared with the client's thread, which answers it once.
    const auto answered = std::make_shared<std::promise<opcua::Answer<>>>();
    METIER_TRY(stream_.setAsync(
        target_.parameter, value,
        sends_times_ ? std::optional(std::chrono::system_clock::now()) : std::nullopt,
        [answered](opcua::Answer<> answer) { answered->set_value(std::move(answer)); }));
    auto written = answered->get_future().get();
    if (!written && written.error().code == Errc::not_supported && sends_times_) {
        sends_times_ = false;
        written = stream_.set(target_.parameter, value);
    }
    METIER_TRY(written);
    return {};
}

void StreamSession::send(const device::JointArray& set_point, UtcTime meant_for) {
    write(target_.parameter, target_.valueOf(set_point),
          sends_times_ ? std::optional(meant_for) : std::nullopt);
}

Result<StreamSession::Ending> StreamSession::endStream() {
    if (skill::findField(stream_.parameters(), kEndOfStream) != nullptr) {
        write(kEndOfStream, true, std::chrono::system_clock::now());
        return Ending::awaited;
    }
    METIER_ASSIGN(const bool halted, haltStream());
    if (!halted) {
        return Ending::awaited;  // its state says how it ended
    }
    METIER_TRY(stream_.awaitRest(std::chrono::steady_clock::now() + kLongestHalt));
    METIER_TRY(resetHalted());
    return Ending::reached;
}

bool StreamSession::isBehind() const {
    return notes_->oldestUnanswered() < std::chrono::steady_clock::now() - kLongestUnanswered;
}

Result<bool> StreamSession::haltStream() {
    const auto halted = stream_.halt();
    // A stream that has ended meanwhile cannot be halted.
    if (!halted && !(foreign_ && halted.error().status == opcua::status::kBadInvalidState)) {
        return fail(halted.error());
    }
    return halted.has_value();
}

Result<void> StreamSession::resetStream(bool stopped) {
    METIER_ASSIGN(auto state, stream_.state());
    // A skill that is Ready while its arm is stopped resets the arm by way of Halted; one of
    // another maker that is Suspended would go on to an old set-point.
    const bool goes_on = state == skill::State::suspended || state == skill::State::running;
    if (foreign_ ? goes_on : state == skill::State::ready && stopped) {
        METIER_TRY(stream_.halt());
        if (foreign_) {
            METIER_TRY(stream_.awaitRest(std::chrono::steady_clock::now() + kLongestHalt));
        }
        state = skill::State::halted;
    }
    if (state == skill::State::halted || stopped) {
        return resetHalted();
    }
    return {};
}

Result<void> StreamSession::resetHalted() {
    if (foreign_) {
        METIER_ASSIGN(const auto state, stream_.state());
        if (state == skill::State::ready) {
            notes_->noteCommanded(state);
            return {};
        }
    }
    METIER_TRY(stream_.reset());
    if (foreign_) {
        notes_->noteCommanded(skill::State::ready);
    }
    return {};
}

void StreamSession::write(std::string_view parameter, const skill::Value& value,
                          std::optional<UtcTime> meant_for) {
    const auto number = notes_->noteWrite();
    const auto sent = stream_.setAsync(parameter, value, meant_for,
                                       [notes = notes_, number](const opcua::Answer<>& answer) {
                                           notes->noteAnswer(number, answer);
                                       });
    if (!sent) {
        notes_->noteBroken(sent.error().message);
    }
}

}  // namespace metier::client
