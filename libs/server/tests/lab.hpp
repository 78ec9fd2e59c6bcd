#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "fake_devices.hpp"
#include "metier/client/skill_handle.hpp"
#include "metier/opcua/client.hpp"
#include "metier/server/server.hpp"

namespace metier::server::testing {

/// An empty folder for one test.
inline std::filesystem::path freshFolder() {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    auto folder = std::filesystem::path(::testing::TempDir()) / "metier_server" /
                  (std::string(test->test_suite_name()) + "_" + test->name() + "_" +
                   std::to_string(getpid()));
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
    return folder;
}

inline SteadyTime inAMinute() {
    return std::chrono::steady_clock::now() + std::chrono::minutes(1);
}

/// Servers of a cell in this process, without security, with simulated arms and fake grippers and
/// sensors for devices.
class Lab : public ::testing::Test {
protected:
    ~Lab() override { std::filesystem::remove_all(folder_); }

    Context context() const { return {identity_, drivers_, stop_}; }

    /// A server on a free port.
    template <typename Kind>
    static cell::ServerConfig config(const std::string& name, Kind kind) {
        cell::ServerConfig config;
        config.name = name;
        config.address = "127.0.0.1";
        config.stall_limit = 30.0;  // other tests may have the processors
        config.kind = std::move(kind);
        return config;
    }
    /// An iiwa of the simulator, with the instances and skills of its NodeSet.
    static cell::ArmServer iiwa() {
        cell::ArmServer arm;
        arm.model = METIER_MODELS_DIR "/iiwa7.toml";
        arm.driver.type = "simulator";
        arm.nodeset = "iiwa";
        arm.skills = {"CartesianPtpMoveSkill", "CartesianLinearMoveSkill", "JointPtpMoveSkill",
                      "JointLinearMoveSkill"};
        return arm;
    }
    /// A UR5 of the simulator that follows a stream, without a NodeSet.
    static cell::ArmServer streamedUr() {
        cell::ArmServer arm;
        arm.model = METIER_MODELS_DIR "/ur5.toml";
        arm.driver.type = "simulator";
        arm.skills = {"PositionStreamSkill"};
        arm.stream_silence = 10.0;  // likewise
        return arm;
    }

    std::unique_ptr<Server> serve(const cell::ServerConfig& config) const {
        auto server = start(config, context());
        EXPECT_TRUE(server) << server.error().message;
        return server ? std::move(*server) : nullptr;
    }
    /// Why a server does not start.
    Error refusal(const cell::ServerConfig& config) const {
        const auto server = start(config, context());
        EXPECT_FALSE(server) << "it starts";
        return server ? Error{} : server.error();
    }

    static std::unique_ptr<opcua::Client> connect(const Server& server) {
        opcua::ClientOptions options;
        options.connect_timeout = std::chrono::minutes(1);
        options.call_timeout = std::chrono::minutes(1);
        auto client = opcua::Client::connect(server.url(), options);
        EXPECT_TRUE(client) << client.error().message;
        return client ? std::move(*client) : nullptr;
    }
    /// Names of the skills of a server.
    static std::vector<std::string> skillsOf(opcua::Client& client) {
        const auto skills = client::findSkills(client).value();
        std::vector<std::string> names;
        for (const auto& skill : skills) {
            names.push_back(skill.name);
        }
        return names;
    }
    static client::SkillHandle open(opcua::Client& client, const std::string& name) {
        auto address = client::findSkill(client, name);
        EXPECT_TRUE(address) << address.error().message;
        return client::SkillHandle::open(client, std::move(*address)).value();
    }
    /// A file in the folder of this test.
    std::filesystem::path write(const std::string& name, const std::string& text) const {
        std::ofstream(folder_ / name) << text;
        return folder_ / name;
    }

    const std::filesystem::path folder_ = freshFolder();
    const Identity identity_ =
        Identity::create({.insecure_lab = true, .folder = folder_ / "security"}, "lab", {}).value();
    const std::vector<device::Driver> drivers_ = fakeDrivers();
    const link::StopSignal stop_;
};

}  // namespace metier::server::testing
