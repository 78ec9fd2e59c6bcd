// Arms that move together come to rest together, for a stop of any of them; three processes.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "metier/opcua_skill/namespaces.hpp"
#include "metier_program.hpp"
#include "watched_skill.hpp"

namespace metier::system_tests {
namespace {

using skill::Reason;
using skill::State;
using skill::ValueMap;
using ::testing::HasSubstr;
using ::testing::StartsWith;

using Seconds = std::chrono::duration<double>;
using Joints = std::vector<double>;

// Largest difference at which the arms may stand on the common way [s of the planned time].
constexpr double kApart = 0.020;
// The longer cycle of the two arms; a round trip on this machine, which runs other tests, too [s].
constexpr double kCycle = 0.008;
constexpr double kRoundTrip = 0.030;
// Others run on this machine: one round of so many is not held up by them.
constexpr int kRounds = 5;
// Duration of the common motion, long enough for all that is done on the way [s].
constexpr double kDuration = 4.0;

std::filesystem::path cell() {
    return std::filesystem::path(METIER_SOURCE_DIR) / "tests" / "system" / "synchronized.toml";
}

ServerProcess serve(const std::string& name, std::vector<std::string> more = {}) {
    more.insert(more.end(), {"--port", "0"});
    return ServerProcess(name, more, cell());
}

/// Time when a skill began to come to rest, by its server's clock.
class Stops {
public:
    Stops(opcua::Client& client, const opcua::NodeId& skill) {
        const auto metier = client.namespaceIndex(opcua_skill::kMetierUri).value();
        subscription_ =
            client
                .subscribeEvents(
                    skill,
                    {.fields = {{{0, "Time"}}},
                     .of_type = opcua::NodeId(metier, opcua_skill::kStoppingEventTypeId)},
                    [times = times_](const opcua::EventNotice& notice) {
                        if (notice.kind == opcua::EventNotice::Kind::event) {
                            times->tryPush(notice.fields[0].as<UtcTime>().value());
                        }
                    })
                .value();
    }
    UtcTime next() { return times_->popUntil(inAMinute()).value(); }

private:
    // Shared with the callback, which may run until the subscription has ended.
    std::shared_ptr<Queue<UtcTime>> times_ = std::make_shared<Queue<UtcTime>>(100);
    opcua::Subscription subscription_;
};

double distance(const Joints& a, const Joints& b) {
    double sum = 0.0;
    for (std::size_t axis = 0; axis < a.size(); ++axis) {
        sum += (a[axis] - b[axis]) * (a[axis] - b[axis]);
    }
    return std::sqrt(sum);
}

/// One arm of the two: its server, and a client that is not the component.
class Arm {
public:
    explicit Arm(const std::string& server)
        : server_(serve(server)),
          skill_(server_.url(), "JointPtpMoveSkill"),
          stops_(skill_.client(), skill_->address().node),
          home_(joints()) {}

    const std::string& url() const { return server_.url(); }
    client::SkillHandle& skill() { return *skill_; }
    skill::TransitionEvent awaitEvent(State to) { return skill_.awaitEvent(to); }
    Joints joints() { return jointPosition(skill_.client(), *skill_); }
    const Joints& home() const { return home_; }
    UtcTime stopped() { return stops_.next(); }
    /// Waits until it has gone a good part of its way, at most a minute.
    void awaitOnTheWay() {
        constexpr double part = 0.4;
        const auto deadline = inAMinute();
        while (distance(home_, joints()) < part * distance(home_, way_.back())) {
            ASSERT_LT(std::chrono::steady_clock::now(), deadline);
        }
    }

    void goHome() {
        const auto gone = skill_->runWith(
            {fmt::format("home-{}", ++homes_), {{"TargetJointPosition", home_}}}, inAMinute());
        ASSERT_TRUE(gone) << gone.error().message;
    }
    /// Records its places at equal intervals of the way from home to here.
    void learnWay() {
        const auto target = joints();
        goHome();
        const auto report =
            skill_->check({{"TargetJointPosition", target}, {"Duration", kDuration}});
        ASSERT_TRUE(report) << report.error().message;
        ASSERT_TRUE(report->possible) << report->reason;
        way_ = report->joint_path;
    }
    /// The planned time at which it is where it stands now [s].
    double plannedTime() {
        const double gone = distance(home_, joints());
        const auto after = std::find_if(way_.begin(), way_.end(), [&](const Joints& place) {
            return distance(home_, place) > gone;
        });
        if (after == way_.begin() || after == way_.end()) {
            return after == way_.end() ? kDuration : 0.0;
        }
        const double low = distance(home_, *(after - 1));
        const double step = distance(home_, *after) - low;
        const auto index = static_cast<double>(after - 1 - way_.begin());
        return kDuration * (index + (gone - low) / step) / static_cast<double>(way_.size() - 1);
    }

private:
    ServerProcess server_;
    Watched skill_;
    Stops stops_;
    const Joints home_;
    std::vector<Joints> way_;
    int homes_ = 0;
};

/// Two arms, `left` and `right` for the component, and what a round of stopping them showed.
class StoppedArms : public ::testing::Test {
protected:
    struct Round {
        double begins_later;        ///< the other arm begins to brake so long after the first [s]
        double skew;                ///< of the planned times at which they stand [s]
        double stands;              ///< so long after the first has begun to brake, both stand [s]
        bool heard_in_time = true;  ///< the other began before the first one stood
    };

