#include "web.hpp"

#include <gmock/gmock.h>

namespace metier::virtual_netft {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

std::string get(const std::string& target, const WebPages& pages = {}) {
    return answerWeb("GET " + target + " HTTP/1.1\r\n\r\n", pages).text;
}

std::vector<Change> changesOf(const std::string& target) {
    return answerWeb("GET " + target + " HTTP/1.1\r\n\r\n", {}).changes;
}

MATCHER_P2(Sets, setting, value, "") {
    return arg.setting == setting && arg.value == value;
}

TEST(Web, TellsTheConfiguration) {
    const auto page = get("/netftapi2.xml", {.product = "Gamma <1>"});
    EXPECT_THAT(page, StartsWith("HTTP/1.0 200 OK\r\n"));
    EXPECT_THAT(page, HasSubstr("<prodname>Gamma &lt;1&gt;</prodname>"));
    EXPECT_THAT(page, HasSubstr("<cfgcpf>1000000</cfgcpf>"));
    EXPECT_THAT(page, HasSubstr("<cfgcpt>1000000</cfgcpt>"));
    EXPECT_THAT(page, HasSubstr("<scfgfu>N</scfgfu>"));
    EXPECT_THAT(page, HasSubstr("<scfgtu>Nm</scfgtu>"));
}

// Values that ATI's Java demo needs: it gives up without them.
TEST(Web, TellsWhatTheMakersDemoNeeds) {
    const auto page = get("/netftapi2.xml?index=0");
    EXPECT_THAT(page, HasSubstr("<setcfgsel>0</setcfgsel>"));
    EXPECT_THAT(page, HasSubstr("<cfgcalsel>0</cfgcalsel>"));
    EXPECT_THAT(page, HasSubstr("<cfgnam>empty</cfgnam>"));
    EXPECT_THAT(page, HasSubstr("<comrdtrate>1000</comrdtrate>"));
    EXPECT_THAT(page, HasSubstr("<cfgmr>65;65;200;5;5;5</cfgmr>"));
    EXPECT_THAT(get("/netftcalapi.xml?index=0"), HasSubstr("<calsn>FT00001</calsn>"));
}

TEST(Web, TellsTheLastReading) {
    WebPages pages;
    pages.reading = {{10, -20, 30, 1, -2, 3}, 0x80020000U};
    const auto page = get("/netftapi2.xml", pages);
    EXPECT_THAT(page, HasSubstr("<runstat>0x80020000</runstat>"));
    EXPECT_THAT(page, HasSubstr("<runft>10;-20;30;1;-2;3</runft>"));
    EXPECT_THAT(page, HasSubstr("<runrate>7000</runrate>"));
    EXPECT_THAT(get("/netftapi2.xml"), HasSubstr("<runstat>0x00000000</runstat>"));
}

TEST(Web, TellsWhatIsSet) {
    const auto page = get("/netftapi2.xml", {.address = "127.0.0.1",
                                             .gauge_bias = {745, 17, 447, 184, -596, -253},
                                             .rate = 100,
                                             .buffer_size = 1,
                                             .filter = 3});
    EXPECT_THAT(page, HasSubstr("<setbias>745;17;447;184;-596;-253</setbias>"));
    EXPECT_THAT(page, HasSubstr("<netip>127.0.0.1</netip>"));
    EXPECT_THAT(page, HasSubstr("<comrdte>Enabled</comrdte>"));
    EXPECT_THAT(page, HasSubstr("<comrdtrate>100</comrdtrate>"));
    EXPECT_THAT(page, HasSubstr("<comrdtbsiz>1</comrdtbsiz>"));
    EXPECT_THAT(page, HasSubstr("<setuserfilter>3</setuserfilter>"));
    EXPECT_THAT(page, HasSubstr("<cfgtfx>0;0;0;0;0;0</cfgtfx>"));
    EXPECT_THAT(page, HasSubstr("<cfgcalsn>FT00001</cfgcalsn>"));
    EXPECT_THAT(get("/netftapi2.xml", {.rdt_enabled = false}),
                HasSubstr("<comrdte>Disabled</comrdte>"));
}

TEST(Web, TellsRatingsInItsUnits) {
    WebPages pages;
    pages.calibration.force_unit = kForceUnits[1];
    EXPECT_EQ(pages.calibration.force_unit.name, "kN");
    const auto page = get("/netftapi2.xml", pages);
    EXPECT_THAT(page, HasSubstr("<cfgmr>0.065;0.065;0.2;5;5;5</cfgmr>"));
    EXPECT_THAT(page, HasSubstr("<cfgfu>4</cfgfu>"));
}

TEST(Web, TellsTheCalibrationAsOlderSensorsDo) {
    const auto page = get("/netftcalapi.xml?index=0");
    EXPECT_THAT(page, HasSubstr("<netftCalibration>"));
    EXPECT_THAT(page, HasSubstr("<calcpf>1000000</calcpf>"));
    EXPECT_THAT(page, HasSubstr("<calcpt>1000000</calcpt>"));
    EXPECT_THAT(page, HasSubstr("<calpn>SI-65-5</calpn>"));
    EXPECT_THAT(page, HasSubstr("<scalfu>N</scalfu>"));
    EXPECT_THAT(page, HasSubstr("<scaltu>Nm</scaltu>"));
    EXPECT_THAT(page, HasSubstr("<calmr>65;65;200;5;5;5</calmr>"));
}

TEST(Web, TakesSettings) {
    EXPECT_THAT(changesOf("/comm.cgi?comrdtrate=500"), ElementsAre(Sets(Setting::rate, 500)));
    EXPECT_THAT(changesOf("/comm.cgi?commrdtrate=500"), ElementsAre(Sets(Setting::rate, 500)));
    EXPECT_THAT(changesOf("/comm.cgi?comrdte=0&comrdtrate=7000&comrdtbsiz=40"),
                ElementsAre(Sets(Setting::rdt_enabled, 0), Sets(Setting::rate, 7000),
                            Sets(Setting::buffer_size, 40)));
    EXPECT_THAT(changesOf("/setting.cgi?setuserfilter=12"), ElementsAre(Sets(Setting::filter, 12)));
    const auto bias = changesOf("/setting.cgi?setbias0=0&setbias5=-32768");
    ASSERT_THAT(bias, ElementsAre(Sets(Setting::gauge_bias, 0), Sets(Setting::gauge_bias, -32768)));
    EXPECT_EQ(bias[0].gauge, 0U);
    EXPECT_EQ(bias[1].gauge, 5U);
}

// kuka-isir/ati_sensor takes anything else for a failure.
TEST(Web, AnswersASettingAsARealSensorDoes) {
    EXPECT_THAT(get("/comm.cgi?comrdtrate=500"), StartsWith("HTTP/1.0 302 Found\r\n"));
    EXPECT_THAT(get("/comm.cgi?comrdtrate=500"), HasSubstr("\r\nLocation: /netftapi2.xml\r\n"));
}

TEST(Web, RefusesSettingsBeyondTheirLimits) {
    const auto page = get("/comm.cgi?comrdtrate=9000");
    EXPECT_THAT(page, StartsWith("HTTP/1.0 400 "));
    EXPECT_THAT(page, HasSubstr("comrdtrate: '9000' is not within 1 to 7000"));
    for (const std::string target :
         {"/comm.cgi?comrdtrate=0", "/comm.cgi?comrdtbsiz=41", "/comm.cgi?comrdte=2",
          "/setting.cgi?setuserfilter=13", "/setting.cgi?setbias0=32768",
          "/comm.cgi?comrdtrate=", "/comm.cgi?comrdtrate", "/comm.cgi?comrdtrate=5x",
          "/comm.cgi?comrdtrate=99999999999999999999"}) {
        EXPECT_THAT(get(target), StartsWith("HTTP/1.0 400 ")) << target;
        EXPECT_THAT(get(target), HasSubstr("is not within")) << target;
    }
    EXPECT_THAT(changesOf("/comm.cgi?comrdtrate=500&comrdtbsiz=41"), IsEmpty()) << "all or nothing";
}

TEST(Web, RefusesVariablesThatItDoesNotHave) {
    EXPECT_THAT(get("/comm.cgi?comnetip=1.2.3.4"), HasSubstr("comnetip: not a variable of /comm"));
    EXPECT_THAT(get("/setting.cgi?comrdtrate=5"), StartsWith("HTTP/1.0 400 "));
    EXPECT_THAT(get("/setting.cgi?setbias6=0"), StartsWith("HTTP/1.0 400 "));
    EXPECT_THAT(get("/comm.cgi"), StartsWith("HTTP/1.0 400 "));
    EXPECT_LT(get("/comm.cgi?" + std::string(5000, 'x')).size(), 500U);
}

TEST(Web, RefusesTheRest) {
    EXPECT_THAT(get("/index.htm"), HasSubstr("404"));
    EXPECT_THAT(answerWeb("POST /netftapi2.xml HTTP/1.1\r\n\r\n", {}).text, HasSubstr("405"));
    EXPECT_THAT(answerWeb("\r\n\r\n", {}).text, HasSubstr("400"));
}

}  // namespace
}  // namespace metier::virtual_netft
