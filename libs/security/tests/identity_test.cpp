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

TEST(Identity, IsRefusedWithoutANameThatFits) {
    const auto now = std::chrono::system_clock::now();
    EXPECT_EQ(makeIdentity({.application_name = ""}, now).error().code, Errc::invalid_argument);
    EXPECT_TRUE(makeIdentity({.application_name = std::string(64, 'a')}, now));
    const auto refused = makeIdentity({.application_name = std::string(65, 'a')}, now);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::invalid_argument);
    EXPECT_THAT(refused.error().message, HasSubstr("1 to 64 bytes, not 65"));
    const std::string cut("arm\0 7", 6);
    EXPECT_FALSE(makeIdentity({.application_name = cut}, now)) << "the certificate would say arm";
}

TEST(Identity, IsRefusedWithAnAddressThatIsNone) {
    const auto now = std::chrono::system_clock::now();
    for (const auto* host : {"10.0.0.256", "1.2.3", "1.2.3.4.5", "...", "7"}) {
        const auto refused = makeIdentity({.hosts = {"localhost", host}}, now);
        ASSERT_FALSE(refused) << host;
        EXPECT_EQ(refused.error().code, Errc::invalid_argument) << host;
        EXPECT_THAT(refused.error().message, HasSubstr(std::string("IP:") + host));
    }
}

TEST(Identity, IsValidForADayToAHundredYears) {
    using std::chrono::days;
    const auto now = std::chrono::system_clock::now();
    const auto shortest = makeIdentity({.lifetime = days(1)}, now).value();
    EXPECT_GT(shortest.certificate.notAfter(), now + 23h);
    EXPECT_GT(makeIdentity({.lifetime = days(36'525)}, now)->certificate.notAfter(),
              now + days(36'524));
    for (const auto lifetime : {days(0), days(-1), days(36'526), days::max()}) {
        EXPECT_EQ(makeIdentity({.lifetime = lifetime}, now).error().code, Errc::invalid_argument);
        EXPECT_EQ(makeSuccessor(shortest, lifetime, now).error().code, Errc::invalid_argument);
    }
}

TEST_F(IdentityFolder, KeepsTheFormerIdentityIfTheNewOneCannotBeWritten) {
    const auto former = makeIdentity({}, now_).value();
    ASSERT_TRUE(saveIdentity(folder_, former));
    const auto unknown = std::filesystem::path("/proc/self/identity");
    EXPECT_EQ(saveIdentity(unknown, former).error().code, Errc::resource_unavailable);
    // A folder in the place of the certificate: the identity itself is written first, whole.
    std::filesystem::remove(folder_ / "certificate.der");
    std::filesystem::create_directories(folder_ / "certificate.der" / "x");
    const auto next = makeIdentity({}, now_).value();
    const auto refused = saveIdentity(folder_, next);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr("certificate.der"));
    EXPECT_EQ(loadIdentity(folder_)->certificate, next.certificate);
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 2)
        << "nothing is left of what could not be written";
}

}  // namespace
}  // namespace metier::security
