// Writes to values that no program serves: those of a user's own NodeSet.
#include <gmock/gmock.h>

#include "bare_client.hpp"
#include "nodeset_texts.hpp"

namespace metier::opcua {
namespace {

using testing::BareClient;
using testing::NodesetFolder;

/// Variables 1 (Double), 2 (a Property), 3 (Double[3]), 4, of which clients may write status and
/// time, and 5 (Double of any rank); a type 10 with a Variable 11.
constexpr const char* kNodes = R"(
<UAVariable NodeId="ns=1;i=1" BrowseName="1:Speed" DataType="Double" AccessLevel="3"><References>
  <Reference ReferenceType="Organizes" IsForward="false">i=85</Reference>
  <Reference ReferenceType="HasTypeDefinition">i=63</Reference></References>
  <Value><uax:Double>1.5</uax:Double></Value></UAVariable>
<UAVariable NodeId="ns=1;i=2" BrowseName="1:Name" DataType="i=12" AccessLevel="3"><References>
  <Reference ReferenceType="HasProperty" IsForward="false">i=85</Reference>
  <Reference ReferenceType="HasTypeDefinition">i=68</Reference></References>
  <Value><uax:String>left</uax:String></Value></UAVariable>
<UAVariable NodeId="ns=1;i=3" BrowseName="1:Speeds" DataType="Double" ValueRank="1" ArrayDimensions="3" AccessLevel="3"><References>
  <Reference ReferenceType="Organizes" IsForward="false">i=85</Reference>
  <Reference ReferenceType="HasTypeDefinition">i=63</Reference></References>
  <Value><uax:ListOfDouble><uax:Double>1</uax:Double><uax:Double>2</uax:Double><uax:Double>3</uax:Double></uax:ListOfDouble></Value></UAVariable>
<UAVariable NodeId="ns=1;i=4" BrowseName="1:Free" DataType="Double" AccessLevel="99"><References>
  <Reference ReferenceType="Organizes" IsForward="false">i=85</Reference>
  <Reference ReferenceType="HasTypeDefinition">i=63</Reference></References>
  <Value><uax:Double>1.5</uax:Double></Value></UAVariable>
<UAVariable NodeId="ns=1;i=5" BrowseName="1:Any" DataType="Double" ValueRank="-2" AccessLevel="3"><References>
  <Reference ReferenceType="Organizes" IsForward="false">i=85</Reference>
  <Reference ReferenceType="HasTypeDefinition">i=63</Reference></References>
  <Value><uax:Double>1.5</uax:Double></Value></UAVariable>
<UAObjectType NodeId="ns=1;i=10" BrowseName="1:PressType"><References>
  <Reference ReferenceType="HasSubtype" IsForward="false">i=58</Reference></References></UAObjectType>
<UAVariable NodeId="ns=1;i=11" BrowseName="1:Force" DataType="Double" AccessLevel="3"><References>
  <Reference ReferenceType="HasComponent" IsForward="false">ns=1;i=10</Reference>
  <Reference ReferenceType="i=37">i=78</Reference>
  <Reference ReferenceType="HasTypeDefinition">i=63</Reference></References>
  <Value><uax:Double>7</uax:Double></Value></UAVariable>
)";

const UtcTime kLongAgo(std::chrono::milliseconds(1'700'000'000'000));
const StatusCode kOutOfService{0x808D0000};

class KeptValues : public ::testing::Test {
protected:
    KeptValues() {
        auto options = testing::testOptions();
        options.nodeset_files = {folder_.write({.nodes = kNodes})};
        server_ = testing::makeServer(options);
    }
    void serve() {
        ASSERT_TRUE(server_->start());
        ASSERT_EQ(client_.connect(server_->endpointUrl()), status::kGood);
    }
    AddressSpace& nodes() { return server_->nodes(); }
    NodeId id(std::uint32_t number) {
        return {nodes().namespaceIndex("urn:test:machine").value(), number};
    }

