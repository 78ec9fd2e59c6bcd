#include <gmock/gmock.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "metier/virtual_controller/host.hpp"
#include "metier/virtual_controller/remote_world.hpp"

namespace metier::virtual_controller {

ControllerType worldController();

namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

HostOptions worldOptions() {
    HostOptions options;
    options.name = "world";
    options.type = "world";
    options.address = "127.0.0.1";
    options.control_port = 0;
    options.settings.set("port", 0.0);
    options.settings.set("table", 0.0);
    options.settings.set("part.cube", std::vector<double>{0, 0, 0.015, 0.03, 0.03, 0.03, 0.1});
    options.settings.set("on.gripper", std::string("arm"));
    return options;
}

TEST(WorldServer, AnswersAReportWithItsEffect) {
    const auto host = Host::start(worldOptions(), {worldController()}).value();
    const auto port = host->controller().state().at("port").get<std::uint16_t>();
    RemoteWorld arm(host->context(), "arm", "127.0.0.1", port);
    RemoteWorld gripper(host->context(), "gripper", "127.0.0.1", port);
    const auto deadline = std::chrono::steady_clock::now() + 10s;
    while (!gripper.effect().part_width && std::chrono::steady_clock::now() < deadline) {
        arm.report(
            {.base_from_flange = motion::Pose{{0, 0, 0.015}, Eigen::Quaterniond::Identity()}});
        gripper.report({.jaw_width = 0.05});
        host->context().run_one_for(100ms);
    }
    EXPECT_NEAR(gripper.effect().part_width.value_or(0), 0.03, 1e-12);
}

// A busy machine makes a controller late; it catches up with many cycles at once.
TEST(WorldServer, TakesAnArmsSpeedFromItsOwnTimeHoweverQuicklyItsReportsCome) {
    auto options = worldOptions();
    options.settings.set("wall.front", std::vector<double>{0.6, 0, 0, -1, 0, 0, 5'000, 50});
    const auto host = Host::start(options, {worldController()}).value();
    const auto port = host->controller().state().at("port").get<std::uint16_t>();
    RemoteWorld arm(host->context(), "arm", "127.0.0.1", port);
    const double speed = 0.05;
    const double depth = 0.01;
    double most = 0.0;
    const auto deadline = std::chrono::steady_clock::now() + 10s;
    for (double time = 0.0; most < 5'000 * 0.9 * depth; time += 0.001) {
        ASSERT_LT(std::chrono::steady_clock::now(), deadline);
        const double x = std::min(speed * time, depth);
        arm.report(
            {.time = time,
             .base_from_flange = motion::Pose{{0.6 + x, 0, 0.5}, Eigen::Quaterniond::Identity()}});
        host->context().run_one_for(100ms);
        const double force = arm.effect().wrench.force.norm();
        EXPECT_LE(force, 5'000 * x + 50 * speed + 1e-6) << x << " m behind the wall";
        most = std::max(most, force);
    }
}

TEST(WorldServer, TellsWhatIsWrongWithItsSettings) {
    auto options = worldOptions();
    options.settings.set("part.flat", std::vector<double>{0, 0, 0, 0.1, 0.1, 0.0, 0.1});
    options.settings.set("wall.short", std::vector<double>{0, 0, 0});
    const auto host = Host::start(options, {worldController()});
    ASSERT_FALSE(host);
    EXPECT_THAT(host.error().message, HasSubstr("part.flat: lengths must be over 0 m"));
    EXPECT_THAT(host.error().message, HasSubstr("wall.short: has 3 numbers; needs 8"));
}

TEST(WorldServer, PlacesPartsOnDemand) {
    const auto host = Host::start(worldOptions(), {worldController()}).value();
    EXPECT_EQ(host->controlAnswer(R"({"inject":"place","value":"cube,0.1,0.2,0.3"})").dump(),
              R"({"ok":true})");
    EXPECT_THAT(host->controlAnswer(R"({"state":true})").dump(), HasSubstr("[0.1,0.2,0.3"));
    EXPECT_THAT(host->controlAnswer(R"({"inject":"place","value":"cube"})").dump(),
                HasSubstr("NAME,X,Y,Z"));
}

TEST(WorldServer, RefusesPlacesThatAreNone) {
    const auto host = Host::start(worldOptions(), {worldController()}).value();
    for (const char* value : {"cube,nan,0,0", "cube,0,inf,0", "cube,1,2,3 m", "cube,1,2,3,4",
                              "cube,1,2", ",1,2,3", ""}) {
        const nlohmann::json request{{"inject", "place"}, {"value", value}};
        EXPECT_THAT(host->controlAnswer(request.dump()).dump(), HasSubstr("\"error\":")) << value;
    }
    EXPECT_THAT(host->controlAnswer(R"({"state":true})").dump(), HasSubstr("[0.0,0.0,0.015"));
}

TEST(WorldServer, ReportsEverySettingThatIsWrongAtOnce) {
    auto options = worldOptions();
    options.settings.set("part.heavy", std::vector<double>{0, 0, 0, 0.1, 0.1, 0.1, -1});
    options.settings.set("wall.soft", std::vector<double>{0, 0, 0, 0, 0, 1, 0, 50});
    options.settings.set("wall.nowhere", std::vector<double>{0, 0, 0, 0, 0, 0, 100, 50});
    options.settings.set("part_tolerance", 1.0);
    options.settings.set("gravity", 9.81);
    const auto host = Host::start(options, {worldController()});
    ASSERT_FALSE(host);
    for (const char* name :
         {"part.heavy: ", "wall.soft: ", "wall.nowhere: ", "part_tolerance: ", "gravity"}) {
        EXPECT_THAT(host.error().message, HasSubstr(name));
    }
}

}  // namespace
}  // namespace metier::virtual_controller
