#include "metier/path_evaluation/motion_record.hpp"

#include <gmock/gmock.h>

#include <cmath>

namespace metier::path_evaluation {
namespace {

using ::testing::HasSubstr;
using ::testing::SizeIs;

constexpr const char* kCsv =
    "time,q1,q2\r\n# by hand\n0,0.1,-0.2\n0.1,0.2,-.3\n0.2,0.3,-4e-1\n\n0.3, "
    "0.4,-0.5\n0.4,0.5,-0.6";

TEST(MotionRecord, IsReadFromCsvWithHeadingCommentsAndBlanks) {
    const auto record = parseRecord(kCsv, "a.csv");
    ASSERT_TRUE(record) << record.error().message;
    ASSERT_THAT(*record, SizeIs(5));
    EXPECT_EQ((*record)[1].time, 0.1);
    EXPECT_EQ((*record)[1].position, (motion::JointVector{0.2, -0.3}));
    EXPECT_EQ((*record)[4].position, (motion::JointVector{0.5, -0.6}));
}

TEST(MotionRecord, IsReadFromAListOrThePreviewOfAnObject) {
    const std::string list = R"([{"time":0,"joint_position":[0]},{"time":1,"joint_position":[1]},
        {"time":2,"joint_position":[2]},{"time":3,"joint_position":[3]},
        {"time":4,"joint_position":[4]}])";
    for (const auto& text : {list, R"({"possible":true,"preview":)" + list + "}"}) {
        const auto record = parseRecord(text, "a.json");
        ASSERT_TRUE(record) << record.error().message;
        EXPECT_EQ(record->back().time, 4);
        EXPECT_EQ(record->back().position, (motion::JointVector{4.0}));
    }
}

TEST(MotionRecord, KeepsEveryBitThroughCsv) {
    MotionRecord record;
    for (int i = 0; i < 6; ++i) {
        record.push_back({i / 3.0, {std::sin(i), -1e-17 / 3 * i, 1.0 / 7}});
    }
    const auto back = parseRecord(toCsv(record), "a.csv");
    ASSERT_TRUE(back) << back.error().message;
    for (std::size_t i = 0; i < record.size(); ++i) {
        EXPECT_EQ((*back)[i].time, record[i].time);
        EXPECT_EQ((*back)[i].position, record[i].position);
    }
}

struct WrongRecord {
    const char* name;
    const char* text;
    const char* what;
};

class BadRecord : public ::testing::TestWithParam<WrongRecord> {};

TEST_P(BadRecord, IsToldWithItsPlace) {
    const auto record = parseRecord(GetParam().text, "file");
    ASSERT_FALSE(record);
    EXPECT_EQ(record.error().code, Errc::invalid_argument);
    EXPECT_THAT(record.error().message, HasSubstr(GetParam().what));
}

INSTANTIATE_TEST_SUITE_P(
    Records, BadRecord,
    ::testing::Values(
        WrongRecord{"NotANumber", "0,1\n1,x\n", "file:2: 'x' is not a number"},
        WrongRecord{"TwoHeadings", "t,q\nt,q\n", "file:2: 't' is not a number"},
        WrongRecord{"NotFinite", "0,1\n1,nan\n", "file:2: "},
        WrongRecord{"TimeStands", "0,1\n0,1\n", "file:2: time 0 s is not after 0 s"},
        WrongRecord{"TimeNotFinite", "inf,1\n", "file:1: time inf s is not finite"},
        WrongRecord{"FewerAxes", "0,1,2\n1,1\n", "file:2: 1 joint positions, 2 before"},
        WrongRecord{"NoAxes", "0\n", "file:1: no joint positions"},
        WrongRecord{"TooManyAxes", "0,1,2,3,4,5,6,7,8\n", "file:1: "},
        WrongRecord{"TooShort", "0,1\n1,1\n", "file: 2 positions, at least 5 needed"},
        WrongRecord{"Empty", "", "file: 0 positions"}, WrongRecord{"BrokenJson", "[{", "file: "},
        WrongRecord{"JsonWithoutPreview", "{}", "preview"},
        WrongRecord{"JsonWithoutTime", "[{\"joint_position\":[1]}]", "file: position 1: "},
        WrongRecord{"JsonTimeStands",
                    R"([{"time":0,"joint_position":[1]},{"time":0,"joint_position":[1]}])",
                    "file: position 2: time 0 s is not after 0 s"}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(MotionRecord, AFileThatIsNotThereIsNotFound) {
    const auto record = loadRecord("/nonexistent/record.csv");
    ASSERT_FALSE(record);
    EXPECT_EQ(record.error().code, Errc::not_found);
    EXPECT_THAT(record.error().message, HasSubstr("/nonexistent/record.csv"));
}

TEST(MotionRecord, AnEmptyOneHasAHeadingOnly) {
    EXPECT_EQ(toCsv({}), "time\n");
}

TEST(MotionRecord, OnlyTheFirstLineMayBeAHeadingAlsoBehindComments) {
    const std::string lines = "0,1\n1,1\n2,1\n3,1\n4,1\n";
    EXPECT_THAT(parseRecord("# a\n\nt [s],q1 [rad]\n" + lines, "a").value(), SizeIs(5));
    const auto refused = parseRecord(lines + "# b\nt,q1\n", "a");
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr("a:7: 't' is not a number"));
}

TEST(MotionRecord, OtherSeparatorsAreReportedWithTheLine) {
    const auto semicolons = parseRecord("time;q1\n0;0.1\n1;0.2\n", "a.csv");
    ASSERT_FALSE(semicolons);
    EXPECT_THAT(semicolons.error().message, HasSubstr("a.csv:2: '0;0.1' is not a number"));
    EXPECT_FALSE(parseRecord("0,1,\n", "a.csv")) << "a comma too many";
    EXPECT_FALSE(parseRecord("0,1 2\n", "a.csv"));
}

TEST(MotionRecord, JsonOfAnotherShapeIsRefusedWithoutACrash) {
    for (const char* text :
         {R"({"preview":"text"})", R"({"preview":null})", R"([1,2])", R"([[0,1]])", "[null]",
          R"([{"time":"0","joint_position":[1]}])", R"([{"time":0,"joint_position":1}])",
          R"([{"time":0,"joint_position":["1"]}])", R"([{"time":1e999,"joint_position":[1]}])",
          R"([{"time":0,"joint_position":[]}])", "[", "{\"preview\":[}", "[] []"}) {
        const auto record = parseRecord(text, "file");
        ASSERT_FALSE(record) << text;
        EXPECT_EQ(record.error().code, Errc::invalid_argument) << text;
        EXPECT_THAT(record.error().message, ::testing::StartsWith("file: ")) << text;
    }
    EXPECT_FALSE(parseRecord(std::string(100'000, '['), "file"));
}

TEST(MotionRecord, AFolderIsNoRecord) {
    EXPECT_EQ(loadRecord("/").error().code, Errc::not_found);
}

}  // namespace
}  // namespace metier::path_evaluation
