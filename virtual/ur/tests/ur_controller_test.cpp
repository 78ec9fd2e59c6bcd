// The whole controller over real sockets, with clients that are written down here.

#include <gmock/gmock.h>

#include <asio/post.hpp>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "fake_peer.hpp"
#include "metier/link/tcp_link.hpp"
#include "metier/virtual_controller/controller.hpp"
#include "robot_fixture.hpp"

namespace metier::virtual_controller {
ControllerType urController();
}  // namespace metier::virtual_controller

namespace metier::virtual_ur {
namespace {

using namespace std::chrono_literals;
using link::TcpLink;
using testing::HasSubstr;
using testing::StartsWith;
using virtual_controller::Controller;

SteadyTime in(std::chrono::milliseconds time) {
    return std::chrono::steady_clock::now() + time;
}

/// A controller on a thread of its own, with free ports.
class Cell {
public:
    explicit Cell(const std::string& model_name = "ur5",
                  std::map<std::string, cell::Settings::Value> settings = {})
        : model_(modelOf(model_name)) {
        for (const auto* port :
             {"dashboard_port", "primary_port", "secondary_port", "realtime_port", "rtde_port",
              "primary_read_only_port", "secondary_read_only_port", "realtime_read_only_port"}) {
            settings.emplace(port, 0.0);
        }
        controller_ =
            virtual_controller::urController()
                .start({context_, "arm", "127.0.0.1", cell::Settings("test", std::move(settings)),
                        &model_, faults, world_})
                .value();
        thread_ = std::jthread([this](const std::stop_token& stop) {
            const std::stop_callback end(stop, [this] { context_.stop(); });
            context_.run();
        });
    }
    ~Cell() {
        thread_.request_stop();
        thread_.join();
    }

    template <typename Action>
    auto inTurn(Action action) {
        std::optional<decltype(action(*controller_))> result;
        std::atomic<bool> done{false};
        asio::post(context_, [&] {
            result = action(*controller_);
            done.store(true);
            done.notify_all();
        });
        done.wait(false);
        return *std::move(result);
    }
    Result<void> inject(const std::string& name, const std::string& value = "") {
        return inTurn([&](Controller& controller) { return controller.inject({name, value}); });
    }
    nlohmann::ordered_json state() {
        return inTurn([](Controller& controller) { return controller.state(); });
    }
    TcpLink connect(const std::string& port) {
        return TcpLink::connect("127.0.0.1", state()["ports"][port].get<std::uint16_t>(), in(5s))
            .value();
    }
    bool stateBecomes(const std::string& key, const std::string& value) {
        for (const auto deadline = in(10s); std::chrono::steady_clock::now() < deadline;) {
            if (state()[key] == value) {
                return true;
            }
            std::this_thread::yield();
        }
        return false;
    }

    virtual_controller::LinkFaults faults;

private:
    motion::RobotModel model_;
    HandMadeWorld world_;
    asio::io_context context_;
    std::unique_ptr<Controller> controller_;
    std::jthread thread_;
};

void send(TcpLink& link, std::string_view text) {
    ASSERT_TRUE(link.send(std::as_bytes(std::span(text)), in(5s)));
}

std::string readLine(TcpLink& link) {
    std::string line;
    std::array<std::byte, 1> one{};
    while (link.receiveAll(one, in(5s))) {
        if (one[0] == std::byte{'\n'}) {
            return line;
        }
        line += static_cast<char>(one[0]);
    }
    return line + " (no line end)";
}

std::string ask(TcpLink& link, const std::string& line) {
    send(link, line + "\n");
    return readLine(link);
}

/// A package with a 4 byte size in front; empty if none came.
Bytes readPackage(TcpLink& link) {
    Bytes package(4);
    if (!link.receiveAll(package, in(5s))) {
        return {};
    }
    ByteReader head(package);
    package.resize(head.get<std::uint32_t>());
    if (!link.receiveAll(std::span(package).subspan(4), in(5s))) {
        return {};
    }
    return package;
}

/// A client of port 30004, protocol version 2.
class RtdeClient {
public:
    explicit RtdeClient(TcpLink link) : link_(std::move(link)) {
        EXPECT_EQ(ask('V', bytes({0, 2})), bytes({1}));
    }

