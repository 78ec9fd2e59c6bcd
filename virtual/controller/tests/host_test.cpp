#include "metier/virtual_controller/host.hpp"

#include <gmock/gmock.h>

#include <chrono>
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
    if (auto checked = request.settings.finish(); !checked) {
        return fail(checked.error());
    }
    return std::make_unique<Lamp>();
}

const std::vector<ControllerType> kTypes{{"lamp", "A lamp", startLamp}};

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

TEST(Host, TellsWhichTypesThereAre) {
    auto options = lampOptions();
    options.type = "robot";
    const auto host = Host::start(options, kTypes);
    ASSERT_FALSE(host);
    EXPECT_THAT(host.error().message, HasSubstr("there are: lamp"));
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
