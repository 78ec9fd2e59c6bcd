// A component that uses any arm that it finds, and another one when that arm is lost.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <csignal>
#include <optional>

#include "cable.hpp"
#include "discovered_cell.hpp"
#include "metier/base/queue.hpp"

namespace metier::system_tests {
namespace {

using skill::Reason;
using skill::State;
using skill::TransitionEvent;
using skill::ValueMap;
using ::testing::HasSubstr;

class FoundArm : public ::testing::Test {
protected:
    FoundArm() {
        EXPECT_TRUE(lds_.awaitKnown("iiwa-a"));
        component_.emplace(serveDiscovered("swing", lds_.url()));
        client_ = connectTo(component_->url());
        swing_.emplace(openSkill(*client_, "SwingSkill"));
        swing_->onTransition([this](const TransitionEvent& event) { events_.tryPush(event); });
    }
    ~FoundArm() override { swing_->onTransition({}); }

    static double firstAxisOf(const std::string& url) {
        const auto client = connectTo(url);
        return jointPosition(*client, openSkill(*client, "JointPtpMoveSkill")).front();
    }
    /// A property of the record of the arm's last execution.
    static std::string lastRecordOn(const std::string& url, const std::string& property) {
        const auto client = connectTo(url);
        const auto metier = client->namespaceIndex("urn:metier:skills").value();
        const auto node = client->translate(
            openSkill(*client, "JointPtpMoveSkill").address().node,
            {{metier, "ExecutionRecords"}, {metier, "Latest"}, {metier, property}});
        return client->read(node.value()).value().toString();
    }
    ValueMap to(double first_axis, double speed = 1.0) const {
        auto target = home_;
        target.front() = first_axis;
        return {{"Target", target}, {"Speed", speed}};
    }
    /// Skill that the component publishes as used for `arm`.
    std::string boundTo() const {
        const auto metier = client_->namespaceIndex("urn:metier:skills").value();
        const auto uses =
            client_->browse({.node = swing_->address().node, .reference_type = {metier, 20306U}})
                .value();
        EXPECT_EQ(uses.size(), 1U);
        const auto url = client_->translate(uses.front().target, {{metier, "EndpointUrl"}}).value();
        return client_->read(url).value().as<std::string>().value();
    }
    TransitionEvent awaitEvent(State state) {
        while (auto event = events_.popUntil(inAMinute())) {
            if (event->to == state) {
                return *event;
            }
        }
        throw std::runtime_error("no transition to " + std::string(toString(state)));
    }

