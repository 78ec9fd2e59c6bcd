#include "metier/server/identity.hpp"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include "lab.hpp"

namespace metier::server::testing {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::Field;
using ::testing::HasSubstr;

constexpr const char* kUrl = "opc.tcp://127.0.0.1:4840";

class IdentityOfAServer : public ::testing::Test {
protected:
    ~IdentityOfAServer() override { fs::remove_all(folder_); }

    static security::IdentityOptions options() {
        return {.application_name = "metier test",
                .application_uri = "urn:here:metier:test",
                .hosts = {"localhost"}};
    }
    Identity make(const std::string& name = "test") const {
        return Identity::create(closed_, name, options()).value();
    }

    const fs::path folder_ = freshFolder() / "security";
    const Security closed_{.folder = folder_};
    const Security lab_{.insecure_lab = true, .folder = folder_};
};

TEST_F(IdentityOfAServer, IsMadeOnceAndKept) {
    const auto first = make();
    const auto second = make();
    ASSERT_TRUE(first.credentials() && second.credentials());
    const auto& certificate = first.credentials()->identity.certificate;
    EXPECT_EQ(certificate.applicationUri(), "urn:here:metier:test");
    EXPECT_EQ(certificate.thumbprint(), second.credentials()->identity.certificate.thumbprint());
    EXPECT_NE(certificate.thumbprint(),
              make("other").credentials()->identity.certificate.thumbprint());
    EXPECT_EQ(first.credentials()->trust_folder, folder_ / "trust");
    EXPECT_EQ(first.credentials()->identity_folder, folder_ / "own" / "test");
}

TEST_F(IdentityOfAServer, MakesItsConnectionsSecure) {
    const auto identity = make();
    opcua::ClientOptions connection;
    ASSERT_TRUE(identity.secure(connection, kUrl));
    ASSERT_TRUE(connection.security);
    EXPECT_EQ(connection.security->identity.certificate.thumbprint(),
              identity.credentials()->identity.certificate.thumbprint());
}

TEST_F(IdentityOfAServer, IsNobodysInALabAndNeedsNoFolder) {
    const auto lab = Identity::create(lab_, "test", options());
    ASSERT_TRUE(lab);
    EXPECT_FALSE(lab->credentials());
    opcua::ClientOptions connection;
    EXPECT_TRUE(lab->secure(connection, kUrl));
    EXPECT_FALSE(connection.security);
    EXPECT_FALSE(fs::exists(folder_));
}

TEST_F(IdentityOfAServer, SpeaksToNoOpenServerWhereAClosedOneWas) {
    const auto identity = make();
    opcua::ClientOptions connection;
    ASSERT_TRUE(identity.secure(connection, kUrl));
    identity.noteConnected(connection, kUrl);
    EXPECT_TRUE(closed_.wasClosed(kUrl));
    const auto lab = Identity::create(lab_, "test", options()).value();
    opcua::ClientOptions open;
    const auto refused = lab.secure(open, kUrl);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::access_denied);
    EXPECT_THAT(refused.error().message, AllOf(HasSubstr("was closed before"), HasSubstr(kUrl)));
    lab_.noteServedOpen(kUrl);
    EXPECT_TRUE(lab.secure(open, kUrl)) << "by the hand of its own user";
    lab.noteConnected(open, kUrl);
    EXPECT_FALSE(lab_.wasClosed(kUrl)) << "an open connection proves nothing";
}

TEST_F(IdentityOfAServer, IsRefusedWhereOthersMayWrite) {
    fs::create_directories(folder_);
    ASSERT_EQ(chmod(folder_.c_str(), 0777), 0);
    const auto refused = Identity::create(closed_, "test", options());
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::access_denied);
}

TEST_F(IdentityOfAServer, HasNameAndPortOfItsConfiguration) {
    cell::ServerConfig config;
    config.name = "ur5";
    config.port = 4841;
    config.address = "127.0.0.1";
    const auto fixed = identityOf(config, closed_).value();
    EXPECT_EQ(fixed.credentials()->identity_folder, folder_ / "own" / "ur5-4841");
    EXPECT_THAT(fixed.credentials()->identity.certificate.applicationUri(),
                HasSubstr(":metier:ur5:4841"));
    config.port = 0;
    const auto free = identityOf(config, closed_).value();
    EXPECT_EQ(free.credentials()->identity_folder, folder_ / "own" / "ur5");
}

TEST_F(IdentityOfAServer, NamesTheHostByWhichOthersReachIt) {
    cell::ServerConfig config;
    config.name = "ur5";
    config.address = "0.0.0.0";
    config.discovery.announce_as = "robot.example";
    const auto identity = identityOf(config, closed_).value();
    const auto& certificate = identity.credentials()->identity.certificate;
    EXPECT_THAT(certificate.applicationUri(), HasSubstr("urn:robot.example:metier:ur5:"));
}

}  // namespace
}  // namespace metier::server::testing
