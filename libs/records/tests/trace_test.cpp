// An execution as JSON and as a trace.
#include "metier/records/trace.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "metier/records/json.hpp"
#include "recorded.hpp"

namespace metier::records {
namespace {

using nlohmann::json;
using ::testing::ElementsAre;

Transition transition(std::int64_t time, std::string from, std::string to, std::string step) {
    Transition t;
    t.time = at(time);
    t.from = std::move(from);
    t.to = std::move(to);
    t.step = std::move(step);
    return t;
}

/// A pick that moves an arm of another server in its first step.
class TracedPick : public ::testing::Test {
protected:
    void SetUp() override {
        const auto pick = recorderOf(file_, "urn:test:pick");
        const auto ur5 = recorderOf(file_);
        auto parent = moveOf("p-1");
        parent.server_name = "pick";
        parent.skill = "PickSkill";
        const auto key = pick->begin(parent);
        pick->transition(key, transition(0, "Ready", "Running", "approach"));
        pick->transition(key, transition(600, "Running", "Running", "grasp"));
        pick->transition(key, transition(700, "Running", "Suspended", ""));
        pick->transition(key, transition(800, "Suspended", "Running", "grasp"));
        pick->intermediate(key, {.time = at(900), .value = "{\"Width\":0.02}"});
        pick->transition(key, transition(1'000, "Running", "Ready", ""));
        pick->end(key, finished(at(1'000)));
        auto child = moveOf("p-1/approach", at(100));
        child.parent = "p-1";
        child.parent_server = "urn:test:pick";
        const auto child_key = ur5->begin(child);
        ur5->transition(child_key, transition(100, "Ready", "Running", ""));
        ur5->sample(child_key, sampleAt(0.25, 0.5));
        ur5->end(child_key, finished(at(500)));
        ASSERT_TRUE(pick->flush(soon()) && ur5->flush(soon()));
        store_ = Store::open(file_).value();
        events_ = json::parse(chromeTrace(*store_, store_->find("p-1")->number).value())
                      .at("traceEvents");
    }
    /// "name ts dur" of the slices of that category in that process.
    std::vector<std::string> slices(const std::string& category, int process) const {
        std::vector<std::string> found;
        for (const auto& event : events_) {
            if (event.at("ph") == "X" && event.at("cat") == category &&
                event.at("pid") == process) {
                found.push_back(event.at("name").get<std::string>() + " " + event.at("ts").dump() +
                                " " + event.at("dur").dump());
            }
        }
        return found;
    }

    const std::string file_ = (testFolder() / "records.db").string();
    std::unique_ptr<Store> store_;
    json events_;
};

TEST_F(TracedPick, HasAProcessForEachServerAndSlicesForStatesAndSteps) {
    EXPECT_THAT(slices("execution", 1), ElementsAre("PickSkill 0 1000000"));
    EXPECT_THAT(slices("execution", 2), ElementsAre("JointPtpMoveSkill 100000 400000"));
    EXPECT_THAT(slices("state", 1), ElementsAre("Running 0 700000", "Suspended 700000 100000",
                                                "Running 800000 200000"));
    EXPECT_THAT(slices("step", 1),
                ElementsAre("approach 0 600000", "grasp 600000 100000", "grasp 800000 200000"));
    EXPECT_THAT(slices("state", 2), ElementsAre("Running 100000 400000"));
}

TEST_F(TracedPick, NamesItsProcessesAndShowsWhoStartedWhat) {
    std::vector<std::string> names;
    std::vector<std::string> arrow;
    for (const auto& event : events_) {
        if (event.at("name") == "process_name") {
            names.push_back(event.at("args").at("name"));
        }
        if (event.at("name") == "starts") {
            arrow.push_back(event.at("ph").get<std::string>() + event.at("pid").dump());
        }
    }
    EXPECT_THAT(names, ElementsAre("pick", "ur5"));
    EXPECT_THAT(arrow, ElementsAre("s1", "f2"));
}

TEST_F(TracedPick, IsNotFoundUnderANumberThatNobodyHas) {
    EXPECT_EQ(chromeTrace(*store_, 99).error().code, Errc::not_found);
}

TEST_F(TracedPick, HasAllDetailsInItsJson) {
    const auto number = store_->find("p-1")->number;
    const auto pick = json::parse(toJson(detailsOf(*store_, number).value()));
    EXPECT_EQ(pick.at("skill"), "PickSkill");
    EXPECT_EQ(pick.at("started"), "2026-11-22T00:00:00.000Z");
    EXPECT_EQ(pick.at("duration"), 1.0);
    EXPECT_EQ(pick.at("parameters").at("MaxVelocity").at(0), 1.0);
    EXPECT_EQ(pick.at("transitions").size(), 5U);
    EXPECT_EQ(pick.at("intermediates").at(0).at("value").at("Width"), 0.02);
    EXPECT_EQ(pick.at("children").at(0).at("id"), "p-1/approach");
    const auto child = store_->children(number).value().at(0);
    const auto path = json::parse(toJson(detailsOf(*store_, child.number).value())).at("path");
    EXPECT_EQ(path.at(0).at("time"), 0.25);
    EXPECT_EQ(path.at(0).at("actual").at(1), -0.5);
    EXPECT_FALSE(path.at(0).contains("force"));
}

/// Trace of an execution of a store that two servers wrote.
json traceOf(const std::string& file, const std::string& id) {
    const auto store = Store::open(file).value();
    return json::parse(chromeTrace(*store, store->find(id)->number).value()).at("traceEvents");
}

const json* sliceOf(const json& events, const std::string& category) {
    const auto found = std::find_if(events.begin(), events.end(), [&](const json& event) {
        return event.at("ph") == "X" && event.at("cat") == category;
    });
    return found == events.end() ? nullptr : &*found;
}

TEST(Trace, OfAnExecutionUnderWayEndsWithItsLastEvent) {
    const auto file = (testFolder() / "records.db").string();
    const auto recorder = recorderOf(file);
    const auto key = recorder->begin(moveOf("m-1"));
    recorder->transition(key, transition(0, "Ready", "Running", "approach"));
    recorder->intermediate(key, {.time = at(700), .value = "1"});
    ASSERT_TRUE(recorder->flush(soon()));
    const auto events = traceOf(file, "m-1");
    for (const auto* category : {"execution", "state", "step"}) {
        const auto* slice = sliceOf(events, category);
        ASSERT_NE(slice, nullptr) << category;
        EXPECT_EQ(slice->at("dur"), 700'000) << category;
    }
}

TEST(Trace, OfAnExecutionWithoutEventsHasNoLength) {
    const auto file = (testFolder() / "records.db").string();
    const auto recorder = recorderOf(file);
    recorder->begin(moveOf("m-1"));
    ASSERT_TRUE(recorder->flush(soon()));
    const auto events = traceOf(file, "m-1");
    EXPECT_EQ(sliceOf(events, "execution")->at("dur"), 0);
    EXPECT_EQ(sliceOf(events, "state"), nullptr);
}

TEST(Trace, HasEventsBeforeTheStartAndAfterTheEndWithinTheExecution) {
    const auto file = (testFolder() / "records.db").string();
    const auto recorder = recorderOf(file);
    const auto key = recorder->begin(moveOf("m-1"));
    recorder->transition(key, transition(-5'000, "Ready", "Running", ""));  // the clock was set
    recorder->transition(key, transition(9'000, "Running", "Ready", ""));
    recorder->end(key, finished(at(1'000)));
    ASSERT_TRUE(recorder->flush(soon()));
    const auto events = traceOf(file, "m-1");
    EXPECT_EQ(sliceOf(events, "state")->at("ts"), 0);
    EXPECT_EQ(sliceOf(events, "state")->at("dur"), 1'000'000);
}

TEST(Trace, OfExecutionsThatStartedEachOtherHasEachOnce) {
    const auto file = (testFolder() / "records.db").string();
    const auto recorder = recorderOf(file);
    for (const auto& [id, parent] : {std::pair("one", "other"), {"other", "one"}}) {
        auto execution = moveOf(id);
        execution.parent = parent;
        recordOne(*recorder, execution, finished(at(1)));
    }
    ASSERT_TRUE(recorder->flush(soon()));
    int slices = 0;
    for (const auto& event : traceOf(file, "one")) {
        slices += event.at("ph") == "X" ? 1 : 0;
    }
    EXPECT_EQ(slices, 2);
}

TEST(TimeText, IsCutToMilliseconds) {
    using namespace std::chrono_literals;
    EXPECT_EQ(timeText(at(0) + 999'999us), "2026-11-22T00:00:00.999Z");
    EXPECT_EQ(timeText(UtcTime(-1us)), "1969-12-31T23:59:59.999Z");
    EXPECT_EQ(timeText(UtcTime{}), "") << "not there yet";
}

TEST(RecordJson, HasEveryMemberInTheSameOrderAsEver) {
    const auto read = nlohmann::ordered_json::parse(toJson(moveOf("m-1")));
    std::vector<std::string> names;
    for (const auto& [name, value] : read.items()) {
        names.push_back(name);
    }
    EXPECT_THAT(names, ::testing::ElementsAre(
                           "number", "id", "server", "server_name", "skill", "controller", "device",
                           "parent", "parent_server", "session", "client_name", "user",
                           "thumbprint", "parameters", "check", "started", "ended", "duration",
                           "state", "reason", "reason_text", "result", "missed_cycles"));
}

TEST(RecordJson, TakesWhatIsNoJsonForText) {
    auto execution = moveOf("m-1");
    execution.parameters = "{broken";
    execution.user = "\xFF";
    const auto read = json::parse(toJson(execution));
    EXPECT_EQ(read.at("parameters"), "{broken");
    EXPECT_TRUE(read.at("ended").is_null());
    EXPECT_EQ(read.at("user"), "\xEF\xBF\xBD");
}

}  // namespace
}  // namespace metier::records
