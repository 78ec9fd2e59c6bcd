#include "host/server_audit.hpp"

#include <gmock/gmock.h>

#include "lab.hpp"
#include "metier/opcua/server.hpp"
#include "metier/opcua_skill/namespaces.hpp"
#include "metier/opcua_skill/server_executor.hpp"
#include "metier/server/audit_anchor.hpp"

namespace metier::server::testing {
namespace {

class AuditedServer : public ::testing::Test {
protected:
    ~AuditedServer() override { std::filesystem::remove_all(folder_); }

    cell::ServerConfig config() const {
        cell::ServerConfig config;
        config.name = "iiwa";
        config.address = "127.0.0.1";
        config.state_folder = folder_;
        return config;
    }
    static opcua::ServerOptions options() {
        opcua::ServerOptions options;
        options.port = 0;
        options.nodesets = {"device", "robotics", "metier"};
        return options;
    }

    const std::filesystem::path folder_ = freshFolder();
    const std::filesystem::path log_ = folder_ / "audit" / "iiwa-127.0.0.1-0.log";
};

TEST_F(AuditedServer, ShowsTheNewestChainValueOfItsLog) {
    std::unique_ptr<opcua::Server> server;  // ends after its audit log
    auto made = options();
    const auto audit = ServerAudit::open(config(), made).value();
    server = opcua::Server::create(std::move(made)).value();
    ASSERT_TRUE(audit->follow(*server, std::make_shared<opcua_skill::ServerExecutor>(*server)));
    ASSERT_TRUE(server->start());
    // This is recorded
    const auto client = opcua::Client::connect(server->endpointUrl()).value();
    const auto metier = client->namespaceIndex(opcua_skill::kMetierUri).value();
    const auto anchor = client->translate(opcua::ids::kServer, {{metier, kAuditAnchor}}).value();
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    std::string shown(64, '0');
    while (shown == std::string(64, '0') && std::chrono::steady_clock::now() < deadline) {
        shown = client->read(anchor).value().as<std::string>().value();
    }
    const auto verified = security::verify(log_, {shown});
    ASSERT_TRUE(verified) << verified.error().message;
    EXPECT_EQ(verified->anchors.size(), 1U);
    EXPECT_FALSE(client->write(anchor, opcua::Value::of(std::string("mine"))));
    ASSERT_TRUE(client->close());
    server->stop();
}

TEST_F(AuditedServer, KeepsNoLogWithoutAStateFolder) {
    auto unkept = config();
    unkept.state_folder.clear();
    auto made = options();
    const auto audit = ServerAudit::open(unkept, made);
    ASSERT_TRUE(audit);
    EXPECT_EQ(*audit, nullptr);
    EXPECT_FALSE(made.on_audit);
}

TEST_F(AuditedServer, HandsOnWhatOthersWantToHear) {
    int heard = 0;
    auto made = options();
    made.on_audit = [&heard](const opcua::AuditRecord& /*record*/) { ++heard; };
    {
        const auto audit = ServerAudit::open(config(), made).value();
        opcua::AuditRecord record;
        record.time = std::chrono::system_clock::now();
        record.event = "Start";
        made.on_audit(record);
    }
    EXPECT_EQ(heard, 1);
    const auto verified = security::verify(log_);
    ASSERT_TRUE(verified) << verified.error().message;
    EXPECT_EQ(verified->entries, 1U);
}

TEST_F(AuditedServer, IsRefusedALogThatIsNone) {
    std::filesystem::create_directories(log_.parent_path());
    std::ofstream(log_) << "this is no audit log\n";
    auto made = options();
    const auto audit = ServerAudit::open(config(), made);
    ASSERT_FALSE(audit);
    EXPECT_EQ(audit.error().code, Errc::invalid_argument);
}

}  // namespace
}  // namespace metier::server::testing
