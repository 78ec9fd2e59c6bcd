// What the page shows of records that servers write meanwhile.
#include "records_view.hpp"

#include <gmock/gmock.h>

#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "metier/base/clock.hpp"
#include "metier/records/recorder.hpp"
#include "shown_tab.hpp"

namespace metier::dashboard {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const UtcTime kNoon{std::chrono::seconds(1'800'000'000)};

class RecordsOfACell : public ::testing::Test {
protected:
    RecordsOfACell() {
        std::filesystem::remove_all(folder_);
        records::Recorder::Options options;
        options.url = file();
        options.server = "urn:test:ur5";
        recorder_ = records::Recorder::create(std::move(options)).value();
    }
    ~RecordsOfACell() override {
        recorder_.reset();
        std::filesystem::remove_all(folder_);
    }

    std::string file() const { return (folder_ / "records.db").string(); }
    records::Recorder::Key begin(const std::string& id, const std::string& skill = "Move") {
        records::ExecutionRow execution;
        execution.id = id;
        execution.skill = skill;
        execution.controller = "C";
        execution.user = "anna";
        execution.started = kNoon + started_++ * 1s;
        return recorder_->begin(execution);
    }
    void flush() { ASSERT_TRUE(recorder_->flush(std::chrono::steady_clock::now() + 60s)); }
    std::vector<std::string> idsOf(const httplib::Params& params) {
        httplib::Request request;
        request.params = params;
        const auto reply = view_.list(request);
        std::vector<std::string> ids;
        for (const auto& record : reply.body.at("records")) {
            ids.push_back(record.at("id"));
        }
        return ids;
    }

    const std::filesystem::path folder_ = std::filesystem::path(::testing::TempDir()) /
                                          ("records_of_a_cell_" + std::to_string(getpid()));
    int started_ = 0;
    const SystemClock clock_;
    Board board_{{{"name", "test"}}, clock_};
    std::unique_ptr<records::Recorder> recorder_;
    RecordsView view_{file(), board_};
};

TEST_F(RecordsOfACell, AreNotedAtTheBoardWhileSomebodyLooks) {
    begin("before");
    flush();
    ShownTab tab(board_);
    view_.show(true);
    // What comes before the view has looked for the first time is not new to it.
    std::int64_t begun = 1;
    std::int64_t noted = 0;
    records::Recorder::Key key = 0;
    const auto deadline = std::chrono::steady_clock::now() + 30s;
    while (noted == 0 && std::chrono::steady_clock::now() < deadline) {
        key = begin("new");
        flush();
        ++begun;
        for (const auto& event : tab.seen()) {
            noted = event.name == "execution" ? event.data.at("number").get<std::int64_t>() : noted;
        }
    }
    EXPECT_GT(noted, 1) << "the one from before is not noted";
    const auto isLast = [&](const json& told) { return told.at("number") == begun; };
    if (noted < begun) {
        tab.await("execution", isLast);
    }
    recorder_->end(key, {.time = kNoon + 60s, .state = "Ready", .reason = "Finished"});
    tab.await("execution", isLast);
}

TEST_F(RecordsOfACell, AreFoundByWhatIsAskedFor) {
    begin("a", "Move");
    begin("b", "Grasp");
    begin("c", "Move");
    flush();
    EXPECT_THAT(idsOf({}), ElementsAre("c", "b", "a"));
    EXPECT_THAT(idsOf({{"skill", "Move"}}), ElementsAre("c", "a"));
    EXPECT_THAT(idsOf({{"skill", "Move"}, {"count", "1"}}), ElementsAre("c"));
    EXPECT_THAT(idsOf({{"before", "3"}}), ElementsAre("b", "a"));
    EXPECT_THAT(idsOf({{"user", "otto"}}), IsEmpty());
    EXPECT_THAT(idsOf({{"from", "1800000001"}, {"to", "1800000002"}}), ElementsAre("b"));
    EXPECT_THAT(idsOf({{"text", "grasp"}}), ElementsAre("b"));
    httplib::Request one;
    one.params = {{"count", "1"}};
    EXPECT_EQ(view_.list(one).body.at("more"), true);
    EXPECT_EQ(view_.list({}).body.at("more"), false);
}

TEST_F(RecordsOfACell, NameTheArmThatTheirSkillMoves) {
    board_.addServer("ur5", "ur5", "opc.tcp://127.0.0.1:1");
    ServerShown offer;
    offer.application_uri = "urn:test:ur5";
    offer.skills = {{{"key", "ur5/C/Move"}, {"name", "Move"}, {"controller", "C"}, {"arm", "ur5"}}};
    board_.setOffer("ur5", offer);
    begin("moves", "Move");
    begin("grasps", "Grasp");
    flush();
    const auto shown = view_.list({}).body.at("records");
    EXPECT_TRUE(shown.at(0).at("arm").is_null());
    EXPECT_EQ(shown.at(1).at("arm"), "ur5");
}

TEST_F(RecordsOfACell, HaveTheirPathAndTheirChildren) {
    const auto parent = begin("parent");
    recorder_->sample(parent, {.time = 0.5,
                               .actual = records::SampleValues(std::vector{0.12345678, 1.0}),
                               .commanded = records::SampleValues(std::vector{0.2, 1.0}),
                               .force = {}});
    records::ExecutionRow child;
    child.id = "child";
    child.parent = "parent";
    child.started = kNoon + 60s;
    recorder_->begin(child);
    flush();
    const auto shown = view_.one(1).body;
    EXPECT_EQ(shown.at("path").at(0),
              json::parse(R"({"time":0.5,"q":[0.123457,1.0],"c":[0.2,1.0]})"));
    ASSERT_EQ(shown.at("children").size(), 1U);
    EXPECT_EQ(shown.at("children").at(0).at("id"), "child");
    EXPECT_TRUE(shown.at("ended").is_null()) << "it is under way";
}

TEST_F(RecordsOfACell, ShowTextThatIsNoJsonAsItIs) {
    records::ExecutionRow execution;
    execution.id = "odd";
    execution.parameters = R"({"Target":{"x":1,"y":2,"z":3}})";
    execution.check = "{broken";
    execution.started = kNoon;
    recorder_->begin(execution);
    flush();
    const auto shown = view_.one(1).body;
    EXPECT_EQ(shown.at("parameters").at("Target"), json::array({1, 2, 3}));
    EXPECT_EQ(shown.at("check"), "{broken");
}

TEST(RecordsOfNoStore, AreAnErrorThatNamesIt) {
    const auto file =
        std::string(::testing::TempDir()) + "no_records_" + std::to_string(getpid()) + ".db";
    std::ofstream(file) << "This is no database, and nobody shall write into it.";
    const SystemClock clock;
    Board board({{"name", "test"}}, clock);
    RecordsView view(file, board);
    view.show(true);
    for (const auto& reply : {view.list({}), view.one(1)}) {
        EXPECT_EQ(reply.status, 400);
        EXPECT_THAT(reply.body.at("error").at("message").get<std::string>(), HasSubstr(file));
    }
    std::filesystem::remove(file);
}

TEST(RecordsOfNoStore, AreNoneWhereNothingIsRecorded) {
    const SystemClock clock;
    Board board({{"name", "test"}}, clock);
    RecordsView view("", board);
    view.show(true);
    EXPECT_EQ(view.list({}).body.at("records"), json::array());
    EXPECT_EQ(view.one(1).status, 404);
    httplib::Request wrong;
    wrong.params = {{"count", "0"}};
    EXPECT_EQ(view.list(wrong).status, 400);
}

}  // namespace
}  // namespace metier::dashboard