    DiscoveryProcess lds_{2};
    ServerProcess a_ = serveDiscovered("iiwa-a", lds_.url());
    std::vector<double> home_ = homeOf(a_.url());
    std::optional<ServerProcess> component_;
    std::unique_ptr<opcua::Client> client_;
    Queue<TransitionEvent> events_{1'000};
    std::optional<client::SkillHandle> swing_;

private:
    static std::vector<double> homeOf(const std::string& url) {
        const auto client = connectTo(url);
        return jointPosition(*client, openSkill(*client, "JointPtpMoveSkill"));
    }
};

TEST_F(FoundArm, IsWhatTheNextExecutionRunsOnWhenTheFormerIsGone) {
    EXPECT_EQ(boundTo(), a_.url());
    const auto first = swing_->runWith({"first", to(0.1)}, inAMinute());
    ASSERT_TRUE(first) << first.error().message;
    EXPECT_NEAR(firstAxisOf(a_.url()), 0.1, 1e-3);

    const auto b = serveDiscovered("iiwa-b", lds_.url());
    ASSERT_TRUE(lds_.awaitKnown("iiwa-b"));
    EXPECT_EQ(boundTo(), a_.url()) << "one more is no reason to change";
    a_.kill();
    ASSERT_TRUE(holdsSoon([&] { return boundTo() == b.url(); }));
    const auto second = swing_->runWith({"second", to(0.2)}, inAMinute());
    ASSERT_TRUE(second) << second.error().message;
    EXPECT_NEAR(firstAxisOf(b.url()), 0.2, 1e-3);
    EXPECT_THAT(lastRecordOn(b.url(), "ParentExecution"), HasSubstr("second"));
    EXPECT_THAT(lastRecordOn(b.url(), "ParentServer"), HasSubstr("metier:swing"));
}

TEST_F(FoundArm, IsNotChangedInTheMiddleOfAnExecution) {
    const auto b = serveDiscovered("iiwa-b", lds_.url());
    ASSERT_TRUE(lds_.awaitKnown("iiwa-b"));
    const auto home_of_b = firstAxisOf(b.url());
    ASSERT_TRUE(swing_->startWith({"cut", to(1.5, 0.02)}));
    awaitEvent(State::running);
    a_.kill();
    const auto halted = awaitEvent(State::halted);
    EXPECT_EQ(halted.reason, Reason::device_lost);
    EXPECT_THAT(halted.reason_text, HasSubstr("JointPtpMoveSkill of iiwa-a is lost"));
    ASSERT_TRUE(holdsSoon([&] { return boundTo() == b.url(); }));
    EXPECT_EQ(firstAxisOf(b.url()), home_of_b) << "nothing goes on elsewhere by itself";
    ASSERT_TRUE(swing_->reset());
    const auto next = swing_->runWith({"next", to(0.1)}, inAMinute());
    ASSERT_TRUE(next) << next.error().message;
    EXPECT_NEAR(firstAxisOf(b.url()), 0.1, 1e-3);
}

TEST_F(FoundArm, RefusesToStartUntilAnotherIsThere) {
    a_.kill();
    int attempt = 0;
    ASSERT_TRUE(holdsSoon([&] {
        // Before the loss is noticed a Start may go through, and end Halted.
        if (swing_->state() == State::halted) {
            EXPECT_TRUE(swing_->reset());
        }
        const auto refused = swing_->startWith({fmt::format("nobody-{}", ++attempt), to(0.1)});
        return !refused && refused.error().message.find("cannot be reached") != std::string::npos;
    }));
    const auto b = serveDiscovered("iiwa-b", lds_.url());
    ASSERT_TRUE(holdsSoon([&] { return boundTo() == b.url(); }));
    const auto moved = swing_->runWith({"b", to(0.1)}, inAMinute());
    ASSERT_TRUE(moved) << moved.error().message;
}

TEST_F(FoundArm, IsGivenUpForAnotherWhenItsServerHangs) {
    const auto b = serveDiscovered("iiwa-b", lds_.url());
    ASSERT_TRUE(lds_.awaitKnown("iiwa-b"));
    a_.signal(SIGSTOP);
    EXPECT_TRUE(holdsSoon([&] { return boundTo() == b.url(); }));
    const auto moved = swing_->runWith({"b", to(0.1)}, inAMinute());
    a_.signal(SIGCONT);
    ASSERT_TRUE(moved) << moved.error().message;
    EXPECT_EQ(boundTo(), b.url()) << "one that comes back later is not taken back";
}

/// Lines of a program's output until one has a text.
std::string readUntil(link::ChildProcess& program, const std::string& text) {
    std::string seen;
    for (auto line = program.readLine(inAMinute()); line; line = program.readLine(inAMinute())) {
        if (line->find(text) != std::string::npos) {
            return *line;
        }
        seen += *line + "\n";
    }
    throw std::runtime_error("no '" + text + "' in: " + seen);
}

// The arms and the discovery server are in one network namespace; the component and its client are
// in another one, which reaches the first through a cable.
TEST(SearchForAnArm, EndsWithTheStopSignal) {
    // The signal was blocked, and no thread read it, for up to 20 s.
    const DiscoveryProcess lds;
    auto component =
        link::ChildProcess::start(
            metierCommand({"--log", "info", "serve", discoveredCell().string(), "--server", "swing",
                           "--port", "0", "--discovery", lds.url()}),
            link::ErrorOutput::with_output)
            .value();
    std::string text;
    const auto read = [&](const std::string& until) {
        auto line = component.readLine(inAMinute());
        for (; line && line->find(until) == std::string::npos;
             line = component.readLine(inAMinute())) {
            text += *line + "\n";
        }
        text += line.value_or("");
        return line.has_value();
    };
    ASSERT_TRUE(read("SwingSkill seeks arm")) << text;
    component.signal(SIGINT);
    EXPECT_TRUE(read("stopped before SwingSkill had found arm")) << text;
    EXPECT_EQ(component.waitUntil(inAMinute()), 1);
}

TEST(DiscoveryOnTheNetwork, FindsArmsAndBindsToTheOneThatIsThere) {
    if (const auto obstacle = Cable::obstacle(); !obstacle.empty()) {
        GTEST_SKIP() << "NOT TESTED: discovery between network namespaces: " << obstacle;
    }
    const Cable cable;
    const auto host = Cable::addressOf(":0").substr(std::string("opc.tcp://").size());
    const std::vector<std::string> announced{"--announce-as", host.substr(0, host.find(':'))};
    const DiscoveryProcess lds(2);
    auto a = serveDiscovered("iiwa-a", lds.url(), announced);
    const auto b = serveDiscovered("iiwa-b", lds.url(), announced);
    ASSERT_TRUE(lds.awaitKnown("iiwa-a"));
    ASSERT_TRUE(lds.awaitKnown("iiwa-b"));
    const auto far = [&](const std::vector<std::string>& arguments) {
        return link::ChildProcess::start(cable.atFarEnd(metierCommand(arguments)),
                                         link::ErrorOutput::with_output)
            .value();
    };
    const auto lds_url = Cable::addressOf(lds.url());
    auto find = far({"find", "JointPtpMoveSkillType", "--payload", "5", "--discovery", lds_url});
    EXPECT_THAT(readUntil(find, " fits: "), HasSubstr(Cable::addressOf(a.url())));
    EXPECT_EQ(find.waitUntil(inAMinute()), 0);

    auto component = far({"--log", "info", "serve", discoveredCell().string(), "--server", "swing",
                          "--port", "0", "--discovery", lds_url});
    EXPECT_THAT(readUntil(component, "SwingSkill uses "), HasSubstr(Cable::addressOf(a.url())));
    const auto url = readUntil(component, "ready opc").substr(std::string("ready ").size());
    const auto swingBy = [&](const std::string& target) {
        auto run = far({"run", url, "SwingSkill", "--set", "Target=" + target});
        return run.waitUntil(inAMinute());
    };
    EXPECT_EQ(swingBy("0.1,0.5,0,-1.4,0,0.9,0"), 0);
    a.kill();
    EXPECT_THAT(readUntil(component, "from its next execution on"),
                HasSubstr(Cable::addressOf(b.url())));
    EXPECT_EQ(swingBy("0.2,0.5,0,-1.4,0,0.9,0"), 0);
    const auto client = connectTo(b.url());
    EXPECT_NEAR(jointPosition(*client, openSkill(*client, "JointPtpMoveSkill")).front(), 0.2, 1e-3);
}

}  // namespace
}  // namespace metier::system_tests
