#include "metier/virtual_controller/host.hpp"

#include <gmock/gmock.h>

#include <array>
#include <asio/post.hpp>
#include <chrono>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <thread>

#include "metier/link/tcp_link.hpp"

namespace metier::virtual_controller {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

/// A lamp: can break, and shows whether it did.
class Lamp final : public Controller {
public:
    std::vector<InjectionHelp> injections() const override {
        return {{"break", "The lamp goes out"}};
    }
    Result<void> inject(const Injection& injection) override {
        broken_ = injection.name == "break";
        return {};
    }
    nlohmann::ordered_json state() const override { return {{"broken", broken_}}; }
    void restart() override { broken_ = false; }

private:
    bool broken_ = false;
};

Result<std::unique_ptr<Controller>> startLamp(const ControllerRequest& request) {
    METIER_TRY(request.settings.finish());
    return std::make_unique<Lamp>();
}

/// A thing with a port, which it shows.
class Socket final : public Controller {
public:
    explicit Socket(std::unique_ptr<TcpServer> port) : port_(std::move(port)) {}
    std::vector<InjectionHelp> injections() const override { return {}; }
    Result<void> inject(const Injection&) override { return {}; }
    nlohmann::ordered_json state() const override { return {{"port", port_->port()}}; }
    void restart() override {}

private:
    std::unique_ptr<TcpServer> port_;
};

Result<std::unique_ptr<Controller>> startSocket(const ControllerRequest& request) {
    return TcpServer::listen(request.context, {request.address, 0}, request.faults, {})
        .transform([](auto port) -> std::unique_ptr<Controller> {
            return std::make_unique<Socket>(std::move(port));
        });
}

const std::vector<ControllerType> kTypes{{"lamp", "A lamp", startLamp},
                                         {"socket", "A thing with a port", startSocket}};

HostOptions lampOptions() {
    HostOptions options;
    options.name = "lamp-1";
    options.type = "lamp";
    options.address = "127.0.0.1";
    options.control_port = 0;
    return options;
}

struct HostOfALamp : ::testing::Test {
    std::unique_ptr<Host> host = Host::start(lampOptions(), kTypes).value();
};

TEST_F(HostOfALamp, InjectsAndShows) {
    EXPECT_EQ(host->controlAnswer(R"({"state":true})").dump(), R"({"broken":false})");
    EXPECT_EQ(host->controlAnswer(R"({"inject":"break"})").dump(), R"({"ok":true})");
    EXPECT_EQ(host->controlAnswer(R"({"state":true})").dump(), R"({"broken":true})");
    EXPECT_EQ(host->controlAnswer(R"({"inject":"restart"})").dump(), R"({"ok":true})");
    EXPECT_EQ(host->controlAnswer(R"({"state":true})").dump(), R"({"broken":false})");
}

TEST_F(HostOfALamp, TellsWhatCanBeInjected) {
    const auto help = host->controlAnswer(R"({"help":true})");
    EXPECT_TRUE(help.contains("break"));
    EXPECT_TRUE(help.contains("cut-link"));
}

TEST_F(HostOfALamp, TellsWhatIsWrongWithARequest) {
    const auto unknown = host->controlAnswer(R"({"inject":"explode"})").dump();
    EXPECT_THAT(unknown, HasSubstr("explode"));
    EXPECT_THAT(unknown, HasSubstr("break"));
    EXPECT_THAT(host->controlAnswer(R"({"inject":"delay","value":"soon"})").dump(),
                HasSubstr("0 to 10000"));
    EXPECT_THAT(host->controlAnswer("no json").dump(), HasSubstr("error"));
}

TEST_F(HostOfALamp, TakesFaultsOfTheCableUpToTheirLimits) {
    const auto inject = [this](const std::string& name, const std::string& value) {
        return host->controlAnswer(nlohmann::json{{"inject", name}, {"value", value}}.dump())
            .dump();
    };
    EXPECT_EQ(inject("delay", "10000"), R"({"ok":true})");
    EXPECT_EQ(inject("garble", "1000"), R"({"ok":true})");
    for (const auto* value : {"10001", "-1", "", "1.5", "99999999999999999999"}) {
        EXPECT_THAT(inject("delay", value), HasSubstr("0 to 10000")) << value;
    }
    EXPECT_THAT(inject("garble", "1001"), HasSubstr("0 to 1000"));
    EXPECT_THAT(host->controlAnswer(R"({"inject":"delay","value":5})").dump(),
                HasSubstr("0 to 10000"))
        << "a number is no text";
}

TEST_F(HostOfALamp, AnswersOnItsControlPort) {
    std::jthread thread([this] { host->run(); });
    const auto deadline = std::chrono::steady_clock::now() + 5s;
    auto link = link::TcpLink::connect("127.0.0.1", host->controlPort(), deadline).value();
    const std::string_view request = "{\"inject\":\"break\"}\n{\"state\":true}\n";
    ASSERT_TRUE(link.send(std::as_bytes(std::span(request)), deadline));
    const std::string_view expected = "{\"ok\":true}\n{\"broken\":true}\n";
    std::string answer(expected.size(), '\0');
    ASSERT_TRUE(link.receiveAll(std::as_writable_bytes(std::span(answer)), deadline));
    EXPECT_EQ(answer, expected);
    host->stop();
}

/// A host whose port a client is connected to.
struct HostInCompany : ::testing::Test {
    HostInCompany() {
        auto options = lampOptions();
        options.type = "socket";
        host = Host::start(options, kTypes).value();
        const std::uint16_t port = host->controller().state().at("port");
        client = link::TcpLink::connect("127.0.0.1", port, soon()).value();
    }
    static SteadyTime soon() { return std::chrono::steady_clock::now() + 5s; }
    /// Answer of its control port; by then its thread has done what it was given before.
    std::string ask() const {
        auto link = link::TcpLink::connect("127.0.0.1", host->controlPort(), soon()).value();
        const std::string_view request = "{\"help\":true}\n";
        if (!link.send(std::as_bytes(std::span(request)), soon())) {
            return "";
        }
        std::array<char, 4096> answer{};
        const auto count = link.receive(std::as_writable_bytes(std::span(answer)), soon());
        return {answer.data(), count.value_or(0)};
    }

