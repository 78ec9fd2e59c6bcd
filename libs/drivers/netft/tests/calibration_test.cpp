#include "calibration.hpp"

#include <gmock/gmock.h>

namespace metier::netft_driver {
namespace {

using ::testing::HasSubstr;

std::string newPage(const std::string& force_unit, const std::string& torque_unit) {
    return "<?xml version=\"1.0\"?><netft><prodname>Ethernet Axia</prodname>"
           "<cfgcpf>1000000</cfgcpf><cfgcpt>2000000</cfgcpt><scfgfu>" +
           force_unit + "</scfgfu><scfgtu>" + torque_unit + "</scfgtu></netft>";
}

const UnitTexts kNoUnits{};

TEST(Calibration, IsReadFromTheNewerPage) {
    const auto read = parseCalibration(newPage("N", "Nm"), kNoUnits);
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_DOUBLE_EQ(read->force_per_count, 1e-6);
    EXPECT_DOUBLE_EQ(read->torque_per_count, 5e-7);
}

TEST(Calibration, IsConvertedToSi) {
    const auto read = parseCalibration(newPage(" lbf\n", "lbf-in"), kNoUnits);
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_NEAR(read->force_per_count, 4.4482216152605e-6, 1e-15);
    EXPECT_NEAR(read->torque_per_count, 4.4482216152605 * 0.0254 / 2e6, 1e-18);
}

TEST(Calibration, KnowsUnitsHoweverTheyAreWritten) {
    EXPECT_DOUBLE_EQ(*forceUnit("kN"), 1000.0);
    EXPECT_NEAR(*forceUnit("Klbf"), 4448.2216152605, 1e-9);
    EXPECT_DOUBLE_EQ(*torqueUnit("N-m"), 1.0);
    EXPECT_DOUBLE_EQ(*torqueUnit("N·m"), 1.0);
    EXPECT_DOUBLE_EQ(*torqueUnit("N-mm"), 1e-3);
    EXPECT_DOUBLE_EQ(*torqueUnit("kN-m"), 1e3);
    EXPECT_NEAR(*torqueUnit("lbf-ft"), 1.3558179483314, 1e-10);
    EXPECT_DOUBLE_EQ(*forceUnit("kgf"), 9.80665);
    EXPECT_DOUBLE_EQ(*forceUnit("gf"), 0.00980665);
    EXPECT_DOUBLE_EQ(*torqueUnit("kgf-cm"), 0.0980665);
}

TEST(Calibration, RefusesUnitsThatItDoesNotKnow) {
    EXPECT_THAT(forceUnit("kg").error().message, HasSubstr("unknown force unit 'kg'"));
    EXPECT_THAT(torqueUnit("N").error().message, HasSubstr("known are nm"));
    EXPECT_FALSE(parseCalibration(newPage("kg", "Nm"), kNoUnits));
    EXPECT_FALSE(parseCalibration(newPage("N", "kg-cm"), kNoUnits));
    EXPECT_LT(forceUnit(std::string(5000, 'x')).error().message.size(), 200U);
}

TEST(Calibration, DoesNotGuessAUnit) {
    const auto read = parseCalibration(newPage("", "Nm"), kNoUnits);
    ASSERT_FALSE(read);
    EXPECT_THAT(read.error().message, HasSubstr("no unit of force"));
}

TEST(Calibration, IsReadFromTheOlderPageWithUnitsBySetting) {
    const std::string page =
        "<netftCalibration><calcpf>500</calcpf><calcpt>250</calcpt></netftCalibration>";
    EXPECT_FALSE(parseCalibration(page, kNoUnits));
    const auto read = parseCalibration(page, {"N", "Nm"});
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_DOUBLE_EQ(read->force_per_count, 0.002);
    EXPECT_DOUBLE_EQ(read->torque_per_count, 0.004);
}

TEST(Calibration, BelievesThePageOverTheSetting) {
    EXPECT_DOUBLE_EQ(parseCalibration(newPage("kN", "Nm"), {"N", "Nm"})->force_per_count, 1e-3);
}

TEST(Calibration, RefusesCountsThatAreNone) {
    for (const std::string counts : {"", "0", "-1", "abc", "12x", "nan", "inf", "1e30"}) {
        const auto page = "<a><cfgcpf>" + counts + "</cfgcpf><cfgcpt>1</cfgcpt></a>";
        const auto read = parseCalibration(page, {"N", "Nm"});
        ASSERT_FALSE(read) << counts;
        EXPECT_THAT(read.error().message, HasSubstr("cfgcpf")) << counts;
    }
}

TEST(Calibration, NeedsCountsOfForceAndOfTorque) {
    const auto read = parseCalibration("<a><cfgcpf>1</cfgcpf></a>", {"N", "Nm"});
    ASSERT_FALSE(read);
    EXPECT_THAT(read.error().message, HasSubstr("cfgcpt is '', expected counts per unit"));
}

TEST(Calibration, TakesCountsUpToALimit) {
    const auto page = [](const std::string& counts) {
        return "<a><cfgcpf>" + counts + "</cfgcpf><cfgcpt>1</cfgcpt></a>";
    };
    EXPECT_TRUE(parseCalibration(page("1e12"), {"N", "Nm"}));
    EXPECT_FALSE(parseCalibration(page("1.1e12"), {"N", "Nm"}));
}

TEST(Calibration, RefusesWhatIsNoXml) {
    EXPECT_THAT(parseCalibration("<a><b>", kNoUnits).error().message, HasSubstr("not XML"));
    EXPECT_FALSE(parseCalibration("", kNoUnits));
    EXPECT_FALSE(parseCalibration("<html>404</html>", kNoUnits));
}

std::string ratePage(const std::string& elements) {
    return "<netft>" + elements + "</netft>";
}

TEST(Rate, IsReadFromThePageByEitherName) {
    EXPECT_EQ(*parseRate(ratePage("<comrdte>Enabled</comrdte><comrdtrate>100</comrdtrate>")),
              100.0);
    EXPECT_EQ(*parseRate(ratePage("<commrdtrate>7912</commrdtrate>")), 7912.0);
    EXPECT_EQ(*parseRate(ratePage("<comrdte>1</comrdte><comrdtrate> 50\n</comrdtrate>")), 50.0);
}

TEST(Rate, IsNotGuessed) {
    EXPECT_EQ(*parseRate(ratePage("")), std::nullopt);
    EXPECT_EQ(*parseRate(ratePage("<comrdtrate></comrdtrate>")), std::nullopt);
}

TEST(Rate, IsRefusedIfItIsNone) {
    for (const std::string rate : {"0", "-1", "0.5", "abc", "12x", "nan", "inf", "1e9"}) {
        const auto read = parseRate(ratePage("<comrdtrate>" + rate + "</comrdtrate>"));
        ASSERT_FALSE(read) << rate;
        EXPECT_THAT(read.error().message, HasSubstr("comrdtrate is '" + rate + "'"));
    }
    EXPECT_THAT(parseRate("<a><b>").error().message, HasSubstr("not XML"));
}

TEST(Rate, IsWithinOneAndAHundredThousandRecordsPerSecond) {
    EXPECT_EQ(*parseRate(ratePage("<comrdtrate>1</comrdtrate>")), 1.0);
    EXPECT_EQ(*parseRate(ratePage("<comrdtrate>100000</comrdtrate>")), 1e5);
    EXPECT_FALSE(parseRate(ratePage("<comrdtrate>100001</comrdtrate>")));
}

TEST(Rate, IsRefusedIfRdtIsNotEnabled) {
    const auto read =
        parseRate(ratePage("<comrdte>Disabled</comrdte><comrdtrate>100</comrdtrate>"));
    ASSERT_FALSE(read);
    EXPECT_EQ(read.error().code, Errc::device_fault);
    EXPECT_THAT(read.error().message, HasSubstr("comrdte is 'Disabled', expected Enabled"));
}

}  // namespace
}  // namespace metier::netft_driver