    NodesetFolder folder_;
    std::unique_ptr<Server> server_;
    BareClient client_;
};

TEST_F(KeptValues, TakeWhatClientsWrite) {
    const auto speed = id(1);
    serve();
    EXPECT_EQ(client_.read(speed).value, Value::of(1.5));
    EXPECT_EQ(client_.write(speed, Value::of(2.5)), status::kGood);
    EXPECT_EQ(client_.writeWithStatus(speed, Value::of(3.5), status::kGood), status::kGood);
    EXPECT_EQ(client_.read(speed).value, Value::of(3.5));
    EXPECT_EQ(client_.write(speed, Value::of("fast")), status::kBadTypeMismatch);
    EXPECT_EQ(server_->call([&] { return nodes().read(speed); })->value, Value::of(3.5));
}

TEST_F(KeptValues, TakeNoStatusWithoutStatusWrite) {
    const auto speed = id(1);
    serve();
    for (const auto quality : {kOutOfService, StatusCode(0x40000000)}) {
        EXPECT_EQ(client_.writeWithStatus(speed, Value::of(2.5), quality),
                  status::kBadWriteNotSupported);
    }
    EXPECT_EQ(client_.read(speed).value, Value::of(1.5));
    EXPECT_EQ(client_.read(speed).status, status::kGood);
}

TEST_F(KeptValues, TakeNoTimeWithoutTimestampWrite) {
    const auto speed = id(1);
    const auto name = id(2);
    serve();
    EXPECT_EQ(client_.writeWithTime(speed, Value::of(2.5), kLongAgo, {}),
              status::kBadWriteNotSupported);
    EXPECT_EQ(client_.writeWithTime(speed, Value::of(2.5), {}, kLongAgo),
              status::kBadWriteNotSupported);
    EXPECT_EQ(client_.writeWithTime(name, Value::of("right"), kLongAgo, {}),
              status::kBadWriteNotSupported);
    EXPECT_EQ(client_.read(speed).value, Value::of(1.5));
    EXPECT_EQ(client_.read(name).value, Value::of("left"));
    EXPECT_EQ(client_.writeWithTime(name, Value::of("right"), {}, {}), status::kGood);
}

TEST_F(KeptValues, TakeBothWhereTheAccessLevelAllowsThem) {
    const auto free = id(4);
    serve();
    EXPECT_EQ(client_.writeWithTime(free, Value::of(2.5), kLongAgo, {}), status::kGood);
    EXPECT_EQ(client_.read(free).source_time, kLongAgo);
    EXPECT_EQ(client_.writeWithStatus(free, Value::of(2.5), kOutOfService), status::kGood);
    EXPECT_EQ(client_.read(free).status, kOutOfService);
}

TEST_F(KeptValues, AreWrittenInParts) {
    const auto speeds = id(3);
    serve();
    EXPECT_EQ(client_.writePart(speeds, Value::of(std::vector{9.0}), "1"), status::kGood);
    EXPECT_EQ(client_.read(speeds).value, Value::of(std::vector{1.0, 9.0, 3.0}));
    EXPECT_EQ(client_.writePart(speeds, Value::of(std::vector{9.0}), "7").name(),
              "BadIndexRangeNoData");
    // The stack (1.4.11) wrote beyond the end.
    EXPECT_EQ(client_.writePart(speeds, Value::of(std::vector{7.0, 8.0, 9.0}), "1:3").name(),
              "BadIndexRangeNoData");
    EXPECT_EQ(client_.writePart(speeds, Value::of(std::vector<double>()), "0:4294967295").name(),
              "BadIndexRangeNoData");
    EXPECT_EQ(client_.writePart(speeds, Value::of(std::vector<std::string>{"a"}), "1"),
              status::kBadTypeMismatch);
    EXPECT_EQ(client_.writePart(id(1), Value::of(std::vector{9.0}), "0").isBad(), true);
    EXPECT_EQ(client_.read(speeds).value, Value::of(std::vector{1.0, 9.0, 3.0}));
}

// 2^16 * 2^16 * 2^16 * 2^16 is 0 in 64 bits: the stack (1.4.11) took an empty array for that many
// elements, and read some of them.
TEST_F(KeptValues, HaveAsManyElementsAsTheirDimensionsSay) {
    const auto any = id(5);
    serve();
    EXPECT_EQ(client_.writeArray(any, 6, {2, 3}), status::kGood);
    EXPECT_EQ(client_.writePart(any, Value::of(std::vector{9.0}), "1,2"), status::kGood);
    constexpr std::uint32_t kMany = 65'536;
    EXPECT_EQ(client_.writeArray(any, 0, {kMany, kMany, kMany, kMany}).name(), "BadOutOfRange");
    EXPECT_EQ(client_.writeArray(any, 6, {3, 3}).isBad(), true);
    EXPECT_EQ(client_.writePart(any, Value::of(std::vector{9.0}), "1,2"), status::kGood)
        << "of the array before";
}

TEST_F(KeptValues, MayHaveAnyStatusAndTimeFromTheServer) {
    const auto speed = id(1);
    serve();
    ASSERT_EQ(client_.write(speed, Value::of(2.5)), status::kGood);
    ASSERT_TRUE(server_->call([&] {
        return nodes().write(speed, {Value::of(4.5), kOutOfService, kLongAgo, {}});
    }));
    EXPECT_EQ(client_.read(speed).status, kOutOfService);
    EXPECT_EQ(client_.read(speed).source_time, kLongAgo);
    ASSERT_TRUE(server_->call([&] { return nodes().write(speed, Value::of(5.5)); }));
    EXPECT_EQ(client_.read(speed).value, Value::of(5.5));
}

TEST_F(KeptValues, ReachSubscribers) {
    const auto speed = id(1);
    serve();
    ASSERT_GT(client_.subscribe(5.0), 0.0);
    std::vector<DataValue> seen;
    ASSERT_EQ(client_.watchValue(speed, 0.0, seen), status::kGood);
    ASSERT_TRUE(client_.runUntil([&] { return seen.size() == 1; }));
    ASSERT_EQ(client_.write(speed, Value::of(2.5)), status::kGood);
    ASSERT_TRUE(client_.runUntil([&] { return seen.size() == 2; }));
    EXPECT_EQ(seen[0].value, Value::of(1.5));
    EXPECT_EQ(seen[1].value, Value::of(2.5));
}

TEST_F(KeptValues, GiveWayToAProgramThatServesThem) {
    const auto speed = id(1);
    serve();
    ASSERT_EQ(client_.write(speed, Value::of(2.5)), status::kGood);
    ASSERT_TRUE(server_->call([&] {
        return nodes().setDataSource(
            speed, {[](const Session&) { return DataValue{Value::of(8.0)}; }, nullptr});
    }));
    EXPECT_EQ(client_.read(speed).value, Value::of(8.0));
    EXPECT_EQ(client_.write(speed, Value::of(2.5)), status::kBadWriteNotSupported);
}

TEST_F(KeptValues, AreNoneOfATypeSoThatNewObjectsBeginWithIts) {
    const auto declared = id(11);
    serve();
    EXPECT_EQ(client_.read(declared).value, Value::of(7.0));
    EXPECT_EQ(client_.write(declared, Value::of(8.0)).name(), "BadUserAccessDenied");
    const auto press = server_->call([&] {
        return nodes().addObject(
            {.node = {.parent = ids::kObjectsFolder, .browse_name = {2, "Press"}}, .type = id(10)});
    });
    ASSERT_TRUE(press) << press.error().message;
    const auto force = server_->call([&] {
        return nodes().find(*press, {id(10).namespaceIndex(), "Force"});
    });
    ASSERT_TRUE(force);
    EXPECT_EQ(client_.read(*force).value, Value::of(7.0));
    EXPECT_EQ(client_.writeWithStatus(*force, Value::of(8.0), kOutOfService),
              status::kBadWriteNotSupported);
    EXPECT_EQ(client_.write(*force, Value::of(8.0)), status::kGood);
    EXPECT_EQ(client_.read(*force).value, Value::of(8.0));
}

TEST_F(KeptValues, OfVariablesMadeByAProgramTakeNoStatusEither) {
    const auto made =
        nodes().addVariable({.node = {.parent = ids::kObjectsFolder, .browse_name = {2, "Own"}},
                             .data_type = ids::kDouble,
                             .value = Value::of(1.0),
                             .access = Access::read_write});
    ASSERT_TRUE(made);
    serve();
    EXPECT_EQ(client_.writeWithStatus(*made, Value::of(2.0), kOutOfService),
              status::kBadWriteNotSupported);
    EXPECT_EQ(client_.writeWithTime(*made, Value::of(2.0), kLongAgo, {}), status::kGood);
    EXPECT_EQ(client_.read(*made).source_time, kLongAgo);
}

}  // namespace
}  // namespace metier::opcua
