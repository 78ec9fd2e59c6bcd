#include "metier/security/certificate.hpp"

#include <gmock/gmock.h>

#include "metier/security/identity.hpp"

#include <fstream>

#include "authority.hpp"

namespace metier::security {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(Certificate, TellsWhoseItIs) {
    const auto certificate = selfSigned({.name = "arm 7", .uri = "urn:cell:arm7"});
    EXPECT_EQ(certificate.subject(), "CN=arm 7");
    EXPECT_EQ(certificate.issuer(), "CN=arm 7");
    EXPECT_EQ(certificate.applicationUri(), "urn:cell:arm7");
    EXPECT_EQ(certificate.keyBits(), 2048);
    EXPECT_TRUE(certificate.isSelfSigned());
    EXPECT_FALSE(certificate.isAuthority());
    EXPECT_EQ(certificate.thumbprint().size(), 40U);
    EXPECT_EQ(certificate.thumbprint(), thumbprintOf(certificate.der()));
}

TEST(Certificate, HasTheThumbprintThatOthersCompute) {
    EXPECT_EQ(thumbprintOf("abc"), "a9993e364706816aba3e25717850c26c9cd0d89d");  // FIPS 180-4
}

TEST(Certificate, IsKnownByItsSigner) {
    const Authority authority("factory");
    const auto certificate = authority.sign({.name = "arm"});
    EXPECT_EQ(certificate.issuer(), "CN=factory");
    EXPECT_FALSE(certificate.isSelfSigned());
    EXPECT_TRUE(authority.certificate().isAuthority());
    EXPECT_TRUE(authority.certificate().isSelfSigned());
}

TEST(Certificate, IsTheFirstOfAChain) {
    const auto first = selfSigned({.name = "first"});
    const auto second = selfSigned({.name = "second"});
    const auto chain = Certificate::fromDer(first.der() + second.der());
    ASSERT_TRUE(chain);
    EXPECT_EQ(*chain, first);
}

TEST(Certificate, HasNoUriWhereItHasSeveral) {
    EXPECT_EQ(selfSigned({.uri = "urn:a,URI:urn:b"}).applicationUri(), "");
    EXPECT_EQ(selfSigned({.uri = ""}).applicationUri(), "");
}

TEST(Certificate, IsPrintedWithoutControlCharacters) {
    const auto certificate = selfSigned({.name = "arm\x1b[2J\n"});
    EXPECT_THAT(certificate.subject(), Not(HasSubstr("\x1b")));
    EXPECT_THAT(certificate.subject(), Not(HasSubstr("\n")));
}

TEST(Certificate, IsReadAsDerAndPem) {
    const auto certificate = selfSigned({});
    const auto folder = std::filesystem::path(::testing::TempDir());
    std::ofstream(folder / "c.der") << certificate.der();
    std::ofstream(folder / "c.pem") << certificate.pem();
    EXPECT_EQ(Certificate::fromFile(folder / "c.der").value(), certificate);
    EXPECT_EQ(Certificate::fromFile(folder / "c.pem").value(), certificate);
}

TEST(Certificate, IsNotMadeOfAnythingElse) {
    EXPECT_EQ(Certificate::fromDer("").error().code, Errc::invalid_argument);
    EXPECT_EQ(Certificate::fromDer("certificate").error().message,
              "11 byte that are no X.509 certificate");
    const auto certificate = selfSigned({});
    EXPECT_FALSE(Certificate::fromDer(certificate.der().substr(0, certificate.der().size() - 1)));
    EXPECT_EQ(Certificate::fromFile("/none").error().code, Errc::not_found);
    const auto file = std::filesystem::path(::testing::TempDir()) / "c.txt";
    std::ofstream(file) << std::string(70'000, 'x');
    EXPECT_EQ(Certificate::fromFile(file).error().code, Errc::invalid_argument);
}

// As many devices have: their time seemed over long ago, since a number ran over.
// OpenSSL also reads lengths that are longer than they need to be, and writes the short ones.
TEST(Certificate, IsRefusedInAnotherEncodingThanDer) {
    const auto identity =
        makeIdentity({.application_name = "arm", .application_uri = "urn:arm", .hosts = {"host"}},
                     std::chrono::system_clock::now())
            .value();
    const auto& der = identity.certificate.der();
    ASSERT_EQ(der.substr(0, 2), "\x30\x82") << "a sequence with a length of two bytes";
    const auto longer = std::string("\x30\x83\0", 3) + der.substr(2);
    const auto refused = Certificate::fromDer(longer);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::invalid_argument);
    EXPECT_TRUE(Certificate::fromDer(der));
}

TEST(Certificate, MayBeValidForThousandsOfYears) {
    const auto certificate =
        Certificate::fromFile(std::string(METIER_TRUST_SEEDS) + "/without_end.der");
    ASSERT_TRUE(certificate) << certificate.error().message;
    EXPECT_GT(certificate->notAfter(),
              std::chrono::system_clock::now() + std::chrono::days(36'500));
    EXPECT_LT(certificate->notBefore(), std::chrono::system_clock::now());
}

}  // namespace
}  // namespace metier::security
