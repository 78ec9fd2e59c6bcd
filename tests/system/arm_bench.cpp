#include "arm_bench.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace metier::system_tests {

using namespace std::chrono_literals;
using skill::State;

namespace {

constexpr double kStarted = 0.02;  // [rad]
constexpr double kSamePlace = 1e-6;
// Longer than any cycle of a controller, or of its world.
constexpr auto kPause = 20ms;
constexpr int kRestingLooks = 4;

}  // namespace

std::string toString(When when) {
    constexpr std::array kNames{"ready", "moving", "suspending", "suspended", "resuming", "halted"};
    return kNames.at(static_cast<std::size_t>(when));
}

void PrintTo(const ArmCase& arm, std::ostream* out) {
    *out << arm.name;
}

const std::vector<ArmCase>& allArms() {
    static const std::vector<ArmCase> kArms{
        {.name = "ur5", .axis_1 = 1.0, .stop_fault = "protective-stop", .speed = 0.1},
        {"iiwa", 1.0, "protective-stop", ArmCase::Cut::goes_on},
        {"edo", 0.6, "brake"},
        {"edo_classic", 0.6, "brake"}};
    return kArms;
}

ArmBench::ArmBench(const ArmCase& arm)
    : arm_(arm),
      cell_(deviceCell(arm.name)),
      client_(connectTo(cell_.url("arm"))),
      skill_(openSkill(*client_, "JointPtpMoveSkill")),
      home_(jointPosition(*client_, skill_)) {
    skill_.onTransition([this](const skill::TransitionEvent& event) { events_.tryPush(event); });
}

ArmBench::~ArmBench() {
    skill_.onTransition({});
}

void ArmBench::happensNow() {
    while (events_.popUntil({})) {
    }
    injected_ = std::chrono::system_clock::now();
}

void ArmBench::inject(const std::string& fault, const std::string& value) {
    happensNow();
    cell_.inject("controller", fault, value);
}

void ArmBench::startLongMove() {
    auto target = home_;
    target.front() += arm_.axis_1;
    ASSERT_TRUE(skill_.set("TargetJointPosition", target));
    ASSERT_TRUE(skill_.set("SpeedOverride", arm_.speed));
    const auto started = skill_.start();
    ASSERT_TRUE(started) << started.error().message;
    awaitProgress(kStarted);
}

void ArmBench::awaitProgress(double farther) {
    const auto deadline = inAMinute();
    const double before = std::abs(position() - home_.front());
    while (std::abs(position() - home_.front()) < before + farther) {
        ASSERT_LT(std::chrono::steady_clock::now(), deadline) << "the arm does not move";
        pause();
    }
}

void ArmBench::bring(When when) {
    if (when == When::ready) {
        return;
    }
    startLongMove();
    if (when == When::moving) {
        return;
    }
    if (when == When::halted) {
        ASSERT_TRUE(skill_.halt());
        ASSERT_TRUE(skill_.awaitState(State::halted, inAMinute()));
        return;
    }
    ASSERT_TRUE(skill_.suspend());
    if (when == When::suspending) {
        return;
    }
    ASSERT_TRUE(skill_.awaitState(State::suspended, inAMinute()));
    if (when == When::resuming) {
        ASSERT_TRUE(skill_.resume());
    }
}

double ArmBench::position() const {
    return state().at("joint_position").at(0).get<double>();
}

skill::TransitionEvent ArmBench::endWithin(std::chrono::milliseconds time) {
    const auto deadline = std::chrono::steady_clock::now() + time;
    while (const auto event = events_.popUntil(deadline)) {
        if (event->to == State::halted || event->to == State::ready) {
            return *event;
        }
    }
    ADD_FAILURE() << "the skill did not end in time";
    return {};
}

skill::TransitionEvent ArmBench::haltedAfterInjection() {
    auto halted = endWithin(60s);
    EXPECT_EQ(halted.to, State::halted) << halted.reason_text;
    EXPECT_LT(halted.time - injected_, kNoticed);
    ::testing::Test::RecordProperty(
        "halted_after_ms", std::to_string(std::chrono::duration_cast<std::chrono::milliseconds>(
                                              halted.time - injected_)
                                              .count()));
    return halted;
}

void ArmBench::awaitState(const std::string& name, const std::string& value) const {
    const auto deadline = inAMinute();
    while (state().at(name) != value) {
        ASSERT_LT(std::chrono::steady_clock::now(), deadline) << state();
        pause();
    }
}

void ArmBench::awaitReasonText(const std::string& part) {
    const auto deadline = inAMinute();
    while (skill_.reasonText().find(part) == std::string::npos) {
        ASSERT_LT(std::chrono::steady_clock::now(), deadline) << skill_.reasonText();
        pause();
    }
}

void ArmBench::pause() const {
    nothing_.popUntil(std::chrono::steady_clock::now() + kPause);
}

void ArmBench::expectAtRestOnTheWay() const {
    const auto deadline = std::chrono::steady_clock::now() + kNoticed;
    double last = position();
    for (int resting = 0; resting < kRestingLooks;) {
        pause();
        const double now = position();
        resting = std::abs(now - last) > kSamePlace ? 0 : resting + 1;
        last = now;
        ASSERT_LT(std::chrono::steady_clock::now(), deadline) << "the arm still moves";
    }
    EXPECT_LT(std::abs(last - home_.front()), 0.95 * std::abs(arm_.axis_1));
}

void ArmBench::expectNowhereElse() const {
    const auto joints = state().at("joint_position").get<std::vector<double>>();
    const double moved = (joints.front() - home_.front()) / arm_.axis_1;
    EXPECT_GT(moved, -1e-2);
    EXPECT_LT(moved, 1.0 + 1e-2);
    for (std::size_t axis = 1; axis < home_.size(); ++axis) {
        EXPECT_NEAR(joints.at(axis), home_[axis], 2e-3) << "axis " << axis + 1;
    }
}

void ArmBench::expectResetAndMove() {
    const auto deadline = inAMinute();
    auto reset = skill_.reset();
    while (!reset && std::chrono::steady_clock::now() < deadline) {
        pause();
        reset = skill_.reset();
    }
    ASSERT_TRUE(reset) << reset.error().message;
    const auto moved = skill_.run({{"TargetJointPosition", home_}}, inAMinute());
    EXPECT_TRUE(moved) << moved.error().message;
}

}  // namespace metier::system_tests
