#include <gmock/gmock.h>

#include <algorithm>
#include <set>

#include "runner.hpp"

namespace metier::system_tests {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsSupersetOf;

/// A model that records its events: replies and events, each once.
class Witness final : public Taker {
public:
    Witness(const std::array<std::string, kSkills>& results, std::set<std::string>& witnessed)
        : model_(results), witnessed_(witnessed) {}

    std::string take(const Step& step) override {
        auto reply = model_.take(step);
        witnessed_.insert(reply);
        return reply;
    }
    std::vector<std::string> seen() override {
        auto lines = model_.seen();
        for (const auto& line : lines) {
            const auto event = line.find("event ");
            if (event != std::string::npos) {
                witnessed_.insert(line.substr(event, line.rfind(' ') - event));
            }
        }
        return lines;
    }

private:
    Model model_;
    std::set<std::string>& witnessed_;  // the test's
};

TEST(Histories, OfThreeClientsFollowTheModel) {
    constexpr std::size_t histories = 200;
    constexpr std::size_t length = 50;
    World world;
    RandomSteps steps(20260701);
    std::set<std::string> witnessed;
    for (std::size_t i = 0; i < histories; ++i) {
        const auto history = steps.history(length);
        ASSERT_FALSE(findDivergence(world, history, [&](const auto& results) {
            return std::make_unique<Witness>(results, witnessed);
        })) << explain(world, history);
    }
    EXPECT_THAT(witnessed, IsSupersetOf({"Good", "BadLocked", "BadInvalidState", "BadOutOfRange",
                                         "BadResourceUnavailable", "BadTypeMismatch",
                                         "BadInvalidArgument", "BadTimeout", "BadNotSupported",
                                         "BadDeviceFailure", "BadNotFound", "Good -1", "Good 0"}));
    EXPECT_THAT(
        witnessed,
        IsSupersetOf({"event HaltedToReady ByClient", "event ReadyToRunning ByClient",
                      "event RunningToHalted ByClient", "event RunningToHalted OwnerLost",
                      "event RunningToHalted DeviceLost", "event RunningToHalted ForceExceeded",
                      "event RunningToHalted Error", "event RunningToReady Finished",
                      "event RunningToSuspended ByClient", "event RunningToSuspended OwnerLost",
                      "event SuspendedToRunning ByClient", "event SuspendedToHalted ByClient",
                      "event SuspendedToReady ByClient", "event ReadyToHalted ByClient",
                      "event ReadyToHalted DeviceLost"}));
}

/// Believes that an execution that was suspended cannot be given up.
class WrongModel final : public Model {
public:
    using Model::Model;
    std::string take(const Step& step) override {
        if (step.act == Act::reset && stateOf(step.skill) == skill::State::suspended) {
            return "BadInvalidState";
        }
        return Model::take(step);
    }
};

std::unique_ptr<Taker> makeWrongModel(const std::array<std::string, kSkills>& results) {
    return std::make_unique<WrongModel>(results);
}

TEST(Histories, ThatDifferFromAWrongModelShrinkToTheShortest) {
    World world;
    RandomSteps steps(7);
    auto history = steps.history(100);
    while (!findDivergence(world, history, makeWrongModel)) {
        history = steps.history(100);
    }
    const auto shortest = shrink(history, [&](const History& candidate) {
        return findDivergence(world, candidate, makeWrongModel).has_value();
    });
    std::vector<Act> acts;
    std::transform(shortest.begin(), shortest.end(), std::back_inserter(acts),
                   [](const Step& step) { return step.act; });
    EXPECT_THAT(acts, ElementsAre(Act::start_with, Act::suspend, Act::at_rest, Act::reset))
        << toString(shortest);
    const auto text = explain(world, history, makeWrongModel);
    EXPECT_THAT(text, HasSubstr("4 steps of 100:\nstart_with alice first"));
    EXPECT_THAT(text, HasSubstr("after: reset alice first"));
    EXPECT_THAT(text, HasSubstr("expected:\n  BadInvalidState"));
    EXPECT_THAT(text, HasSubstr("seen:\n  Good"));
}

TEST(Histories, ShrinkToStepsOfWhichNoneCanBeLeftOut) {
    RandomSteps steps(3);
    auto history = steps.history(200);
    history.insert(history.begin() + 17, Step{Act::device_lost, 2, 1, 40});
    history.insert(history.begin() + 150, Step{Act::cut_connection, 2, 1, 4'711});
    const auto shortest = shrink(history, [](const History& candidate) {
        const auto lost = std::find_if(candidate.begin(), candidate.end(), [](const Step& step) {
            return step.act == Act::device_lost;
        });
        return std::any_of(lost, candidate.end(), [](const Step& step) {
            return step.act == Act::cut_connection && step.value > 4'000;
        });
    });
    ASSERT_EQ(shortest.size(), 2U) << toString(shortest);
    EXPECT_EQ(shortest.front(), (Step{Act::device_lost, 0, 0, 0}));
    EXPECT_GT(shortest.back().value, 4'000U);
}

TEST(Histories, AreReadBackAsTheyWerePrinted) {
    RandomSteps steps(11);
    const auto history = steps.history(500);
    EXPECT_EQ(historyFrom(toString(history)).value(), history);
    EXPECT_THAT(historyFrom("start nobody first 0").error().message, HasSubstr("start nobody"));
    EXPECT_FALSE(historyFrom("jump alice first 0"));
    EXPECT_FALSE(historyFrom("start alice first"));
}

TEST(Histories, AreTheSameForTheSameSeed) {
    EXPECT_EQ(RandomSteps(5).history(100), RandomSteps(5).history(100));
    EXPECT_NE(RandomSteps(5).history(100), RandomSteps(6).history(100));
}

}  // namespace
}  // namespace metier::system_tests
