#include <gmock/gmock.h>

#include <future>

#include "served_skills.hpp"

namespace metier::opcua_skill::testing {
namespace {

using namespace std::chrono_literals;

class ComingToRest : public ServedSkills {
protected:
    ComingToRest() : skill_(add(jointMoveDescription())) {
        serve();
        client_ = connect();
        watch_ = std::make_unique<TransitionWatch>(*client_, skill_.id);
    }

    void start() {
        ASSERT_EQ(write(*client_, skill_, "ParameterSet/TargetJointPosition",
                        opcua::Value::of(std::vector{0.5, 1.0})),
                  "Good");
        ASSERT_EQ(call(*client_, skill_, "Start"), "Good");
        ASSERT_EQ(watch_->nextName(), "ReadyToRunning");
        ASSERT_TRUE(skill_.hand->await("start"));
    }
    std::future<bool> comeToRest(std::chrono::milliseconds longest) {
        return std::async(std::launch::async, [this, longest] {
            return skills().comeToRest("the server is ended", longest);
        });
    }

    ServedSkill skill_;
    std::unique_ptr<opcua::Client> client_;
    std::unique_ptr<TransitionWatch> watch_;
};

TEST_F(ComingToRest, IsOverAtOnceIfNothingRuns) {
    EXPECT_TRUE(skills().comeToRest("the server is ended", 60s));
    EXPECT_EQ(readAs<opcua::LocalizedText>(*client_, skill_, "CurrentState").text, "Ready");
}

TEST_F(ComingToRest, BrakesWhatRunsAndWaitsForItsStandstill) {
    start();
    auto rests = comeToRest(60s);
    ASSERT_TRUE(skill_.hand->await("halt")) << "it brakes as at a Halt";
    EXPECT_EQ(rests.wait_for(0s), std::future_status::timeout) << "it moves still";
    skill_.hand->execution().atRest();
    const auto halted = watch_->next();
    ASSERT_TRUE(halted);
    EXPECT_EQ(halted->transition, "RunningToHalted");
    EXPECT_EQ(halted->reason_text, "the server is ended");
    EXPECT_TRUE(rests.get());
}

TEST_F(ComingToRest, GivesUpWhatDoesNotComeToRest) {
    start();
    // Long enough for the server's thread to be asked.
    EXPECT_FALSE(skills().comeToRest("the server is ended", 1s));
    EXPECT_TRUE(skill_.hand->await("halt"));
}

}  // namespace
}  // namespace metier::opcua_skill::testing
