#include "wsg50_gripper.hpp"

#include <fmt/format.h>

#include <chrono>
#include <utility>

#include "metier/link/back_off.hpp"

namespace metier::wsg50_driver {
namespace {

using namespace std::chrono_literals;
using device::SafetyState;

constexpr auto kConnectTimeout = 1s;
constexpr auto kSendTimeout = 200ms;
// Longest time after which the gripper gets an order from another thread.
constexpr auto kSlice = 5ms;

SteadyTime now() {
    return std::chrono::steady_clock::now();
}

device::GripperInfo infoFor(const std::string& name, const Limits& limits) {
    return {.name = name,
            .stroke = limits.stroke,
            .min_force = limits.min_force,
            .max_force = limits.max_force,
            .max_speed = limits.max_speed};
}

}  // namespace

Wsg50Gripper::Wsg50Gripper(Wsg50Options options)
    : options_(std::move(options)),
      usual_info_(infoFor(options_.name, Limits{})),
      safety_({SafetyState::disconnected, named("not connected yet"), false}),
      notifier_([this] {
          safety_.dispatch();
          slot_.dispatch();
      }),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

Wsg50Gripper::~Wsg50Gripper() {
    thread_.request_stop();
    thread_.join();
    lost({Errc::connection_lost, "the driver was shut down"});
}

std::string Wsg50Gripper::named(std::string_view text) const {
    return fmt::format("{}: {}", options_.name, text);
}

Result<void> Wsg50Gripper::ask(MotionKind kind, const device::GripperRequest& request, Done done) {
    const auto safety = safety_.safety();
    if (safety.state != SafetyState::normal) {
        return fail(
            safety.state == SafetyState::disconnected ? Errc::connection_lost : Errc::device_fault,
            safety.text);
    }
    const auto motion = motionFor(kind, request, options_, known_.read());
    const auto asked = motion.and_then(
        [&](const Motion& checked) { return slot_.post(checked, std::move(done)); });
    return asked ? asked : fail(asked.error().code, named(asked.error().message));
}

Result<void> Wsg50Gripper::resetFault() {
    const auto safety = safety_.safety();
    if (safety.state == SafetyState::normal) {
        return {};
    }
    if (safety.state == SafetyState::disconnected) {
        return fail(Errc::connection_lost, safety.text);
    }
    const auto outcome = resets_.ask();
    if (!outcome) {
        return fail(Errc::timeout, safety_.safety().text + "; Reset again when it is done");
    }
    return *outcome;
}

void Wsg50Gripper::run(const std::stop_token& stop) {
    link::BackOff back_off;
    while (!stop.stop_requested()) {
        answered_ = false;
        const auto ended = connection(stop);
        if (ended) {
            return;
        }
        lost(ended.error());
        if (answered_) {
            back_off.reset();
        }
        back_off.wait(stop);
    }
}

Result<void> Wsg50Gripper::connection(const std::stop_token& stop) {
    METIER_ASSIGN(auto link,
                  link::TcpLink::connect(options_.host, options_.port, now() + kConnectTimeout));
    // An earlier request belongs to the connection before.
    resets_.answer(fail(Errc::connection_lost, named("the connection was lost")));
    link_ = &link;
    sent_ = {};
    auto conversation_options = options_.conversation;
    conversation_options.home = conversation_options.home && known_.read().force_limit == 0.0;
    Conversation conversation(conversation_options, now(), *this);
    auto ended = talk(stop, conversation);
    if (ended) {
        takeLeave();
    }
    link_ = nullptr;
    return ended;
}

Result<void> Wsg50Gripper::talk(const std::stop_token& stop, Conversation& conversation) {
    FrameReader reader;
    while (!stop.stop_requested()) {
        passOrders(conversation);
        METIER_TRY(takeBytes(conversation, reader));
        if (auto ticked = conversation.tick(now()); !ticked) {
            return atPeer(ticked.error());
        }
        if (!sent_) {
            return sent_;
        }
    }
    return {};
}

/// Waits a slice for bytes, then takes all frames that are whole.
Result<void> Wsg50Gripper::takeBytes(Conversation& conversation, FrameReader& reader) {
    const auto count = link_->receive(reader.space(), now() + kSlice);
    if (!count) {
        return count.error().code == Errc::timeout ? Result<void>() : fail(count.error());
    }
    reader.received(*count);
    while (const auto frame = reader.next()) {
        if (auto taken = conversation.take(*frame, now()); !taken) {
            return atPeer(taken.error());
        }
    }
    return {};
}

Result<void> Wsg50Gripper::atPeer(const Error& error) const {
    return fail(error.code, fmt::format("{}: {}", link_->peer(), error.message));
}

void Wsg50Gripper::passOrders(Conversation& conversation) {
    const bool stop = slot_.takeStop();
    const auto* motion = slot_.take();
    if (motion != nullptr && stop) {
        onMotionEnd(fail(Errc::cancelled, "stopped before it began"));
    } else if (motion != nullptr && !conversation.ready()) {
        slot_.end(fail(Errc::device_fault, safety_.safety().text));
        notifier_.signal();
    } else if (motion != nullptr) {
        conversation.begin(*motion, now());
    } else if (stop) {
        conversation.stop(now());
    }
    if (conversation.started() && resets_.taken()) {
        conversation.reset(now());
    }
}

/// Announces the end of the connection, so that the gripper does not take it for a failure.
void Wsg50Gripper::takeLeave() {
    if (slot_.posted() != nullptr) {
        send(Command(CommandId::stop));
    }
    send(Command(CommandId::disconnect));
}

/// Notes that the connection is gone, and ends everything that was under way.
void Wsg50Gripper::lost(const Error& why) {
    const auto text = named(why.message);
    slot_.close({Errc::connection_lost, why.message});
    setSafety({SafetyState::disconnected, text, false});
    slot_.end(fail(Errc::connection_lost, text));
    resets_.answer(fail(Errc::connection_lost, text));
    notifier_.signal();
}

void Wsg50Gripper::publish(device::GripperState state) {
    state.safety = safety_.state();
    state_.write(state);
}

void Wsg50Gripper::setSafety(device::Safety safety) {
    safety_.set(std::move(safety));
    publish(state_.read());
}

void Wsg50Gripper::send(Command command) {
    if (sent_) {
        sent_ = link_->send(command.bytes(), now() + kSendTimeout);
    }
}

void Wsg50Gripper::onLimits(const Limits& limits, double force_limit) {
    answered_ = true;
    auto known = known_.read();
    known.limits = limits;
    if (known.force_limit == 0.0) {
        known.force_limit = force_limit;
        read_info_ = infoFor(options_.name, limits);
        info_.store(&read_info_);
    }
    known_.write(known);
}

void Wsg50Gripper::onState(const device::GripperState& state) {
    publish(state);
}

void Wsg50Gripper::onSafety(device::Safety safety) {
    if (safety.state == SafetyState::normal) {
        slot_.open();
        setSafety({});
    } else {
        slot_.close({Errc::device_fault, safety.text});
        setSafety({safety.state, named(safety.text), safety.limit_violated});
    }
    notifier_.signal();
}

void Wsg50Gripper::onMotionEnd(Result<device::GripperOutcome> outcome) {
    slot_.end(outcome ? std::move(outcome)
                      : fail(outcome.error().code, named(outcome.error().message)));
    notifier_.signal();
}

void Wsg50Gripper::onResetEnd(Result<void> outcome) {
    resets_.answer(outcome ? outcome : fail(outcome.error().code, named(outcome.error().message)));
}

}  // namespace metier::wsg50_driver