    std::unique_ptr<Host> host;
    std::optional<link::TcpLink> client;
};

TEST_F(HostInCompany, EndsOnceItsClientsHaveGone) {
    std::jthread thread([this] { host->run(); });
    ASSERT_THAT(ask(), HasSubstr("cut-link")) << "the client is taken before";
    host->stopOnceAlone(60s);
    EXPECT_THAT(ask(), HasSubstr("cut-link"));
    client.reset();
    const auto begun = std::chrono::steady_clock::now();
    thread.join();
    EXPECT_LT(std::chrono::steady_clock::now() - begun, 30s);
}

TEST_F(HostInCompany, AnswersOnItsControlPortWhileTheCableIsCut) {
    std::jthread thread([this] { host->run(); });
    asio::post(host->context(), [this] { host->controlAnswer(R"({"inject":"cut-link"})"); });
    EXPECT_THAT(ask(), HasSubstr("cut-link"));
    host->stop();
}

TEST_F(HostInCompany, EndsInTimeAlthoughAClientStays) {
    std::jthread thread([this] { host->run(); });
    ASSERT_THAT(ask(), HasSubstr("cut-link"));
    host->stopOnceAlone(20ms);
    thread.join();
}

TEST(Host, TellsWhichTypesThereAre) {
    auto options = lampOptions();
    options.type = "robot";
    const auto host = Host::start(options, kTypes);
    ASSERT_FALSE(host);
    EXPECT_THAT(host.error().message, HasSubstr("there are: lamp, socket"));
}

TEST(Host, RefusesAWorldWithoutAnAddress) {
    auto options = lampOptions();
    options.world_address = "over there";
    const auto host = Host::start(options, kTypes);
    ASSERT_FALSE(host);
    EXPECT_THAT(host.error().message, HasSubstr("\"over there\" is not an address"));
}

TEST(Host, PassesOnWhatIsWrongWithTheSettings) {
    auto options = lampOptions();
    options.settings.set("colour", 3.0);
    const auto host = Host::start(options, kTypes);
    ASSERT_FALSE(host);
    EXPECT_THAT(host.error().message, HasSubstr("colour: unknown"));
}

}  // namespace
}  // namespace metier::virtual_controller
