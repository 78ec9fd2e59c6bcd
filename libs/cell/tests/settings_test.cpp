#include "metier/cell/settings.hpp"

#include <gmock/gmock.h>

namespace metier::cell {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

Settings someSettings() {
    return Settings("cell.toml:4: server[0].driver", {{"gain", 300.0},
                                                      {"power_on", true},
                                                      {"address", std::string("10.0.0.5")},
                                                      {"base", std::vector<double>{1, 2, 3}}});
}

TEST(Settings, GivesWhatWasSetAndElseTheDefault) {
    const auto settings = someSettings();
    EXPECT_EQ(settings.numberOr("gain", 100, 0, 2000), 300);
    EXPECT_EQ(settings.numberOr("lookahead", 0.1, 0, 1), 0.1);
    EXPECT_TRUE(settings.flagOr("power_on", false));
    EXPECT_EQ(settings.text("address"), "10.0.0.5");
    EXPECT_THAT(settings.numbersOr("base", {}, 3), ElementsAre(1, 2, 3));
    EXPECT_TRUE(settings.finish());
}

TEST(Settings, TellsEverythingThatIsWrongWithItsPlace) {
    const auto settings = someSettings();
    EXPECT_EQ(settings.numberOr("gain", 100, 0, 200), 100);
    EXPECT_EQ(settings.numberOr("address", 1, 0, 2), 1);
    EXPECT_EQ(settings.text("serial"), "");
    settings.numbersOr("base", {}, 6);
    const auto checked = settings.finish();
    ASSERT_FALSE(checked);
    EXPECT_EQ(checked.error().code, Errc::invalid_argument);
    EXPECT_THAT(checked.error().message,
                HasSubstr("cell.toml:4: server[0].driver.gain: 300 is not within 0 to 200"));
    EXPECT_THAT(checked.error().message, HasSubstr("address: is not a number"));
    EXPECT_THAT(checked.error().message, HasSubstr("serial: missing"));
    EXPECT_THAT(checked.error().message, HasSubstr("base: has 3 numbers; needs 6"));
    EXPECT_THAT(checked.error().message,
                HasSubstr("power_on: unknown; known here: address, base, gain, serial"));
}

TEST(Settings, AreOverriddenOneByOne) {
    auto settings = someSettings();
    settings.set("gain", 50.0);
    EXPECT_EQ(settings.numberOr("gain", 100, 0, 2000), 50);
}

}  // namespace
}  // namespace metier::cell
