// `metier dashboard` of a cell in which servers use one another, or have devices on their wires.
#include <gmock/gmock.h>

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

#include "../metier_program.hpp"
#include "../running_cell.hpp"
#include "tab.hpp"

namespace metier::system_tests {
namespace {

using nlohmann::json;

/// The page of a running cell, and a tab that shows it.
class CellPage {
public:
    explicit CellPage(const std::filesystem::path& file)
        : cell_(file),
          page_(metierCommand({"dashboard", "--port", "0", "--records", "off", "--cell",
                               file.string(), "--endpoints", cell_.endpoints().string()})),
          tab_(page_.url()) {
        awaitAll();
    }

    Tab& tab() { return tab_; }
    json shown() { return tab_.ask("/api/cell").body; }
    RunningCell& cell() { return cell_; }
    /// A skill as the page has it. Throws if there is none.
    json skill(const std::string& server, const std::string& name) {
        const auto offered = this->server(server);
        for (const auto& one : offered.at("skills")) {
            if (one.at("name") == name) {
                return one;
            }
        }
        throw std::runtime_error(server + " has no " + name);
    }
    json server(const std::string& name) {
        const auto all = shown();
        for (const auto& one : all.at("servers")) {
            if (one.at("name") == name) {
                return one;
            }
        }
        throw std::runtime_error("no server " + name);
    }

private:
    void awaitAll() {
        for (const auto& [name, url] : cell_.urls()) {
            while (server(name).at("connected") != true) {
                tab_.await("server",
                           [&, name = name](const json& s) { return s.at("key") == name; });
            }
        }
    }

    RunningCell cell_;
    ServerProcess page_;
    Tab tab_;
};

std::vector<std::string> namesIn(const json& list, const char* key) {
    std::vector<std::string> names;
    for (const auto& one : list) {
        names.push_back(key == nullptr ? one.get<std::string>() : one.at(key).get<std::string>());
    }
    return names;
}

TEST(CellPageTest, TakingAllLeavesServersToTheComponentsThatMoveThem) {
    CellPage page(simulatedCell());
    auto& tab = page.tab();
    const auto taken = tab.tell("/api/control", {{"server", "all"}, {"action", "take"}});
    ASSERT_EQ(taken.status, 200) << taken.error();
    EXPECT_EQ(taken.body.at("failed"), json::array()) << taken.body;
    EXPECT_THAT(namesIn(taken.body.at("taken"), nullptr),
                ::testing::ElementsAre("ur5-move", "iiwa", "edo-move"));
    EXPECT_EQ(taken.body.at("left_out"),
              json::array({{{"server", "ur5"}, {"used_by", "ur5-move"}},
                           {{"server", "edo"}, {"used_by", "edo-move"}}}));
    EXPECT_EQ(page.server("edo-move").at("uses"), json::array({"edo"}));

    const auto key = page.skill("edo-move", "JointPtpMoveSkill").at("key").get<std::string>();
    const auto started = tab.tell(
        "/api/skills/start",
        {{"key", key}, {"parameters", {{"TargetJointPosition", {0.3, 0.1, 0.9, 0.1, 0.1, 0.1}}}}});
    ASSERT_EQ(started.status, 200) << started.error();
    EXPECT_EQ(tab.awaitState(key, "Running").at("reason_text"), "");
    EXPECT_EQ(tab.awaitState(key, "Ready").at("reason_text"), "");

    const auto one = tab.tell("/api/control", {{"server", "edo"}, {"action", "take"}});
    EXPECT_EQ(one.body.at("taken"), json::array({"edo"})) << "by name it is taken all the same";
}

/// Waits for a change of one live value, under `group` and `key`, that is wanted.
json awaitLive(Tab& tab, const char* group, const char* key, const char* name,
               const std::function<bool(const json&)>& wanted) {
    const auto path = json::json_pointer(fmt::format("/{}/{}/{}", group, key, name));
    return tab
        .await("live",
               [&](const json& live) { return live.contains(path) && wanted(live.at(path)); })
        .at(path);
}

TEST(CellPageTest, ShowsWhatASensorAndTheCyclesOfAnArmTell) {
    CellPage page(deviceCell("sensor"));
    auto& tab = page.tab();
    ASSERT_EQ(tab.tell("/api/control", {{"server", "all"}, {"action", "take"}}).status, 200);
    const auto key = page.skill("arm", "CartesianLinearMoveSkill").at("key").get<std::string>();
    const auto started =
        tab.tell("/api/skills/start",
                 {{"key", key},
                  {"parameters", {{"TargetPosition", {0, 0, 0.05, 0, 0, 0}}, {"Relative", 1}}}});
    ASSERT_EQ(started.status, 200) << started.error();
    const auto isArm = [](const json& joints) { return joints.size() == 6; };
    const auto first = awaitLive(tab, "arms", "arm", "c", isArm);
    awaitLive(tab, "arms", "arm", "c", [&](const json& joints) { return joints != first; });
    const auto jitter = awaitLive(tab, "arms", "arm", "jitter", [](const json&) { return true; });
    EXPECT_GE(jitter.get<double>(), 0.0);
    tab.awaitState(key, "Ready");
    page.cell().inject("netft", "wrench", "0 0 -12 0 0 0");
    awaitLive(tab, "arms", "arm", "f",
              [](const json& wrench) { return wrench.at(2).get<double>() < -11.0; });
}

/// A gripper finds its zero first; Reset is refused until it has.
void resetOnceHome(Tab& tab, const std::string& key) {
    constexpr int kTimeout = 504;
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    auto reset = tab.tell("/api/skills/reset", {{"key", key}});
    while (reset.status == kTimeout && std::chrono::steady_clock::now() < end) {
        reset = tab.tell("/api/skills/reset", {{"key", key}});
    }
    ASSERT_EQ(reset.status, 200) << reset.error();
}

TEST(CellPageTest, ShowsHowWideAGripperIsOpen) {
    CellPage page(deviceCell("wsg50"));
    auto& tab = page.tab();
    ASSERT_EQ(tab.tell("/api/control", {{"server", "all"}, {"action", "take"}}).status, 200);
    const auto key = page.skill("gripper", "MoveGripperSkill").at("key").get<std::string>();
    resetOnceHome(tab, key);
    tab.awaitState(key, "Ready");
    constexpr double kWidth = 0.03;
    const auto started =
        tab.tell("/api/skills/start", {{"key", key}, {"parameters", {{"Width", kWidth}}}});
    ASSERT_EQ(started.status, 200) << started.error();
    awaitLive(tab, "grippers", "gripper", "width",
              [](const json& told) { return std::abs(told.get<double>() - kWidth) < 0.001; });
}

}  // namespace
}  // namespace metier::system_tests
