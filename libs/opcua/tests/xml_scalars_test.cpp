#include "nodesets/xml_scalars.hpp"

#include <gtest/gtest.h>
#include <open62541/types_generated.h>

#include <cmath>
#include <limits>

namespace metier::opcua {
namespace {

TEST(XmlTimes, AreReadWithFractionAndZone) {
    constexpr UA_DateTime kNoon = 133'590'384'000'000'000;  // 2024-05-01T12:00:00Z
    EXPECT_EQ(dateTimeIn("2024-05-01T12:00:00Z"), kNoon);
    EXPECT_EQ(dateTimeIn(" 2024-05-01T12:00:00 "), kNoon);
    EXPECT_EQ(dateTimeIn("2024-05-01T14:30:00+02:30"), kNoon);
    EXPECT_EQ(dateTimeIn("2024-05-01T11:00:00-01:00"), kNoon);
    EXPECT_EQ(dateTimeIn("2024-05-01T12:00:00.0000001Z"), kNoon + 1);
    EXPECT_EQ(dateTimeIn("2024-05-01T12:00:00.12345678901234567890Z"), kNoon + 1'234'567);
}

TEST(XmlTimes, BeforeTheFirstTimeOfOpcUaAreThatTime) {
    EXPECT_EQ(dateTimeIn("1601-01-01T00:00:00Z"), 0);
    EXPECT_EQ(dateTimeIn("0001-01-01T00:00:00Z"), 0);
}

TEST(XmlTimes, ThatAreNoneAreRefused) {
    for (const auto* text : {"", "2024-05-01", "2024-13-01T00:00:00Z", "2024-05-01T12:00Z",
                             "2024-05-01T12:00:00X", "2024-05-01T12:00:00+1", "20240501T120000Z"}) {
        EXPECT_FALSE(dateTimeIn(text)) << text;
    }
}

TEST(XmlNumbers, AreReadAsXmlSpellsThem) {
    EXPECT_EQ(doubleIn(" +1.5E2 "), 150.0);
    EXPECT_EQ(doubleIn("INF"), std::numeric_limits<double>::infinity());
    EXPECT_EQ(doubleIn("-INF"), -std::numeric_limits<double>::infinity());
    EXPECT_TRUE(std::isnan(doubleIn("NaN").value()));
    EXPECT_FALSE(doubleIn("1,5"));
    EXPECT_FALSE(doubleIn(""));
}

TEST(XmlNumbers, OfAnEnumerationFollowTheName) {
    EXPECT_EQ(enumerationIn("Running_Light_2"), 2);
    EXPECT_EQ(enumerationIn(" 7 "), 7);
    EXPECT_FALSE(enumerationIn("Running"));
}

TEST(XmlNumbers, AreBoundedByTheirType) {
    UA_Int16 number = 0;
    EXPECT_FALSE(readNumber("-32768", UA_TYPES[UA_TYPES_INT16], &number));
    EXPECT_EQ(number, -32768);
    EXPECT_EQ(readNumber("32768", UA_TYPES[UA_TYPES_INT16], &number),
              "'32768' is no number from -32768 to 32767");
}

TEST(XmlTruth, HasFourSpellings) {
    EXPECT_EQ(booleanIn("true"), true);
    EXPECT_EQ(booleanIn(" 1 "), true);
    EXPECT_EQ(booleanIn("false"), false);
    EXPECT_EQ(booleanIn("0"), false);
    EXPECT_FALSE(booleanIn("yes"));
}

}  // namespace
}  // namespace metier::opcua