    StoppedArms(const std::string& left, const std::string& right, skill::Frame left_pose)
        : left_(left),
          right_(right),
          both_server_(
              serve("both", {"--use", "left=" + left_.url(), "--use", "right=" + right_.url()})),
          both_(both_server_.url(), "SynchronizedMoveSkill"),
          poses_{
              {"TargetPoses", std::vector<skill::Frame>{left_pose, {0.4, -0.3, 0.5, 3.14, 0, 1}}},
              {"Duration", kDuration}} {
        const auto there = both_->runWith({"there", poses_}, inAMinute());
        EXPECT_TRUE(there) << there.error().message;
        left_.learnWay();
        right_.learnWay();
    }

    void start(int round) {
        const auto started = both_->startWith({fmt::format("round-{}", round), poses_});
        ASSERT_TRUE(started) << started.error().message;
        left_.awaitOnTheWay();
        right_.awaitOnTheWay();
    }
    /// After both stand. \param last when the later one came to rest
    Round observed(UtcTime first, UtcTime other, UtcTime last) {
        return {Seconds(other - first).count(),
                std::abs(left_.plannedTime() - right_.plannedTime()),
                Seconds(last - first).count()};
    }
    static void print(const Round& round) {
        fmt::print("the other begins {:.1f} ms later, skew {:.1f} ms, both stand after {:.3f} s\n",
                   1e3 * round.begins_later, 1e3 * round.skew, round.stands);
    }
    /// A client that is not the component halts the left arm, and resets all when they stand.
    Round haltLeft() {
        EXPECT_TRUE(left_.skill().halt());
        const auto first = left_.stopped();
        const auto other = right_.stopped();
        const auto stands = left_.awaitEvent(State::halted);
        right_.awaitEvent(State::halted);
        const auto both = both_.awaitEvent(State::halted);
        EXPECT_THAT(both.reason_text, StartsWith("left was Halted (ByClient)"));
        auto seen = observed(first, other, both.time);
        seen.heard_in_time = other < stands.time;
        EXPECT_TRUE(both_->reset());
        EXPECT_TRUE(left_.skill().reset());
        right_.awaitEvent(State::ready);
        return seen;
    }
    static bool beginsAtOnce(const Round& round) {
        return round.begins_later < kCycle + kRoundTrip && round.heard_in_time;
    }
    static void expectBegunAtOnce(const Round& round) {
        EXPECT_LT(round.begins_later, kCycle + kRoundTrip);
        EXPECT_TRUE(round.heard_in_time) << "the other hears of it before the first one stands";
    }
    /// Repeats a round until one was not disturbed by other load of this machine.
    template <typename Do>
    void expectTogether(Do one) {
        Round round{};
        for (int i = 0; i < kRounds; ++i) {
            round = one(i);
            print(round);
            left_.goHome();
            right_.goHome();
            if (beginsAtOnce(round) && round.skew < kApart) {
                break;
            }
        }
        expectBegunAtOnce(round);
        EXPECT_LT(round.skew, kApart);
    }

    Arm left_;
    Arm right_;
    ServerProcess both_server_;
    Watched both_;
    const ValueMap poses_;
};

/// Arms of different makers, with different limits and cycles.
class UnlikeArms : public StoppedArms {
protected:
    UnlikeArms() : StoppedArms("left", "right", {0.5, 0, 0.4, 3.14159, 0, 3.14159}) {}
};

class LikeArms : public StoppedArms {
protected:
    LikeArms() : StoppedArms("right", "right", {0.4, -0.3, 0.5, 3.14, 0, 1}) {}
};

TEST_F(UnlikeArms, StandAtOnePlaceOfTheirWayIfAnotherClientSuspendsOneAndGoOnTogether) {
    expectTogether([&](int round) {
        start(round);
        EXPECT_TRUE(right_.skill().suspend());
        const auto first = right_.stopped();
        const auto other = left_.stopped();
        left_.awaitEvent(State::suspended);
        right_.awaitEvent(State::suspended);
        const auto both = both_.awaitEvent(State::suspended);
        EXPECT_EQ(both.reason, Reason::by_client);
        EXPECT_THAT(both.reason_text, StartsWith("right was suspended by "));
        const auto seen = observed(first, other, both.time);
        EXPECT_TRUE(both_->resume());
        EXPECT_EQ(both_.awaitEvent(State::ready).reason, Reason::finished);
        const auto record = both_->execution(fmt::format("round-{}", round));
        EXPECT_TRUE(record);
        const double end = std::get<double>(record->result.at("SkewAtEnd"));
        return Round{seen.begins_later, std::max(seen.skew, end), seen.stands};
    });
}

TEST_F(UnlikeArms, StandAtOnePlaceOfTheirWayIfTheWholeIsSuspended) {
    expectTogether([&](int round) {
        start(round);
        EXPECT_TRUE(both_->suspend());
        const auto left = left_.stopped();
        const auto right = right_.stopped();
        const auto both = both_.awaitEvent(State::suspended);
        const auto seen = observed(std::min(left, right), std::max(left, right), both.time);
        EXPECT_TRUE(both_->resume());
        EXPECT_EQ(both_.awaitEvent(State::ready).reason, Reason::finished);
        return seen;
    });
}

TEST_F(LikeArms, BrakeAtOnceAndStandAtOnePlaceOfTheirWayIfAnotherClientHaltsOne) {
    expectTogether([&](int round) {
        start(round);
        return haltLeft();
    });
}

// Each arm stands by its own limits: a Halt does not wait for the slower one.
TEST_F(UnlikeArms, BrakeAtOnceWithTheirOwnLimitsIfAnotherClientHaltsOne) {
    Round round{.begins_later = 1e9, .skew = 0, .stands = 0};
    for (int i = 0; i < kRounds && !beginsAtOnce(round); ++i) {
        start(i);
        round = haltLeft();
        print(round);
        left_.goHome();
        right_.goHome();
    }
    expectBegunAtOnce(round);
}

}  // namespace
}  // namespace metier::system_tests
