#include "metier/virtual_netft/web.hpp"

#include <gmock/gmock.h>

namespace metier::virtual_netft {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST(Web, TellsTheConfiguration) {
    const auto page = answerWeb("GET /netftapi2.xml HTTP/1.1\r\n\r\n", "Gamma <1>", {});
    EXPECT_THAT(page, StartsWith("HTTP/1.0 200 OK\r\n"));
    EXPECT_THAT(page, HasSubstr("<prodname>Gamma &lt;1&gt;</prodname>"));
    EXPECT_THAT(page, HasSubstr("<cfgcpf>1000000</cfgcpf>"));
    EXPECT_THAT(page, HasSubstr("<cfgcpt>1000000</cfgcpt>"));
    EXPECT_THAT(page, HasSubstr("<scfgfu>N</scfgfu>"));
    EXPECT_THAT(page, HasSubstr("<scfgtu>Nm</scfgtu>"));
}

TEST(Web, TellsTheCalibrationAsOlderSensorsDo) {
    const auto page = answerWeb("GET /netftcalapi.xml?index=0 HTTP/1.1\r\n\r\n", "", {});
    EXPECT_THAT(page, HasSubstr("<netftCalibration>"));
    EXPECT_THAT(page, HasSubstr("<calcpf>1000000</calcpf>"));
    EXPECT_THAT(page, HasSubstr("<calcpt>1000000</calcpt>"));
}

TEST(Web, RefusesTheRest) {
    EXPECT_THAT(answerWeb("GET /index.htm HTTP/1.1\r\n\r\n", "", {}), HasSubstr("404"));
    EXPECT_THAT(answerWeb("POST /netftapi2.xml HTTP/1.1\r\n\r\n", "", {}), HasSubstr("405"));
    EXPECT_THAT(answerWeb("\r\n\r\n", "", {}), HasSubstr("400"));
}

}  // namespace
}  // namespace metier::virtual_netft
