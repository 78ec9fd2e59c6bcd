#include "host/recorded_used_skill.hpp"

#include <gmock/gmock.h>

#include <filesystem>

#include "lab.hpp"
#include "metier/records/store.hpp"
#include "scripted_used_skill.hpp"

namespace metier::server::testing {
namespace {

using composition::UsedSkillEnd;
using composition::testing::ScriptedUsedSkill;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// Keeps what it is notified of.
class Listener final : public composition::UsedSkillListener {
public:
    void onSuspended() override { heard.emplace_back("suspended"); }
    void onResumed() override { heard.emplace_back("resumed"); }
    void onReset(const Result<void>& /*outcome*/) override { heard.emplace_back("reset"); }
    void onStopping(const composition::UsedSkillStop& stop) override { heard.push_back(stop.text); }
    void onEnd(UsedSkillEnd end) override { heard.push_back("end: " + end.text); }

    std::vector<std::string> heard;
};

/// A skill of another maker that a component uses and records.
class ForeignRecord : public ::testing::Test {
public:
    ForeignRecord(const ForeignRecord&) = delete;
    ForeignRecord& operator=(const ForeignRecord&) = delete;

protected:
    ForeignRecord() { weld_->lacks_text = "no atomic start, no dead-man"; }
    ~ForeignRecord() override {
        used_.reset();
        recorder_.reset();
        std::filesystem::remove_all(folder_);
    }

    void begin() {
        skill::StartRequest request{.execution_id = "cell.Weld/1/go/1",
                                    .parameters = {{"Current", 90.0}}};
        request.parent.id = "cell.Weld/1";
        used_->begin(request, listener_);
    }
    /// The newest record, as readers see it.
    records::ExecutionRow row() {
        EXPECT_TRUE(recorder_->flush(std::chrono::steady_clock::now() + std::chrono::seconds(60)));
        return store().find("cell.Weld/1/go/1").value();
    }
    records::Store& store() {
        if (!store_) {
            store_ = records::Store::open(file()).value();
        }
        return *store_;
    }
    std::string file() const { return (folder_ / "records.db").string(); }

    const std::filesystem::path folder_ = freshFolder();
    std::unique_ptr<records::Recorder> recorder_ =
        records::Recorder::create({.url = file(), .server = "urn:test:cell"}).value();
    std::shared_ptr<ForeignRecords> records_ = std::make_shared<ForeignRecords>(*recorder_);
    ScriptedUsedSkill* weld_ =
        new ScriptedUsedSkill("Weld of welder", {.name = "Weld", .type = "WeldType"});
    std::unique_ptr<composition::UsedSkill> used_ = recorded(
        std::unique_ptr<composition::UsedSkill>(weld_), records_, {"welder", "Torch", "Weld"});
    std::unique_ptr<records::Store> store_;
    Listener listener_;
};

TEST_F(ForeignRecord, HoldsWhatWasStartedWhereAndForWhom) {
    begin();
    weld_->finish({{"Length", 0.25}});
    const auto record = row();
    EXPECT_EQ(record.server, "urn:test:cell") << "the server of the component keeps it";
    EXPECT_EQ(record.server_name, "welder");
    EXPECT_EQ(record.controller, "Torch");
    EXPECT_EQ(record.skill, "Weld");
    EXPECT_EQ(record.parent, "cell.Weld/1");
    EXPECT_EQ(record.parameters, R"({"Current":90})");
    EXPECT_EQ(record.state, "Ready");
    EXPECT_EQ(record.reason, "Finished");
    EXPECT_EQ(record.result, R"({"Length":0.25})");
    EXPECT_THAT(listener_.heard, ElementsAre("end: "));
}

TEST_F(ForeignRecord, SaysWhatTheServerLacks) {
    begin();
    weld_->finish();
    const auto record = row();
    const auto transitions = store().transitions(record.number).value();
    ASSERT_EQ(transitions.size(), 1U);
    EXPECT_EQ(transitions[0].to, "Running");
    EXPECT_THAT(transitions[0].reason_text, HasSubstr("no atomic start, no dead-man"));
}

TEST_F(ForeignRecord, HasEachSuspendAndResume) {
    begin();
    weld_->stops(skill::State::suspended);
    weld_->suspended();
    weld_->resumed();
    weld_->halted(skill::Reason::by_client, "by the panel");
    const auto record = row();
    EXPECT_EQ(record.state, "Halted");
    EXPECT_EQ(record.reason, "ByClient");
    EXPECT_EQ(record.reason_text, "by the panel");
    std::vector<std::string> states;
    const auto transitions = store().transitions(record.number).value();
    for (const auto& transition : transitions) {
        states.push_back(transition.from + " to " + transition.to);
    }
    EXPECT_THAT(states,
                ElementsAre("Ready to Running", "Running to Suspended", "Suspended to Running"));
    EXPECT_THAT(listener_.heard,
                ElementsAre("by somebody", "suspended", "resumed", "end: by the panel"));
}

TEST_F(ForeignRecord, OfARefusedStartSaysSo) {
    begin();
    weld_->refused("no gas");
    EXPECT_EQ(row().state, "Halted");
    EXPECT_EQ(row().reason_text, "the start was refused: no gas");
}

TEST_F(ForeignRecord, OfALostServerHasNoKnownEnd) {
    begin();
    weld_->listener->onEnd({UsedSkillEnd::Kind::lost, {}, skill::Reason::device_lost, "gone"});
    EXPECT_EQ(row().state, records::kLost);
    EXPECT_EQ(row().reason, records::kServerLost);
    EXPECT_EQ(row().reason_text, "gone");
}

TEST_F(ForeignRecord, EndsUnknownWhenNobodyWaitsAnyMore) {
    begin();
    used_->release();
    EXPECT_EQ(row().state, records::kLost);
    EXPECT_EQ(row().reason_text, "nobody waited for its end");
}

TEST_F(ForeignRecord, EndsUnknownWithTheServerOfTheComponent) {
    begin();
    records_->letGo();
    EXPECT_EQ(row().state, records::kLost);
    EXPECT_EQ(row().reason_text, "the server that had started it was stopped");
    weld_->finish();
    EXPECT_EQ(row().state, records::kLost);
    begin();
    weld_->finish();
    EXPECT_EQ(store().list({}, {}).value().executions.size(), 1U);
}

TEST_F(ForeignRecord, IsNotMadeOfServersThatRecordThemselves) {
    weld_->lacks_text = "";
    begin();
    weld_->suspended();
    weld_->resumed();
    weld_->finish();
    ASSERT_TRUE(recorder_->flush(std::chrono::steady_clock::now() + std::chrono::seconds(60)));
    EXPECT_TRUE(store().list({}, {}).value().executions.empty());
    EXPECT_THAT(listener_.heard, ElementsAre("suspended", "resumed", "end: "));
}

TEST_F(ForeignRecord, LeavesAllCallsToTheUsedSkill) {
    EXPECT_EQ(used_->name(), "Weld of welder");
    EXPECT_EQ(used_->description().type, "WeldType");
    EXPECT_TRUE(used_->reset(listener_));
    weld_->wasReset();
    begin();
    EXPECT_TRUE(used_->suspend());
    EXPECT_TRUE(used_->resume());
    used_->halt();
    used_->check({}, [](const auto& /*report*/) {});
    used_->compareClocks([](const auto& /*offset*/) {});
    EXPECT_THAT(weld_->heard(), ElementsAre("reset", "begin", "suspend", "resume", "halt", "check",
                                            "compareClocks"));
    EXPECT_THAT(listener_.heard, ElementsAre("reset"));
}

}  // namespace
}  // namespace metier::server::testing
