#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "conversation.hpp"
#include "wire.hpp"

namespace metier::wsg50_driver::testing {

/// A conversation whose gripper and whose time are moved by hand.
class Talk : private ConversationListener {
public:
    explicit Talk(ConversationOptions options = {})
        : options_(options), conversation_(options, now_, *this) {}

    /// Everything up to a gripper that is ready; `bits` of its system state.
    void start(std::uint32_t bits = kReferenced) {
        hear(limits());
        hear(reply(0x33, kSuccess, f32(40)));
        if (options_.acceleration > 0) {
            hear(reply(0x30, kSuccess));
        }
        hear(systemState(bits));
        hear(graspingState(kIdle));
        hear(width(50));
        hear(force(0));
    }

    /// Takes frames; the last error of the conversation, if there was one, stays in `error`.
    void hear(const Bytes& bytes) {
        std::copy(bytes.begin(), bytes.end(), reader_.space().begin());
        reader_.received(bytes.size());
        while (const auto frame = reader_.next()) {
            note(conversation_.take(*frame, now_));
        }
    }

    /// One update of all four values.
    void update(std::uint32_t bits, int grasping, float width_mm, float newton = 0) {
        hear(systemState(bits));
        hear(graspingState(grasping));
        hear(width(width_mm));
        hear(force(newton));
    }

    /// Lets time pass, with an unchanged gripper that goes on sending its state.
    void pass(std::chrono::milliseconds time, std::uint32_t bits, int grasping, float width_mm) {
        for (auto left = time; left.count() > 0; left -= options_.update_period) {
            now_ += options_.update_period;
            update(bits, grasping, width_mm);
            note(conversation_.tick(now_));
        }
    }

    /// Lets time pass in silence.
    void wait(std::chrono::milliseconds time) {
        now_ += time;
        note(conversation_.tick(now_));
    }

    void begin(const Motion& motion) { conversation_.begin(motion, now_); }
    void stop() { conversation_.stop(now_); }
    void reset() { conversation_.reset(now_); }
    bool ready() const { return conversation_.ready(); }

    /// The error that the motion ended with; empty text if it did not.
    std::string motionError() const {
        return ends.size() == 1 && !ends.front() ? ends.front().error().message : "";
    }
    Errc motionCode() const { return ends.front().error().code; }

    /// The commands so far, by id.
    std::vector<int> sentIds() const {
        std::vector<int> ids;
        for (const auto& command : sent) {
            ids.push_back(std::to_integer<int>(command[3]));
        }
        return ids;
    }

    std::vector<Bytes> sent;
    std::vector<device::Safety> safeties;
    std::vector<Result<device::GripperOutcome>> ends;
    std::vector<Result<void>> resets;
    device::GripperState state;
    std::optional<Limits> known_limits;
    double force_limit = 0;
    std::optional<Error> error;

private:
    void note(const Result<void>& result) {
        if (!result) {
            error = result.error();
        }
    }
    void send(Command command) override {
        const auto bytes = command.bytes();
        sent.emplace_back(bytes.begin(), bytes.end());
    }
    void onLimits(const Limits& told, double limit) override {
        known_limits = told;
        force_limit = limit;
    }
    void onState(const device::GripperState& told) override { state = told; }
    void onSafety(device::Safety safety) override { safeties.push_back(std::move(safety)); }
    void onMotionEnd(Result<device::GripperOutcome> outcome) override {
        ends.push_back(std::move(outcome));
    }
    void onResetEnd(Result<void> outcome) override { resets.push_back(std::move(outcome)); }

    ConversationOptions options_;
    SteadyTime now_ = SteadyTime(std::chrono::hours(1));
    FrameReader reader_;
    Conversation conversation_;
};

inline constexpr Motion kGrasp{MotionKind::grasp, 0.030, 0.05, 20.0};
inline constexpr Motion kRelease{MotionKind::release, 0.080, 0.1, 20.0};
inline constexpr Motion kMove{MotionKind::move, 0.060, 0.1, 20.0};

}  // namespace metier::wsg50_driver::testing