    Bytes ask(char type, const Bytes& payload = {}) {
        sendPackage(type, payload);
        while (true) {
            auto [answered, content] = read();
            if (answered == type || answered == 0) {
                return content;
            }
        }
    }
    void sendPackage(char type, const Bytes& payload) {
        ByteWriter package;
        package.put(static_cast<std::uint16_t>(payload.size() + 3))
            .put(static_cast<std::uint8_t>(type))
            .bytes(payload);
        ASSERT_TRUE(link_.send(package.content(), in(5s)));
    }
    std::pair<char, Bytes> read() {
        Bytes head(3);
        if (!link_.receiveAll(head, in(5s))) {
            return {};
        }
        ByteReader reader(head);
        Bytes payload(reader.get<std::uint16_t>() - 3U);
        if (!payload.empty() && !link_.receiveAll(payload, in(5s))) {
            return {};
        }
        return {static_cast<char>(head[2]), payload};
    }
    void setUpOutputs(double frequency, std::string_view names) {
        ByteWriter payload;
        payload.put(frequency).text(names);
        EXPECT_EQ(ask('O', payload.content()).at(0), std::byte{1});
        EXPECT_EQ(ask('S'), bytes({1}));
    }
    /// The next data package, after the recipe id.
    Bytes sample() {
        while (true) {
            auto [type, payload] = read();
            if (type == 'U' || type == 0) {
                return {payload.begin() + (payload.empty() ? 0 : 1), payload.end()};
            }
        }
    }

private:
    TcpLink link_;
};

TEST(UrController, TheDashboardGreetsAndLeadsToRunning) {
    Cell cell("ur5", {{"powered", false}, {"power_on_time", 0.1}, {"brake_release_time", 0.1}});
    auto link = cell.connect("dashboard");
    EXPECT_EQ(readLine(link), "Connected: Universal Robots Dashboard Server");
    EXPECT_EQ(ask(link, "robotmode"), "Robotmode: POWER_OFF");
    EXPECT_EQ(ask(link, "power on"), "Powering on");
    ASSERT_TRUE(cell.stateBecomes("robot_mode", "IDLE"));
    EXPECT_EQ(ask(link, "brake release"), "Brake releasing");
    ASSERT_TRUE(cell.stateBecomes("robot_mode", "RUNNING"));
    EXPECT_EQ(ask(link, "quit"), "Disconnected");
    std::array<std::byte, 1> one{};
    EXPECT_EQ(link.receive(one, in(5s)).error().code, Errc::connection_lost);
}

TEST(UrController, RtdePackagesLieOnAGridAndComeEvenly) {
    for (const auto& [model, rate] : {std::pair{"ur5", 125.0}, std::pair{"ur5e", 500.0}}) {
        Cell cell(model);
        RtdeClient client(cell.connect("rtde"));
        client.setUpOutputs(rate, "timestamp");
        std::optional<double> before;
        for (int i = 0; i < 50; ++i) {
            const auto sample = client.sample();
            const auto timestamp = ByteReader(sample).get<double>();
            EXPECT_GT(timestamp, 40.0);
            if (before) {
                EXPECT_NEAR(timestamp - *before, 1.0 / rate, 1e-6);
            }
            before = timestamp;
        }
    }
}

TEST(UrController, DigitalOutputsOfAClientShowInTheOutputs) {
    Cell cell;
    RtdeClient client(cell.connect("rtde"));
    EXPECT_EQ(client.ask('I', bytes({}, "standard_digital_output_mask,standard_digital_output")),
              bytes({1}, "UINT8,UINT8"));
    client.sendPackage('U', bytes({1, 0x81, 0x81}));
    client.setUpOutputs(125.0, "actual_digital_output_bits");
    std::uint64_t bits = 0;
    for (int i = 0; i < 100 && bits != 0x81; ++i) {
        const auto sample = client.sample();
        bits = ByteReader(sample).get<std::uint64_t>();
    }
    EXPECT_EQ(bits, 0x81U);
}

TEST(UrController, TheSpeedSliderIsToldOnceAndNotInTheScalingOfTheLimiter) {
    Cell cell;
    RtdeClient client(cell.connect("rtde"));
    EXPECT_EQ(client.ask('I', bytes({}, "speed_slider_mask,speed_slider_fraction")),
              bytes({1}, "UINT32,DOUBLE"));
    ByteWriter half;
    half.put(std::uint8_t{1}).put(std::uint32_t{1}).put(0.5);
    client.sendPackage('U', half.content());
    client.setUpOutputs(125.0, "speed_scaling,target_speed_fraction");
    double scaling = 0.0;
    double slider = 1.0;
    for (int i = 0; i < 100 && slider != 0.5; ++i) {
        const auto sample = client.sample();
        ByteReader reader(sample);
        scaling = reader.get<double>();
        slider = reader.get<double>();
    }
    EXPECT_EQ(slider, 0.5);
    EXPECT_EQ(scaling, 1.0);
    EXPECT_EQ(cell.state()["speed_slider"], 0.5);
}

TEST(UrController, AnInputIsFreeAgainWhenItsClientIsGone) {
    Cell cell;
    const auto names = bytes({}, "input_int_register_24");
    RtdeClient second(cell.connect("rtde"));
    {
        RtdeClient first(cell.connect("rtde"));
        EXPECT_EQ(first.ask('I', names), bytes({1}, "INT32"));
        EXPECT_EQ(second.ask('I', names), bytes({0}, "IN_USE"));
    }
    Bytes answer;
    for (const auto deadline = in(5s);
         answer != bytes({1}, "INT32") && std::chrono::steady_clock::now() < deadline;) {
        answer = second.ask('I', names);
    }
    EXPECT_EQ(answer, bytes({1}, "INT32"));
}

TEST(UrController, BrokenRtdePackagesCloseTheConnection) {
    Cell cell;
    auto link = cell.connect("rtde");
    ASSERT_TRUE(link.send(bytes({0, 1, 'V'}), in(5s)));
    std::array<std::byte, 8> some{};
    EXPECT_EQ(link.receive(some, in(5s)).error().code, Errc::connection_lost);
}

TEST(UrController, PrimaryAndSecondaryBeginWithTheVersionAndGoOnWithStates) {
    Cell cell;
    for (const auto* port : {"primary", "secondary", "primary_read_only", "secondary_read_only"}) {
        auto link = cell.connect(port);
        const auto version = readPackage(link);
        ASSERT_GT(version.size(), 15U) << port;
        EXPECT_EQ(version[4], std::byte{20});
        EXPECT_EQ(version[14], std::byte{3});
        std::optional<std::uint64_t> before;
        for (int i = 0; i < 4; ++i) {
            const auto state = readPackage(link);
            ASSERT_GT(state.size(), 18U) << port;
            EXPECT_EQ(state[4], std::byte{16});
            EXPECT_EQ(state[9], std::byte{0}) << "the first part, which has the time";
            const auto time = ByteReader(std::span(state).subspan(10)).get<std::uint64_t>();
            if (before) {
                EXPECT_NEAR(static_cast<double>(time - *before), 100'000.0, 8'000.0) << "[us]";
            }
            before = i > 0 ? std::optional(time) : std::nullopt;  // the first comes at once
        }
    }
}

TEST(UrController, TheRealTimePortSendsEachCycle) {
    Cell cell("ur5e");
    auto link = cell.connect("realtime_read_only");
    double before = 0.0;
    for (int i = 0; i < 20; ++i) {
        const auto package = readPackage(link);
        ASSERT_EQ(package.size(), 1220U);
        const auto time = ByteReader(std::span(package).subspan(4)).get<double>();
        if (before > 0.0) {
            EXPECT_NEAR(time - before, 0.002, 1e-9);
        }
        before = time;
    }
}

/// Waits for a message of the primary port of that kind that contains the text.
bool primaryTells(TcpLink& link, int kind, std::string_view text) {
    for (const auto deadline = in(5s); std::chrono::steady_clock::now() < deadline;) {
        const auto package = readPackage(link);
        if (package.empty()) {
            return false;
        }
        const std::string_view all(reinterpret_cast<const char*>(package.data()), package.size());
        if (package[4] == std::byte{20} && package.size() > 14 &&
            package[14] == static_cast<std::byte>(kind) && all.find(text) != all.npos) {
            return true;
        }
    }
    return false;
}

constexpr std::string_view kFollow =
    "def follow():\n"
    "  while read_input_integer_register(0) == 1:\n"
    "    q = [0,0,0,0,0,0]\n"
    "    i = 0\n"
    "    while i < 6:\n"
    "      q[i] = read_input_float_register(i)\n"
    "      i = i + 1\n"
    "    end\n"
    "    servoj(q, 0, 0, 0.008, 0.03, 2000)\n"
    "  end\n"
    "end\n";

/// Streams positions through registers 0 to 5, with the switch in integer register 0.
class Streamer {
public:
    explicit Streamer(Cell& cell) : client_(cell.connect("rtde")) {
        EXPECT_EQ(client_.ask('I', bytes({}, "input_int_register_0")), bytes({1}, "INT32"));
        std::string names;
        for (int i = 0; i < 6; ++i) {
            names += (i > 0 ? "," : "") + ("input_double_register_" + std::to_string(i));
        }
        EXPECT_EQ(client_.ask('I', bytes({}, names)).at(0), std::byte{2});
        client_.setUpOutputs(125.0, "target_q,runtime_state,safety_mode");
    }
    struct Sample {
        Vector6 q{};
        std::uint32_t runtime = 0;
        std::int32_t safety = 0;
    };
    Sample next() {
        const auto payload = client_.sample();
        ByteReader reader(payload);
        Sample sample;
        for (auto& value : sample.q) {
            value = reader.get<double>();
        }
        sample.runtime = reader.get<std::uint32_t>();
        sample.safety = reader.get<std::int32_t>();
        EXPECT_TRUE(reader.complete());
        return sample;
    }
    template <typename Condition>
    bool until(Condition condition) {
        for (int i = 0; i < 1000; ++i) {
            if (condition(next())) {
                return true;
            }
        }
        return false;
    }
    void write(std::int32_t run) {
        ByteWriter payload;
        payload.put(std::uint8_t{1}).put(run);
        client_.sendPackage('U', payload.content());
    }
    void write(const Vector6& q) {
        ByteWriter payload;
        payload.put(std::uint8_t{2}).putAll(q);
        client_.sendPackage('U', payload.content());
    }

private:
    RtdeClient client_;
};

TEST(UrController, AScriptUploadedOnTheSecondaryPortFollowsAStreamOfRegisters) {
    Cell cell;
    Streamer streamer(cell);
    auto primary = cell.connect("primary");
    auto secondary = cell.connect("secondary");
    const auto start = streamer.next().q;
    streamer.write(start);
    streamer.write(1);
    send(secondary, kFollow);
    EXPECT_TRUE(primaryTells(primary, 7, "PROGRAM_XXX_STARTEDfollow"));
    ASSERT_TRUE(streamer.until([](const auto& sample) { return sample.runtime == 2; }));
    Vector6 q = start;
    // Slow, and never far ahead: a test that was held up must not make the arm leap afterwards.
    constexpr double kAmplitude = 0.02;
    constexpr double kMostAhead = 0.005;
    const auto near = [&](const auto& sample) {
        return sample.safety != 1 || std::abs(sample.q[5] - q[5]) < kMostAhead;
    };
    for (int i = 1; i <= 125; ++i) {
        Streamer::Sample sample;
        ASSERT_TRUE(streamer.until([&](const auto& next) { return near(sample = next); }));
        ASSERT_EQ(sample.safety, 1);
        q[5] = start[5] + kAmplitude * (1.0 - std::cos(i * 0.008 * M_PI));
        streamer.write(q);
    }
    EXPECT_TRUE(
        streamer.until([&](const auto& sample) { return std::abs(sample.q[5] - q[5]) < 1e-6; }));
    streamer.write(0);
    EXPECT_TRUE(streamer.until([](const auto& sample) { return sample.runtime == 1; }));
    EXPECT_TRUE(primaryTells(primary, 7, "PROGRAM_XXX_STOPPEDfollow"));
}

TEST(UrController, AViolationIsAProtectiveStopUntilItIsUnlocked) {
    Cell cell("ur5", {{"unlock_delay", 0.3}});
    Streamer streamer(cell);
    auto primary = cell.connect("primary");
    auto secondary = cell.connect("secondary");
    auto dashboard = cell.connect("dashboard");
    readLine(dashboard);
    auto q = streamer.next().q;
    streamer.write(q);
    streamer.write(1);
    send(secondary, kFollow);
    ASSERT_TRUE(streamer.until([](const auto& sample) { return sample.runtime == 2; }));
    q[0] += 2.0;
    streamer.write(q);
    ASSERT_TRUE(streamer.until([](const auto& sample) { return sample.safety == 3; }));
    EXPECT_TRUE(primaryTells(primary, 6, "axis 1"));
    EXPECT_EQ(ask(dashboard, "safetymode"), "Safetymode: PROTECTIVE_STOP");
    ASSERT_TRUE(streamer.until([](const auto& sample) { return sample.runtime == 4; }));
    std::string answer;
    for (const auto deadline = in(5s);
         answer != "Protective stop releasing" && std::chrono::steady_clock::now() < deadline;) {
        answer = ask(dashboard, "unlock protective stop");
    }
    EXPECT_EQ(answer, "Protective stop releasing");
    EXPECT_TRUE(streamer.until([](const auto& sample) { return sample.safety == 1; }));
    EXPECT_EQ(ask(dashboard, "stop"), "Stopped");
    EXPECT_TRUE(streamer.until([](const auto& sample) { return sample.runtime == 1; }));
}

TEST(UrController, AProgramDialsBackToItsClient) {
    Cell cell;
    auto listener = link::TcpListener::listen("127.0.0.1", 0).value();
    auto secondary = cell.connect("secondary");
    send(secondary, "def dial():\n  socket_open(\"127.0.0.1\", " + std::to_string(listener.port()) +
                        ", \"back\")\n"
                        "  r = socket_read_binary_integer(2, \"back\", 5)\n"
                        "  socket_send_int(r[1] + r[2], \"back\")\n"
                        "  sleep(1)\nend\n");
    auto peer = listener.accept(in(5s));
    ASSERT_TRUE(peer) << peer.error().message;
    ASSERT_TRUE(peer->send(bytes({0, 0, 0, 40, 0, 0, 0, 2}), in(5s)));
    Bytes answer(4);
    ASSERT_TRUE(peer->receiveAll(answer, in(5s)));
    EXPECT_EQ(answer, bytes({0, 0, 0, 42}));
    // It hangs up when the program ends.
    std::array<std::byte, 1> one{};
    EXPECT_EQ(peer->receive(one, in(5s)).error().code, Errc::connection_lost);
}

TEST(UrController, AReadOnlyPortTakesNoScript) {
    Cell cell;
    auto primary = cell.connect("primary");
    auto read_only = cell.connect("secondary_read_only");
    auto secondary = cell.connect("secondary");
    send(read_only, "def no():\n  textmsg(\"no\")\nend\n");
    readPackage(read_only);
    send(secondary, "def yes():\n  textmsg(\"yes\")\nend\n");
    EXPECT_TRUE(primaryTells(primary, 7, "PROGRAM_XXX_STARTEDyes"));
}

TEST(UrController, InjectionsDoWhatTheySay) {
    Cell cell("ur5e", {{"power_on_time", 0.05}, {"brake_release_time", 0.05}});
    auto dashboard = cell.connect("dashboard");
    readLine(dashboard);
    ASSERT_TRUE(cell.inject("protective-stop"));
    EXPECT_TRUE(cell.stateBecomes("safety_mode", "PROTECTIVE_STOP"));
    ASSERT_TRUE(cell.inject("emergency-stop"));
    EXPECT_TRUE(cell.stateBecomes("robot_mode", "POWER_OFF"));
    EXPECT_TRUE(cell.stateBecomes("safety_mode", "ROBOT_EMERGENCY_STOP"));
    ASSERT_TRUE(cell.inject("release-emergency-stop"));
    EXPECT_EQ(ask(dashboard, "brake release"), "Brake releasing");
    EXPECT_TRUE(cell.stateBecomes("robot_mode", "RUNNING"));
    ASSERT_TRUE(cell.inject("local-control"));
    EXPECT_EQ(ask(dashboard, "is in remote control"), "false");
    EXPECT_THAT(ask(dashboard, "play"), HasSubstr("not allowed"));
    ASSERT_TRUE(cell.inject("remote-control"));
    EXPECT_EQ(ask(dashboard, "is in remote control"), "true");
    ASSERT_TRUE(cell.inject("limit", "4"));
    EXPECT_TRUE(cell.stateBecomes("safety_mode", "PROTECTIVE_STOP"));
    EXPECT_EQ(cell.inject("limit", "7").error().code, Errc::invalid_argument);
    EXPECT_EQ(cell.inject("limit", "x").error().code, Errc::invalid_argument);
    EXPECT_EQ(cell.inject("fire").error().code, Errc::not_found);
    for (const auto& help : cell.inTurn([](Controller& c) { return c.injections(); })) {
        EXPECT_TRUE(cell.inject(help.name)) << help.name;
    }
}

TEST(UrController, RecoveryModeEndsTheProgramUntilSomebodyMovesTheArmBack) {
    Cell cell;
    auto secondary = cell.connect("secondary");
    send(secondary, "def p():\n  sleep(100)\nend\n");
    ASSERT_TRUE(cell.stateBecomes("runtime_state", "playing"));
    ASSERT_TRUE(cell.inject("recovery-mode"));
    EXPECT_TRUE(cell.stateBecomes("safety_mode", "RECOVERY"));
    EXPECT_TRUE(cell.stateBecomes("runtime_state", "stopped"));
    EXPECT_TRUE(cell.stateBecomes("robot_mode", "RUNNING"));
    ASSERT_TRUE(cell.inject("end-recovery"));
    EXPECT_TRUE(cell.stateBecomes("safety_mode", "NORMAL"));
}

TEST(UrController, AProgramIsStoppedAtThePanel) {
    Cell cell;
    auto secondary = cell.connect("secondary");
    send(secondary, "def p():\n  while True:\n    sync()\n  end\nend\n");
    ASSERT_TRUE(cell.stateBecomes("runtime_state", "playing"));
    ASSERT_TRUE(cell.inject("program-stop"));
    EXPECT_TRUE(cell.stateBecomes("runtime_state", "stopped"));
}

TEST(UrController, ARestartBreaksEveryConnectionAndServesAgain) {
    Cell cell;
    auto rtde = cell.connect("rtde");
    auto dashboard = cell.connect("dashboard");
    readLine(dashboard);
    cell.inTurn([](Controller& controller) {
        controller.restart();
        return true;
    });
    std::array<std::byte, 1> one{};
    EXPECT_EQ(rtde.receive(one, in(5s)).error().code, Errc::connection_lost);
    EXPECT_EQ(dashboard.receive(one, in(5s)).error().code, Errc::connection_lost);
    RtdeClient again(cell.connect("rtde"));
    again.setUpOutputs(125.0, "robot_mode");
    const auto sample = again.sample();
    EXPECT_EQ(ByteReader(sample).get<std::int32_t>(), 7);
}

TEST(UrController, ALineWithoutEndClosesTheDashboard) {
    Cell cell;
    auto dashboard = cell.connect("dashboard");
    readLine(dashboard);
    send(dashboard, std::string(5000, 'x'));
    std::array<std::byte, 1> one{};
    EXPECT_EQ(dashboard.receive(one, in(5s)).error().code, Errc::connection_lost);
}

}  // namespace
}  // namespace metier::virtual_ur
