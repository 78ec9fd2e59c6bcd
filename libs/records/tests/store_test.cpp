// Content of a store and how it is found, the same in both databases.
#include "metier/records/store.hpp"

#include "either_store.hpp"

namespace metier::records {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

INSTANTIATE_EITHER(EitherStore);

TEST_P(EitherStore, HoldsAllThatWasTold) {
    const auto recorder = recorderOf(url_);
    auto given = moveOf("m-1");
    given.parent = "p-1";
    given.parent_server = "urn:test:pick";
    const auto key = recorder->begin(given);
    recorder->transition(key, {.time = at(0),
                               .from = "Ready",
                               .to = "Running",
                               .sub_state = "Executing",
                               .step = "approach",
                               .reason = {},
                               .reason_text = {}});
    const std::array actual{0.1, 0.2};
    const std::array commanded{0.11, 0.21};
    const std::array force{1.0, 2.0, 3.0, 0.1, 0.2, 0.3};
    const PathSample sample{.time = 0.5,
                            .actual = SampleValues(actual),
                            .commanded = SampleValues(commanded),
                            .force = SampleValues(force)};
    recorder->sample(key, sample);
    recorder->intermediate(key, {.time = at(600), .value = "0.5"});
    ASSERT_TRUE(recorder->flush(soon()));
    EXPECT_FALSE(store()->find("m-1")->isOver());
    recorder->sample(key, sampleAt(0.9, 0.3));
    recorder->end(key, finished(at(1'000)));
    ASSERT_TRUE(recorder->flush(soon()));

    const auto reading = store();
    const auto found = reading->find("m-1");
    ASSERT_TRUE(found) << found.error().message;
    const auto& e = *found;
    EXPECT_THAT(
        (std::array{e.server, e.server_name, e.controller, e.skill, e.device, e.user}),
        ElementsAre("urn:test:ur5", "ur5", "Controller", "JointPtpMoveSkill", "ur5", "anna"));
    EXPECT_THAT((std::array{e.parent, e.parent_server, e.session, e.client_name, e.thumbprint}),
                ElementsAre("p-1", "urn:test:pick", "s-7", "metier command", "ab12"));
    EXPECT_THAT(
        (std::array{e.parameters, e.check, e.result, e.state, e.reason, e.reason_text}),
        ElementsAre(given.parameters, given.check, R"({"Duration":1.0})", "Ready", "Finished", ""));
    EXPECT_EQ(e.started, at(0));
    EXPECT_EQ(e.ended, at(1'000));
    EXPECT_EQ(e.missed_cycles, 2U);
    const auto transitions = reading->transitions(e.number).value();
    ASSERT_EQ(transitions.size(), 1U);
    EXPECT_EQ(transitions[0].step, "approach");
    EXPECT_EQ(transitions[0].time, at(0));
    ASSERT_EQ(reading->intermediates(e.number)->size(), 1U);
    EXPECT_EQ(reading->intermediates(e.number)->front().value, "0.5");
    const auto path = reading->path(e.number).value();
    ASSERT_EQ(path.size(), 2U);
    EXPECT_EQ(path[0].commanded, sample.commanded);
    EXPECT_EQ(path[0].force, sample.force);
    EXPECT_EQ(path[1].actual, sampleAt(0.9, 0.3).actual);
    EXPECT_EQ(reading->find(std::to_string(e.number))->id, "m-1");
    EXPECT_EQ(reading->find("m-2").error().code, Errc::not_found);
}

TEST_P(EitherStore, ListsTheNewestFirstByPages) {
    recordSix();
    EXPECT_THAT(ids({}), ElementsAre("f", "e", "d", "c", "b", "a"));
    const auto reading = store();
    const auto first = reading->list({}, {.before = 0, .count = 4}).value();
    ASSERT_EQ(first.executions.size(), 4U);
    EXPECT_TRUE(first.more);
    const auto second =
        reading->list({}, {.before = first.executions.back().number, .count = 4}).value();
    ASSERT_EQ(second.executions.size(), 2U);
    EXPECT_EQ(second.executions[0].id, "b");
    EXPECT_FALSE(second.more);
    EXPECT_THAT(reading->list({}, {.before = 77, .count = 4})->executions, IsEmpty());
}

TEST_P(EitherStore, ListsOneExecutionAtLeastAndThoseOfOneMomentByTheirNumber) {
    const auto recorder = recorderOf(url_);
    for (const auto* id : {"a", "b", "c"}) {
        recordOne(*recorder, moveOf(id), finished(at(1)));
        ASSERT_TRUE(recorder->flush(soon()));
    }
    EXPECT_THAT(ids({}, {.before = 0, .count = 0}), ElementsAre("c"));
    const auto before = store()->find("c")->number;
    EXPECT_THAT(ids({}, {.before = before, .count = 1}), ElementsAre("b"));
    EXPECT_THAT(ids({}, {.before = before, .count = 4'000'000'000}), ElementsAre("b", "a"));
}

TEST_P(EitherStore, FindsTheNewestOfAnIdAndANumberBeforeAnId) {
    const auto recorder = recorderOf(url_);
    for (const auto& [id, start] : {std::pair("twice", 0), {"twice", 2'000}, {"1", 3'000}}) {
        recordOne(*recorder, moveOf(id, at(start)), finished(at(start + 1)));
        ASSERT_TRUE(recorder->flush(soon()));
    }
    const auto reading = store();
    EXPECT_EQ(reading->find("twice")->started, at(2'000));
    EXPECT_EQ(reading->find("1")->number, 1) << "not the execution with that id";
    for (const auto* nobody : {"", "-1", "99", "99999999999999999999", "1 ", "twic"}) {
        EXPECT_EQ(reading->find(nobody).error().code, Errc::not_found) << nobody;
    }
}

TEST_P(EitherStore, HasNothingOfANumberThatNobodyHas) {
    recordSix();
    const auto reading = store();
    for (const std::int64_t number : {0, -1, 99}) {
        EXPECT_THAT(reading->children(number).value(), IsEmpty()) << number;
        EXPECT_THAT(reading->transitions(number).value(), IsEmpty()) << number;
        EXPECT_THAT(reading->intermediates(number).value(), IsEmpty()) << number;
        EXPECT_THAT(reading->path(number).value(), IsEmpty()) << number;
    }
}

TEST_P(EitherStore, FindsTheNewestOfMoreKindsThanOneStatementTakes) {
    constexpr int kSkills = 250;
    const auto recorder = recorderOf(url_);
    for (int i = 0; i < kSkills; ++i) {
        auto execution = moveOf("m-" + std::to_string(i), at(i * 7 % kSkills));
        execution.skill = "Skill" + std::to_string(i);
        recordOne(*recorder, execution, finished(at(1'000)));
    }
    ASSERT_TRUE(recorder->flush(soon()));
    Filter filter;
    filter.user = "anna";
    const auto all = store()->list(filter, {.before = 0, .count = 1'000}).value();
    ASSERT_EQ(all.executions.size(), kSkills + 0U);
    for (std::size_t i = 0; i < all.executions.size(); ++i) {
        ASSERT_EQ(all.executions[i].started, at(kSkills - 1 - static_cast<int>(i)));
    }
    filter.user.clear();
    filter.text = "skill";
    EXPECT_EQ(store()->list(filter, {.before = 0, .count = 200})->executions.back().started,
              at(kSkills - 200));
}

TEST_P(EitherStore, FiltersByEachFieldAndAllTogether) {
    recordSix();
    const auto only = [this](auto member, const std::string& value) {
        Filter filter;
        filter.*member = value;
        return ids(filter);
    };
    EXPECT_THAT(only(&Filter::server, "urn:test:edo"), ElementsAre("f", "d", "b"));
    EXPECT_THAT(only(&Filter::server, "edo"), ElementsAre("f", "d", "b"));
    EXPECT_THAT(only(&Filter::skill, "JointPtpMoveSkill"), ElementsAre("e", "c", "a"));
    EXPECT_THAT(only(&Filter::state, "Halted"), ElementsAre("c"));
    EXPECT_THAT(only(&Filter::reason, "Error"), ElementsAre("c"));
    EXPECT_THAT(only(&Filter::user, "ben"), ElementsAre("f", "e", "d"));
    EXPECT_THAT(only(&Filter::state, "Lost"), IsEmpty());
    Filter several;
    several.server = "ur5";
    several.user = "anna";
    several.from = at(1'000);
    EXPECT_THAT(ids(several), ElementsAre("c"));
    several.until = at(2'000);
    EXPECT_THAT(ids(several), IsEmpty());
    Filter times;
    times.from = at(1'000);
    times.until = at(3'000);
    EXPECT_THAT(ids(times), ElementsAre("c", "b"));
}

TEST_P(EitherStore, FindsTextInNamesReasonsAndIds) {
    recordSix();
    const auto withText = [this](const std::string& text, const std::string& user = {}) {
        Filter filter;
        filter.text = text;
        filter.user = user;
        return ids(filter);
    };
    EXPECT_THAT(withText("OVER limit 3.1"), ElementsAre("c"));
    EXPECT_THAT(withText("over limit", "ben"), IsEmpty());
    EXPECT_THAT(withText("linear"), ElementsAre("f", "d", "b"));
    EXPECT_THAT(withText("linear", "anna"), ElementsAre("b"));
    EXPECT_THAT(withText("d"), ElementsAre("f", "e", "d", "c", "b", "a"));  // Ready, edo
    EXPECT_THAT(withText("%"), IsEmpty());
    EXPECT_THAT(withText("' OR 1=1 --"), IsEmpty());
}

TEST_P(EitherStore, FindsTextThatManyDifferentReasonsHave) {
    constexpr int kReasons = 250;
    const auto recorder = recorderOf(url_);
    for (int i = 0; i < kReasons; ++i) {
        auto execution = moveOf("m-" + std::to_string(i), at(i));
        execution.user = i % 2 == 0 ? "anna" : "ben";
        recordOne(*recorder, execution, halted(at(i + 1), "axis " + std::to_string(i) + " Late"));
    }
    recordOne(*recorder, moveOf("other", at(kReasons)), halted(at(kReasons), "too early"));
    ASSERT_TRUE(recorder->flush(soon()));
    Filter filter;
    filter.text = " late";
    EXPECT_THAT(ids(filter, {.before = 0, .count = 3}), ElementsAre("m-249", "m-248", "m-247"));
    const auto before = store()->find("m-100")->number;
    EXPECT_THAT(ids(filter, {.before = before, .count = 2}), ElementsAre("m-99", "m-98"));
    EXPECT_EQ(ids(filter, {.before = 0, .count = 1'000}).size(), kReasons + 0U);
    filter.user = "ben";
    EXPECT_THAT(ids(filter, {.before = before, .count = 2}), ElementsAre("m-99", "m-97"));
}

TEST_P(EitherStore, FindsChildrenOnAnyServer) {
    const auto pick = recorderOf(url_, "urn:test:pick");
    const auto ur5 = recorderOf(url_);
    recordOne(*pick, moveOf("p"), finished(at(5'000)));
    auto child = moveOf("p/1");
    child.parent = "p";
    child.parent_server = "urn:test:pick";
    recordOne(*ur5, child, finished(at(2'000)));
    auto own = moveOf("p/2", at(3'000));
    own.parent = "p";
    recordOne(*pick, own, finished(at(4'000)));
    auto of_another = moveOf("x/1");
    of_another.parent = "p";  // an execution of its own server, which is not that of p
    recordOne(*ur5, of_another, finished(at(4'000)));
    ASSERT_TRUE(pick->flush(soon()) && ur5->flush(soon()));

    const auto reading = store();
    const auto children = reading->children(reading->find("p")->number).value();
    ASSERT_EQ(children.size(), 2U);
    EXPECT_EQ(children[0].id, "p/1");
    EXPECT_EQ(children[1].id, "p/2");
    Filter filter;
    filter.parent = "p";
    EXPECT_EQ(ids(filter).size(), 3U);
    filter.user = "ben";
    EXPECT_THAT(ids(filter), IsEmpty());
    filter.user.clear();
    filter.text = "p/2";
    EXPECT_THAT(ids(filter), ElementsAre("p/2"));
}

TEST_P(EitherStore, TellsWhatCameOrChanged) {
    const auto recorder = recorderOf(url_);
    ASSERT_TRUE(recorder->flush(soon()));
    const auto reading = store();
    const auto before = reading->latestRevision().value();
    const auto key = recorder->begin(moveOf("m-1"));
    ASSERT_TRUE(recorder->flush(soon()));
    const auto began = reading->changes(before).value();
    ASSERT_EQ(began.executions.size(), 1U);
    EXPECT_FALSE(began.executions[0].isOver());
    EXPECT_THAT(reading->changes(began.revision)->executions, IsEmpty());
    recordOne(*recorder, moveOf("m-2"), finished(at(2'000)));
    recorder->end(key, finished(at(2'000)));
    ASSERT_TRUE(recorder->flush(soon()));
    const auto ended = reading->changes(began.revision).value();
    ASSERT_EQ(ended.executions.size(), 2U);
    EXPECT_TRUE(ended.executions[0].isOver() && ended.executions[1].isOver());
    EXPECT_EQ(ended.revision, reading->latestRevision().value());
}

TEST_P(EitherStore, ShowsOfChangesThoseThatListWouldShow) {
    recordSix();
    std::vector<Filter> filters(9);
    filters[1].server = "edo";
    filters[2].skill = "JointPtpMoveSkill";
    filters[3].state = "Halted";
    filters[4].text = "OVER limit 3.1";
    filters[5].text = "linear";
    filters[6].text = "e";
    filters[6].user = "ben";
    filters[7].from = at(1'000);
    filters[7].until = at(3'000);
    filters[8].parent = "nobody";
    const auto reading = store();
    for (const auto& filter : filters) {
        auto changed = reading->changes(0, filter)->executions;
        std::vector<std::string> found;
        for (auto one = changed.rbegin(); one != changed.rend(); ++one) {
            found.push_back(one->id);  // they were written in the order of their starts
        }
        EXPECT_EQ(found, ids(filter));
    }
}

TEST_P(EitherStore, GoesOnAfterChangesThatDoNotFit) {
    recordSix();
    const auto reading = store();
    Filter filter;
    filter.user = "ben";
    const auto first = reading->changes(0, filter, 1).value();
    ASSERT_EQ(first.executions.size(), 1U);
    EXPECT_EQ(first.executions[0].id, "d");
    const auto second = reading->changes(first.revision, filter).value();
    EXPECT_EQ(second.executions.size(), 2U);
    EXPECT_EQ(second.revision, reading->latestRevision().value());
    const auto beyond = reading->changes(second.revision + 1'000, filter).value();
    EXPECT_TRUE(beyond.executions.empty());
    EXPECT_EQ(beyond.revision, second.revision) << "another store was here before";
}

TEST_P(EitherStore, TakesAnyBytesAsNames) {
    const auto recorder = recorderOf(url_);
    auto strange = moveOf("id '\";--\xFF");
    strange.user = std::string("a\0b", 3);
    strange.client_name = "\xC0\xAF\xED\xA0\x80 \xF0\x9F\xA4\x96 $1 \\x41";
    strange.skill = std::string(5'000, 's');
    strange.parameters = std::string(2'000'000, '\xC3');
    recordOne(*recorder, strange, halted(at(1'000), std::string(9'999, 'r')));
    ASSERT_TRUE(recorder->flush(soon()));
    const auto found = store()->list({}, {}).value().executions.at(0);
    EXPECT_EQ(found.id, "id '\";--\xEF\xBF\xBD");
    EXPECT_EQ(found.user,
              "a\xEF\xBF\xBD"
              "b");
    EXPECT_THAT(found.client_name, HasSubstr("\xF0\x9F\xA4\x96 $1 \\x41"));
    EXPECT_EQ(found.skill.size(), 300U);
    EXPECT_EQ(found.reason_text.size(), 2'000U);
    EXPECT_LE(found.parameters.size(), 1'000'000U);
}

TEST_P(EitherStore, IsNotThereUntilSomebodyRecords) {
    EXPECT_EQ(Store::open(url_).error().code, Errc::not_found);
}

TEST(StoreUrl, IsAFileOrADatabase) {
    EXPECT_EQ(Store::open("").error().code, Errc::invalid_argument);
    EXPECT_EQ(Store::open("mysql://host/x").error().code, Errc::invalid_argument);
    Recorder::Options options;
    options.url = "mysql://host/x";
    options.server = "urn:x";
    EXPECT_EQ(Recorder::create(options).error().code, Errc::invalid_argument);
    options.url = "records.db";
    options.server.clear();
    EXPECT_EQ(Recorder::create(options).error().code, Errc::invalid_argument);
    const auto file = (testFolder() / "a ?#% b.db").string();
    ASSERT_TRUE(recorderOf("sqlite:" + file)->flush(soon()));
    EXPECT_TRUE(Store::open(file));
    EXPECT_TRUE(Store::open("sqlite://" + file));
}

}  // namespace
}  // namespace metier::records
