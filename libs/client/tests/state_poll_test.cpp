// StatePoll at a Program whose state the test writes.
#include "state_poll.hpp"

#include <gmock/gmock.h>

#include <condition_variable>
#include <mutex>
#include <vector>

#include "served_nodes.hpp"
#include "transition_log.hpp"

namespace metier::client {
namespace {

using namespace std::chrono_literals;
using opcua::Value;
using skill::State;
using skill::TransitionNumber;
using ::testing::ElementsAre;

/// What a log calls, on the client's thread.
class Heard {
public:
    void add(TransitionNumber transition) {
        {
            const std::lock_guard lock(mutex_);
            transitions_.push_back(transition);
        }
        changed_.notify_all();
    }
    void doubt() {
        {
            const std::lock_guard lock(mutex_);
            ++doubts_;
        }
        changed_.notify_all();
    }
    /// Waits until there are so many; false after 10 s.
    bool awaitTransitions(std::size_t count) {
        return await([&] { return transitions_.size() >= count; });
    }
    bool awaitDoubts(int count) {
        return await([&] { return doubts_ >= count; });
    }
    std::vector<TransitionNumber> transitions() {
        const std::lock_guard lock(mutex_);
        return transitions_;
    }
    int doubts() {
        const std::lock_guard lock(mutex_);
        return doubts_;
    }

private:
    bool await(const std::function<bool()>& done) {
        std::unique_lock lock(mutex_);
        return changed_.wait_for(lock, 10s, done);
    }

    std::mutex mutex_;
    std::condition_variable changed_;
    std::vector<TransitionNumber> transitions_;
    int doubts_ = 0;
};

class PolledState : public ::testing::Test {
protected:
    PolledState() {
        const auto program = served_.program(opcua::ids::kObjectsFolder, "Lamp");
        const auto current = served_.variable(program, {0, "CurrentState"}, Value::of("Ready"));
        state_ = served_.variable(current, {0, "Number"}, Value::of(number(State::ready)));
        log_->watch({.on_transition = [this](const auto& event) { heard_.add(event.number); },
                     .on_missed = [this] { heard_.doubt(); }});
        nodes_.state = current;
        nodes_.state_number = state_;
        client_ = opcua::Client::connect(served_.url()).value();
        poll_ = std::make_shared<StatePoll>(*client_, nodes_, log_);
    }
    ~PolledState() override { poll_->stop(); }

    static std::uint32_t number(State state) { return static_cast<std::uint32_t>(state); }
    /// The server's own write; the state is readable alone for clients.
    void show(State state) {
        served_.server().post([this, state] {
            EXPECT_TRUE(served_.nodes().write(state_, Value::of(number(state))));
        });
    }

    Heard heard_;
    testing::ServedNodes served_;
    opcua::NodeId state_;
    ProgramNodes nodes_;
    std::shared_ptr<TransitionLog> log_ = std::make_shared<TransitionLog>();
    std::unique_ptr<opcua::Client> client_;
    std::shared_ptr<StatePoll> poll_;
};

TEST_F(PolledState, AddsEachChangeAndADoubt) {
    poll_->begin();
    ASSERT_TRUE(client_->read(state_)) << "answered after the first read of the poll";
    show(State::running);
    ASSERT_TRUE(heard_.awaitTransitions(1));
    show(State::suspended);
    ASSERT_TRUE(heard_.awaitTransitions(2));
    show(State::halted);
    ASSERT_TRUE(heard_.awaitTransitions(3));
    EXPECT_THAT(heard_.transitions(), ElementsAre(TransitionNumber::ready_to_running,
                                                  TransitionNumber::running_to_suspended,
                                                  TransitionNumber::suspended_to_halted));
    EXPECT_TRUE(heard_.awaitDoubts(3));
}

TEST_F(PolledState, AddsARunThatWentByUnseenOnce) {
    poll_->begin();
    poll_->noteStart();
    ASSERT_TRUE(heard_.awaitTransitions(2));
    EXPECT_THAT(heard_.transitions(), ElementsAre(TransitionNumber::ready_to_running,
                                                  TransitionNumber::running_to_ready));
    EXPECT_TRUE(heard_.awaitDoubts(1));
    show(State::halted);
    ASSERT_TRUE(heard_.awaitTransitions(3));
    EXPECT_EQ(heard_.transitions().back(), TransitionNumber::ready_to_halted);
}

TEST_F(PolledState, EndsWithADoubtWhenTheConnectionIsLost) {
    poll_->begin();
    poll_->noteStart();
    ASSERT_TRUE(heard_.awaitDoubts(1));
    const auto before = heard_.doubts();
    served_.end();
    EXPECT_TRUE(heard_.awaitDoubts(before + 1));
}

TEST_F(PolledState, MayBeStoppedInACallbackAndIsSilentThen) {
    log_->watch({.on_transition = [this](const auto& event) {
        poll_->stop();
        heard_.add(event.number);
    }});
    poll_->begin();
    poll_->noteStart();  // a run that went by unseen: two transitions at once
    ASSERT_TRUE(heard_.awaitTransitions(1));
    Heard another;
    const auto log = std::make_shared<TransitionLog>();
    log->watch({.on_transition = [&](const auto& event) { another.add(event.number); }});
    const StatePolling still(std::make_shared<StatePoll>(*client_, nodes_, log));
    still.poll()->noteStart();
    ASSERT_TRUE(another.awaitTransitions(2));
    show(State::halted);
    ASSERT_TRUE(another.awaitTransitions(3));
    EXPECT_EQ(heard_.transitions().size(), 1U) << "not even the second of the same answer";
}

}  // namespace
}  // namespace metier::client
