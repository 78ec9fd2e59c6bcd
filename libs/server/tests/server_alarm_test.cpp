#include "host/server_alarm.hpp"

#include <gmock/gmock.h>

#include "lab.hpp"
#include "metier/base/queue.hpp"
#include "metier/opcua_skill/server_executor.hpp"

namespace metier::server::testing {
namespace {

struct Seen {
    std::uint16_t severity = 0;
    std::string source;
    std::string message;
};

class AlarmOfAServer : public ::testing::Test {
protected:
    AlarmOfAServer() {
        opcua::ServerOptions options;
        options.port = 0;
        server_ = opcua::Server::create(std::move(options)).value();
        EXPECT_TRUE(
            alarm_.follow(*server_, std::make_shared<opcua_skill::ServerExecutor>(*server_)));
        EXPECT_TRUE(server_->start());
        client_ = opcua::Client::connect(server_->endpointUrl()).value();
        subscription_ =
            client_
                ->subscribeEvents(
                    opcua::ids::kServer,
                    {.fields = {{{0, "Severity"}}, {{0, "SourceName"}}, {{0, "Message"}}},
                     .of_type = opcua::ids::kSystemEventType},
                    [this](const auto& notice) { note(notice); })
                .value();
    }
    ~AlarmOfAServer() override {
        static_cast<void>(client_->close());
        server_->stop();
    }

    Seen next() {
        auto seen = seen_.popUntil(inAMinute());
        return seen ? std::move(*seen) : Seen{};
    }

private:
    void note(const opcua::EventNotice& notice) {
        if (notice.kind == opcua::EventNotice::Kind::event) {
            static_cast<void>(
                seen_.tryPush({notice.fields[0].as<std::uint16_t>().value(),
                               notice.fields[1].as<std::string>().value(),
                               notice.fields[2].as<opcua::LocalizedText>().value().text}));
        }
    }

    Queue<Seen> seen_{10};
    std::unique_ptr<opcua::Server> server_;

protected:
    ServerAlarm alarm_{"ur5", "Records"};  // ends before the server

private:
    std::unique_ptr<opcua::Client> client_;
    opcua::Subscription subscription_;
};

TEST_F(AlarmOfAServer, IsAnEventWhenItBeginsAndWhenItIsOver) {
    alarm_.tell(ServerAlarm::Kind::begins, "the disk is full");
    const auto begins = next();
    EXPECT_EQ(begins.severity, 800);
    EXPECT_EQ(begins.source, "Records");
    EXPECT_EQ(begins.message, "the disk is full");
    alarm_.tell(ServerAlarm::Kind::over, "there is room again");
    const auto over = next();
    EXPECT_EQ(over.severity, 100);
    EXPECT_EQ(over.message, "there is room again");
}

TEST(AlarmWithoutAServer, IsOnlyLogged) {
    ServerAlarm alarm("ur5", "Records");
    alarm.tell(ServerAlarm::Kind::begins, "nobody hears this");
}

}  // namespace
}  // namespace metier::server::testing
