#include "options.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

namespace metier::edo_driver {
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::HasSubstr;

device::OpenRequest request() {
    device::OpenRequest request;
    request.name = "edo";
    request.address = "10.42.0.49";
    return request;
}

TEST(Options, HaveDefaults) {
    const auto options = readOptions(request()).value();
    EXPECT_EQ(options.host, "10.42.0.49");
    EXPECT_EQ(options.port, 9090);
    EXPECT_FALSE(options.generation);
    EXPECT_EQ(options.layout.count(), 7U);
    EXPECT_EQ(options.layout.mask(), 127U);
    EXPECT_EQ(options.axis_names.size(), 6U);
    EXPECT_EQ(options.joint_timeout, 100ms);
    EXPECT_NEAR(options.reset.offset, 3.5 * std::numbers::pi / 180.0, 1e-12);
    EXPECT_FALSE(options.start_on_connect);
    EXPECT_NEAR(options.axes.velocity[0], 22.79 * std::numbers::pi / 180.0, 1e-12);
}

TEST(Options, AreRead) {
    auto asked = request();
    asked.settings.set("port", 9091.0);
    asked.settings.set("generation", std::string("classic"));
    asked.settings.set("gripper", false);
    asked.settings.set("joint_timeout", 0.05);
    asked.settings.set("grasp_shortfall_mm", 5.0);
    const auto options = readOptions(asked).value();
    EXPECT_EQ(options.port, 9091);
    EXPECT_EQ(options.generation->kind, Generation::Kind::classic);
    EXPECT_EQ(options.layout.mask(), 63U);
    EXPECT_EQ(options.joint_timeout, 50ms);
    EXPECT_DOUBLE_EQ(options.gripper.grasp_shortfall, 0.005);
}

TEST(Options, TellEverythingThatIsWrong) {
    auto asked = request();
    asked.settings.set("generation", std::string("newest"));
    asked.settings.set("prot", 9091.0);
    asked.settings.set("stroke", 8.0);
    const auto options = readOptions(asked);
    ASSERT_FALSE(options);
    EXPECT_EQ(options.error().code, Errc::invalid_argument);
    EXPECT_THAT(options.error().message,
                AllOf(HasSubstr("generation"), HasSubstr("prot"), HasSubstr("stroke")));
}

}  // namespace
}  // namespace metier::edo_driver
