#include "metier/records/recorder.hpp"

#include <gmock/gmock.h>

#include <filesystem>

#include "metier/records/store.hpp"

namespace metier::records {
namespace {

using namespace std::chrono_literals;

SteadyTime soon() {
    return std::chrono::steady_clock::now() + 20s;
}

/// Milliseconds after the beginning of 2026-11-22.
UtcTime at(std::int64_t milliseconds) {
    return UtcTime(1'795'305'600s + std::chrono::milliseconds(milliseconds));
}

class RecordedExecution : public ::testing::Test {
protected:
    RecordedExecution() { std::filesystem::remove_all(file_.parent_path()); }

    std::unique_ptr<Recorder> recorder(const std::string& server = "urn:test:ur5") {
        return Recorder::create({.url = file_.string(), .server = server}).value();
    }
    std::unique_ptr<Store> store() { return Store::open(file_.string()).value(); }
    static Execution move(const std::string& id) {
        Execution e;
        e.id = id;
        e.server_name = "ur5";
        e.skill = "JointPtpMoveSkill";
        e.controller = "Controller";
        e.device = "ur5";
        e.user = "anna";
        e.parameters = R"({"MaxVelocity":[1.0]})";
        e.started = at(0);
        e.state = "Running";
        return e;
    }

    const std::filesystem::path file_ =
        std::filesystem::path(::testing::TempDir()) / "records" /
        ::testing::UnitTest::GetInstance()->current_test_info()->name() / "records.db";
};

TEST_F(RecordedExecution, IsInTheStoreWithAllThatWasToldOfIt) {
    const auto recording = recorder();
    const auto key = recording->begin(move("m-1"));
    recording->transition(key, {.time = at(0), .from = "Ready", .to = "Running"});
    const std::array actual{0.1, 0.2};
    recording->sample(key, {.time = 0.5, .actual = SampleValues(actual)});
    recording->intermediate(key, {.time = at(600), .value = "0.5"});
    recording->transition(
        key, {.time = at(1'000), .from = "Running", .to = "Ready", .reason = "Finished"});
    recording->end(key, {.time = at(1'000),
                         .state = "Ready",
                         .reason = "Finished",
                         .result = R"({"Duration":1.0})",
                         .missed_cycles = 2});
    ASSERT_TRUE(recording->flush(soon()));

    const auto reading = store();
    const auto found = reading->find("m-1");
    ASSERT_TRUE(found) << found.error().message;
    EXPECT_EQ(found->number, 1);
    EXPECT_EQ(found->server, "urn:test:ur5");
    EXPECT_EQ(found->skill, "JointPtpMoveSkill");
    EXPECT_EQ(found->user, "anna");
    EXPECT_EQ(found->started, at(0));
    EXPECT_EQ(found->ended, at(1'000));
    EXPECT_EQ(found->state, "Ready");
    EXPECT_EQ(found->reason, "Finished");
    EXPECT_EQ(found->result, R"({"Duration":1.0})");
    EXPECT_EQ(found->missed_cycles, 2U);
    const auto transitions = reading->transitions(1).value();
    ASSERT_EQ(transitions.size(), 2U);
    EXPECT_EQ(transitions[1].to, "Ready");
    EXPECT_EQ(reading->intermediates(1).value().at(0).value, "0.5");
    const auto path = reading->path(1).value();
    ASSERT_EQ(path.size(), 1U);
    EXPECT_EQ(path[0].actual, SampleValues(actual));
    EXPECT_EQ(path[0].time, 0.5);
}

}  // namespace
}  // namespace metier::records
