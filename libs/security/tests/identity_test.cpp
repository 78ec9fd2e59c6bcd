#include "metier/security/identity.hpp"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include <fstream>

namespace metier::security {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

class IdentityFolder : public ::testing::Test {
protected:
    IdentityFolder() { std::filesystem::remove_all(folder_); }
    static mode_t modeOf(const std::filesystem::path& file) {
        struct stat found {};
        ::stat(file.c_str(), &found);
        return found.st_mode & 0777U;
    }

    const UtcTime now_ = std::chrono::system_clock::now();
    const std::filesystem::path folder_ =
        std::filesystem::path(::testing::TempDir()) /
        ::testing::UnitTest::GetInstance()->current_test_info()->name() / "own";
};

TEST_F(IdentityFolder, GivesTheIdentityThatWasSaved) {
    const IdentityOptions options{.application_name = "metier ur5",
                                  .application_uri = "urn:host:metier:ur5:48411",
                                  .hosts = {"host", "127.0.0.1"}};
    const auto made = makeIdentity(options, now_);
    ASSERT_TRUE(made) << made.error().message;
    EXPECT_EQ(made->certificate.subject(), "CN=metier ur5");
    EXPECT_EQ(made->certificate.applicationUri(), "urn:host:metier:ur5:48411");
    EXPECT_EQ(made->certificate.keyBits(), 2048);
    EXPECT_LT(made->certificate.notBefore(), now_);
    EXPECT_GT(made->certificate.notAfter(), now_ + 729 * 24h);
    EXPECT_LT(made->certificate.notAfter(), now_ + 731 * 24h);
    ASSERT_TRUE(saveIdentity(folder_, *made));
    const auto again = loadIdentity(folder_);
    ASSERT_TRUE(again) << again.error().message;
    EXPECT_EQ(again->certificate, made->certificate);
    EXPECT_EQ(again->private_key, made->private_key);
}

TEST_F(IdentityFolder, ShowsItsKeyToItsOwnerAlone) {
    ASSERT_TRUE(saveIdentity(folder_, makeIdentity({}, now_).value()));
    EXPECT_EQ(modeOf(folder_ / "identity.pem"), 0600U);
    EXPECT_EQ(modeOf(folder_ / "certificate.der"), 0644U);
    EXPECT_EQ(modeOf(folder_), 0700U);
    ::chmod((folder_ / "identity.pem").c_str(), 0640);
    const auto refused = loadIdentity(folder_);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::access_denied);
    EXPECT_THAT(refused.error().message, HasSubstr("mode 640, must be 600"));
}

TEST_F(IdentityFolder, IsNotReadIfItsKeyIsOfAnotherCertificate) {
    const auto one = makeIdentity({}, now_).value();
    const auto other = makeIdentity({}, now_).value();
    ASSERT_TRUE(saveIdentity(folder_, {one.certificate, other.private_key}));
    EXPECT_EQ(loadIdentity(folder_).error().code, Errc::invalid_argument);
    std::ofstream(folder_ / "identity.pem") << "nonsense";
    EXPECT_EQ(loadIdentity(folder_).error().code, Errc::invalid_argument);
}

TEST_F(IdentityFolder, HasNoneAtFirst) {
    EXPECT_EQ(loadIdentity(folder_).error().code, Errc::not_found);
}

TEST_F(IdentityFolder, ThatCannotBeWrittenIsTold) {
    const auto file = std::filesystem::path(::testing::TempDir()) / "a_file";
    std::ofstream(file) << "x";
    const auto refused = saveIdentity(file / "own", makeIdentity({}, now_).value());
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr(file.string()));
}

TEST(Identity, IsRefusedWithAWeakKeyOrNamesThatSayMore) {
    const auto now = std::chrono::system_clock::now();
    EXPECT_THAT(makeIdentity({.key_bits = 1024}, now).error().message,
                HasSubstr("1024 bit is not within 2048 to 4096"));
    EXPECT_FALSE(makeIdentity({.application_uri = ""}, now));
    EXPECT_FALSE(makeIdentity({.application_uri = "urn:a,DNS:bank"}, now));
    EXPECT_FALSE(makeIdentity({.hosts = {"a b"}}, now));
    EXPECT_FALSE(makeIdentity({.hosts = {""}}, now));
}

}  // namespace
}  // namespace metier::security
