// The clock of a server's computer jumps, by days and years, or in steps, while its arm moves.
#include <gmock/gmock.h>

#include <optional>
#include <ostream>

#include "discovered_cell.hpp"
#include "installation.hpp"
#include "jumping_clock/jumping_clock.hpp"
#include "metier/base/queue.hpp"
#include "watched_skill.hpp"

namespace metier::system_tests {
namespace {

using namespace std::chrono_literals;
using skill::Reason;
using skill::State;

/// Present time of a server's clock.
UtcTime timeOf(opcua::Client& client) {
    return client.read(opcua::NodeId(0, 2258U)).value().as<UtcTime>().value();
}

using Offsets = std::vector<std::chrono::nanoseconds>;
constexpr std::chrono::hours kDay{24};
constexpr auto kTenYears = 3'652 * kDay;

struct Jump {
    const char* name;
    Offsets offsets;  // one after the other during each motion, kStep of axis 1 apart
};
void PrintTo(const Jump& jump, std::ostream* out) {
    *out << jump.name;
}

constexpr double kStep = 0.03;  // [rad]
// Three times as far as the most steps lead: a machine that is busy looks late.
constexpr double kTarget = 2.0;  // [rad]

/// A second to and fro, and at last more.
Offsets steps() {
    Offsets offsets;
    for (int i = 0; i < 10; ++i) {
        offsets.insert(offsets.end(), {1s, 0s});
    }
    offsets.emplace_back(2h);
    return offsets;
}

class ClockJump : public ::testing::TestWithParam<Jump> {
protected:
    void SetUp() override {
        if (!JumpingClock::obstacle().empty()) {
            GTEST_SKIP() << "NOT TESTED: " << JumpingClock::obstacle();
        }
        server_.emplace(clock_.of(
            metierCommand({"serve", simulatedCell().string(), "--server", "iiwa", "--port", "0"})));
        move_.emplace(server_->url(), "JointPtpMoveSkill");
    }
    /// Axis 1 to kTarget and nowhere else, over some six seconds.
    void start() {
        ASSERT_TRUE(
            (*move_)->set("TargetJointPosition", std::vector<double>{kTarget, 0, 0, 0, 0, 0, 0}));
        ASSERT_TRUE((*move_)->set("SpeedOverride", 0.2));
        const auto started = (*move_)->start();
        ASSERT_TRUE(started) << started.error().message;
        EXPECT_EQ(move_->awaitEvent(State::running).to, State::running);
    }
    void jump() {
        for (const auto& offset : GetParam().offsets) {
            clock_.set(offset);
            const auto there = axis() + kStep;
            ASSERT_TRUE(holdsSoon([&] { return axis() >= there; }));
        }
    }

    double axis() { return jointPosition(move_->client(), **move_).front(); }

    JumpingClock clock_;
    std::optional<ServerProcess> server_;
    std::optional<Watched> move_;
};

TEST_P(ClockJump, NeitherEndsNorDelaysAMotion) {
    start();
    const auto begun = std::chrono::steady_clock::now();
    jump();
    const auto ended = move_->awaitEvent(State::ready);
    EXPECT_EQ(ended.reason, Reason::finished) << ended.reason_text;
    EXPECT_LT(std::chrono::steady_clock::now() - begun, 30s);
    EXPECT_NEAR(axis(), kTarget, 1e-3);
    const auto wrong = timeOf(move_->client()) - std::chrono::system_clock::now();
    EXPECT_LT(std::chrono::abs(wrong - GetParam().offsets.back()), 30s) << "the clock did jump";
}

TEST_P(ClockJump, DoesNotKeepAnArmFromStopping) {
    start();
    jump();
    ASSERT_TRUE((*move_)->halt());
    EXPECT_EQ(move_->awaitEvent(State::halted).reason, Reason::by_client);
    const auto resting = axis();
    EXPECT_LT(resting, kTarget);
    EXPECT_NEAR(axis(), resting, 1e-3);
}

INSTANTIATE_TEST_SUITE_P(ByTime, ClockJump,
                         ::testing::Values(Jump{"ADayOn", {kDay}}, Jump{"ADayBack", {-kDay}},
                                           Jump{"TenYearsOn", {kTenYears}},
                                           Jump{"TenYearsBack", {-kTenYears}},
                                           Jump{"StepsOfSeconds", steps()}),
                         [](const auto& of) { return std::string(of.param.name); });

class ClockJumpOfAClosedServer : public ::testing::Test {
protected:
    void SetUp() override {
        if (!JumpingClock::obstacle().empty()) {
            GTEST_SKIP() << "NOT TESTED: " << JumpingClock::obstacle();
        }
    }

    JumpingClock clock_;
    const Installation here_{"here"};
};

// All certificates are over by that clock: who is there stays, also when the server looks again.
TEST_F(ClockJumpOfAClosedServer, EndsNoSession) {
    const auto options = here_.asCommand();
    const ServerProcess arm(clock_.of(
        here_.command({"serve", simulatedCell().string(), "--server", "iiwa", "--port", "0"})));
    const auto client = opcua::Client::connect(arm.url(), options);
    ASSERT_TRUE(client) << client.error().message;
    auto second = options;
    second.application_name = "metier second";
    const auto user = here_.run({"user", "add", "anna"}, "anna's own");
    ASSERT_EQ(user.status, 0) << user.output;
    second.user = opcua::UserName{"anna", "anna's own"};
    const auto leaving = opcua::Client::connect(arm.url(), second);
    ASSERT_TRUE(leaving) << leaving.error().message;
    clock_.set(kTenYears);
    ASSERT_EQ(here_.run({"user", "remove", "anna"}).status, 0);  // so the server looks
    EXPECT_TRUE(holdsSoon([&] { return !(*leaving)->read(opcua::NodeId(0, 2258U)); }));
    EXPECT_TRUE((*client)->read(opcua::NodeId(0, 2258U)));
}

}  // namespace
}  // namespace metier::system_tests
